"""Errors and warnings."""

from __future__ import annotations

import errno
import math
import operator
import warnings
from collections.abc import Iterable, Sequence
from typing import Any

__all__ = ["Cancelled", "Error", "FileError", "InvalidType", "InvalidValue", "MissingFile", "NotMet", "TaotieWarning"]


class Error(Exception):
    """Something that could not be done, with the place and a remedy.

    Every error is one, and the common ones are also Python's own: see `InvalidValue`, `InvalidType` and `FileError`.

    Attributes
    ----------
    kind : str
        ``"io"``, ``"parse"``, ``"invalid"``, ``"unsupported"``, ``"limit"`` or ``"cancelled"``.
    path : str or None
        The file concerned.
    where : str or None
        The location in the file, or the argument and its value.
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


class InvalidValue(Error, ValueError):
    """An argument has an invalid value; the error names both, and the accepted values."""


class InvalidType(Error, TypeError):
    """An argument has the wrong type, or an array the wrong dtype."""


class FileError(Error, OSError):
    """A file cannot be read or written, or violates its format. `filename` is its path, as for every `OSError`."""

    def __init__(
        self,
        text: str,
        kind: str = "io",
        path: str | None = None,
        where: str | None = None,
        remedy: str | None = None,
        code: int | None = None,
    ) -> None:
        super().__init__(text, kind, path, where, remedy)
        self.filename, self.strerror, self.errno = path, remedy, code

    def __str__(self) -> str:
        return str(self.args[0])

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.kind, self.path, self.where, self.remedy, self.errno)


class MissingFile(FileError, FileNotFoundError):
    """A file does not exist."""


class Cancelled(Error):
    """The progress callback stopped the work. Nothing is left half done."""


class NotMet(Error):
    """A proof does not meet its requirements."""


class TaotieWarning(UserWarning):
    """Something was wrong and has been fixed, or was left out."""


#: The exceptions for errors of the native module, by kind; `Error` for all others.
_KINDS: dict[str, type[Error]] = {"cancelled": Cancelled, "invalid": InvalidValue, "type": InvalidType, "unmet": NotMet}


def make(
    text: str, kind: str, path: str | None, where: str | None, remedy: str | None, code: int | None = None
) -> Error:
    """Return the exception for an error of the native module; `code` is the error number of the operating system."""
    if kind in ("io", "parse"):
        return (MissingFile if code == errno.ENOENT else FileError)(text, kind, path, where, remedy, code)
    return _KINDS.get(kind, Error)(text, kind, path, where, remedy)


def invalid(where: str, remedy: str) -> InvalidValue:
    """Return the error for an unusable value: `where` names the argument and its value, `remedy` the accepted ones."""
    return InvalidValue(f"{where}: {remedy}", "invalid", None, where, remedy)


def invalid_type(name: str, value: object, expected: str) -> InvalidType:
    """Return the error for an argument of the wrong type."""
    where, remedy = f"{name} {' '.join(repr(value).split()):.60}", f"of type {type(value).__name__}; expected {expected}"
    return InvalidType(f"{where}: {remedy}", "type", None, where, remedy)


def choose(name: str, value: object, accepted: Sequence[str]) -> None:
    """Refuse a value other than the accepted texts."""
    if not isinstance(value, str):
        raise invalid_type(name, value, f"one of: {', '.join(accepted)}")
    if value not in accepted:
        raise invalid(f"{name} {value!r}", f"unknown; expected one of: {', '.join(accepted)}")


def number(name: str, value: Any) -> float:
    """Return a finite number, of Python or NumPy; refuse everything else."""
    if isinstance(value, (str, bytes)):
        raise invalid_type(name, value, "a number")
    try:
        found = float(value)
    except (TypeError, ValueError, OverflowError):
        raise invalid_type(name, value, "a number") from None
    if not math.isfinite(found):
        raise invalid(f"{name} {found}", "expected a finite number")
    return found


def integer(name: str, value: Any, least: int | None = None) -> int:
    """Return an integer, of Python or NumPy; refuse everything else, and those below the least."""
    if isinstance(value, bool):
        raise invalid_type(name, value, "an integer")
    try:
        found = operator.index(value)
    except TypeError:
        raise invalid_type(name, value, "an integer") from None
    if least is not None and found < least:
        raise invalid(f"{name} {found}", f"expected an integer of {least} or more")
    return found


def warn(listed: Iterable[tuple[str, int]], stacklevel: int = 3) -> None:
    """Issue one warning of each kind that occurred, with its count."""
    for what, count in listed:
        if count == 0:
            continue
        times = "" if count == 1 else f" ({count} times)"
        warnings.warn(what + times, TaotieWarning, stacklevel=stacklevel)
