"""Errors and warnings."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any

__all__ = ["Cancelled", "Error", "NotMet", "TaotieWarning"]


class Error(Exception):
    """Something that could not be done, with the place and a remedy.

    Attributes
    ----------
    kind : str
        ``"io"``, ``"parse"``, ``"invalid"``, ``"unsupported"``, ``"limit"`` or ``"cancelled"``.
    path : str or None
        The file concerned.
    where : str or None
        The location in the file, or the invalid value.
    remedy : str or None
        The problem there, and what to do about it.
    """

    kind: str
    path: str | None
    where: str | None
    remedy: str | None

    def __init__(
        self,
        text: str,
        kind: str = "invalid",
        path: str | None = None,
        where: str | None = None,
        remedy: str | None = None,
    ) -> None:
        super().__init__(text)
        self.kind, self.path, self.where, self.remedy = kind, path, where, remedy

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.kind, self.path, self.where, self.remedy)


class Cancelled(Error):
    """The progress callback stopped the work. Nothing is left half done."""


class NotMet(Error):
    """A proof does not meet its requirements."""


class TaotieWarning(UserWarning):
    """Something was wrong and has been fixed, or was left out."""


def make(text: str, kind: str, path: str | None, where: str | None, remedy: str | None) -> Error:
    """Return the exception for an error of the native module."""
    return (Cancelled if kind == "cancelled" else Error)(text, kind, path, where, remedy)


def invalid(where: str, remedy: str) -> Error:
    """Return the error for an unusable value."""
    return Error(f"{where}: {remedy}", "invalid", None, where, remedy)


def warn(listed: Iterable[tuple[str, int]], stacklevel: int = 3) -> None:
    """Issue one warning of each kind, with its count."""
    for what, count in listed:
        times = "" if count == 1 else f" ({count} times)"
        warnings.warn(what + times, TaotieWarning, stacklevel=stacklevel)
