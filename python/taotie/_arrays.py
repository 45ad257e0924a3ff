"""Checked conversion of arguments: arrays, images, paths."""

from __future__ import annotations

import os
from typing import Any, TypeAlias, Union

import numpy as np
import numpy.typing as npt

from ._error import InvalidType, integer, invalid, invalid_type

Array: TypeAlias = npt.NDArray[Any]
PathLike: TypeAlias = Union[str, "os.PathLike[str]"]


def path(name: str, value: object) -> str:
    """Return a path as text; refuse everything else."""
    found = os.fspath(value) if isinstance(value, (str, os.PathLike)) else None
    if not isinstance(found, str):
        raise invalid_type(name, value, "str or a path")
    return found


def sides(name: str, value: Any) -> tuple[int, int]:
    """Return width and height from one integer for both, or from two; refuse everything else."""
    pair = [value, value] if np.ndim(value) == 0 else list(value)
    if len(pair) != 2:
        raise invalid(name, f"{len(pair)} numbers; expected an integer, or (width, height)")
    if any(isinstance(side, str) for side in pair):
        raise invalid_type(name, value, "an integer, or (width, height)")
    width, height = (integer(name, side, 1) for side in pair)
    return width, height


def rows(name: str, values: npt.ArrayLike, widths: tuple[int, ...]) -> npt.NDArray[np.float32]:
    """Return rows of finite numbers as a contiguous float32 array; refuse everything else."""
    array = _numbers(name, values)
    expected = f"{_shapes(widths)}, float32 or float64"
    _check_shape(name, array, (widths, expected))
    if array.dtype.kind not in "fiu":
        raise _wrong_dtype(name, array, expected)
    with np.errstate(over="ignore"):
        single = np.ascontiguousarray(array, dtype=np.float32)
    _check_finite(name, single)
    return single


def triangles(name: str, values: npt.ArrayLike, vertices: int) -> npt.NDArray[np.uint32]:
    """Return triangles as a contiguous array of uint32 indices below the number of vertices."""
    array = _numbers(name, values)
    expected = "(n, 3), uint32 or another integer"
    if array.size == 0:
        array = array.reshape(-1, 3).astype(np.uint32)
    _check_shape(name, array, ((3,), expected))
    if array.dtype.kind not in "iu":
        raise _wrong_dtype(name, array, expected)
    if array.size and (array.min() < 0 or array.max() >= vertices):
        row = int(np.argmax(((array < 0) | (array >= vertices)).any(axis=1)))
        wrong = next(int(index) for index in array[row] if not 0 <= index < vertices)
        what = "an index below 0" if wrong < 0 else "an index beyond the last vertex"
        accepted = f"0 to {vertices - 1}" if vertices else "none, since there are no vertices"
        raise invalid(name, f"row {row} has {what}, {wrong}; accepted: {accepted}")
    return np.ascontiguousarray(array, dtype=np.uint32)


def colors(name: str, values: npt.ArrayLike) -> Array:
    """Return colours as contiguous RGBA: sRGB codes if they are uint8, otherwise linear float32 in [0, 1]."""
    array = _numbers(name, values)
    expected = "(n, 3) or (n, 4), uint8 (sRGB) or float32 or float64 (linear, 0 to 1)"
    _check_shape(name, array, ((3, 4), expected))
    if array.dtype.kind != "f" and array.dtype != np.uint8:
        raise _wrong_dtype(name, array, expected)
    if array.dtype != np.uint8:
        array = array.astype(np.float32)
        _check_finite(name, array)
        if array.size and (array.min() < 0 or array.max() > 1):
            low, high = float(array.min()), float(array.max())
            remedy = "floats are linear, 0 to 1; pass sRGB codes of 0 to 255 as uint8"
            raise invalid(name, f"values from {low:g} to {high:g}; {remedy}")
    if array.shape[1] == 3:
        opaque = np.full((len(array), 1), 255 if array.dtype == np.uint8 else 1, array.dtype)
        array = np.concatenate([array, opaque], axis=1)
    return np.ascontiguousarray(array)


