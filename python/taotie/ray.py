"""Collections on Ray: every asset is a task, on any machine of a cluster.

>>> import taotie.ray
>>> taotie.ray.run("collection.toml", address="auto")["states"]
{'done': 812, 'required-not-met': 3, 'refused': 0, 'failed': 5}

The collection's folder lies on a file system that all machines share, and the package is installed on all of them. What is done,
the manifest and every file are those of ``taotie batch``, to the bit; either goes on where the other was cut off.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import ray

__all__ = ["run"]

#: Tasks that wait beside those that run, for each processor of the cluster.
_AHEAD = 4


def run(
    collection: str | Path,
    *,
    address: str | None = None,
    threads: int = 1,
    retry_failed: bool = False,
    time_limit: float | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    command: Sequence[str] | None = None,
) -> dict[str, Any]:
    """Bake a collection on a Ray cluster.

    This process holds no asset: it hands out jobs and writes the manifest. Each job is two tasks: one reads the scan and
    foresees its memory, the other bakes it, with ``memory=`` of that forecast and ``num_cpus=`` of its threads. A task whose
    machine is lost is done again elsewhere; what is wrong with an asset is a record of the manifest.

    Parameters
    ----------
    collection
        The collection's file, ``collection.toml``.
    address
        The cluster, as ``ray.init`` takes it; a cluster of this machine if not given. Where Ray is initialised already, that
        cluster is used.
    threads
        Threads of a bake.
    retry_failed
        Whether what failed or was refused is attempted again.
    time_limit
        The longest time of a task, seconds.
    progress
        Called with ``id``, ``state`` and ``error`` of each asset that has ended.
    command
        The program ``taotie`` on all machines; the package's own if not given.

    Returns
    -------
    dict
        ``states``, the last state of each asset, counted; ``attempts``, ``known``, ``files`` and ``warnings``.

    Raises
    ------
    RuntimeError
        Where the collection's file is wrong, or another process works on it; it has said why on stderr.
    """
    if not ray.is_initialized():
        ray.init(address=address)
    arguments = [str(collection), "--jobs", str(threads), *(["--retry-failed"] if retry_failed else [])]
    with _Book(arguments, command) as book:
        tasks = _Tasks(threads, time_limit, command)
        for planned in book.planned:
            while tasks.are_enough():
                _keep(book, tasks.wait(), progress)
            tasks.foresee(planned)
        while tasks.running:
            _keep(book, tasks.wait(), progress)
        return book.close()


def _keep(book: _Book, told: dict[str, Any] | None, progress: Callable[[dict[str, Any]], None] | None) -> None:
    if told is not None:
        record = book.add(told)
        if progress is not None:
            progress(record)


class _Tasks:
    """The tasks that are at work: what each is, by its reference."""

    def __init__(self, threads: int, time_limit: float | None, command: Sequence[str] | None) -> None:
        self.running: dict[Any, tuple[dict[str, Any], float | None]] = {}
        self._threads = threads
        self._how = (time_limit, command)
        # Ray counts a machine that is lost among those that tasks are retried for, an error of the task not.
        self._task = ray.remote(max_retries=5, retry_exceptions=False)(_work)
        self._most = _AHEAD * max(1, int(ray.cluster_resources().get("CPU", 1)))

    def are_enough(self) -> bool:
        return len(self.running) >= self._most

    def foresee(self, planned: dict[str, Any]) -> None:
        """Read a scan for its forecast."""
        task = self._task.options(num_cpus=1, memory=planned["reading"], name=f"foresee {planned['job']['id']}")
        self.running[task.remote(planned, None, *self._how)] = (planned, None)

    def _bake(self, planned: dict[str, Any], forecast: int, spent: float) -> None:
        task = self._task.options(num_cpus=self._threads, memory=forecast, name=f"bake {planned['job']['id']}")
        self.running[task.remote(planned, self._threads, *self._how)] = (planned, spent)

    def wait(self) -> dict[str, Any] | None:
        """Wait until a task ends; return what became of a job, where one has come to its end."""
        (ended,), _ = ray.wait(list(self.running), num_returns=1)
        planned, spent = self.running.pop(ended)
        told: dict[str, Any] = {"id": planned["job"]["id"], "outcome": None, "error": None, "seconds": 0.0, "forecast": None}
        try:
            told.update(ray.get(ended))
        except ray.exceptions.RayError as error:
            told["error"] = "its task was lost: " + " ".join(str(error).split())[:300]
            return told
        if told["outcome"] is None and told["error"] is None and spent is None:
            largest = max((node["Resources"].get("memory", 0.0) for node in ray.nodes() if node["Alive"]), default=0.0)
            if told["forecast"] <= largest:
                self._bake(planned, told["forecast"], told["seconds"])
                return None
            need, most = (f"{size / 2**20:.0f} MiB" for size in (told["forecast"], largest))
            told["outcome"] = _refused(f"it needs about {need} of memory, the largest machine of the cluster has {most}")
        told["seconds"] += spent or 0.0
        return told


def _refused(why: str) -> dict[str, Any]:
    lists: dict[str, Any] = {name: [] for name in ("input", "stages", "required", "warnings", "parts")}
    return {"state": "refused", "error": why, "figures": None, "peak_bytes": None, **lists}


def _work(
    planned: dict[str, Any],
    threads: int | None,
    time_limit: float | None,
    command: Sequence[str] | None,
) -> dict[str, Any]:
    """Do a job by a process of its own, or foresee its memory where it has no threads yet."""
    told: dict[str, Any] = {"forecast": None}
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
            said = message.pop("tell")
            if said == "ended":
                told["outcome"] = message
            elif said == "forecast":
                told["forecast"] = message["bytes"]
                if threads is None:
                    # It ends with its stdin, and leaves nothing.
                    break
                process.stdin.write(json.dumps({"threads": threads}) + "\n")
                process.stdin.flush()
        process.stdin.close()
        process.stdout.close()
        code = process.wait()
        is_late = time_limit is not None and time.monotonic() - start >= time_limit
        timer.cancel()
        told["seconds"] = time.monotonic() - start
        foreseen = threads is None and told["forecast"] is not None
        if "outcome" not in told and not foreseen:
            told["error"] = _sentence(code, time_limit if is_late else None, complaints)
    return told


def _sentence(code: int, exceeded: float | None, complaints: Any) -> str:
    if exceeded is not None:
        return f"it took longer than {exceeded:.0f} s and was ended; raise time_limit, or ask for less"
    complaints.seek(0)
    words = complaints.read()[-2000:].strip().splitlines()
    how = f"was ended by signal {-code}" if code < 0 else f"crashed with code {code}"
    return f"its process {how}" + (f": {words[-1]}" if words else "")


def _program(command: Sequence[str] | None) -> list[str]:
    return list(command) if command else [sys.executable, "-m", "taotie"]


class _Book:
    """The process that plans a collection, and keeps its manifest."""

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

    def __enter__(self) -> _Book:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.kill()
        self._process.wait()

    def _line(self) -> str:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"the collection cannot be worked on: taotie ended with code {self._process.wait()}")
        return line

    def add(self, told: dict[str, Any]) -> dict[str, Any]:
        """Write down what became of a job; return what its record says in short."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(told) + "\n")
        self._process.stdin.flush()
        record: dict[str, Any] = json.loads(self._line())
        return record

    def close(self) -> dict[str, Any]:
        """Write the page; return what became of the collection."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        summary: dict[str, Any] = json.loads(self._line())
        self._process.wait()
        return summary
