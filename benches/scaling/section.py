"""The section of docs/benchmarks.md."""

import results
from page import table, two_digits, wrapped

PLOT = "images/scaling.svg"


def text(records, axes):
    """The section's Markdown."""
    lines = ["## Scaling", "", wrapped(ABOUT), "", f"![{ALT}]({PLOT})", ""]
    for axis in axes:
        lines += [*along(axis, results.lines(records, axis.name)), ""]
    return "\n".join([*lines, *notes(records)]).rstrip()


def along(axis, lines):
    """Milliseconds per frame, and below them the cost of each step."""
    labels = dict.fromkeys(point.label for point in axis.points)
    rows = [[f"{named(*key)}, ms", *(shown(record.median) for record in line)] for key, line in lines.items()]
    if axis.name in STEPS:
        what, step = STEPS[axis.name]
        for key, line in lines.items():
            rows.append([f"{named(*key)}, {what}", *steps(line, step)])
    return table([axis.title, *labels], rows)


def named(shading, line):
    return f"`{shading}`, {line}" if line else f"`{shading}`"


def shown(ms):
    if ms is None:
        return "–"
    return f"{ms:.2f}" if ms < 10 else f"{ms:.1f}" if ms < 100 else f"{ms:.0f}"


def steps(line, step):
    """The result of `step` for each record and the previous one; the first has none."""
    cells = ["–"]
    for before, here in zip(line, line[1:]):
        lacks = before.median is None or here.median is None
        cells.append("–" if lacks else step(before, here, line))
    return cells


def nanoseconds(before, here, _):
    """Nanoseconds per additional unit."""
    return signed((here.median - before.median) * 1e6 / (here.amount - before.amount))


def of_lights(_, here, line):
    """Nanoseconds per light beyond the first and pixel that shows the vessel."""
    first = line[0]
    if first.median is None:
        return "–"
    return signed((here.median - first.median) * 1e6 / (here.amount - first.amount) / (here.coverage * here.pixels))


def times_as_fast(_, here, line):
    """The speed relative to the first."""
    return "–" if line[0].median is None else f"{line[0].median / here.median:.2f}"


def signed(x):
    """With two digits, also if a time decreased by chance."""
    return "0" if x == 0 else f"{'−' if x < 0 else ''}{two_digits(abs(x))}"


def notes(records):
    """The reasons for dashes."""
    sentences = [f"No figure of {r.label} {r.axis} ({named(r.shading, r.line)}): {r.why}." for r in records if r.why]
    if any(record.is_busy() for record in records):
        sentences.append("Other dashes were measured while other programs used the processor.")
    return [wrapped(" ".join(sentences))] if sentences else []


# By axis: the meaning of a step, and how it is counted.
STEPS = {
    "triangles": ("ns per further triangle", nanoseconds),
    "pixels": ("ns per further pixel", nanoseconds),
    "lights": ("ns per light beyond the first and pixel of the vessel", of_lights),
    "threads": ("times as fast as one", times_as_fast),
}

ALT = "Milliseconds per frame over triangles, pixels, lights, texels and threads"

ABOUT = (
    "One thing at a time changes in the scene of [Rendering](#rendering): 199,680 triangles, 1024² pixels, one light, "
    "maps of 2048², all threads (`benches/scaling/axes.py`). More lights are points on a ring around it that share the "
    "intensity of one; maps of other sizes show the same. Images of 64² have almost no pixels to shade: they show the "
    "cost of the triangles only. Each frame rotates the object, draws it at one sample per pixel and ends with all "
    "pixels as 8-bit sRGB in memory; `ggx` is under an environment too. Medians of the frames of all rounds; all "
    "points of an axis alternate."
)
