"""The program `taotie`: where it is, and its runs in the background."""

import contextlib
import importlib.util
import json
import queue
import re
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import bpy

from .problem import Problem

ENDING_S = 15


def command(preferences):
    """Returns the start of the command line: the program of the preferences, on PATH, or in Blender's Python."""
    chosen = preferences.program
    if chosen:
        path = Path(bpy.path.abspath(chosen))
        if not path.is_file():
            raise Problem(f"no program at `{path}`: correct the path in the preferences of the add-on")
        return [str(path)]
    if found := shutil.which("taotie"):
        return [found]
    if importlib.util.find_spec("taotie"):
        return [sys.executable, "-m", "taotie"]
    raise Problem("taotie is not installed: install the program, or state its path in the preferences of the add-on")


def run(command, arguments):
    """Runs the program that `command` starts: a generator of (stage, fraction), which returns the text printed.

    It never waits. Closing it ends the program, which then leaves its files as they were.
    """
    try:
        process = subprocess.Popen(
            [str(word) for word in (*command, "--progress", *arguments)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            errors="replace",
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),  # of Windows
        )
    except OSError as error:
        raise Problem(f"cannot start `{command[0]}`: {error.strerror or error}") from error
    with _ending(process):
        lines, printed, said = queue.Queue(), [], []
        readers = [
            threading.Thread(target=_read, args=(process.stderr, lines.put), daemon=True),
            threading.Thread(target=_read, args=(process.stdout, printed.append), daemon=True),
        ]
        for reader in readers:
            reader.start()
        latest = ("starting", 0.0)
        while any(reader.is_alive() for reader in readers):
            yield (latest := _latest(lines, said, latest))
        _latest(lines, said, latest)
        code = process.wait()
    if code not in (0, 1):  # 1: done, but a requirement is not met
        raise Problem(_message(said) or f"`{command[0]}` ended with exit code {code}")
    return "".join(printed)


def _read(stream, put):
    for line in stream:
        put(line)


@contextlib.contextmanager
def _ending(process):
    try:
        yield
    finally:
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(ENDING_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        process.stdout.close()
        process.stderr.close()


def _latest(lines, said, latest):
    """Returns the latest progress; other lines are messages."""
    while not lines.empty():
        line = lines.get_nowait().strip()
        try:
            step = json.loads(line)
            latest = step["stage"], float(step["done"])
        except (ValueError, TypeError, KeyError):
            said.append(line)
    return latest


def _message(said):
    """Returns the error among the lines that the program wrote; without one, the last lines."""
    found = re.search(r"^(?:taotie: )?error: (.*?)(?:\n\n|\Z)", "\n".join(said), re.MULTILINE | re.DOTALL)
    return found[1].strip() if found else "\n".join(said[-3:])
