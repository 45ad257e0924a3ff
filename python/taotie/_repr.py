"""Values described by their fields: one line, and comparison of all fields."""

from __future__ import annotations

from dataclasses import MISSING, fields
from typing import Any

import numpy as np


class Value:
    """A base of dataclasses, declared with ``repr=False, eq=False``, whose fields may be arrays."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(_given(self))})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and _identity(self) == _identity(other)

    def __hash__(self) -> int:
        return hash(_identity(self))


def _given(thing: Any) -> list[str]:
    """Return the fields that differ from their defaults; arrays by shape and dtype."""
    given = []
    for field in fields(thing):
        value = getattr(thing, field.name)
        is_default = not isinstance(value, np.ndarray) and field.default is not MISSING and value == field.default
        if not is_default:
            given.append(f"{field.name}={_text(value)}")
    return given


def _text(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"<{value.dtype} {value.shape}>"
    shape = getattr(value, "shape", getattr(value, "size", None))
    text = f"<{type(value).__name__} {shape}>" if isinstance(shape, tuple) else repr(value)
    return text if "\n" not in text else f"<{type(value).__name__}>"


def _identity(thing: Any) -> tuple[object, ...]:
    """Return what equal values share, and can be hashed."""

    def key(value: Any) -> object:
        if isinstance(value, np.ndarray):
            return value.shape, value.dtype.str, value.tobytes()
        return tuple(map(key, value)) if isinstance(value, (list, tuple)) else value

    return tuple(key(getattr(thing, field.name)) for field in fields(thing))
