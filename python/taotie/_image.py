"""Images that show themselves."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _taotie


class Image(np.ndarray[Any, np.dtype[np.uint8]]):
    """An image: an array ``(height, width, 4)`` of uint8, sRGB with straight alpha.

    Notebooks show it; `save` writes it as PNG. Everything else is that of NumPy.
    """

    def _repr_png_(self) -> bytes | None:
        if self.ndim != 3 or self.shape[2] != 4 or self.dtype != np.uint8:
            return None
        return _taotie.write_png(np.ascontiguousarray(self.view(np.ndarray)))

    def save(self, path: str) -> None:
        """Write a PNG.

        Parameters
        ----------
        path : str
            The file, ending with ``.png``.
        """
        data = self._repr_png_()
        if data is None:
            raise ValueError(f"an image of shape {self.shape}, dtype {self.dtype}; wanted is (height, width, 4), uint8")
        with open(path, "wb") as file:
            file.write(data)


def image(codes: npt.NDArray[np.uint8]) -> Image:
    """Return an array as an image, without a copy."""
    return codes.view(Image)
