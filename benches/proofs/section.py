"""The section of docs/proofs.md."""

import collections
import dataclasses
import math

from page import row, wrapped

HEAD = (
    "scan", "program", "triangles", "kB", "mean °", "p95 °", "worst 1 % °", "surface mean °", "distance ≤ %",
    "missed %", "FLIP", "standard",
)  # fmt: skip
TITLES = {
    "whole": "## The whole scan, packed",
    "triangles": "## Equal triangle counts",
    "bytes": "## Equal bytes",
}


@dataclasses.dataclass(frozen=True)
class Measured:
    """How it was measured: machine, versions of the other programs, fraction of the triangles, and fractions of the
    bytes for scans without and with textures."""

    machine: str
    versions: str
    ratio: float
    budgets: tuple[float, float]


@dataclasses.dataclass(frozen=True)
class Row:
    """A program's asset with the report of its proof, or why there is none."""

    program: str
    asset: object = None
    report: dict | None = None
    failed: str | None = None

    @property
    def level(self):
        return self.report["proof"]["levels"][0]

    @property
    def mean(self):
        """The mean angle as seen; infinite if no pixel shows both."""
        return found(self.level["overview"]["angles"], "summary", "mean")

    @property
    def unmet(self):
        return [required["figure"] for required in self.report["required"] if not required["met"]]


def text(measured, results):
    """The section's Markdown; `results` are pairs of a scan and its rows by comparison."""
    lines = [wrapped(f"Measured on: {measured.machine}; {measured.versions}.")]
    for kind, title in TITLES.items():
        prose = f"{about(kind, measured)} {summary(results, kind)}"
        lines += ["", title, "", wrapped(prose), "", row(HEAD), "|---|---|" + "---:|" * (len(HEAD) - 3) + "---|"]
        lines += [line for scan, rows in results for line in scan_rows(scan, rows[kind])]
    return "\n".join(lines)


def about(kind, measured):
    plain, textured = measured.budgets
    return {
        "whole": "No triangle is removed.",
        "triangles": f"{measured.ratio:.0%} of the scan's triangles; bytes follow.",
        "bytes": f"{plain:.0%} of the bytes of the whole scan packed, {textured:.0%} with textures; triangles follow.",
    }[kind]


def summary(results, kind):
    """Counts of scans by program: with the smallest mean angle, meeting `standard`, and better left unreduced.

    Scans with an asset that could not be proved are excluded.
    """
    complete = [rows for _, rows in results if not any(row.failed for row in rows[kind])]
    best = [min(rows[kind], key=lambda row: row.mean) for rows in complete]
    passing = [row for rows in complete for row in rows[kind] if not row.unmet]
    outdone = [row for rows in complete for row in rows[kind] if is_outdone(row, rows["whole"])]
    facts = [f"smallest mean angle as seen: {counts(best)}", f"`standard` met: {counts(passing)}"]
    if kind != "whole":
        facts.append(f"the whole scan, packed, has both fewer bytes and a smaller mean angle: {counts(outdone)}")
    return f"**Of {len(complete)} scans with every asset proved: {'; '.join(facts)}.**"


def is_outdone(row, whole):
    """True if an asset of the whole scan has fewer bytes and a smaller mean angle."""
    others = [other for other in whole if not (row.failed or other.failed)]
    return any(other.asset.bytes < row.asset.bytes and other.mean < row.mean for other in others)


def counts(rows):
    """The number of rows of each program, the most first."""
    count = collections.Counter(row.program for row in rows)
    return ", ".join(f"{name} {times}" for name, times in count.most_common()) or "none"


def scan_rows(scan, rows):
    yield row([scan.name, "as it is", f"{scan.triangles:,}", kilobytes(scan.bytes), *["–"] * (len(HEAD) - 4)])
    yield from (row(["", one.program, *cells(one)]) for one in rows)


def cells(one):
    if one.failed:
        return [f"failed: {one.failed}".replace("|", "\\|"), *["–"] * (len(HEAD) - 3)]
    return [f"{one.asset.triangles:,}", kilobytes(one.asset.bytes), *figures(one.level), verdict(one)]


def figures(level):
    seen, on_surface, patch = level["overview"]["angles"], level["surface_angles"], level["patches"]["angle"]
    missed = max(level["coverage"]["missed_of_scan"], level["coverage"]["missed_of_asset"])
    flip = [view["flip"] for view in level["views"]]
    angles = [found(seen, "summary", key) for key in ("mean", "p95")]
    angles += [found(patch, "mean"), found(on_surface, "mean")]
    yield from (f"{angle:.2f}" if angle < math.inf else "–" for angle in angles)
    yield f"{100 * level['hausdorff_of_diagonal']['upper']:.2f}"
    yield f"{100 * missed:.3f}"
    yield f"{sum(flip) / len(flip):.4f}"


def found(tree, *path):
    """The number at the path; infinite if nothing was measured."""
    for key in path:
        tree = tree and tree[key]
    return math.inf if tree is None else tree


def verdict(one):
    return "met" if not one.unmet else "not met: " + ", ".join(one.unmet)


def kilobytes(count):
    return f"{count / 1000:.1f}"
