"""How work runs: its progress and its threads."""

from __future__ import annotations

import contextlib
import itertools
import logging
from collections.abc import Callable, Iterator, Mapping
from typing import Any, TypeAlias, TypedDict, Union

from ._error import integer, invalid_type

#: Stages at DEBUG; what has been read, baked, proved and written at INFO.
log = logging.getLogger("taotie")

#: ``True`` shows a bar, a callable gets stage and fraction and stops the work by returning ``False``.
Progress: TypeAlias = Union[bool, Callable[[str, float], object], None]


class Running(TypedDict):
    """The options for the native module."""

    progress: Callable[[str, float], object] | None
    threads: int | None


@contextlib.contextmanager
def running(progress: Progress, threads: int | None, stages: Mapping[str, float] = {}) -> Iterator[Running]:
    """Yield the options for running work, with a progress bar if requested; see `Overall` for the stages."""
    if threads is not None:
        threads = integer("threads", threads, 1)
    if not (progress is None or isinstance(progress, bool) or callable(progress)):
        raise invalid_type("progress", progress, "True, False or a callable of stage and fraction")
    with listener(progress, stages) as listened:
        yield {"progress": listened, "threads": threads}


@contextlib.contextmanager
def listener(progress: Progress, stages: Mapping[str, float] = {}) -> Iterator[Callable[[str, float], Any] | None]:
    """Yield the callable that receives progress, or None: it moves a bar if requested, and logs stages."""
    with shown(progress, stages) as receiver:
        yield _Logged(receiver) if log.isEnabledFor(logging.DEBUG) else receiver


@contextlib.contextmanager
def shown(progress: Progress, stages: Mapping[str, float] = {}) -> Iterator[Callable[[str, float], Any] | None]:
    """Yield the callable that receives progress, or None: it moves a bar if requested."""
    bar = _bar(stages) if progress is True else None
    try:
        yield bar if isinstance(progress, bool) else progress
    finally:
        if bar is not None:
            bar.close()


class _Logged:
    """Logs each stage, and passes progress on."""

    def __init__(self, shown: Callable[[str, float], Any] | None) -> None:
        self._shown, self._stage = shown, ""

    def __call__(self, stage: str, fraction: float) -> Any:
        if stage != self._stage:
            self._stage = stage
            log.debug("%s", stage)
        return None if self._shown is None else self._shown(stage, fraction)


class _Lines:
    """Prints a line to stderr for each stage, if tqdm is not installed."""

    def __init__(self) -> None:
        self._stage = ""

    def __call__(self, stage: str, fraction: float) -> None:
        if stage != self._stage:
            import sys

            self._stage = stage
            print(f"taotie: {stage}", file=sys.stderr)

    def close(self) -> None:
        """End the last line."""


class Overall:
    """The completed fraction of work of several stages, which never falls.

    ``stages`` has the shares of the time of all stages, in order. Those that do not occur are skipped; others do not
    count, unless none is known.
    """

    def __init__(self, stages: Mapping[str, float]) -> None:
        total = sum(stages.values())
        ends = itertools.accumulate(stages.values())
        self._ranges = {stage: ((end - share) / total, end / total) for (stage, share), end in zip(stages.items(), ends)}
        self._done = 0.0

    def at(self, stage: str, fraction: float) -> float:
        """Return the fraction of all work that is done."""
        begin, end = self._ranges.get(stage, (0.0, 0.0) if self._ranges else (0.0, 1.0))
        self._done = max(self._done, begin + (end - begin) * fraction)
        return self._done


class _Bar:
    """Shows one tqdm bar for all stages."""

    def __init__(self, tqdm: Any, stages: Mapping[str, float]) -> None:
        self._overall = Overall(stages)
        form = "{desc}: {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"
        self._bar = tqdm(total=1000, desc="taotie", leave=False, bar_format=form)

    def __call__(self, stage: str, fraction: float) -> None:
        self._bar.set_description(stage, refresh=False)
        self._bar.update(int(self._overall.at(stage, fraction) * 1000) - self._bar.n)

    def close(self) -> None:
        """End the bar."""
        self._bar.close()


def _bar(stages: Mapping[str, float]) -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _Lines()
    return _Bar(tqdm, stages)
