"""Kills commands at work, hundreds of times, and checks the remaining files: `make faults`.

Signals at random moments, full disks, folders that are read-only or vanish, several processes with one output. After
each, all files are the old ones, or all are those of the new run, and the next run leaves nothing temporary.
"""

import argparse
import contextlib
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from place import JOBS, Place, hashes

# The maximum time from a signal to the end of the process, in seconds.
MOST = 0.2

SIGNALS = {"SIGINT": (signal.SIGINT, 130), "SIGTERM": (signal.SIGTERM, 143), "SIGKILL": (signal.SIGKILL, -9)}


def say(text):
    print(text, flush=True)


class Trial:
    """A job with the files of its versions, and their durations."""

    def __init__(self, place, job):
        self.place, self.job = place, job
        self.kept = tempfile.mkdtemp(dir=place.folder)
        place.clear()
        start = time.monotonic()
        place.run(job.arguments(1))
        self.seconds = time.monotonic() - start
        self.new_names = set(hashes(place.out))
        self.bytes = sum(os.path.getsize(os.path.join(place.out, name)) for name in self.new_names)
        place.clear()
        if not job.is_fresh:
            place.run(job.arguments(0))
        shutil.copytree(place.out, self.kept, dirs_exist_ok=True)
        self.old = hashes(place.out)

    def check(self, must_be=None):
        """Returns `old` or `new`; fails if files are mixed or unexpected."""
        found = hashes(self.place.out)
        if found == self.old:
            state = "old"
        elif set(found) == self.new_names and all(self.old.get(name) != found[name] for name in found):
            state = "new"
        else:
            changed = sorted(name for name in set(found) | set(self.old) if found.get(name) != self.old.get(name))
            raise AssertionError(f"{self.job.name}: neither the old files nor the new ones: {changed} differ")
        if must_be and state != must_be:
            raise AssertionError(f"{self.job.name}: the files are the {state} ones")
        return state


def end(process, number):
    """Sends a signal; returns the exit code, the seconds until the end and the output."""
    start = time.monotonic()
    process.send_signal(number)
    process.wait()
    took = time.monotonic() - start
    return process.returncode, took, process.stderr.read()


def signals(trial, name, rounds, chance):
    """Ends runs at random moments with a signal."""
    number, code = SIGNALS[name]
    states, longest = {"old": 0, "new": 0}, 0.0
    for _ in range(rounds):
        trial.place.restore(trial.kept)
        process = trial.place.start(trial.job.arguments(1))
        time.sleep(chance.uniform(0.02, 1.05 * trial.seconds))
        ended, took, said = end(process, number)
        assert ended in (code, 0), f"{trial.job.name}, {name}: exit code {ended}: {said}"
        if name == "SIGKILL":
            trial.place.sweep()
        elif ended != 0:
            longest = max(longest, took)
            assert took <= MOST, f"{trial.job.name}, {name}: it took {took * 1e3:.0f} ms to end"
        states[trial.check("new" if ended == 0 else None)] += 1
    within = f", at most {longest * 1e3:.0f} ms" if longest else ""
    say(f"{trial.job.name:10} {name:8} {rounds:4} times: {states['old']} old, {states['new']} new{within}")


def limited(place, arguments, most):
    """Starts a run with a limit on the size of files."""
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    return place.start(arguments, preexec_fn=limit)


def full_disk(trial, rounds, chance, mounted):
    """Simulates a full disk: a small file system if one can be mounted, else a limit on the size of files."""
    states = {"old": 0, "new": 0}
    for _ in range(rounds):
        trial.place.restore(trial.kept)
        if mounted:
            held = os.statvfs(trial.place.out)
            free = held.f_bavail * held.f_frsize
            ballast = os.path.join(trial.place.folder, "ballast")
            with open(ballast, "wb") as file:
                file.write(bytes(max(0, free - int(chance.uniform(0, 1.5 * trial.bytes)))))
            process = trial.place.start(trial.job.arguments(1))
        else:
            process = limited(trial.place, trial.job.arguments(1), int(chance.uniform(1, trial.bytes)))
        _, said = process.communicate()
        if mounted:
            os.remove(ballast)
        assert process.returncode in (0, 2), f"{trial.job.name}: exit code {process.returncode}: {said}"
        states[trial.check("new" if process.returncode == 0 else "old")] += 1
    say(f"{trial.job.name:10} full disk {rounds:3} times: {states['old']} old, {states['new']} new")


