"""How work runs: its progress and its threads."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Any, TypeAlias, TypedDict, Union

#: ``True`` shows a bar, a callable gets stage and fraction and stops the work by returning ``False``.
Progress: TypeAlias = Union[bool, Callable[[str, float], object], None]


class Running(TypedDict):
    """The options for the native module."""

    progress: Callable[[str, float], object] | None
    threads: int | None


@contextlib.contextmanager
def running(progress: Progress, threads: int | None) -> Iterator[Running]:
    """Yield the options for running work, with a progress bar if requested."""
    if progress is True:
        bar = _bar()
        try:
            yield {"progress": bar, "threads": threads}
        finally:
            bar.close()
    else:
        yield {"progress": progress or None, "threads": threads}


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


class _Bar:
    """Shows a tqdm bar for each stage."""

    def __init__(self, tqdm: Any) -> None:
        self._tqdm, self._stage, self._bar = tqdm, "", None

    def __call__(self, stage: str, fraction: float) -> None:
        if stage != self._stage:
            self.close()
            self._stage, self._bar = stage, self._tqdm(total=1000, desc=stage, unit="‰", leave=False)
        if self._bar is not None:
            self._bar.update(int(fraction * 1000) - self._bar.n)

    def close(self) -> None:
        """End the bar."""
        if self._bar is not None:
            self._bar.close()


def _bar() -> Any:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _Lines()
    return _Bar(tqdm)
