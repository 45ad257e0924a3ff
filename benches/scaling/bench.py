"""The part `scaling` of `make bench`: frame times of Taotie over triangles, pixels, lights, textures and threads."""

import os
import shutil
import statistics
import sys

import axes
import command
import measure
import measured
import quiet
import results
import section
import talk
from command import say
from results import Record
from rows import Report

HERE = os.path.dirname(os.path.abspath(__file__))
# The milliseconds of a case's turn in a round, unless a single frame takes longer; and the maximum number of frames.
TURN, MOST_FRAMES = 500, 15
# A case that takes more milliseconds per frame has one turn after its first frame.
TOO_LONG = 1500
# The maximum time of an answer, including loading, in seconds.
PATIENCE = 300.0
# No larger images are written.
LARGEST_PICTURE = 2048


def arguments():
    parser = command.part_parser(__doc__, "bench-scaling")
    parser.add_argument("--rounds", type=int, default=3, help="turns per case")
    known = axes.axes()
    parser.add_argument("--axis", action="append", choices=known, help="only this axis")
    args = command.part_arguments(parser)
    args.axes = [axis.quick() if args.quick else axis for axis in known.values() if axis.name in (args.axis or known)]
    return args


def make(folder, chosen):
    """Generates the scenes of all cases. Failures are reported, and their cases fail."""
    cases = [point.case for axis in chosen for point in axis.points]
    parts = ["environment"]
    parts += dict.fromkeys(f"mesh:{case.mesh}" for case in cases)
    parts += dict.fromkeys(f"maps:{case.maps}" for case in cases)
    parts += dict.fromkeys(f"scene:{case.mesh}:{case.maps}:{case.lights}" for case in cases)
    for part in parts:
        try:
            # One process each, so that none keeps the memory of the previous one.
            measure.run([sys.executable, os.path.join(HERE, "variants.py"), folder, part])
        except measure.Failed as failed:
            say(f"cannot generate {part}: {str(failed).strip().splitlines()[-1]}")


class Run:
    """All measurements, as they are made."""

    def __init__(self, args):
        self.args = args
        self.scene = os.path.join(args.folder, "scene")
        self.pictures = os.path.join(args.folder, "pictures")
        self.records = []

    def all(self):
        shutil.rmtree(self.pictures, ignore_errors=True)
        os.makedirs(self.pictures)
        for axis in self.args.axes:
            self.along(axis)

    def along(self, axis):
        """The cases of an axis in alternation, in processes that persist for all rounds."""
        sessions = {}
        try:
            some = [self.first(sessions, axis, point, shading) for point in axis.points for shading in point.shadings]
            _, watch = quiet.undisturbed(lambda watch: self.turns(sessions, some, watch))
        finally:
            for session in sessions.values():
                session.close()
        for record, _ in some:
            record.load = watch.share(id(record))
            report(record)

    def turns(self, sessions, some, watch):
        """The turns of all cases, which replace earlier ones."""
        for record, _ in some:
            record.ms = []
        for number in range(self.args.rounds):
            for record, case in some:
                if not record.why and (number == 0 or statistics.median(record.ms) <= TOO_LONG):
                    count = max(1, min(MOST_FRAMES, round(TURN / record.first)))
                    with watch.turn(id(record)):
                        self.ask(sessions, record, case, count)

    def first(self, sessions, axis, point, shading):
        """A case with its record, which contains the time of one frame."""
        case = point.case
        record = Record(axis.name, point.line, shading, point.amount, point.label, case.side**2)
        self.records.append(record)
        self.ask(sessions, record, case, 1, self.picture(axis, case, shading))
        record.first = record.ms[0] if record.ms else 0.0
        return record, case

    def picture(self, axis, case, shading):
        """The file for the first frame, for checking it by eye."""
        if case.side > LARGEST_PICTURE:
            return None
        name = f"{axis.name}-{case.scene}-{case.side}-{case.threads or 'all'}-{shading}.png"
        return os.path.join(self.pictures, name)

    def ask(self, sessions, record, case, frames, png=None):
        """Times some frames; a case without an answer is not tried again."""
        key = (case.scene, case.threads, record.shading)
        try:
            if key not in sessions:
                sessions[key] = talk.Session(self.command(case, record.shading), {})
            answer = sessions[key].ask(case.side, case.side, frames, png, PATIENCE)
        except (talk.Silent, OSError) as failed:
            record.why = str(failed)
            say(f"{record.axis} {record.label} {record.shading} is excluded: {record.why}")
            if key in sessions:
                sessions.pop(key).close()
            return
        record.ms += answer["ms"]
        record.coverage, record.mib = answer["coverage"], record.mib or answer["peak_mib"]

    def command(self, case, shading):
        path = os.path.join(self.scene, f"{case.scene}-{shading}.gltf")
        command = [measured.frames(self.args.programs), path, "--shading", shading, "--ask"]
        command += ["--threads", str(case.threads)] if case.threads else []
        return command + measured.light(self.scene, shading, "--environment")


def report(record):
    if record.ms:
        what = f"{record.axis:9} {record.line:15} {record.label:>6} {record.shading:14}"
        median = statistics.median(record.ms)
        say(f"{what} {median:9.2f} ms (least {min(record.ms):.2f}, of {len(record.ms)}) {record.mib:6.0f} MiB")


def plot(folder, records, to):
    """Draws the plot in a separate process; reports a failure."""
    path = os.path.join(folder, "times.json")
    results.save(path, records)
    measure.run([sys.executable, os.path.join(HERE, "plot.py"), path, to])


def main():
    args = arguments()
    run = Run(args)
    make(run.scene, args.axes)
    run.all()
    plot(args.folder, run.records, os.path.splitext(args.report)[0] + ".svg")
    busy = sum(record.is_busy() for record in run.records)
    Report([], {}, section.text(run.records, args.axes), busy, len(run.records)).save(args.report)


if __name__ == "__main__":
    command.run(main)
