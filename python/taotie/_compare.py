"""One model rendered by several surface methods, with their errors."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._error import invalid, warn
from ._model import Model
from ._model import model as a_model
from ._options import CompareOptions, Shading, Surface, background, camera_and_light, check, chosen, environment
from ._options import settings, takes
from ._run import running

if TYPE_CHECKING:
    from typing_extensions import Unpack

Floats = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False, repr=False)
class View:
    """A surface as it appears in the image.

    Attributes
    ----------
    normals : ndarray
        ``(H, W, 3)`` float32, world space: the mean of each pixel; NaN where nothing is seen.
    images : dict
        ``(H, W, 3)`` float32 in [0, 1], sRGB, under each reflectance model.
    angles : ndarray or None
        ``(H, W)`` float32: degrees between its normals and the true ones; None for the reference itself.
    inner_angles : ndarray or None
        The same away from silhouettes.

    Examples
    --------
    >>> found = tt.compare(asset, scan, methods=["smooth"], size=64)
    >>> found.views["smooth"]
    <taotie.View 64x64: ggx>
    """

    normals: Floats
    images: dict[str, Floats]
    angles: Floats | None = None
    inner_angles: Floats | None = None

    def __repr__(self) -> str:
        height, width = self.normals.shape[:2]
        return f"<taotie.View {width}x{height}: {', '.join(self.images)}>"


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """The results of a comparison.

    Attributes
    ----------
    report : dict
        All figures, as reported by the library.
    views : dict of str to View
        By method, such as ``smooth`` or ``bump:5``, and ``reference``.

    Examples
    --------
    >>> tt.compare(asset, scan, methods=["smooth", "tangent-normal"], size=64)
    <taotie.Comparison smooth, tangent-normal, reference>
    """

    report: dict[str, Any]
    views: dict[str, View]

    def mean_deg(self, method: str) -> float | None:
        """Return the mean angle between a method's normals and the truth, away from silhouettes, in degrees.

        Examples
        --------
        >>> found = tt.compare(asset, scan, methods=["smooth", "tangent-normal"], size=64)
        >>> found.mean_deg("tangent-normal") < found.mean_deg("smooth")
        True
        """
        for found in self.report["methods"]:
            if found["method"] == method:
                error = found.get("error")
                inner = None if error is None else error.get("inner")
                return None if inner is None else float(inner["mean"])
        raise invalid(f"method {method!r}", f"unknown; expected one of: {', '.join(self.views)}")

    def to_dict(self) -> dict[str, Any]:
        """Return the report as plain data.

        Examples
        --------
        >>> text = json.dumps(tt.compare(asset, scan, methods=["smooth"], size=64).to_dict())
        """
        return dict(self.report)

    def __repr__(self) -> str:
        return f"<taotie.Comparison {', '.join(self.views)}>"


@takes(CompareOptions)
def compare(
    low: Any,
    high: Any = None,
    *,
    methods: Sequence[Union[Surface, str]] = (),
    shading: Sequence[Shading] | Shading = ("ggx",),
    baseline: Shading | None = None,
    points: int | Sequence[tuple[int, int]] = 10,
    match: Literal["normal", "uv", "pixel"] = "normal",
    **options: Unpack[CompareOptions],
) -> Comparison:
    """Render a model by several surface methods and measure their error. Names and defaults are those of the command.

    Parameters
    ----------
    low : path, Model, Asset, or a mesh of another package
        The model.
    high : the same, optional
        The high-poly reference: a model at the same position with its relief as geometry, such as the scan. Its
        material is its own if it has one, otherwise that of the model.
    methods : sequence of str
        facet, smooth, bump, bump-printed, object-normal, tangent-normal; ``bump:5`` and ``bump-printed:5`` take a factor.
    shading : str or sequence of str
        Reflectance models.
    baseline : str, optional
        Also measure the effect of the reflectance model, compared with this one.
    points : int or pixels
        Sample points for which normals are listed.
    match : {"normal", "uv", "pixel"}
        Which point of the reference corresponds to a point of the model.
    **options
        See `RenderOptions`.

    Returns
    -------
    Comparison

    Examples
    --------
    >>> found = tt.compare(asset, scan, methods=["facet", "smooth"], size=64)
    >>> sorted(found.views)
    ['facet', 'reference', 'smooth']
    """
    check("compare", options, CompareOptions)
    model = a_model(low, options.get("material"), options.get("bump_scale"))
    reference = None if high is None else a_model(high)
    compared: dict[str, Any] = {
        "shadings": [shading] if isinstance(shading, str) else list(shading),
        "baseline": baseline,
        "points": {"spread": points} if isinstance(points, int) else {"pixels": [list(pixel) for pixel in points]},
        "matching": match,
        "settings": {"width": 640, "height": 640} | settings(options),
        "development": {"exposure_stops": float(options.get("exposure", 0.0)), **chosen(options, ["tone"])},
    }
    if methods:
        compared["methods"] = [_method(name) for name in methods]
    request = {
        "options": {"options": compared, "background": background(options), **camera_and_light(options)},
        "environment": environment(options),
    }
    names = [_name(model, "model"), _name(reference, "reference")]
    models = {"low": model._native, "high": reference._native if reference else None, "names": names}
    with running(options.get("progress"), options.get("threads")) as run:
        found = _taotie.compare(models, request, run)
    warn(found["warnings"])
    views = {name: View(**view) for name, view in found["views"].items()}
    return Comparison(json.loads(found["report"]), views)


def _name(model: Model | None, otherwise: str) -> str:
    """Return the name of a model's file without its folders, which are private."""
    return Path(model.path).name if model and model.path else otherwise


def _method(name: str) -> dict[str, Any]:
    surface, _, factor = name.partition(":")
    return {"surface": surface, "factor": float(factor) if factor else None}
