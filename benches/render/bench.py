"""The part `render` of `make bench`: one scene by Taotie and other renderers in turn, with time and memory."""

import json
import os
import shutil
import statistics
import sys

import cases
import command
import measure
import quiet
import section
import summed
import talk
from cold import Cold
from command import say
from rows import Report

# Mesa on the CPU even if there is a GPU.
SOFTWARE = {"LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe"}
# The milliseconds of a participant's turn in a round, unless a single frame takes longer.
TURN = 500
# A participant that takes more milliseconds per frame has one turn and is not run with larger meshes.
TOO_LONG = 2000


def arguments():
    parser = command.part_parser(__doc__, "bench-render")
    parser.add_argument("--rounds", type=int, default=3, help="turns per participant and case")
    parser.add_argument("--cold-rounds", type=int, default=3, help="whole processes per kind; 0 for none")
    parser.add_argument("--peer", action="append", help="only these peers, or `none`")
    parser.add_argument("--mesh", action="append", choices=cases.MESHES, help="only these")
    parser.add_argument("--shading", action="append", choices=cases.SHADINGS, help="only these")
    parser.add_argument("--plain", action="store_true", help="also Taotie without the features that peers lack")
    parser.add_argument("--also", metavar="FOLDER", help="also Taotie's programs in this folder, to compare builds")
    parser.add_argument("--json", help="file for all times")
    return command.part_arguments(parser)


def participants(args):
    some = [cases.taotie(args.programs)]
    if args.plain:
        some.append(cases.taotie(args.programs, "taotie-plain", "Taotie, plain", ["--plain"]))
    if args.also:
        some.append(cases.taotie(args.also, "taotie-also", "Taotie, the other build"))
    names = args.peer or (["llvmpipe"] if args.quick else None)
    return some + [peer for peer in cases.peers(args.folder) if names is None or peer.name in names]


class Run:
    """All measurements, as they are made."""

    def __init__(self, args, some):
        self.args, self.some = args, some
        self.meshes = args.mesh or list(cases.MESHES)[: 2 if args.quick else None]
        self.scene = os.path.join(args.folder, "scene")
        self.pictures = os.path.join(args.folder, "pictures")
        self.out = {}  # by shading and name, why it no longer takes part
        self.slow = {}  # by shading and name, why it is not run with more triangles
        self.times = {}  # milliseconds of each turn by (mesh, shading, size) and name
        self.watches = {}  # the load of other programs by (mesh, shading, size)
        self.mib = {}  # peak at the first size, by (mesh, shading) and name
        self.about = {}
        self.cold = Cold(self.scene, self.pictures, 0 if args.quick else args.cold_rounds, say)

    def all(self):
        shutil.rmtree(self.pictures, ignore_errors=True)
        os.makedirs(self.pictures)
        for one in self.some:
            if one.first:
                measure.run(one.first(self.scene, self.meshes[0]))
        for mesh in self.meshes:
            for shading in self.args.shading or cases.SHADINGS:
                self.warm(mesh, shading)
        for shading in self.args.shading or cases.SHADINGS:
            self.cold.measure([one for one in self.some if (shading, one.name) not in self.out], shading)

    def warm(self, mesh, shading):
        """The frames of one model, at all sizes, with persistent processes."""
        sessions = {}
        for size in cases.SIZES[:1] if self.args.quick else cases.SIZES:
            case = (mesh, shading, size)
            some = [one for one in self.some if self.takes_part(one, case)]
            frames = self.probed(sessions, case, some)
            self.times[case], self.watches[case] = quiet.undisturbed(
                lambda watch: self.turns(sessions, case, frames, watch)
            )
            self.report(case)
            for one in self.some:
                if one.one_size and one.name in sessions:
                    sessions.pop(one.name).close()
        for session in sessions.values():
            session.close()

    def takes_part(self, one, case):
        mesh, shading, size = case
        slow, _ = self.slow.get((shading, one.name), (mesh, ""))
        fits = shading in one.shadings and size in one.sizes
        return fits and (shading, one.name) not in self.out and slow == mesh

    def probed(self, sessions, case, some):
        """The number of frames per turn of each participant that answers, after an image for the comparison."""
        mesh, shading, size = case
        frames = {}
        for one in some:
            png = os.path.join(self.pictures, f"{mesh}-{shading}-{size[0]}-{one.name}.png")
            probe = self.ask(sessions, one, case, 1, png)
            if probe:
                frames[one] = max(1, min(15, round(TURN / probe["ms"][0])))
        return frames

    def turns(self, sessions, case, frames, watch):
        """The milliseconds of each turn by name; the participants alternate."""
        times = {}
        for _ in range(self.args.rounds):
            for one in frames:
                turns = times.setdefault(one.name, [])
                if turns and statistics.median(turns[0]) > TOO_LONG:
                    continue
                with watch.turn(one.name):
                    answer = self.ask(sessions, one, case, frames[one])
                if answer:
                    turns.append(answer["ms"])
        return {name: turns for name, turns in times.items() if turns}

    def ask(self, sessions, one, case, frames, png=None):
        """An answer; a participant that gives none is excluded from then on."""
        mesh, shading, size = case
        if (shading, one.name) in self.out:
            return None
        if one.name not in sessions:
            sessions[one.name] = talk.Session(one.talks(self.scene, mesh, shading), one.environment)
        try:
            answer = sessions[one.name].ask(*size, frames, png)
        except talk.Silent as silent:
            say(f"{one.name} is excluded from {mesh} {shading} {size[0]}×{size[1]} onwards: {silent}")
            self.out[shading, one.name] = str(silent)
            sessions.pop(one.name).close()
            return None
        if size == cases.SIZES[0]:
            self.mib.setdefault((mesh, shading), {})[one.name] = answer["peak_mib"]
        self.about[one.name] = answer.get("about", "")
        return answer

    def report(self, case):
        mesh, shading, size = case
        for name, turns in self.times[case].items():
            median, least = statistics.median(sum(turns, [])), min(map(min, turns))
            say(f"{mesh:5} {shading:14} {size[0]}×{size[1]} {name:12} {median:9.2f} ms (least {least:.2f})")
            if median > TOO_LONG and name != "taotie" and mesh != self.meshes[-1]:
                why = f"it takes {median / 1000:.1f} s per frame of {cases.MESHES[mesh]} triangles"
                self.slow.setdefault((shading, name), (mesh, why))


def compared(run):
    """The differences between Taotie's and llvmpipe's images, by pictures.py."""
    command = [sys.executable, os.path.join(cases.HERE, "pictures.py"), run.pictures]
    return json.loads(measure.run(command).output)


def main():
    args = arguments()
    os.environ |= SOFTWARE
    run = Run(args, participants(args))
    made = [sys.executable, os.path.join(cases.HERE, "scene.py"), run.scene]
    measure.run(made + run.meshes)
    run.all()
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump({" ".join(map(str, case)): times for case, times in run.times.items()}, file)
    watches = [*run.watches.values(), *run.cold.watches.values()]
    busy = sum(watch.most() > quiet.LIMIT for watch in watches)
    versions = {one.title: run.about[one.name] for one in run.some if run.about.get(one.name)}
    rows = summed.rows(run)
    Report(rows, versions, section.text(run, compared(run)), busy, len(watches)).save(args.report)


if __name__ == "__main__":
    command.run(main)
