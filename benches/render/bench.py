"""Pictures of one scene by Taotie and by other renderers in turn, and what they took: `make bench-render`."""

import argparse
import json
import os
import statistics
import sys

import cases
import machine
import measure
import page
import section
import talk

TARGET = "bench-render"
ROOT = os.path.dirname(os.path.dirname(cases.HERE))
# What a participant's turn takes in a round, milliseconds, as far as at least one frame allows.
TURN = 500
# Who takes longer than this for a frame is not asked for larger meshes, milliseconds.
TOO_LONG = 3000


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", default=os.path.join(ROOT, "target/release"), help="where taotie and frames are")
    parser.add_argument("--folder", default=os.path.join(ROOT, "target/bench-render"), help="for scene and pictures")
    parser.add_argument("--page", default=os.path.join(ROOT, "docs/benchmarks.md"), help="whose section is written")
    parser.add_argument("--rounds", type=int, default=3, help="turns of each participant in each case")
    parser.add_argument("--cold-rounds", type=int, default=2, help="whole processes of each kind; 0 for none")
    parser.add_argument("--quick", action="store_true", help="Taotie and llvmpipe at 1024², warm; the page is left alone")
    parser.add_argument("--only", action="append", metavar="PEER", help="these peers alone; the page is left alone")
    parser.add_argument("--mesh", action="append", choices=cases.MESHES, help="these alone; the page is left alone")
    parser.add_argument("--shading", action="append", choices=cases.SHADINGS, help="likewise")
    parser.add_argument("--plain", action="store_true", help="also Taotie without what peers do not do")
    parser.add_argument("--also", metavar="FOLDER", help="also Taotie's programs from there, to compare two builds")
    parser.add_argument("--json", help="where all times are written to")
    args = parser.parse_args()
    if not os.access(os.path.join(args.programs, "taotie"), os.X_OK):
        parser.error(f"{args.programs} holds no taotie; `make bench-render` builds it")
    return args


def say(text):
    print(text, file=sys.stderr, flush=True)


def participants(args):
    some = [cases.taotie(args.programs)]
    if args.plain:
        some.append(cases.taotie(args.programs, "taotie-plain", "Taotie, plain", more=["--plain"]))
    if args.also:
        some.append(cases.taotie(args.also, "taotie-also", "Taotie, the other build"))
    names = args.only or (["llvmpipe"] if args.quick else None)
    return some + [peer for peer in cases.peers() if names is None or peer.name in names]


class Run:
    """All that is measured, as it comes."""

    def __init__(self, args, some):
        self.args, self.some = args, some
        self.scene = os.path.join(args.folder, "scene")
        self.pictures = os.path.join(args.folder, "pictures")
        self.out = {}  # the names of those that cannot take part, with the reason
        self.times = {}  # milliseconds by (mesh, shading, size) and name
        self.mib = {}  # peak by mesh and shading, and name
        self.about = {}

    def all(self):
        os.makedirs(self.pictures, exist_ok=True)
        sizes = cases.SIZES[:1] if self.args.quick else cases.SIZES
        for mesh in self.args.mesh or cases.MESHES:
            for shading in self.args.shading or cases.SHADINGS:
                self.warm(mesh, shading, sizes)

    def warm(self, mesh, shading, sizes):
        """The frames of one model, at all sizes."""
        sessions = {}
        for one in self.some:
            if shading in one.shadings and one.name not in self.out:
                sessions[one.name] = talk.Session(one.talks(self.scene, mesh, shading), one.environment)
                self.ask(sessions, one.name, (mesh, shading, sizes[0]), 0)
        for size in sizes:
            self.turns(sessions, (mesh, shading, size))
        for session in sessions.values():
            session.close()

    def turns(self, sessions, case):
        mesh, shading, size = case
        frames = {}
        for name in list(sessions):
            png = os.path.join(self.pictures, f"{mesh}-{shading}-{size[0]}-{name}.png")
            probe = self.ask(sessions, name, case, 1, png)
            if probe:
                frames[name] = max(1, min(15, round(TURN / probe["ms"][0])))
        for _ in range(self.args.rounds):
            for name in list(sessions):
                answer = self.ask(sessions, name, case, frames[name])
                if answer:
                    self.times.setdefault(case, {}).setdefault(name, []).extend(answer["ms"])
        for name, times in self.times.get(case, {}).items():
            median = statistics.median(times)
            say(f"{mesh:5} {shading:14} {size[0]}×{size[1]} {name:12} {median:9.2f} ms (least {min(times):.2f})")
            if median > TOO_LONG and mesh != list(cases.MESHES)[-1]:
                self.out.setdefault(name, f"it took {median / 1000:.1f} s a frame of {cases.MESHES[mesh]} triangles")

    def ask(self, sessions, name, case, frames, png=None):
        """An answer; who gives none is out from here on."""
        mesh, shading, size = case
        try:
            answer = sessions[name].ask(*size, frames, png)
        except talk.Silent as silent:
            say(f"{name} is left out from {mesh} {shading} on: {silent}")
            self.out[name] = str(silent)
            sessions.pop(name).close()
            return None
        most = self.mib.setdefault((mesh, shading), {})
        most[name] = max(most.get(name, 0), answer["peak_mib"])
        self.about[name] = answer.get("about", "")
        return answer


def compared(run):
    """What pictures.py says of Taotie's and the first peer's pictures."""
    command = [sys.executable, os.path.join(cases.HERE, "pictures.py"), run.pictures]
    return json.loads(measure.run(command).output)


def main():
    args = arguments()
    whole = not (args.quick or args.only or args.mesh or args.shading)
    if whole:
        page.around(args.page, TARGET)  # fails now rather than after minutes
    run = Run(args, participants(args))
    made = [sys.executable, os.path.join(cases.HERE, "scene.py"), run.scene]
    measure.run(made + list(args.mesh or cases.MESHES))
    run.all()
    text = section.text(machine.described(os.path.join(args.programs, "taotie")), run, compared(run))
    print(text)
    if args.json:
        with open(args.json, "w", encoding="utf-8") as file:
            json.dump({" ".join(map(str, case)): times for case, times in run.times.items()}, file)
    if whole:
        page.write(args.page, TARGET, text)


if __name__ == "__main__":
    try:
        main()
    except (measure.Failed, page.Unmarked, OSError) as error:
        sys.exit(str(error))