def image(name: str, values: Any) -> Any:
    """Return an image in the form that the native module takes: a path, or texels ``(height, width, channels)``.

    Booleans are refused; float64 is rounded to float32; PIL images are converted to arrays.
    """
    if isinstance(values, (str, os.PathLike)):
        return path(name, values)
    array = _numbers(name, _of_pil(values))
    if array.dtype == np.float64 or array.dtype == np.float16:
        array = array.astype(np.float32)
    if array.ndim == 2:
        array = array[:, :, None]
    expected = "(height, width) or (height, width, 1 to 4), uint8, uint16 or float32"
    if array.ndim != 3 or not 1 <= array.shape[2] <= 4 or 0 in array.shape:
        raise invalid(name, f"an array of shape {np.shape(values)}, dtype {array.dtype}; expected {expected}")
    if array.dtype not in (np.dtype(np.uint8), np.dtype(np.uint16), np.dtype(np.float32)):
        raise _wrong_dtype(name, array, expected)
    return np.ascontiguousarray(array)


def _of_pil(values: Any) -> Any:
    """Convert a PIL image whose mode is neither grey, RGB nor RGBA, such as one with a palette."""
    mode = getattr(values, "mode", None)
    if not isinstance(mode, str) or not hasattr(values, "convert") or mode in ("L", "LA", "RGB", "RGBA", "I;16", "F"):
        return values
    if mode.startswith("I"):
        codes = np.asarray(values)
        is_16_bit = codes.min(initial=0) >= 0 and codes.max(initial=0) <= 65535
        return codes.astype(np.uint16) if is_16_bit else codes
    is_transparent = mode == "PA" or "transparency" in getattr(values, "info", {})
    return values.convert("RGBA" if is_transparent or mode in ("RGBa", "La") else "RGB")


def _numbers(name: str, values: Any) -> Array:
    try:
        array = np.asarray(values)
    except (TypeError, ValueError, RuntimeError) as error:
        raise invalid_type(name, values, f"an array of numbers ({error})") from None
    if array.dtype == object or array.dtype.kind in "USV":
        raise invalid_type(name, values, "an array of numbers, with rows of the same length")
    return array if array.dtype.isnative else array.astype(array.dtype.newbyteorder("="))


def _shapes(widths: tuple[int, ...]) -> str:
    return " or ".join(f"(n, {width})" for width in widths)


def _check_shape(name: str, array: Array, wanted: tuple[tuple[int, ...], str]) -> None:
    widths, expected = wanted
    if array.ndim != 2 or array.shape[1] not in widths:
        raise invalid(name, f"an array of shape {array.shape}, dtype {array.dtype}; expected {expected}")


def _wrong_dtype(name: str, array: Array, expected: str) -> InvalidType:
    remedy = f"an array of dtype {array.dtype}, shape {array.shape}; expected {expected}"
    return InvalidType(f"{name}: {remedy}", "type", None, name, remedy)


def _check_finite(name: str, array: npt.NDArray[np.float32]) -> None:
    # A finite sum proves that all are finite, in one pass without a temporary array.
    with np.errstate(over="ignore", invalid="ignore"):
        is_proved = bool(np.isfinite(array.sum(dtype=np.float32)))
    if not is_proved and not np.isfinite(array).all():
        row = int(np.argmin(np.isfinite(array).all(axis=1)))
        raise invalid(name, f"row {row} is {array[row].tolist()}; expected finite numbers of float32")


def matrix(name: str, values: npt.ArrayLike, side: int) -> npt.NDArray[np.float64]:
    """Return a square matrix of finite numbers."""
    array = _numbers(name, values)
    if array.shape != (side, side) or array.dtype.kind not in "iuf" or not np.isfinite(array).all():
        raise invalid(name, f"an array of shape {array.shape}; expected ({side}, {side}), finite numbers")
    return array.astype(np.float64)


def affine(name: str, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return an affine transform, ``(4, 4)``, for column vectors."""
    transform = matrix(name, values, 4)
    if not np.allclose(transform[3], (0, 0, 0, 1)):
        raise invalid(name, f"its last row is {transform[3].tolist()}; expected 0, 0, 0, 1")
    return transform


__all__ = ["Array", "PathLike", "affine", "colors", "image", "matrix", "path", "rows", "sides", "triangles"]
