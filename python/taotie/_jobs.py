"""The processes of a collection run by others: one that plans and keeps the books, and one for each job."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from types import TracebackType
from typing import Any

from ._error import Error

__all__ = ["Book", "work"]


def work(
    planned: dict[str, Any],
    threads: int | None,
    time_limit: float | None,
    command: Sequence[str] | None,
) -> dict[str, Any]:
    """Do a job in a separate process; without threads, only estimate its memory and find its address."""
    report: dict[str, Any] = {"forecast": None, "address": None}
    start = time.monotonic()
    with tempfile.TemporaryFile("w+") as complaints, subprocess.Popen(
        [*_program(command), "batch-worker"],
        cwd=planned["folder"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=complaints,
        text=True,
        encoding="utf-8",
    ) as process:
        assert process.stdin is not None and process.stdout is not None
        timer = threading.Timer(time_limit or threading.TIMEOUT_MAX, process.kill)
        timer.daemon = True
        timer.start()
        process.stdin.write(json.dumps(planned["job"]) + "\n")
        process.stdin.flush()
        for line in process.stdout:
            message = json.loads(line)
            kind = message.pop("message")
            if kind == "ended":
                report["outcome"] = message
            elif kind == "address":
                report["address"] = message["address"]
            elif kind == "forecast":
                report["forecast"] = message["bytes"]
                if threads is None:
                    # It exits when its stdin closes, and leaves nothing behind.
                    break
                process.stdin.write(json.dumps({"threads": threads}) + "\n")
                process.stdin.flush()
        process.stdin.close()
        process.stdout.close()
        code = process.wait()
        is_late = time_limit is not None and time.monotonic() - start >= time_limit
        timer.cancel()
        report["seconds"] = time.monotonic() - start
        estimated = threads is None and report["forecast"] is not None
        if "outcome" not in report and not estimated:
            report["error"] = _sentence(code, time_limit if is_late else None, complaints)
    return report


def _sentence(code: int, exceeded: float | None, complaints: Any) -> str:
    if exceeded is not None:
        return f"took longer than {exceeded:.0f} s, stopped; raise time_limit, or ask for less"
    complaints.seek(0)
    words = complaints.read()[-2000:].strip().splitlines()
    how = f"was killed by signal {-code}" if code < 0 else f"crashed with code {code}"
    return f"its process {how}" + (f": {words[-1]}" if words else "")


def _program(command: Sequence[str] | None) -> list[str]:
    """Return the command that runs ``taotie``."""
    return list(command) if command else [sys.executable, "-m", "taotie"]


class Book:
    """The process that plans a collection and keeps its manifest."""

    def __init__(self, arguments: Sequence[str], command: Sequence[str] | None) -> None:
        self._process = subprocess.Popen(
            [*_program(command), "batch-book", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            encoding="utf-8",
        )
        self.planned: list[dict[str, Any]] = []
        while line := self._line().strip():
            self.planned.append(json.loads(line))

    def __enter__(self) -> Book:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.kill()
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            with suppress(OSError):
                stream.close()  # type: ignore[union-attr]

    def _line(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            why = f"taotie exited with code {self._process.wait()}; its message is on stderr"
            raise Error(f"could not run the collection: {why}", "io", None, "the collection", why)
        return line

    def add(self, report: dict[str, Any]) -> dict[str, Any]:
        """Record the outcome of a job; return a summary of its record."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(report) + "\n")
        self._process.stdin.flush()
        record: dict[str, Any] = json.loads(self._line())
        return record

    def close(self) -> dict[str, Any]:
        """Write the page; return the outcome of the collection."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        summary: dict[str, Any] = json.loads(self._line())
        self._process.wait()
        return summary
