"""Images that notebooks can display."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _taotie


class Image(np.ndarray[Any, np.dtype[np.uint8]]):
    """An image: an array ``(height, width, 4)`` of uint8, sRGB with straight alpha.

    Notebooks display it; `save` writes it as PNG. In every other respect it is a NumPy array.
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
            raise ValueError(f"an image of shape {self.shape}, dtype {self.dtype}; expected (height, width, 4), uint8")
        with open(path, "wb") as file:
            file.write(data)


def image(codes: npt.NDArray[np.uint8]) -> Image:
    """View an array as an image, without copying."""
    return codes.view(Image)
