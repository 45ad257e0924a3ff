"""The section of docs/benchmarks.md."""

import statistics

import cases
from page import table, two_digits, wrapped


def milliseconds(x):
    return f"{x:.1f}" if x < 100 else f"{x:.0f}"


def text(machine, run, differences):
    """The section's Markdown."""
    lines = ["## Rendering", "", wrapped(f"{ABOUT} Measured on: {machine}."), ""]
    titles = {one.name: one.title for one in run.some}
    for shading in cases.SHADINGS:
        some = {case: times for case, times in run.times.items() if case[1] == shading}
        if some:
            lines += [*warm(shading, some, titles), ""]
    lines += [wrapped(apart(differences)), ""]
    return "\n".join([*lines, "The commands:", "", "```sh", *COMMANDS, "```"])


def warm(shading, results, titles):
    """Milliseconds a frame of each participant, with the ratio to the first."""
    sizes = list(dict.fromkeys(size for _, _, size in results))
    meshes = list(dict.fromkeys(mesh for mesh, _, _ in results))
    columns = [(mesh, shading, size) for size in sizes for mesh in meshes]
    names = [name for name in titles if any(name in results.get(case, {}) for case in columns)]
    heads = [f"{cases.MESHES[mesh]}, {size[0]}×{size[1]}" for mesh, _, size in columns]
    rows = [[titles[name], *(cell(results.get(case, {}), name) for case in columns)] for name in names]
    return [f"`{shading}`, milliseconds a frame (times Taotie's):", "", *table(["triangles, pixels", *heads], rows)]


def cell(times, name):
    if name not in times:
        return "–"
    own = statistics.median(times[name])
    first = statistics.median(times["taotie"])
    ratio = "" if name == "taotie" else f" ({two_digits(own / first)})"
    return f"{milliseconds(own)}{ratio}"


def apart(differences):
    """A sentence on the pictures."""
    told = [f"{case.replace('-', ' ', 1)} {d['mean']:.1f}" for case, d in differences.items()]
    return (
        "The pictures of Taotie and of llvmpipe differ by so many codes of 8 bits on average over the object: "
        f"{', '.join(told)}."
    )


ABOUT = (
    "`make bench-render` shows a carved bronze vessel with three maps of 2048² (`benches/render/scene.py`) by each "
    "program in turn. Each frame turns the object, draws it at one sample a pixel with trilinear filtering, and ends "
    "with all pixels as 8-bit sRGB in memory. Median milliseconds over all rounds; in brackets the multiple of Taotie's."
)

COMMANDS = (
    "make bench-render                 # everything; writes this section",
    "make bench-render BENCH=--quick   # Taotie and llvmpipe at 1024²; prints it",
)
