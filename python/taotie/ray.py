"""Collections on Ray: every asset is a task, on any machine of a cluster.

>>> import taotie.ray
>>> taotie.ray.run("collection.toml", address="auto")["states"]
{'done': 812, 'required-not-met': 3, 'refused': 0, 'failed': 5}

The collection's folder is on a file system shared by all machines, or on one that fsspec supports, such as S3; the
package is installed on all of them. Results, manifest and every file are those of ``taotie batch``, to the bit; each
can continue where the other was interrupted.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import ray

from ._jobs import Book, work
from ._stored import Keeper, Stored, is_url

__all__ = ["run"]

#: Tasks queued in addition to the running ones, for each processor of the cluster.
_AHEAD = 4


def run(
    collection: str | Path,
    *,
    address: str | None = None,
    storage_options: dict[str, Any] | None = None,
    threads: int = 1,
    retry_failed: bool = False,
    time_limit: float | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    command: Sequence[str] | None = None,
) -> dict[str, Any]:
    """Bake a collection on a Ray cluster.

    This process holds no asset: it hands out jobs and writes the manifest. Each job is two tasks: one reads the scan and
    estimates its memory, the other bakes it, with ``memory=`` of that estimate and ``num_cpus=`` of its threads. If a
    machine is lost, its tasks are repeated elsewhere; a problem with an asset is recorded in the manifest.

    Parameters
    ----------
    collection
        The collection's file, ``collection.toml``: a path, or a URL of fsspec such as ``s3://bucket/bronzes/collection.toml``.
        For a URL, everything that the collection reads and writes is in that folder. Each task fetches the files that
        its scan references and uploads its results; the manifest is copied there once a minute and at the end.
    address
        The cluster, as for ``ray.init``; defaults to a cluster of this machine. If Ray is already initialised, that
        cluster is used.
    storage_options
        Options of fsspec's file system, such as keys and endpoints; only with a URL.
    threads
        Threads per bake.
    retry_failed
        True to retry assets that failed or were refused.
    time_limit
        The longest time of a task, in seconds.
    progress
        Called with ``id``, ``state`` and ``error`` of each finished asset.
    command
        The program ``taotie`` on all machines; defaults to the package's own.

    Returns
    -------
    dict
        ``states``, the number of assets in each final state; ``attempts``, ``known``, ``files`` and ``warnings``.

    Raises
    ------
    RuntimeError
        If the collection's file is invalid, or another process is working on it; the reason is printed to stderr.
    FileNotFoundError
        If a URL names no file.
    """
    if not ray.is_initialized():
        ray.init(address=address)
    more = ["--jobs", str(threads), *(["--retry-failed"] if retry_failed else [])]
    how = (threads, time_limit, command)
    if not is_url(collection):
        return _bake([str(collection), *more], _Tasks(None, *how), progress or _ignore)
    stored = Stored(str(collection), storage_options or {})
    stored.look()
    with tempfile.TemporaryDirectory(prefix="taotie-") as folder:
        outline = stored.outline(Path(folder))
        keeper = Keeper(stored, Path(folder))

        def recorded(record: dict[str, Any]) -> None:
            keeper.recorded()
            (progress or _ignore)(record)

        try:
            summary = _bake([str(outline), *more], _Tasks(stored, *how), recorded)
        finally:
            keeper.end()
        summary["files"] = [stored.url_of(os.path.relpath(file, folder)) for file in summary["files"]]
        return summary


def _ignore(_: dict[str, Any]) -> None:
    """Ignore a finished asset."""


def _bake(arguments: list[str], tasks: _Tasks, recorded: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    """Do all jobs of a collection."""

    def keep(report: dict[str, Any] | None) -> None:
        if report is not None:
            recorded(book.add(report))

    with Book(arguments, tasks.command) as book:
        for planned in book.planned:
            while tasks.are_enough():
                keep(tasks.wait())
            tasks.estimate(planned)
        while tasks.running:
            keep(tasks.wait())
        return book.close()


class _Tasks:
    """The running tasks, by reference."""

    def __init__(
        self, stored: Stored | None, threads: int, time_limit: float | None, command: Sequence[str] | None
    ) -> None:
        self.running: dict[Any, tuple[dict[str, Any], float | None]] = {}
        self.command = command
        self._threads = threads
        self._how = (time_limit, command)
        self._stored = ray.put(stored)
        # Ray counts a lost machine among the failures that tasks are retried for, but not an error of the task.
        self._task = ray.remote(max_retries=5, retry_exceptions=False)(_task)
        self._most = _AHEAD * max(1, int(ray.cluster_resources().get("CPU", 1)))

    def are_enough(self) -> bool:
        return len(self.running) >= self._most

    def estimate(self, planned: dict[str, Any]) -> None:
        """Read a scan to estimate its memory."""
        # Ray never starts a task that no machine has the memory for.
        memory = min(planned["reading"], _largest())
        task = self._task.options(num_cpus=1, memory=memory, name=f"estimate {planned['job']['id']}")
        self.running[task.remote(self._stored, planned, None, *self._how)] = (planned, None)

    def _bake(self, planned: dict[str, Any], forecast: int, spent: float) -> None:
        task = self._task.options(num_cpus=self._threads, memory=forecast, name=f"bake {planned['job']['id']}")
        self.running[task.remote(self._stored, planned, self._threads, *self._how)] = (planned, spent)

    def wait(self) -> dict[str, Any] | None:
        """Wait until a task ends; return the report of its job if the job has ended too."""
        (ended,), _ = ray.wait(list(self.running), num_returns=1)
        planned, spent = self.running.pop(ended)
        done: dict[str, Any] = {"id": planned["job"]["id"], "outcome": None, "error": None, "seconds": 0.0, "forecast": None}
        try:
            done.update(ray.get(ended))
        except ray.exceptions.RayError as error:
            done["error"] = "lost its task: " + " ".join(str(error).split())[:300]
            return done
        if done["outcome"] is None and done["error"] is None and spent is None:
            largest = _largest()
            if done["forecast"] <= largest:
                self._bake({**planned, "address": done["address"]}, done["forecast"], done["seconds"])
                return None
            need, most = (f"{size / 2**20:.0f} MiB" for size in (done["forecast"], largest))
            done["outcome"] = _refused(f"needs about {need} of memory; the largest machine of the cluster has {most}")
        done["seconds"] += spent or 0.0
        return done


def _largest() -> float:
    """Return the memory of the largest machine of the cluster, bytes."""
    return max((node["Resources"].get("memory", 0.0) for node in ray.nodes() if node["Alive"]), default=0.0)


def _refused(why: str) -> dict[str, Any]:
    lists: dict[str, Any] = {name: [] for name in ("input", "stages", "required", "warnings", "parts")}
    return {"state": "refused", "error": why, "figures": None, "peak_bytes": None, **lists}


def _task(stored: Stored | None, planned: dict[str, Any], *how: Any) -> dict[str, Any]:
    """Do a job, or estimate its memory, locally or after fetching its files."""
    return work(planned, *how) if stored is None else stored.work(planned, *how)
