"""Figures of a proof in words; the program's JSON has numbers without units."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

# The unit of figures by the end of their name, and its factor on the number in JSON.
UNITS = {"angle": ("°", 1), "color": (" ΔE", 1), "silhouette": (" px", 1), "memory": (" B", 1), "bytes": (" B", 1),
         "missed": (" %", 100), "completeness": (" %", 100), "hausdorff": (" %", 100)}
# Limits that are a minimum; those of `within-…` are too.
LEAST = {"completeness", "ssim"}
WITHIN = {"within-angle": ("deg", 1), "within-color": ("dE", 1), "within-distance": ("%", 100)}


def in_words(figure: dict[str, Any]) -> str:
    """Return a required figure with its limit, such as `mean-angle 0.0137° (at most 1°)`."""
    name = figure["figure"]
    unit, factor = next((UNITS[end] for end in UNITS if name.endswith(end)), ("", 1))
    least = name in LEAST
    if figure["is_length"]:
        unit, factor = " m", 1
    if name in WITHIN:
        within, scale = WITHIN[name]
        name = f"within-{digits(figure['within'] * scale)}{within}"
        unit, factor, least = " %", 100, True
    if figure["level"]:
        name += f"@{figure['level']}"
    value = "not compared" if figure["value"] is None else f"{digits(figure['value'] * factor)}{unit}"
    return f"{name} {value} ({'at least' if least else 'at most'} {digits(figure['most'] * factor)}{unit})"


def digits(number: float) -> str:
    """Return a number with five digits, without an exponent."""
    return f"{Decimal(f'{number:.5g}'):f}"
