"""The section of docs/benchmarks.md."""

import statistics

import cases
from cold import FRESH, KEPT
from page import seconds, table, two_digits, wrapped


def text(machine, run, differences):
    """The section's Markdown."""
    lines = ["## Rendering", "", wrapped(f"{ABOUT} Measured on: {machine}. {versions(run)}"), ""]
    for size in cases.SIZES:
        for shading in cases.SHADINGS:
            lines += warm(run, shading, size)
    lines += [wrapped(apart(differences)), ""] if differences else []
    lines += [*cold(run), *memory(run)]
    lines += [wrapped(notes(run)), ""] if notes(run) else []
    return "\n".join([*lines, "The commands:", "", "```sh", *COMMANDS, "```"])


def milliseconds(x):
    return f"{x:.2f}" if x < 10 else f"{x:.1f}" if x < 100 else f"{x:.0f}"


def compared(own, first, show):
    """A figure, with the multiple of Taotie's if both exist."""
    if own is None:
        return "–"
    return show(own) if first is None or own is first else f"{show(own)} ({two_digits(own / first)})"


def warm(run, shading, size):
    """Milliseconds per frame of each participant and mesh."""
    medians = {
        mesh: {name: statistics.median(times) for name, times in run.times[mesh, shading, size].items()}
        for mesh in cases.MESHES
        if (mesh, shading, size) in run.times
    }
    some = [one for one in run.some if any(one.name in row for row in medians.values())]
    if not some:
        return []
    rows = [
        [one.title, *(compared(row.get(one.name), row.get("taotie"), milliseconds) for row in medians.values())]
        for one in some
    ]
    head = [f"`{shading}`, {size[0]}×{size[1]}, ms", *(f"{cases.MESHES[mesh]} triangles" for mesh in medians)]
    return [*table(head, rows), ""]


def cold(run):
    """Seconds of whole processes, and their memory."""
    lines = []
    for shading in cases.SHADINGS:
        rows = []
        for one in run.some:
            found = [run.cold.median(shading, one.name, kind) for kind in (FRESH, KEPT)]
            if any(found):
                own = [run.cold.median(shading, "taotie", kind) for kind in (FRESH, KEPT)]
                first = [None, None] if one.name == "taotie" else own
                cells = [compared(f and f[0], t and t[0], seconds) for f, t in zip(found, first)]
                most = max(f[1] for f in found if f)
                rows.append([one.title, *cells, f"{most:.0f}"])
        if rows:
            head = [f"`{shading}`, process to PNG", "caches fresh, s", "caches kept, s", "largest process, MiB"]
            lines += [*table(head, rows), ""]
    return [wrapped(ABOUT_COLD), "", *lines] if lines else []


def memory(run):
    """MiB of the processes that render frames, at the first size."""
    lines = []
    for shading in cases.SHADINGS:
        meshes = [mesh for mesh in cases.MESHES if (mesh, shading) in run.mib]
        some = [one for one in run.some if any(one.name in run.mib[mesh, shading] for mesh in meshes)]
        if some:
            rows = [[one.title, *(memory_cell(run.mib[mesh, shading], one.name) for mesh in meshes)] for one in some]
            floors = [(floor(mesh, shading), run.mib[mesh, shading].get("taotie")) for mesh in meshes]
            shown = [f"{least:.0f}" + (f" ({two_digits(own / least)})" if own else "") for least, own in floors]
            rows.append(["maps, mesh, 40 bytes per pixel", *shown])
            head = [f"`{shading}`, peak MiB", *(f"{cases.MESHES[mesh]} triangles" for mesh in meshes)]
            lines += [*table(head, rows), ""]
    return [wrapped(ABOUT_MEMORY), "", *lines] if lines else []


def memory_cell(row, name):
    return compared(row.get(name), row.get("taotie"), lambda mib: f"{mib:.0f}")


def floor(mesh, shading):
    """The minimum memory in MiB: decoded maps, the arrays of the mesh, 40 bytes per pixel of the first size."""
    triangles = int(cases.MESHES[mesh].replace(",", ""))
    maps = cases.DECODED_MAPS * (1 if shading == "ggx" else 2 / 3)
    width, height = cases.SIZES[0]
    return maps + (triangles / 2 * cases.VERTEX + triangles * cases.TRIANGLE + 40 * width * height) / 2**20


def apart(differences):
    """A sentence about the images of Taotie and llvmpipe, of which there is at least one pair."""
    most = {}
    for case, difference in differences.items():
        shading = next(shading for shading in cases.SHADINGS if shading in case)
        most[shading] = max(most.get(shading, 0), difference["mean"])
    parts = " and ".join(f"{mean:.1f} for `{shading}`" for shading, mean in most.items())
    covered = max(difference["coverage"] for difference in differences.values())
    return (
        f"The vessel fills up to {covered:.0%} of the image. Over it, Taotie's and llvmpipe's images differ on average "
        f"by at most this many 8-bit codes: {parts}; Taotie takes more care of occlusion, of energy and of "
        "highlights narrower than a pixel."
    )


def versions(run):
    parts = [f"{one.title}: {run.about[one.name]}" for one in run.some if run.about.get(one.name)]
    return f"{'; '.join(parts)}." if parts else ""


def notes(run):
    """The differences of peers, and the reasons for dashes."""
    parts = [f"{one.title}: {one.note}." for one in run.some if one.note and run.about.get(one.name)]
    titles = {one.name: one.title for one in run.some}
    dashes = {key: why for key, (_, why) in run.slow.items()} | run.out
    parts += [
        f"No figures of {titles[name]} (`{shading}`) where there is a dash: {why}."
        for (shading, name), why in dashes.items()
    ]
    return " ".join(parts)


ABOUT = (
    "`make bench-render` renders a carved bronze vessel with maps of 2048² with each program in turn "
    "(`benches/render/scene.py`): `cook-torrance` with colours, normals and one light, `ggx` with occlusion, roughness "
    "and metalness too, and under an environment. Each frame rotates the object, draws it at one sample per pixel "
    "with trilinear filtering, and "
    "ends with all pixels as 8-bit sRGB in memory. Medians over the rounds; in brackets the multiple of Taotie's. "
    "The goal for llvmpipe at 1024×1024: 2 at 2,048 triangles, 3 from 199,680 upwards."
)

ABOUT_COLD = (
    "Whole processes, from start to a written PNG of 1024×1024 with 2,048 triangles: `taotie render` and the script of "
    "each peer. llvmpipe and lavapipe get the environment prefiltered from a file; Taotie, VTK, F3D and three.js "
    "filter it themselves, and Taotie and F3D keep that in their caches."
)

ABOUT_MEMORY = (
    "Peak memory of the processes that render frames of 1024×1024, including loading; Taotie, llvmpipe and lavapipe "
    "read "
    "the filtered environment from a file. The last row is the minimum: the decoded maps without smaller "
    "levels, the arrays of the mesh, 40 bytes per pixel; in brackets Taotie's multiple of it."
)

COMMANDS = (
    "make bench-render                 # everything, in about ten minutes; writes this section",
    "make bench-render BENCH=--quick   # Taotie and llvmpipe at 1024²; prints it",
)
