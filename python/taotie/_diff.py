"""The difference between two images or normal maps."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import image
from ._error import warn
from ._material import Color, rgb
from ._run import Progress, running


@dataclass(frozen=True, eq=False, repr=False)
class Difference:
    """The difference between two images, or between the normals of two maps.

    Attributes
    ----------
    figures : dict
        As printed by ``taotie diff --json`` under ``metrics``: ``angle`` for normal maps; ``flip``, ``ssim``,
        ``psnr`` and ``rmse`` for images. None if not measured.
    map : ndarray
        ``(H, W)`` float32: the difference at each pixel; NaN where there is none.
    title, unit : str
        The meaning and the unit of the map.

    Examples
    --------
    >>> found = tt.diff(np.zeros((32, 32, 3), np.uint8), np.full((32, 32, 3), 51, np.uint8))
    >>> round(found.rmse, 6), found.map.shape
    (0.2, (32, 32))
    """

    figures: dict[str, Any]
    map: npt.NDArray[np.float32]
    title: str
    unit: str

    @property
    def mean_deg(self) -> float | None:
        """The mean angle between normals, degrees; None for images."""
        angle = self.figures["angle"]
        return None if angle is None else float(angle["mean"])

    @property
    def flip(self) -> float | None:
        """The mean FLIP error, [0, 1]; None for normal maps."""
        flip = self.figures["flip"]
        return None if flip is None else float(flip["mean"])

    @property
    def ssim(self) -> float | None:
        """Structural similarity, at most 1."""
        value: float | None = self.figures["ssim"]
        return value

    @property
    def rmse(self) -> float | None:
        """Root mean square error of encoded values, [0, 1]."""
        value: float | None = self.figures["rmse"]
        return value

    @property
    def psnr(self) -> float | None:
        """Peak signal-to-noise ratio, in decibels; infinite for equal images."""
        value: float | None = self.figures["psnr"]
        return float("inf") if value is None and self.rmse == 0.0 else value

    def to_dict(self) -> dict[str, Any]:
        """Return the figures as plain data.

        Examples
        --------
        >>> a, b = tt.render(scan, size=32), tt.render(scan, size=32, material="brass")
        >>> sorted(tt.diff(a, b).to_dict())
        ['angle', 'flip', 'psnr', 'rmse', 'ssim']
        """
        return dict(self.figures)

    def __repr__(self) -> str:
        height, width = self.map.shape
        names = [name for name, value in self.figures.items() if value is not None]
        return f"<taotie.Difference {width}x{height}: {', '.join(names)}>"


def diff(
    a: Any,
    b: Any,
    *,
    metric: Literal["angle", "flip", "ssim", "psnr", "rmse"] | None = None,
    encoding: Literal["auto", "color", "unit", "signed"] = "auto",
    background: Color = "black",
    pixels_per_degree: float = 67.0,
    progress: Progress = None,
) -> Difference:
    """Measure the difference between two images, or between the normals of two maps.

    Parameters
    ----------
    a, b : path or array_like
        Images of equal size: files, arrays ``(height, width)`` or ``(height, width, 1 to 4)`` of uint8, uint16 (both
        sRGB) or float32, or PIL images.
    metric : str, optional
        The figure to compute; defaults to all that apply.
    encoding : {"auto", "color", "unit", "signed"}
        The meaning of the numbers: colours, or normals in [0, 1] or in [-1, 1]. Auto guesses from the pixels.
    background : color
        The background of transparent images.
    pixels_per_degree : float
        Of the observer, for FLIP.

    Returns
    -------
    Difference

    Examples
    --------
    >>> a, b = tt.render(scan, size=32), tt.render(scan, size=32, material="brass")
    >>> 0 < tt.diff(a, b).flip < 1
    True
    """
    request = {
        "metric": metric,
        "encoding": {"normals": encoding} if encoding in ("unit", "signed") else encoding,
        "background": rgb(background),
        "pixels_per_degree": float(pixels_per_degree),
    }
    with running(progress, None) as run:
        found = _taotie.diff({"a": image("a", a), "b": image("b", b)}, request, run)
    warn(found["warnings"])
    return Difference(json.loads(found["figures"]), found["map"], found["title"], found["unit"])
