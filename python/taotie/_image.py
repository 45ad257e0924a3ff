"""Rendered images: arrays that notebooks can display, and output variables by name."""

from __future__ import annotations

import os
from typing import Any, SupportsIndex

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import PathLike, path as a_path
from ._camera import Camera
from ._error import invalid

#: The formats that `Image.save` writes.
_FORMATS = (".png", ".jpg", ".jpeg", ".webp")


class Image(np.ndarray[Any, np.dtype[np.uint8]]):
    """An image: an array ``(height, width, 4)`` of uint8, sRGB with straight alpha.

    Notebooks display it, and `save` writes it. Otherwise it is a NumPy array: reductions of it are
    scalars, and other packages take it without a copy, as by ``torch.from_dlpack(image)``.

    Attributes
    ----------
    camera : Camera or None
        The camera of the image, with ``pose``, ``K``, ``projection`` and planes; it can be passed to `render` again.
        None for parts of images and for images that were computed.

    Examples
    --------
    >>> image = tt.render(scan, size=(64, 48))
    >>> image.shape, float(image.max()), image.camera.pose.shape
    ((48, 64, 4), 255.0, (4, 4))
    """

    camera: Camera | None = None

    def __array_finalize__(self, of: Any) -> None:
        # Parts, and pixels in another order, are not what the camera sees.
        is_whole = isinstance(of, np.ndarray) and (of.shape, of.strides) == (self.shape, self.strides)
        if is_whole and self.dtype == np.uint8:
            self.camera = getattr(of, "camera", None)

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        # What is computed is no longer this image, unless in place: a scalar, or a plain array.
        if array is self:
            return self
        return array[()] if array.ndim == 0 else np.asarray(array)

    def __reduce__(self) -> Any:
        reduced: Any = super().__reduce__()
        make, arguments, state = reduced
        return make, arguments, (state, self.camera)

    def __setstate__(self, state: Any) -> None:
        own, self.camera = state
        super().__setstate__(own)

    def _repr_png_(self) -> bytes | None:
        if not self._is_whole():
            return None
        return _taotie.write_png(np.ascontiguousarray(self.view(np.ndarray)))

    def _is_whole(self) -> bool:
        return self.ndim == 3 and self.shape[2] == 4 and self.dtype == np.uint8 and self.size > 0

    def save(self, path: PathLike, *, quality: int = 90) -> None:
        """Write the image as PNG, JPEG or lossless WebP.

        Parameters
        ----------
        path : str or path
            The file, ending with ``.png``, ``.jpg``, ``.jpeg`` or ``.webp``.
        quality : int
            Of JPEG, 1 to 100.

        Raises
        ------
        Error
            If the name ends otherwise, or if a JPEG, which has no alpha, would lose transparent pixels.

        Examples
        --------
        >>> tt.render(scan, size=32).save("image.jpg", quality=85)
        """
        name = a_path("path", path)
        suffix = os.path.splitext(name)[1].lower()
        if suffix not in _FORMATS:
            raise invalid(f"path {name!r}", f"unknown format; expected one of: {', '.join(_FORMATS)}")
        if not self._is_whole():
            raise invalid("image", f"an array of shape {self.shape}, dtype {self.dtype}; expected (height, width, 4), uint8")
        if not 1 <= quality <= 100:
            raise invalid(f"quality {quality}", "expected 1 to 100")
        codes = np.ascontiguousarray(self.view(np.ndarray))
        if suffix == ".png":
            data = _taotie.write_png(codes)
        elif suffix == ".webp":
            data = _taotie.write_photo(codes, None)
        elif (codes[:, :, 3] == 255).all():
            data = _taotie.write_photo(codes, int(quality))
        else:
            raise invalid(
                f"path {name!r}", "a JPEG has no transparent pixels; use .png or .webp, or render with a background color"
            )
        with open(name, "wb") as file:
            file.write(data)


class Buffers(dict[str, npt.NDArray[Any]]):
    """Linear light and output variables by name, as returned by `render` with ``linear=True``.

    Attributes
    ----------
    camera : Camera
        The camera of the image, with ``pose``, ``K``, ``projection`` and planes; it can be passed to `render` again.

    Examples
    --------
    >>> found = tt.render(scan, linear=True, aov=["depth", "triangle"], size=(64, 48))
    >>> found
    <taotie.Buffers 64x48: color, depth, triangle>
    >>> found["depth"].dtype, found["triangle"].dtype
    (dtype('float32'), dtype('uint32'))
    """

    camera: Camera

    def __init__(self, arrays: dict[str, npt.NDArray[Any]], camera: Camera) -> None:
        super().__init__(arrays)
        self.camera = camera

    def __reduce_ex__(self, protocol: SupportsIndex) -> Any:
        return Buffers, (dict(self), self.camera)

    def __repr__(self) -> str:
        height, width = next(iter(self.values())).shape[:2]
        return f"<taotie.Buffers {width}x{height}: {', '.join(self)}>"


def image(codes: npt.NDArray[np.uint8], camera: Camera) -> Image:
    """View an array as an image, without copying."""
    seen = codes.view(Image)
    seen.camera = camera
    return seen
