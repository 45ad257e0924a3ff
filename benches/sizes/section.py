"""The section of docs/sizes.md."""

from page import row, wrapped

HEAD = ["model", "tool", "triangles", "kB", "mean °", "p95 °", "ΔE00 base colour", "ΔE00 image"]


def text(machine, versions, results, judge):
    """The section's Markdown."""
    prose = (
        f"Measured on: {machine}; {versions}. Textures of at most 1024², a tenth of the triangles. "
        f"Images of {judge.PIXELS}² from {len(judge.AZIMUTHS)} sides."
    )
    lines = [row(HEAD), "|---|---|" + "---:|" * (len(HEAD) - 2)]
    for subject, triangles, outcomes in results:
        lines.append(row([subject.name, "as it is", f"{triangles:,}", kilobytes(subject.bytes), *["–"] * 4]))
        lines += [row(["", tool, *cells(outcome)]) for tool, outcome in outcomes]
    return "\n".join([wrapped(prose), "", *lines])


def cells(outcome):
    if "failed" in outcome:
        return [f"failed: {outcome['failed']}".replace("|", "\\|"), *["–"] * 5]
    verdict = outcome["verdict"]
    figures = (verdict.degrees, verdict.p95, verdict.albedo, verdict.image)
    return [f"{outcome['triangles']:,}", kilobytes(outcome["bytes"]), *(f"{figure:.2f}" for figure in figures)]


def kilobytes(count):
    return f"{count / 1000:.1f}"
