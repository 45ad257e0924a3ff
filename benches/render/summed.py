"""The rows of the summary: Taotie and each peer, by round."""

import statistics

import cases
from cold import FRESH, KEPT
from rows import Row

# The peer with a goal, and the goal by mesh at the first size.
RIVAL, GOALS = "llvmpipe", {"2k": 2, "200k": 3, "2m": 3}


def rows(run):
    """All rows: frames, whole processes, memory."""
    peers = [one for one in run.some if one.name != "taotie"]
    return [*frames(run, peers), *processes(run, peers), *memory(run, peers)]


def frames(run, peers):
    return [row for case in run.times for row in of_case(run, peers, case).values()]


def of_case(run, peers, case):
    """The row of each peer that has figures of the case, by name."""
    mesh, shading, size = case
    medians = {name: [statistics.median(turn) for turn in turns] for name, turns in run.times[case].items()}
    title = f"frame, `{shading}`, {size[0]}×{size[1]}, {cases.MESHES[mesh]} triangles"
    found = {}
    for one in peers:
        if one.name in medians and "taotie" in medians:
            goal = GOALS[mesh] if one.name == RIVAL and size == cases.SIZES[0] else None
            load = run.watches[case].share("taotie", one.name)
            found[one.name] = Row(title, one.title, "ms", medians["taotie"], medians[one.name], goal, load)
    return found


def processes(run, peers):
    return [row for key in run.cold.watches for row in of_processes(run, peers, *key).values()]


def of_processes(run, peers, shading, kind):
    """The row of each peer that has figures, by name."""
    found = {}
    own = run.cold.seconds(shading, "taotie", kind)
    for one in peers:
        other = run.cold.seconds(shading, one.name, kind)
        if own and other:
            load = run.cold.watches[shading, kind].share("taotie", one.name)
            title = f"process to PNG, `{shading}`, caches {kind}"
            found[one.name] = Row(title, one.title, "s", own, other, None, load)
    return found


def memory(run, peers):
    """Peaks at the first size."""
    found = []
    for (mesh, shading), peaks in run.mib.items():
        title = f"frame, `{shading}`, {cases.MESHES[mesh]} triangles: peak memory"
        own = [peaks["taotie"]] if "taotie" in peaks else []
        found += [Row(title, one.title, "MiB", own, [peaks[one.name]]) for one in peers if own and one.name in peaks]
    return found
