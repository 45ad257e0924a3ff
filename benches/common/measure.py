"""Measures the time and peak memory of whole processes."""

import dataclasses
import os
import subprocess
import sys
import tempfile
import time


class Failed(Exception):
    """A command that failed."""


@dataclasses.dataclass(frozen=True)
class Run:
    """Wall seconds, CPU seconds of user and system together, peak resident memory in MiB, and the output."""

    seconds: float
    processor: float
    mib: float
    output: str


def run(command, environment=None, accepted=(0,)):
    """Runs a command to its end; with `environment`, its variables are exactly these. Fails unless its exit code is
    one of `accepted`.

    The peak of a process includes the memory of the one that started it, up to the moment it executes its own
    program. So the caller must stay small: arrays belong in separate processes.
    """
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as talk:
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=output, stderr=talk, env=environment)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in accepted:
            raise Failed(f"{' '.join(command)}\nended with {process.returncode}:\n{_text(talk)[-2000:]}")
        mib = usage.ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)
        return Run(seconds, usage.ru_utime + usage.ru_stime, mib, _text(output))


def _text(file):
    file.seek(0)
    return file.read().decode(errors="replace")


def read_once(path):
    """Reads the file, so that the first timed process is not the only one to wait for the disk."""
    with open(path, "rb") as file:
        while file.read(1 << 24):
            pass
