"""The section of docs/benchmarks.md."""

import statistics

import cases
import summed
from cold import FRESH, KEPT
from page import BUSY, seconds, table, two_digits, wrapped


def text(run, differences):
    """The section's Markdown."""
    lines = ["## Rendering", "", wrapped(ABOUT), ""]
    for size in cases.SIZES:
        for shading in cases.SHADINGS:
            lines += warm(run, shading, size)
    lines += [wrapped(apart(differences)), ""] if differences else []
    lines += [*cold(run), *memory(run)]
    lines += [wrapped(notes(run))] if notes(run) else []
    return "\n".join(lines).rstrip()


def milliseconds(x):
    return f"{x:.2f}" if x < 10 else f"{x:.1f}" if x < 100 else f"{x:.0f}"


def compared(own, first, show):
    """A figure, with the multiple of Taotie's if both exist."""
    if own is None:
        return "–"
    return show(own) if first is None or own is first else f"{show(own)} ({two_digits(own / first)})"


def cell(row, show):
    """A peer's figure, and the spread of its multiple of Taotie's; `row` of the summary, if there is one."""
    if row is None:
        return "–"
    return BUSY if row.is_busy() else f"{show(statistics.median(row.other))} ({row.spread_text()})"


def warm(run, shading, size):
    """Milliseconds per frame of each participant and mesh."""
    some = [case for case in run.times if case[1:] == (shading, size)]
    if not some:
        return []
    rows = [["Taotie", *(own_frames(run, case) for case in some)]]
    peers = [one for one in run.some if one.name != "taotie" and any(one.name in run.times[case] for case in some)]
    found = [summed.of_case(run, peers, case) for case in some]
    rows += [[one.title, *(cell(its.get(one.name), milliseconds) for its in found)] for one in peers]
    head = [f"`{shading}`, {size[0]}×{size[1]}, ms", *(f"{cases.MESHES[case[0]]} triangles" for case in some)]
    return [*table(head, rows), ""]


def own_frames(run, case):
    """Taotie's milliseconds."""
    turns = run.times[case].get("taotie")
    if run.watches[case].is_busy("taotie"):
        return BUSY
    return milliseconds(statistics.median(map(statistics.median, turns))) if turns else "–"


def cold(run):
    """Seconds of whole processes, and their memory."""
    lines = []
    for shading in cases.SHADINGS:
        kinds = [kind for kind in (FRESH, KEPT) if (shading, kind) in run.cold.watches]
        peers = [one for one in run.some if one.name != "taotie" and run.cold.mib(shading, one.name)]
        if not kinds:
            continue
        found = [summed.of_processes(run, peers, shading, kind) for kind in kinds]
        own = [own_process(run, shading, kind) for kind in kinds]
        rows = [["Taotie", *own, f"{run.cold.mib(shading, 'taotie'):.0f}"]]
        for one in peers:
            mib = f"{run.cold.mib(shading, one.name):.0f}"
            rows.append([one.title, *(cell(its.get(one.name), seconds) for its in found), mib])
        head = [f"`{shading}`, process to PNG", *(f"caches {kind}, s" for kind in kinds), "largest process, MiB"]
        lines += [*table(head, rows), ""]
    return [wrapped(ABOUT_COLD), "", *lines] if lines else []


def own_process(run, shading, kind):
    """Taotie's seconds."""
    times = run.cold.seconds(shading, "taotie", kind)
    if run.cold.watches[shading, kind].is_busy("taotie"):
        return BUSY
    return seconds(statistics.median(times)) if times else "–"


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
    "A carved bronze vessel with maps of 2048² (`benches/render/scene.py`): `cook-torrance` with colours, normals and "
    "one light, `ggx` with occlusion, roughness and metalness too, and under an environment. Each frame rotates the "
    "object, draws it at one sample per pixel with trilinear filtering, and ends with all pixels as 8-bit sRGB in "
    "memory. Medians over the rounds; in brackets the least and greatest multiple of Taotie's in a round."
)

ABOUT_COLD = (
    "Whole processes, from start to a written PNG of 1024×1024 with 2,048 triangles: `taotie render` and the script of "
    "each peer. llvmpipe and lavapipe get the environment prefiltered from a file; Taotie, VTK, F3D and three.js "
    "filter it themselves, and Taotie and F3D keep that in their caches."
)

ABOUT_MEMORY = (
    "Peak memory of the processes that render frames of 1024×1024, including loading; Taotie, llvmpipe and lavapipe "
    "read the filtered environment from a file. The last row is the minimum: the decoded maps without smaller levels, "
    "the arrays of the mesh, 40 bytes per pixel; in brackets Taotie's multiple of it."
)
