"""Representations on one line."""

from __future__ import annotations

from dataclasses import MISSING, fields
from typing import Any

import numpy as np


def brief(thing: Any) -> str:
    """Return a dataclass with the fields that differ from their defaults; arrays by shape and dtype."""
    given = []
    for field in fields(thing):
        value = getattr(thing, field.name)
        is_default = not isinstance(value, np.ndarray) and field.default is not MISSING and value == field.default
        if field.repr and not is_default:
            given.append(f"{field.name}={_value(value)}")
    return f"{type(thing).__name__}({', '.join(given)})"


def _value(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"<{value.dtype} {value.shape}>"
    shape = getattr(value, "shape", getattr(value, "size", None))
    text = f"<{type(value).__name__} {shape}>" if isinstance(shape, tuple) else repr(value)
    return text if "\n" not in text else f"<{type(value).__name__}>"