def vanished(trial, rounds, chance):
    """Removes the folder while files are written for it."""
    place, away = trial.place, trial.place.out + "-away"
    for _ in range(rounds):
        place.restore(trial.kept)
        process = place.start(trial.job.arguments(1))
        time.sleep(chance.uniform(0.02, trial.seconds))
        os.rename(place.out, away)
        _, said = process.communicate()
        shutil.rmtree(place.out, ignore_errors=True)
        os.rename(away, place.out)
        assert process.returncode in (0, 2), f"{trial.job.name}: exit code {process.returncode}: {said}"
        place.sweep()
        trial.check()
    say(f"{trial.job.name:10} vanished folder {rounds} times")


def read_only(trial):
    """Makes the folder read-only."""
    if os.geteuid() == 0:
        say(f"{trial.job.name:10} read-only folder: skipped, since root can write anywhere")
        return
    trial.place.restore(trial.kept)
    os.chmod(trial.place.out, 0o555)
    process = trial.place.start(trial.job.arguments(1))
    _, said = process.communicate()
    os.chmod(trial.place.out, 0o755)
    assert process.returncode == 2 and "denied" in said.lower(), f"{trial.job.name}: {process.returncode}: {said}"
    trial.check("old")
    say(f"{trial.job.name:10} read-only folder")


def together(trial, rounds):
    """Runs two processes that write the same files."""
    for _ in range(rounds):
        trial.place.restore(trial.kept)
        runs = [trial.place.start(trial.job.arguments(1)) for _ in range(2)]
        said = [run.communicate()[1] for run in runs]
        assert all(run.returncode == 0 for run in runs), f"{trial.job.name}: {said}"
        trial.check("new")
    say(f"{trial.job.name:10} two at once {rounds} times")


@contextlib.contextmanager
def small_disk():
    """A small file system, or None if none can be mounted."""
    folder = tempfile.mkdtemp()
    line = ["mount", "-t", "tmpfs", "-o", "size=256m", "tmpfs", folder]
    is_made = shutil.which("mount") is not None and subprocess.run(line, capture_output=True).returncode == 0
    try:
        yield folder if is_made else None
    finally:
        if is_made:
            subprocess.run(["umount", folder], check=True)
        os.rmdir(folder)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--taotie", default="target/release/taotie", help="the program")
    parser.add_argument("--rounds", type=int, default=100, help="rounds per signal and job; a tenth for other faults")
    parser.add_argument("--seed", type=int, default=1, help="seed of the random moments")
    parser.add_argument("--only", help="one job: " + ", ".join(job.name for job in JOBS))
    return parser.parse_args()


def main():
    args = arguments()
    chance, few = random.Random(args.seed), max(1, args.rounds // 10)
    jobs = [job for job in JOBS if args.only in (None, job.name)]
    with tempfile.TemporaryDirectory() as folder:
        place = Place(folder, args.taotie)
        for job in jobs:
            trial = Trial(place, job)
            for name in SIGNALS:
                signals(trial, name, args.rounds, chance)
            vanished(trial, few, chance)
            read_only(trial)
            together(trial, few)
    with small_disk() as mounted, tempfile.TemporaryDirectory() as folder:
        if mounted is None:
            say("cannot mount a file system: simulating a full disk with a limit on the size of files")
        place = Place(mounted or folder, args.taotie)
        for job in jobs:
            full_disk(Trial(place, job), few, chance, mounted is not None)


if __name__ == "__main__":
    try:
        main()
    except AssertionError as wrong:
        sys.exit(f"wrong: {wrong}")
