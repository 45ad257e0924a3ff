"""The section of docs/benchmarks.md."""

from statistics import median

from page import BUSY, seconds, table, wrapped
from rows import Row

# Minimum ratios of Blender's time and memory to Taotie's.
TIME_GOAL, MEMORY_GOAL = 12, 6


def times(results):
    ratios = [f"ratio (goal {goal})" for goal in (TIME_GOAL, MEMORY_GOAL)]
    head = ["job", "rounds", "Taotie s", "Blender s", ratios[0], "Taotie MiB", "Blender MiB", ratios[1]]
    return table(head, [_times_row(*result) for result in results])


def _times_row(job, bakers, watch):
    own, other = bakers["taotie"], bakers.get("blender", [])
    cells = [job.title, str(len(own))]
    for key, show in (("seconds", seconds), ("mib", lambda mib: f"{mib:.0f}")):
        ours, theirs = ([run[key] for run in runs] for runs in (own, other))
        if key == "seconds" and watch.is_busy(*bakers):
            cells += [BUSY, BUSY, BUSY]
        elif other:
            ratio = Row(job.title, "Blender", key, ours, theirs).ratio_text()
            cells += [show(median(ours)), show(median(theirs)), ratio]
        else:
            cells += [show(median(ours)), "–", "–"]
    return cells


def errors(accuracy):
    head = ["normals of the 1 M job", "mean °", "median °", "95 % below °"]
    rows = [[name, *(f"{e[key]:.3f}" for key in ("mean", "median", "p95"))] for name, e in accuracy["maps"].items()]
    return table(head, rows)


def about_blender(results, lacks):
    if lacks:
        return f"Blender was not available ({lacks}), so only Taotie was measured."
    longest = max((run["import"] for _, bakers, _ in results for run in bakers.get("blender", [])), default=0)
    return (
        "Blender is the Python module `bpy`, with Cycles on the CPU, selected to active. Its time is load, bake and "
        f"save; the import of its module, up to {seconds(longest)} s, is not counted."
    )


def about_errors(accuracy):
    if "lacks" in accuracy:
        return [wrapped(f"The maps' angular errors could not be measured here: {accuracy['lacks']}.")]
    prose = (
        f"Angles between the normals of a map and those of the scan, at {accuracy['points']:,} random points of the "
        "low-poly mesh, measured with Embree rays along its interpolated normals. Of the points, "
        f"{accuracy['missed']:,} hit no scan and are excluded. Taotie dithers 8-bit maps where there would be "
        "[bands](decisions/baking.md#dithered-normals), at the cost of some accuracy."
    )
    return [wrapped(prose), "", *errors(accuracy)]


def text(results, accuracy, lacks):
    """The section's Markdown."""
    prose = (
        "A carved vessel is baked onto 2,048 triangles (`benches/bake/scene.py`). Median seconds, and the peak "
        "resident memory of the process. Taotie's time is that of the whole process, `taotie bake … --no-verify`."
    )
    lines = ["## Baking", "", wrapped(f"{prose} {about_blender(results, lacks)}"), ""]
    return "\n".join([*lines, *times(results), "", *about_errors(accuracy)])
