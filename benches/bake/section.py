"""The section of docs/benchmarks.md."""

from page import seconds, table, two_digits, wrapped

# How many times Taotie's time and memory Blender is to take at least.
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
        return f"Blender could not be asked here ({lacks}), so Taotie stands alone."
    answers = [bakers["blender"] for _, _, bakers in results if "blender" in bakers]
    longest = max(answer["import"] for answer in answers)
    return (
        f"Blender is {answers[0]['version']} (`bpy`, Cycles on the processor, selected to active). Its time is load, "
        f"bake and save; the import of its module, up to {seconds(longest)} s, is not counted."
    )


def about_errors(accuracy):
    if "lacks" in accuracy:
        return [wrapped(f"The maps' angular errors could not be measured here: {accuracy['lacks']}.")]
    prose = (
        f"Angles between the normals that a map shows and the scan's, at {accuracy['points']:,} random points of the "
        "low-poly mesh, by rays of Embree along its interpolated normals. Of the points "
        f"{accuracy['missed']:,} met no scan and are left out. Taotie dithers maps of 8 bits, which hides steps "
        "under a moving light and costs some of the angle."
    )
    return [wrapped(prose), "", *errors(accuracy)]


def text(machine, results, accuracy, lacks):
    """The section's Markdown."""
    prose = (
        "`make bench-bake` bakes a carved vessel onto 2,048 triangles (`benches/bake/scene.py`), by each program in "
        "turn. Median seconds, and the peak resident memory of the process. Taotie's time is that of the whole "
        "process from start to end, `taotie bake … --no-verify`; the ratios are Blender's figures by Taotie's."
    )
    told = wrapped(f"{prose} {about_blender(results, lacks)} Measured on: {machine}.")
    lines = ["## Baking", "", told, ""]
    lines += [*times(results), "", *about_errors(accuracy), "", "The commands:", "", "```sh"]
    return "\n".join([*lines, *COMMANDS, "```"])


COMMANDS = (
    "make bench-bake                 # all jobs; writes this section",
    "make bench-bake BENCH=--quick   # the jobs of 1 M triangles once; prints it",
)
