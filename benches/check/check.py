"""Compares this build with a stored one and fails if it is slower by more than 5 %: `make bench-check`.

Both builds alternate, each one first in every other round (ABBA), over all cases, so that anything that slows the
machine slows both. For each pair of runs the ratio counts, for both wall time and CPU time; verdict.py decides when
ratios are a loss. A case with a loss in either is run again with twice the rounds, and only counts as one if these
runs show a loss too: noise seldom repeats.
"""

import argparse
import json
import os
import statistics
import sys

import command
import machine
import measure
import measured
import page
import work
from command import say
from verdict import GAIN, LOSS, SAME, ratio, verdict

TARGET = "bench-check"
FOLDER = os.path.join(command.ROOT, "target", TARGET)
CLOCKS = ("wall", "processor")


def arguments():
    about = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=about)
    parser.add_argument("--folder", default=FOLDER, help="working folder")
    parser.add_argument("--base", default=os.path.join(FOLDER, "base"), help="folder of the old taotie and frames")
    parser.add_argument("--programs", default=command.PROGRAMS, help="folder of the new ones")
    parser.add_argument("--rounds", type=int, default=12, help="pairs per case, at least 2")
    parser.add_argument("--limit", type=float, default=1.05, help="the ratio from which it counts as a loss")
    parser.add_argument("--only", action="append", choices=work.whole_set(), help="only this case; may be repeated")
    parser.add_argument("--json", help="file for all times")
    args = parser.parse_args()
    if args.rounds < 2:
        parser.error("--rounds: at least 2")
    for folder, target in ((args.base, "bench-store"), (args.programs, TARGET)):
        for program in (os.path.join(folder, "taotie"), measured.frames(folder)):
            if not os.access(program, os.X_OK):
                parser.error(f"{program} is not a program; `make {target}` builds it")
    return args


def make(folder):
    """Generates missing scenes."""
    for kind, place, names in (("bake", "bake", [work.SCAN]), ("render", "scene", work.MESHES)):
        script = os.path.join(command.ROOT, "benches", kind, "scene.py")
        measure.run([sys.executable, script, os.path.join(folder, place), *names])


def taken(builds, chosen, rounds):
    """Pairs of times, base and now, by case."""
    pairs = {name: [] for name in chosen}
    for number in range(rounds):
        for name, case in chosen.items():
            order = builds if number % 2 == 0 else builds[::-1]
            times = {build: case(build) for build in order}
            pairs[name].append([times[build] for build in builds])
        say(f"round {number + 1} of {rounds}")
    return pairs


def by_clock(pairs, clock):
    return [(getattr(base, clock), getattr(now, clock)) for base, now in pairs]


def judged(pairs, limit):
    """A loss by either clock counts; a gain must be one by both."""
    verdicts = {verdict(by_clock(pairs, clock), limit) for clock in CLOCKS}
    if LOSS in verdicts:
        return LOSS
    return GAIN if verdicts == {GAIN} else SAME


def checked(builds, chosen, args):
    """Pairs of times by case; cases with a loss are run again, and the new pairs count."""
    pairs = taken(builds, chosen, args.rounds)
    again = {name: chosen[name] for name, some in pairs.items() if judged(some, args.limit) == LOSS}
    if again:
        say(f"again, with twice the rounds: {'; '.join(again)}")
        pairs |= taken(builds, again, 2 * args.rounds)
    return pairs


def report(pairs, limit):
    """The table."""
    rows = []
    for name, some in pairs.items():
        shown = [f"{statistics.median(times):.1f}" for times in zip(*by_clock(some, "wall"))]
        ratios = [f"{ratio(by_clock(some, clock)):.3f}" for clock in CLOCKS]
        rows.append([name, *shown, *ratios, judged(some, limit)])
    head = ["case", "base, ms", "now, ms", "ratio", "CPU time ratio", "verdict"]
    return "\n".join(page.table(head, rows))


def main():
    args = arguments()
    make(args.folder)
    builds = [work.Build(args.base, args.folder, work.BASE), work.Build(args.programs, args.folder, work.NOW)]
    chosen = {name: case for name, case in work.whole_set().items() if name in (args.only or work.whole_set())}
    try:
        for build in builds:
            build.prepare()
        pairs = checked(builds, chosen, args)
    finally:
        for build in builds:
            build.close()
    print(f"{report(pairs, args.limit)}\n\nMeasured on: {machine.described(builds[1].taotie)}.")
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump({name: [[vars(time) for time in pair] for pair in some] for name, some in pairs.items()}, file)
    losses = [name for name, some in pairs.items() if judged(some, args.limit) == LOSS]
    if losses:
        sys.exit(f"slower than before: {'; '.join(losses)}")


if __name__ == "__main__":
    command.run(main)
