"""Collections on Ray: every asset is a task, on any machine of a cluster.

>>> import taotie.ray
>>> taotie.ray.run("collection.toml", address="auto")["states"]
{'done': 812, 'required-not-met': 3, 'refused': 0, 'failed': 5}

The collection's folder lies on a file system that all machines share, or on one that fsspec knows, such as S3; the package is
installed on all of them. What is done, the manifest and every file are those of ``taotie batch``, to the bit; either goes on
where the other was cut off.
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

#: Tasks that wait beside those that run, for each processor of the cluster.
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
    foresees its memory, the other bakes it, with ``memory=`` of that forecast and ``num_cpus=`` of its threads. A task whose
    machine is lost is done again elsewhere; what is wrong with an asset is a record of the manifest.

    Parameters
    ----------
    collection
        The collection's file, ``collection.toml``: a path, or a URL of fsspec such as ``s3://bucket/bronzes/collection.toml``.
        Of a URL, all that the collection reads and writes lies below that folder. Each task fetches what its scan names and
        brings what it made; the manifest is copied there once a minute and at the end.
    address
        The cluster, as ``ray.init`` takes it; a cluster of this machine if not given. Where Ray is initialised already, that
        cluster is used.
    storage_options
        What fsspec's file system takes, such as keys and endpoints; only with a URL.
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
    FileNotFoundError
        Where a URL names no file.
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
    """Hear of an asset and say nothing."""


def _bake(arguments: list[str], tasks: _Tasks, recorded: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    """Do all jobs of a collection."""

    def keep(told: dict[str, Any] | None) -> None:
        if told is not None:
            recorded(book.add(told))

    with Book(arguments, tasks.command) as book:
        for planned in book.planned:
            while tasks.are_enough():
                keep(tasks.wait())
            tasks.foresee(planned)
        while tasks.running:
            keep(tasks.wait())
        return book.close()


class _Tasks:
    """The tasks that are at work: what each is, by its reference."""

    def __init__(
        self, stored: Stored | None, threads: int, time_limit: float | None, command: Sequence[str] | None
    ) -> None:
        self.running: dict[Any, tuple[dict[str, Any], float | None]] = {}
        self.command = command
        self._threads = threads
        self._how = (time_limit, command)
        self._stored = ray.put(stored)
        # Ray counts a machine that is lost among those that tasks are retried for, an error of the task not.
        self._task = ray.remote(max_retries=5, retry_exceptions=False)(_task)
        self._most = _AHEAD * max(1, int(ray.cluster_resources().get("CPU", 1)))

    def are_enough(self) -> bool:
        return len(self.running) >= self._most

    def foresee(self, planned: dict[str, Any]) -> None:
        """Read a scan for its forecast."""
        task = self._task.options(num_cpus=1, memory=planned["reading"], name=f"foresee {planned['job']['id']}")
        self.running[task.remote(self._stored, planned, None, *self._how)] = (planned, None)

    def _bake(self, planned: dict[str, Any], forecast: int, spent: float) -> None:
        task = self._task.options(num_cpus=self._threads, memory=forecast, name=f"bake {planned['job']['id']}")
        self.running[task.remote(self._stored, planned, self._threads, *self._how)] = (planned, spent)

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
                self._bake({**planned, "address": told["address"]}, told["forecast"], told["seconds"])
                return None
            need, most = (f"{size / 2**20:.0f} MiB" for size in (told["forecast"], largest))
            told["outcome"] = _refused(f"it needs about {need} of memory, the largest machine of the cluster has {most}")
        told["seconds"] += spent or 0.0
        return told


def _refused(why: str) -> dict[str, Any]:
    lists: dict[str, Any] = {name: [] for name in ("input", "stages", "required", "warnings", "parts")}
    return {"state": "refused", "error": why, "figures": None, "peak_bytes": None, **lists}


def _task(stored: Stored | None, planned: dict[str, Any], *how: Any) -> dict[str, Any]:
    """Do a job, or foresee its memory, where its files are or where they are fetched to."""
    return work(planned, *how) if stored is None else stored.work(planned, *how)
