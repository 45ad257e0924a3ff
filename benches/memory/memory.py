"""Compares the estimated with the actual memory of commands: `make memory`.

A command reports what it needs if its memory limit is lower. So a file is tried with the limit requested by the last
refusal, starting with one byte, until it is accepted: that limit is the estimate. The accepted run is the one
measured, by the largest resident set that the system counts for its process, minus that of the program for a model of
two triangles.
"""

import argparse
import math
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import tempfile
import threading

import models
from cases import cases

MIB = 1 << 20
UNITS = {"KiB": 1 << 10, "MiB": 1 << 20, "GiB": 1 << 30}
# Below this, threads and memory kept by the system's allocator dominate: such runs are counted separately.
FLOOR = 64 * MIB
# The maximum factor by which an estimate may exceed the peak.
SLACK = 2
# The message of a refusal; the figure is rounded to its last digit.
REFUSAL = re.compile(r"(?:needs about|the file has) ([\d.]+) (KiB|MiB|GiB)")


class Run:
    """A finished process: its exit code, its messages, its peak in bytes."""

    def __init__(self, program, line, folder, seconds):
        with tempfile.TemporaryFile() as said:
            # Nothing is kept from one run to the next.
            around = os.environ | {"XDG_CACHE_HOME": os.path.join(folder, "out-cache")}
            process = subprocess.Popen([program, *line], cwd=folder, env=around, stdout=subprocess.DEVNULL, stderr=said)
            timer = threading.Timer(seconds, process.kill)
            timer.start()
            _, status, usage = os.wait4(process.pid, 0)
            timer.cancel()
            process.returncode = self.code = os.waitstatus_to_exitcode(status)
            self.peak = usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
            said.seek(0)
            self.said = said.read().decode(errors="replace")


class Row:
    """A file with a command: estimated and actual memory."""

    def __init__(self, name, command, stated, run, bare):
        self.name, self.command, self.stated, self.code, self.said = name, command, stated, run.code, run.said
        self.peak = max(run.peak - bare, 0)
        self.is_refused = False

    @property
    def is_small(self):
        return self.stated < FLOOR

    @property
    def ratio(self):
        return self.peak / self.stated

    def judgement(self):
        if self.is_refused:
            return "refused"
        if self.is_small:
            return "small" if self.peak <= FLOOR else "above"
        if self.ratio > 1:
            return "above"
        return "far below" if self.ratio < 1 / SLACK else "held"

    def line(self):
        stated, peak = self.stated / MIB, self.peak / MIB
        return f"| {self.name} | {self.command} | {stated:.1f} | {peak:.1f} | {self.ratio:.2f} | {self.judgement()} | {self.code} |"


def asked(said):
    """The figure of a refusal, rounded up by half of its last digit; None if it is not a refusal."""
    found = REFUSAL.search(said)
    if not found or "too large" not in said:
        return None
    number, unit = found.groups()
    digit = 0.1 if "." in number else 1
    return math.ceil((float(number) + digit / 2) * UNITS[unit]) + 1


def measure(place, name, command, path):
    """Tries limits until one is accepted."""
    line = command.format(path).split(" ") if " " not in path else [part.format(path) for part in command.split(" ")]
    limit = 1
    while True:
        place.clear()
        run = Run(place.program, [*line, "--memory-limit", str(limit)], place.folder, place.seconds)
        wanted = asked(run.said) if run.code != 0 else None
        # A refused bake also prints what it needs.
        row = Row(name, command.format(os.path.basename(path)).split(" -o")[0], limit, run, place.bare)
        if wanted is None or wanted <= limit:
            return row
        if wanted > place.most:
            row.stated, row.is_refused = wanted, True
            return row
        limit = wanted


class Place:
    """The folder in which commands run."""

    def __init__(self, folder, args):
        self.folder, self.program = folder, os.path.abspath(args.taotie)
        self.most, self.seconds = int(args.most * (1 << 30)), args.seconds
        self.kept, self.bare = set(), 0

    def make(self, maker):
        """Generates files in a separate process: a process starts with the peak of its parent."""
        process = multiprocessing.get_context("fork").Process(target=maker)
        process.start()
        process.join()
        if process.exitcode != 0:
            raise RuntimeError("cannot generate a file")

    def clear(self):
        """Removes the output of commands."""
        for name in os.listdir(self.folder):
            if name.startswith("out"):
                path = os.path.join(self.folder, name)
                shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)

    def empty(self):
        """Removes everything except the files to keep."""
        for name in set(os.listdir(self.folder)) - self.kept:
            path = os.path.join(self.folder, name)
            shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)


def totals(rows):
    """Summary lines about all rows."""
    counted = [row for row in rows if not row.is_small and not row.is_refused]
    small, refused = [row for row in rows if row.is_small], [row for row in rows if row.is_refused]
    files = len({row.name for row in rows})
    yield f"{len(rows)} runs of {files} files: {len(counted)} estimated at 64 MiB or more, {len(small)} below, {len(refused)} refused"
    yield f"peak above the estimate: {sum(row.judgement() == 'above' for row in rows)}"
    yield f"estimate more than {SLACK} times the peak: {sum(row.judgement() == 'far below' for row in rows)}"
    if counted:
        for title, pick in (("highest", max), ("lowest", min)):
            worst = pick(counted, key=lambda row: row.ratio)
            yield f"{title} peak: {worst.ratio:.2f} of the estimate ({worst.name}: {worst.command})"
    if small:
        yield f"highest peak of the small ones: {max(row.peak for row in small) / MIB:.1f} MiB"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--taotie", default="target/release/taotie", help="the program")
    parser.add_argument("--data", default=os.environ.get("TAOTIE_DATA", "../shared/data"), help="the folder of shared files")
    parser.add_argument("--shared", type=int, default=100, help="maximum number of shared files")
    parser.add_argument("--most", type=float, default=6, help="GiB; runs that need more are not executed")
    parser.add_argument("--seconds", type=float, default=300, help="maximum seconds per run")
    parser.add_argument("--only", default="", help="only files and commands that match this regular expression")
    parser.add_argument("--table", help="file for the table, in addition to the terminal")
    return parser.parse_args()


def main():
    args = arguments()
    data = os.path.abspath(args.data)
    table = open(args.table, "w", encoding="utf-8") if args.table else None

    def say(text):
        print(text, flush=True)
        if table:
            print(text, file=table, flush=True)

    say("| file | command | estimate, MiB | peak, MiB | ratio | | exit code |\n|---|---|--:|--:|--:|---|--:|")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        place = Place(folder, args)
        os.chdir(folder)
        place.make(lambda: models.obj("ball.obj", 100, has_uvs=True))
        place.make(lambda: models.obj("two.obj", 1))
        place.kept = set(os.listdir(folder))
        place.bare = Run(place.program, ["inspect", "two.obj"], folder, place.seconds).peak
        for case in cases(data, args.shared):
            commands = [line for line in case.commands if re.search(args.only, f"{case.name} {line}")]
            if commands and case.make:
                place.make(case.make)
            for command in commands:
                rows.append(measure(place, case.name, command, case.path))
                say(rows[-1].line())
            place.empty()
    print()
    for sentence in totals(rows):
        say(sentence)
    if any(row.judgement() in ("above", "far below") for row in rows):
        sys.exit(1)


if __name__ == "__main__":
    main()
