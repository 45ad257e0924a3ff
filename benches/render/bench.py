"""Renders one scene with Taotie and other renderers in turn, and reports time and memory: `make bench-render`."""

import json
import os
import shutil
import statistics
import sys

import cases
import command
import machine
import measure
import page
import section
import talk
from cold import Cold
from command import say

TARGET = "bench-render"
# Mesa on the CPU even if there is a GPU.
SOFTWARE = {"LIBGL_ALWAYS_SOFTWARE": "1", "GALLIUM_DRIVER": "llvmpipe"}
# The milliseconds of a participant's turn in a round, unless a single frame takes longer.
TURN = 500
# A participant that takes more milliseconds per frame has one turn and is not run with larger meshes.
TOO_LONG = 2000


def arguments():
    parser = command.parser(__doc__, TARGET)
    parser.add_argument("--programs", default=command.PROGRAMS, help="folder of taotie and frames")
    parser.add_argument("--rounds", type=int, default=3, help="turns per participant and case")
    parser.add_argument("--cold-rounds", type=int, default=2, help="whole processes per kind; 0 for none")
    parser.add_argument(
        "--quick", action="store_true", help="Taotie and llvmpipe at 1024², warm; does not write the page"
    )
    parser.add_argument(
        "--only", action="append", metavar="PEER", help="only these peers, or `none`; does not write the page"
    )
    parser.add_argument("--mesh", action="append", choices=cases.MESHES, help="only these; does not write the page")
    parser.add_argument("--shading", action="append", choices=cases.SHADINGS, help="likewise")
    parser.add_argument("--plain", action="store_true", help="also Taotie without the features that peers lack")
    parser.add_argument("--also", metavar="FOLDER", help="also Taotie's programs in this folder, to compare builds")
    parser.add_argument("--json", help="file for all times")
    args = parser.parse_args()
    if args.rounds < 1:
        parser.error("--rounds: at least 1")
    if not os.access(os.path.join(args.programs, "taotie"), os.X_OK):
        parser.error(f"{args.programs} does not contain taotie; `make bench-render` builds it")
    return args


def participants(args):
    some = [cases.taotie(args.programs)]
    if args.plain:
        some.append(cases.taotie(args.programs, "taotie-plain", "Taotie, plain", ["--plain"]))
    if args.also:
        some.append(cases.taotie(args.also, "taotie-also", "Taotie, the other build"))
    names = args.only or (["llvmpipe"] if args.quick else None)
    return some + [peer for peer in cases.peers(args.folder) if names is None or peer.name in names]


class Run:
    """All measurements, as they are made."""

    def __init__(self, args, some):
        self.args, self.some = args, some
        self.meshes = args.mesh or list(cases.MESHES)
        self.scene = os.path.join(args.folder, "scene")
        self.pictures = os.path.join(args.folder, "pictures")
        self.out = {}  # by shading and name, why it no longer takes part
        self.slow = {}  # by shading and name, why it is not run with more triangles
        self.times = {}  # milliseconds by (mesh, shading, size) and name
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
            self.turns(sessions, case, [one for one in self.some if self.takes_part(one, mesh, shading)])
            self.report(case)
            for one in self.some:
                if one.one_size and one.name in sessions:
                    sessions.pop(one.name).close()
        for session in sessions.values():
            session.close()

    def takes_part(self, one, mesh, shading):
        slow, _ = self.slow.get((shading, one.name), (mesh, ""))
        return shading in one.shadings and (shading, one.name) not in self.out and slow == mesh

    def turns(self, sessions, case, some):
        mesh, shading, size = case
        frames = {}
        for one in some:
            png = os.path.join(self.pictures, f"{mesh}-{shading}-{size[0]}-{one.name}.png")
            probe = self.ask(sessions, one, case, 1, png)
            if probe:
                frames[one] = max(1, min(15, round(TURN / probe["ms"][0])))
        for number in range(self.args.rounds):
            for one in list(frames):
                if number and statistics.median(self.times.get(case, {}).get(one.name, [0])) > TOO_LONG:
                    continue
                answer = self.ask(sessions, one, case, frames[one])
                if answer:
                    self.times.setdefault(case, {}).setdefault(one.name, []).extend(answer["ms"])

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
        for name, times in self.times.get(case, {}).items():
            median = statistics.median(times)
            say(f"{mesh:5} {shading:14} {size[0]}×{size[1]} {name:12} {median:9.2f} ms (least {min(times):.2f})")
            if median > TOO_LONG and name != "taotie" and mesh != self.meshes[-1]:
                why = f"it takes {median / 1000:.1f} s per frame of {cases.MESHES[mesh]} triangles"
                self.slow.setdefault((shading, name), (mesh, why))


def compared(run):
    """The differences between Taotie's and llvmpipe's images, by pictures.py."""
    command = [sys.executable, os.path.join(cases.HERE, "pictures.py"), run.pictures]
    return json.loads(measure.run(command).output)


def main():
    args = arguments()
    whole = not (args.quick or args.only or args.mesh or args.shading)
    if whole:
        page.around(args.page, TARGET)  # fails now rather than after minutes
    os.environ |= SOFTWARE
    run = Run(args, participants(args))
    made = [sys.executable, os.path.join(cases.HERE, "scene.py"), run.scene]
    measure.run(made + run.meshes)
    run.all()
    text = section.text(machine.described(os.path.join(args.programs, "taotie")), run, compared(run))
    print(text)
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump({" ".join(map(str, case)): times for case, times in run.times.items()}, file)
    if whole:
        page.write(args.page, TARGET, text)


if __name__ == "__main__":
    command.run(main)
