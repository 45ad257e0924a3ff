"""Normals from photographs under changing light."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import PathLike, image, path
from ._error import choose, invalid, invalid_type, number, warn
from ._run import Progress, running


@dataclass(frozen=True, eq=False, repr=False)
class PhotometricNormals:
    """Normals from photographs, each with its uncertainty. All maps are ``(H, W)`` unless stated, NaN without a normal.

    Attributes
    ----------
    normals : ndarray
        ``(H, W, 3)`` float32 unit vectors: x to the right, y up, z towards the camera.
    sigma : ndarray
        Degrees within which 68 % of the true normals are expected.
    albedo : ndarray
        The brightness under light along the normal, in the unit of the photographs.
    color : ndarray
        ``(H, W, 3)``: the same in linear red, green and blue, whose mean is `albedo`; without highlights.
    residuals : ndarray
        Standard deviation of a pixel's residuals, relative to its albedo.
    depth : ndarray
        Heights towards the camera, in pixels or the unit of ``pixel_size``.
    mask : ndarray
        bool: True where there is a normal.
    light_residuals : ndarray
        ``(N,)``: root mean square residual of lit samples under each light, relative to the albedo.

    Examples
    --------
    >>> found = tt.photometric(photographs, lights=directions)
    >>> found
    <taotie.PhotometricNormals 48x48: 2,304 normals, mean sigma ...°>
    >>> np.allclose(found.normals, truth, atol=0.01)
    True
    """

    normals: npt.NDArray[np.float32]
    sigma: npt.NDArray[np.float32]
    albedo: npt.NDArray[np.float32]
    color: npt.NDArray[np.float32]
    residuals: npt.NDArray[np.float32]
    depth: npt.NDArray[np.float32]
    mask: npt.NDArray[np.bool_]
    light_residuals: npt.NDArray[np.float64]
    _native: _taotie.Normals = field(compare=False)

    @property
    def mean_sigma_deg(self) -> float:
        """The mean of `sigma` over all normals, degrees."""
        return float(np.mean(self.sigma[self.mask], dtype=np.float64))

    def save(self, folder: PathLike) -> None:
        """Write the files of ``taotie photometric``, except for its reports, into a folder, which is created.

        Examples
        --------
        >>> tt.photometric(photographs, lights=directions).save("relief")
        >>> tt.load("relief/relief.glb").triangles
        4418
        """
        warn(self._native.save(path("folder", folder)))

    def __repr__(self) -> str:
        height, width = self.mask.shape
        count = int(self.mask.sum())
        return f"<taotie.PhotometricNormals {width}x{height}: {count:,} normals, mean sigma {self.mean_sigma_deg:.1f}°>"


def photometric(
    images: PathLike | Sequence[Any],
    *,
    lights: npt.ArrayLike | None = None,
    mask: Any = None,
    encoding: Literal["auto", "linear", "srgb"] = "auto",
    pixel_size: float | None = None,
    unit: Literal["mm", "cm", "m", "in"] | None = None,
    progress: Progress = None,
    threads: int | None = None,
) -> PhotometricNormals:
    """Estimate normals from photographs from one position under changing light, each with its uncertainty.

    Parameters
    ----------
    images : path or sequence of array_like
        A folder of photographs or an ``.lp`` file, as for ``taotie photometric``; a relightable image (``.ptm``,
        ``.rti``); or at least four images of equal size: arrays ``(height, width)`` or ``(height, width, 3)`` of uint8
        (sRGB), uint16 or float (both linear), PIL images, or paths.
    lights : array_like, optional
        ``(N, 3)``: for each image a vector of any length towards its distant light; x to the right, y up, z towards the
        camera. Required for images, refused for a path, which states them.
    mask : path or array_like, optional
        White, True or above one half where normals are estimated; for photographs by path, the path of an image.
    encoding : {"auto", "linear", "srgb"}
        The meaning of the numbers in the photographs.
    pixel_size : float, optional
        The side of a pixel on the object: the unit of depth, and of lamp positions in an ``.lp`` file.
    unit : {"mm", "cm", "m", "in"}, optional
        The unit of ``pixel_size``; models that are saved are then in metres.

    Returns
    -------
    PhotometricNormals

    Raises
    ------
    InvalidValue
        If the lights do not determine normals, sizes differ, or an argument is invalid.
    FileError
        If a file cannot be read.

    Examples
    --------
    >>> found = tt.photometric(photographs, lights=directions)
    >>> found.normals.shape, bool(found.mask.all())
    ((48, 48, 3), True)
    """
    choose("encoding", encoding, ("auto", "linear", "srgb"))
    if pixel_size is not None:
        pixel_size = number("pixel_size", pixel_size)
        if pixel_size <= 0:
            raise invalid(f"pixel_size {pixel_size:g}", "expected a number above 0")
    if unit is not None:
        choose("unit", unit, ("mm", "cm", "m", "in"))
        if pixel_size is None:
            raise invalid(f"unit {unit!r}", "expected pixel_size, too")
    taken = _photographs(images, lights)
    taken["mask"] = None if mask is None else _mask(mask)
    with running(progress, threads) as run:
        native = _taotie.photometric(taken, {"encoding": encoding, "pixel_size": pixel_size, "unit": unit}, run)
    warn(native.warnings())
    arrays = native.arrays()
    return PhotometricNormals(
        **arrays, mask=~np.isnan(arrays["sigma"]), light_residuals=np.array(native.lights()), _native=native
    )


def _photographs(images: PathLike | Sequence[Any], lights: npt.ArrayLike | None) -> dict[str, Any]:
    """Return the photographs for the native module."""
    if isinstance(images, (str, os.PathLike)):
        if lights is not None:
            raise invalid("lights", "the folder or file of photographs states them; leave them out, or pass images")
        return {"path": path("images", images), "images": [], "lights": None}
    try:
        listed = list(images)
    except TypeError:
        raise invalid_type("images", images, "a path, or a sequence of images") from None
    if not listed:
        raise invalid("images", "an empty sequence; expected at least four images")
    if lights is None:
        raise invalid("lights", "missing; expected a vector towards the light for each image, of shape (N, 3)")
    taken = [image(f"images[{i}]", each) for i, each in enumerate(listed)]
    return {"path": None, "images": taken, "lights": _lights(lights, len(taken))}


def _lights(lights: npt.ArrayLike, count: int) -> npt.NDArray[np.float64]:
    """Return the vectors towards the lights."""
    try:
        vectors = np.ascontiguousarray(lights, dtype=np.float64)
    except (TypeError, ValueError):
        raise invalid_type("lights", lights, "an array of numbers, of shape (N, 3)") from None
    if vectors.shape != (count, 3):
        raise invalid("lights", f"an array of shape {vectors.shape}; expected ({count}, 3), a vector for each image")
    if not np.isfinite(vectors).all():
        raise invalid("lights", "numbers that are not finite")
    return vectors


def _mask(mask: Any) -> Any:
    """Return the mask for the native module."""
    if isinstance(mask, (str, os.PathLike)):
        return path("mask", mask)
    array = np.asarray(mask)
    is_binary = array.dtype == bool or (array.dtype.kind in "ui" and array.max(initial=0) == 1)
    return image("mask", array.astype(np.uint8) * 255 if is_binary else mask)
