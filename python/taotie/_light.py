"""Lights, and light from all directions."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, fields
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

from ._arrays import Array, PathLike, image
from ._error import invalid
from ._repr import Value


@dataclass(frozen=True, repr=False, eq=False)
class Environment(Value):
    """Light from all directions. An option given separately overrides its field.

    Parameters
    ----------
    source : {"studio", "none"}, path or array_like
        The built-in studio, an equirectangular .hdr or .exr, or none. Or an equirectangular image as an array: linear
        radiance, ``(height, width, 3)`` floats, its first row the zenith, its middle column towards -z.
    rotation_deg : float
        Rotation counterclockwise as seen from above, degrees.
    intensity : float
        Factor of its light.
    visible : bool
        Show it behind the model.

    Examples
    --------
    >>> sky = np.zeros((64, 128, 3), np.float32)
    >>> sky[:20] = (0.4, 0.6, 1.0)
    >>> image = tt.render(scan, env=tt.Environment(sky, rotation_deg=30, visible=True), size=32)
    """

    source: PathLike | npt.ArrayLike
    _: KW_ONLY
    rotation_deg: float = 0.0
    intensity: float = 1.0
    visible: bool = False


def radiance(values: Any) -> Array:
    """Return an equirectangular image of light in the form that the native module takes."""
    array: Array = image("env", values)
    if array.dtype != np.float32 or array.shape[2] not in (3, 4):
        raise invalid(
            "env", f"an array of shape {array.shape}, dtype {array.dtype}; expected linear radiance, (height, width, 3) floats"
        )
    return array


def is_named(source: Any) -> bool:
    """Return true for an environment given by its name or path."""
    return isinstance(source, (str, os.PathLike))


@dataclass(frozen=True, repr=False, eq=False)
class Light(Value):
    """A light that keeps its position relative to the camera on a turntable. ``str`` returns its text.

    Parameters
    ----------
    kind : {"point", "spot", "directional"}
        Its form.
    at : (x, y, z), optional
        Position of a point or spot light.
    toward : (x, y, z), optional
        Point that a spot light is aimed at, or direction in which a directional light shines.
    from_deg : (azimuth, elevation), optional
        Direction that a directional light comes from, relative to the view, degrees.
    strength : float, default 3
        Intensity of a point or spot light, irradiance of a directional one.
    color : str or float, optional
        Colour in CSS syntax, or linear grey; the strength is multiplied by it.
    falloff : {"none", "inverse-square"}, optional
        Falloff of a point or spot light with distance.
    angle_deg : float, default 30
        Angle from the axis of a spot light beyond which it is dark, degrees.
    inner_deg : float, optional
        Angle from the axis up to which it has full strength, degrees; defaults to 0.8 of ``angle_deg``.

    Examples
    --------
    >>> key = tt.Light("directional", from_deg=(-75, 10), strength=4)
    >>> str(key)
    'directional from=-75.0,10.0 strength=4.0'
    >>> image = tt.render(scan, light=[key, tt.Light("point", at=(1, 2, 3), color="#ffe0b0")], size=32)
    """

    kind: Literal["point", "spot", "directional"]
    _: KW_ONLY
    at: Sequence[float] | None = None
    toward: Sequence[float] | None = None
    from_deg: Sequence[float] | None = None
    strength: float | None = None
    color: Union[str, float, None] = None
    falloff: Literal["none", "inverse-square"] | None = None
    angle_deg: float | None = None
    inner_deg: float | None = None

    def __str__(self) -> str:
        values = ((field.name.removesuffix("_deg"), getattr(self, field.name)) for field in fields(self)[1:])
        return " ".join([self.kind, *(f"{key}={_word(value)}" for key, value in values if value is not None)])


def _word(value: Any) -> str:
    """Return a value in the text of a light: one word, with numbers that are read back exactly."""
    if isinstance(value, str):
        return value.replace(" ", "")
    return ",".join(repr(float(number)) for number in np.ravel(value))
