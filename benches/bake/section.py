"""The section of docs/benchmarks.md."""

from page import seconds, table, two_digits, wrapped

# Minimum ratios of Blender's time and memory to Taotie's.
TIME_GOAL, MEMORY_GOAL = 12, 6


def times(results):
    ratios = [f"ratio (goal {goal})" for goal in (TIME_GOAL, MEMORY_GOAL)]
    head = ["job", "rounds", "Taotie s", "Blender s", ratios[0], "Taotie MiB", "Blender MiB", ratios[1]]
    return table(head, [_times_row(*result) for result in results])


def _times_row(job, rounds, bakers):
    own, other = bakers["taotie"], bakers.get("blender")
    cells = [job.title, str(rounds)]
    for key, show in (("seconds", seconds), ("mib", lambda mib: f"{mib:.0f}")):
        peer = [show(other[key]), two_digits(other[key] / own[key])] if other else ["–", "–"]
        cells += [show(own[key]), *peer]
    return cells


def errors(accuracy):
    head = ["normals of the 1 M job", "mean °", "median °", "95 % below °"]
    rows = [[name, *(f"{e[key]:.3f}" for key in ("mean", "median", "p95"))] for name, e in accuracy["maps"].items()]
    return table(head, rows)


def about_blender(results, lacks):
    if lacks:
        return f"Blender was not available ({lacks}), so only Taotie was measured."
    answers = [bakers["blender"] for _, _, bakers in results if "blender" in bakers]
    longest = max(answer["import"] for answer in answers)
    return (
        f"Blender is {answers[0]['version']} (`bpy`, Cycles on the CPU, selected to active). Its time is load, "
        f"bake and save; the import of its module, up to {seconds(longest)} s, is not counted."
    )


def about_errors(accuracy):
    if "lacks" in accuracy:
        return [wrapped(f"The maps' angular errors could not be measured here: {accuracy['lacks']}.")]
    prose = (
        f"Angles between the normals of a map and those of the scan, at {accuracy['points']:,} random points of the "
        "low-poly mesh, measured with Embree rays along its interpolated normals. Of the points, "
        f"{accuracy['missed']:,} hit no scan and are excluded. Taotie dithers 8-bit maps, which hides steps "
        "under a moving light at the cost of some accuracy."
    )
    return [wrapped(prose), "", *errors(accuracy)]


def text(machine, results, accuracy, lacks):
    """The section's Markdown."""
    prose = (
        "`make bench-bake` bakes a carved vessel onto 2,048 triangles (`benches/bake/scene.py`), with both programs "
        "in alternation. Median seconds, and the peak resident memory of the process. Taotie's time is that of the "
        "whole process, `taotie bake … --no-verify`; the ratios are Blender's figures divided by Taotie's."
    )
    about = wrapped(f"{prose} {about_blender(results, lacks)} Measured on: {machine}.")
    lines = ["## Baking", "", about, ""]
    lines += [*times(results), "", *about_errors(accuracy), "", "The commands:", "", "```sh"]
    return "\n".join([*lines, *COMMANDS, "```"])


COMMANDS = (
    "make bench-bake                 # all jobs; writes this section",
    "make bench-bake BENCH=--quick   # the jobs of 1 M triangles once; prints it",
)
