"""Normal maps from heights or from other normal maps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import Array, image
from ._error import choose, invalid, invalid_type, number, warn
from ._run import Progress, running

__all__ = ["Converted", "convert", "from_height"]


@dataclass(frozen=True, eq=False, repr=False)
class Converted:
    """A normal map, with the error due to storing it.

    Attributes
    ----------
    map : ndarray
        ``(H, W, 3)`` uint8 or uint16.
    error_deg : ndarray
        ``(H, W)`` float32: degrees between the exact normals and the stored ones; NaN where there is none.

    Examples
    --------
    >>> tt.normals.convert(np.full((8, 8), 0.5, np.float32), source="height", height_scale=4, bits=8)
    <taotie.Converted 8x8 uint8>
    """

    map: Array
    error_deg: npt.NDArray[np.float32]

    def __repr__(self) -> str:
        height, width = self.map.shape[:2]
        return f"<taotie.Converted {width}x{height} {self.map.dtype}>"


def from_height(
    heights: npt.ArrayLike,
    *,
    scale: float,
    border: Literal["repeat", "mirror", "clamp"] = "repeat",
) -> npt.NDArray[np.float32]:
    """Return the tangent-space normals of a height map, exact to float32 rounding.

    ``n = (-s dh/dx, -s dh/dy, 1)``, normalised, y up the image; differences over one and two texels on either side
    (Fornberg 1988, table 1).

    Parameters
    ----------
    heights : array_like
        ``(H, W)``: floats as they are, integers scaled to [0, 1].
    scale : float
        Height of 1 in texels: a slope of one texel per texel is 45 degrees.
    border : {"repeat", "mirror", "clamp"}
        Heights beyond the border.

    Returns
    -------
    ndarray
        ``(H, W, 3)`` float32, unit, green up. Use `convert` for a map of 8 or 16 bits.

    Examples
    --------
    >>> slope = np.tile(np.linspace(0, 1, 8, dtype=np.float32), (8, 1))
    >>> tt.normals.from_height(slope, scale=7, border="clamp")[4, 4].round(3)
    array([-0.707,  0.   ,  0.707], dtype=float32)
    """
    array = np.asarray(heights)
    expected = "(H, W), floats, uint8 or uint16"
    if array.dtype.kind not in "fu":
        raise invalid_type("heights", heights, f"an array of {expected}")
    if array.ndim != 2 or array.size == 0:
        raise invalid("heights", f"an array of shape {array.shape}, dtype {array.dtype}; expected {expected}")
    if not np.isfinite(array).all():
        raise invalid("heights", "an infinite value or NaN; expected finite numbers")
    choose("border", border, ("repeat", "mirror", "clamp"))
    if array.dtype.kind == "u":
        array = array.astype(np.float32) / np.float32(np.iinfo(array.dtype).max)
    values = np.ascontiguousarray(array, dtype=np.float32).reshape(-1)
    height, width = array.shape
    normals: npt.NDArray[np.float32] = _taotie.normals_of_heights(
        {"values": values, "size": [width, height]}, number("scale", scale), border
    )
    return normals


def convert(
    map: Any,
    *,
    source: Literal["auto", "height", "tangent", "object"] = "auto",
    green_in: Literal["up", "down"] | None = None,
    green: Literal["up", "down"] = "up",
    bits: Literal[8, 16] | None = None,
    dither: bool = False,
    height_scale: float | None = None,
    border: Literal["repeat", "mirror", "clamp"] = "repeat",
    progress: Progress = None,
) -> Converted:
    """Make a normal map from heights, or convert its green and bit depth, as ``taotie normals`` does without a mesh.

    Parameters
    ----------
    map : path or array_like
        ``(H, W)`` or ``(H, W, channels)`` of uint8, uint16 or float32, a PIL image, or a file.
    source : {"auto", "height", "tangent", "object"}
        The content of the map; auto guesses from the pixels.
    green_in : {"up", "down"}, optional
        Direction of green in the input: up (OpenGL, glTF) or down (DirectX); by default guessed from the pixels.
    green : {"up", "down"}
        Direction of green in the output.
    bits : {8, 16}, optional
        Defaults to those of the input if its space stays the same, otherwise 16.
    dither : bool
        Dither before rounding.
    height_scale : float, optional
        Height of white in texels; required for heights.
    border : {"repeat", "mirror", "clamp"}
        Heights beyond the border of the map.

    Returns
    -------
    Converted

    Examples
    --------
    >>> directx = np.full((4, 4, 3), (128, 90, 240), np.uint8)
    >>> tt.normals.convert(directx, source="tangent", green_in="down").map[0, 0]
    array([128, 165, 240], dtype=uint8)
    """
    choose("source", source, ("auto", "height", "tangent", "object"))
    contents: dict[str, Any] = {"auto": None, "height": "heights"}
    request = {
        "content": contents.get(source, {"normals": source}),
        "green": green_in,
        "options": {
            "green": green,
            "bits": bits,
            "dither": dither,
            "height_scale": None if height_scale is None else number("height_scale", height_scale),
            "border": border,
        },
    }
    with running(progress, None) as run:
        made = _taotie.convert(image("map", map), request, run)
    warn(made["warnings"])
    return Converted(made["map"], made["error"])
