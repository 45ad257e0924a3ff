"""A participant's process: requests in, times out.

A request is a line `WIDTH HEIGHT FRAMES [PNG]`; the answer a line of JSON with `ms`, the time of each frame, and
`peak_mib`. The process chooses the number of untimed frames before them.
"""

import json
import os
import select
import subprocess
import tempfile
import time


class Silent(Exception):
    """A process that did not answer."""


class Session:
    """One process for one mesh and shading, for any number of requests."""

    def __init__(self, command, environment):
        self.talk = tempfile.TemporaryFile()
        self.process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.talk,
            env=os.environ | environment,
            start_new_session=True,
        )
        self.rest = b""

    def ask(self, width, height, frames, png=None, patience=60.0):
        """The answer, as a dictionary. Waits no more than `patience` seconds."""
        return self.request(f"{width} {height} {frames} {png or ''}".strip(), patience)

    def request(self, request, patience):
        """The answer to a request line, as a dictionary."""
        try:
            self.process.stdin.write(f"{request}\n".encode())
            self.process.stdin.flush()
        except OSError:
            raise Silent(self.last_words()) from None
        until = time.monotonic() + patience
        while True:
            line = self.line(until)
            if line.startswith(b"{"):
                return json.loads(line)

    def line(self, until):
        while b"\n" not in self.rest:
            ready, _, _ = select.select([self.process.stdout], [], [], max(0.0, until - time.monotonic()))
            if not ready:
                raise Silent("timed out")
            data = os.read(self.process.stdout.fileno(), 1 << 16)
            if not data:
                raise Silent(self.last_words())
            self.rest += data
        line, _, self.rest = self.rest.partition(b"\n")
        return line

    def processor(self):
        """CPU seconds of the process so far, user and system together; only on Linux."""
        with open(f"/proc/{self.process.pid}/stat", encoding="utf-8") as file:
            fields = file.read().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def last_words(self):
        self.talk.seek(0)
        lines = self.talk.read().decode(errors="replace").strip().splitlines()
        errors = [line for line in lines if "rror" in line]
        return (errors or lines or ["it ended without a message"])[-1]

    def close(self):
        """Lets the process end on its own, or kills it after a while."""
        try:
            self.process.stdin.close()
            self.process.wait(10)
        except (OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()
        self.talk.close()
