"""Proofs: how far an asset is from its scan."""

from __future__ import annotations

import base64
import html
import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias, TypedDict

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import path as a_path
from ._error import NotMet, integer, warn
from ._model import scan_models
from ._options import check, takes
from ._run import Progress, Running, log, running

if TYPE_CHECKING:
    from typing_extensions import Unpack

Floats: TypeAlias = npt.NDArray[np.float32]

#: The stages of a proof with their shares of its time.
STAGES = {
    "read the model": 0.05,
    "read the scan": 0.1,
    "join the scan": 0.05,
    "sort the scan": 0.1,
    "write": 0.05,
    "read back": 0.05,
    "measure maps": 0.05,
    "measure normals": 0.2,
    "map errors": 0.1,
    "compare views": 0.2,
    "measure levels": 0.05,
    "measure more points": 0.05,
}


class VerifyOptions(TypedDict, total=False):
    """Options of `verify`, `Asset.verify` and `Written.verify`.

    Parameters
    ----------
    points : int, default 20000
        Pixels of the overview and points on each surface to compare, at least 10.
    map : int, default 1024
        The most texels along a side of ``error_map``.
    view : int, default 384
        Pixels along a side of the images from all sides, at least 11.
    threads : int, optional
        1 to 1024; defaults to all of the machine's. Results do not depend on it.
    progress : bool or callable, optional
        True for a progress bar; a callable receives stage and fraction, and stops the work by returning False.

    Examples
    --------
    >>> quick: tt.VerifyOptions = {"points": 1000, "view": 64}
    >>> proof = asset.verify(scan, **quick)
    """

    points: int
    map: int
    view: int
    threads: int | None
    progress: Progress


_DEFAULTS = {"points": 20_000, "map": 1024, "view": 384}


@dataclass(frozen=True)
class Met:
    """A requirement and its outcome.

    Attributes
    ----------
    figure : str
        As on the command line, such as ``mean-angle``.
    most : float
        The limit: degrees, fractions of 1, pixels or bytes; metres if `is_length`.
    is_length : bool
        True if limit, value and interval are lengths in metres.
    level : int or None
        The level of detail, 0 the finest; None for a figure of the whole asset.
    value : float or None
        The measured value; None if it could not be measured.
    interval : tuple of float, or None
        The interval that contains the value, with a confidence of 99 % if it is estimated from samples.
    met : bool
        True if the whole interval is within the limit.
    text : str
        All of the above as text.
    within : float or None
        For figures that are the share of the surface within a limit, such as ``within-5deg``: that limit, in degrees,
        ΔE, or fractions of the diagonal.

    Examples
    --------
    >>> for met in proof.require("missed=5%", mean_angle=20):
    ...     print(met.figure, met.met)
    missed True
    mean-angle True
    """

    figure: str
    most: float
    is_length: bool
    level: int | None
    value: float | None
    interval: tuple[float, float] | None
    met: bool
    text: str
    within: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Proof:
    """How far an asset, as written and read back, is from its scan. Notebooks show its figures and its error map.

    Attributes
    ----------
    figures : dict
        All figures, as under ``proof`` in the command's report.
    error_map : ndarray or None
        ``(H, W)`` float32: degrees between the normals of asset and scan at each texel, on the surface; NaN between UV
        islands. None if the asset has no UVs.
    color_map : ndarray or None
        ``(H, W)`` float32: CIEDE2000 between the base colours; None if the scan does not specify its material.
    detail_map : ndarray or None
        ``(H, W)`` float32: width of the asset's texels relative to the scan's finest detail; None without textures.
    options : dict
        The options that it was made with: points, map, view.
    maps : list of dict
        The maps, as under ``maps`` in the command's report: file, range, unit, and the ``error`` of those that no figure
        covers, such as ``ao`` and ``height``. Empty for an asset that was not baked here.

    Examples
    --------
    >>> proof = asset.verify(scan)
    >>> proof.mean_deg < proof.p95_deg
    True
    >>> proof.error_map.shape
    (64, 64)
    """

    figures: Mapping[str, Any]
    error_map: Floats | None
    color_map: Floats | None = None
    detail_map: Floats | None = None
    options: Mapping[str, int] = field(default_factory=dict)
    maps: Sequence[Mapping[str, Any]] = ()

    @property
    def mean_deg(self) -> float:
        """The mean angle between the normals as seen, at the same pixel, in degrees; NaN if no pixel was compared."""
        return self._angle("mean")

    @property
    def p95_deg(self) -> float:
        """The 95th percentile of these angles, in degrees."""
        return self._angle("p95")

    @property
    def max_deg(self) -> float:
        """The largest of these angles at any sample, in degrees."""
        return self._angle("max")

    @property
    def missed(self) -> float:
        """The fraction of the visible surface where the other shows nothing, the worse of scan and asset, [0, 1]."""
        coverage = self._finest["coverage"]
        return float(max(coverage["missed_of_scan"], coverage["missed_of_asset"]))

    @property
    def hausdorff(self) -> float:
        """The upper bound of the largest distance between the visible surfaces, as a fraction of the diagonal."""
        return float(self._finest["hausdorff_of_diagonal"]["upper"])

    @property
    def _finest(self) -> Mapping[str, Any]:
        finest: Mapping[str, Any] = self.figures["levels"][0]
        return finest

    def _angle(self, name: str) -> float:
        angles = self._finest["overview"]["angles"]
        return float("nan") if angles is None else float(angles["summary"][name])

    def require(
        self,
        *requirements: str,
        mean_angle: float | str | None = None,
        p95_angle: float | str | None = None,
        max_angle: float | str | None = None,
        mean_color: float | str | None = None,
        p95_color: float | str | None = None,
        missed: float | str | None = None,
        hausdorff: float | str | None = None,
        bytes: float | str | None = None,
    ) -> list[Met]:
        """Require that figures do not exceed limits, as ``taotie bake --require`` does.

        Parameters
        ----------
        *requirements : str
            As on the command line: ``"standard"``, ``"mean-angle=2"``, ``"mean-angle@1=5"``, ``"missed=0.1%"``,
            ``"bytes=3MB"``, ``"texel=50um"``.
        mean_angle, p95_angle, max_angle : float or str, optional
            Normal error, degrees.
        mean_color, p95_color : float or str, optional
            Colour error, CIEDE2000.
        missed : float or str, optional
            Visible surface that the other model lacks, per cent.
        hausdorff : float or str, optional
            Upper bound of the largest distance, per cent of the diagonal, or a length such as ``"0.2mm"`` if the unit of
            the scan is known.
        bytes : float or str, optional
            Of the asset with the files that it references.

        Returns
        -------
        list of Met

        Raises
        ------
        NotMet
            If a figure exceeds its limit, or could not be measured.

        Examples
        --------
        >>> met = proof.require("missed=5%", mean_angle=20)
        >>> proof.require(mean_angle=0.001)
        Traceback (most recent call last):
        taotie.NotMet: ...
        """
        named = {
            "mean-angle": mean_angle,
            "p95-angle": p95_angle,
            "max-angle": max_angle,
            "mean-color": mean_color,
            "p95-color": p95_color,
            "missed": missed,
            "hausdorff": hausdorff,
            "bytes": bytes,
        }
        wanted = [*requirements, *(f"{name}={most}" for name, most in named.items() if most is not None)]
        held = [_met(met, text) for met, text in _taotie.require(dict(self.figures), wanted)]
        failed = [met.text for met in held if not met.met]
        if failed:
            raise NotMet("; ".join(failed), "invalid", None, "the proof", "; ".join(failed))
        return held

    def to_dict(self) -> dict[str, Any]:
        """Return the figures as plain data.

        Examples
        --------
        >>> text = json.dumps(proof.to_dict())
        """
        return dict(self.figures)

    def __repr__(self) -> str:
        angles = f"mean {self.mean_deg:.3g}°, 95th percentile {self.p95_deg:.3g}°"
        return f"<taotie.Proof {angles}, {self.missed:.3%} missed>"

    def _repr_html_(self) -> str:
        rows = {
            "mean normal error as seen": f"{self.mean_deg:.3g}°",
            "95th percentile": f"{self.p95_deg:.3g}°",
            "largest": f"{self.max_deg:.3g}°",
            "visible surface missed": f"{self.missed:.3%}",
            "largest distance, of the diagonal": f"at most {self.hausdorff:.3%}",
        }
        if (size := self.figures.get("bytes_out")) is not None:
            rows["bytes"] = f"{size:,}"
        cells = "".join(f"<tr><th>{name}</th><td>{html.escape(text)}</td></tr>" for name, text in rows.items())
        return f"<table>{cells}</table>{self._error_picture()}"

    def _error_picture(self) -> str:
        if self.error_map is None or np.isnan(self.error_map).all():
            return ""
        most = max(float(np.nanpercentile(self.error_map, 99)), 1e-3)
        data = base64.b64encode(_picture(self.error_map, most)).decode()
        caption = f"Error of the normals on the surface: dark violet is 0°, yellow {most:.3g}° and more"
        picture = f'<img alt="{caption}" src="data:image/png;base64,{data}">'
        return f"<figure>{picture}<figcaption>{caption}</figcaption></figure>"


def _met(met: str, text: str) -> Met:
    """Return a requirement's outcome from JSON."""
    facts = json.loads(met)
    interval = facts.pop("interval")
    return Met(text=text, interval=None if interval is None else tuple(interval), **facts)


@takes(VerifyOptions)
def verify(asset: str | os.PathLike[str], scan: Any, **options: Unpack[VerifyOptions]) -> Proof:
    """Compare an asset's file, made by any program, with the scan that it should look like.

    Parameters
    ----------
    asset : path
        The asset (.gltf, .glb, .obj, .ply, .stl, .fbx), at the position of the scan: glTF in metres if the scan's unit is
        known, other formats in that unit.
    scan : path, Model, or a mesh of another package; or a list of them
        The scan that it should look like. It is read with the options of the bake, if the asset records them, unless
        it was loaded with other options.
    **options
        See `VerifyOptions`.

    Returns
    -------
    Proof

    Examples
    --------
    >>> path = asset.save("packed.glb").path
    >>> proof = tt.verify(path, "scan.ply", points=1000, view=64)
    >>> proof.require(mean_angle=20)[0].met
    True
    """
    check("verify", options, VerifyOptions)
    high, file = scan_models(scan), a_path("asset", asset)
    return measured(lambda chosen, run: _taotie.verify(file, high, chosen, run), options)


def measured(measure: Callable[[dict[str, int], Running], dict[str, Any]], options: Mapping[str, Any]) -> Proof:
    """Run a measurement by the native module; return its proof, and issue its warnings."""
    chosen = {name: integer(name, options.get(name, default)) for name, default in _DEFAULTS.items()}
    with running(options.get("progress"), options.get("threads"), STAGES) as run:
        found = measure(chosen, run)
    warn(found["warnings"])
    fields = {name: found[name] for name in ("error_map", "color_map", "detail_map")}
    proof = Proof(json.loads(found["figures"]), **fields, options=chosen, maps=json.loads(found["maps"]))
    log.info("proved %r", proof)
    return proof


#: The most pixels along a side of a map in a notebook.
_SHOWN = 320


def _picture(values: Floats, most: float) -> bytes:
    """Return the PNG of a map in the colours of report pages, transparent where it is NaN."""
    step = -(-max(values.shape) // _SHOWN)
    return _taotie.write_heat(np.ascontiguousarray(values[::step, ::step], dtype=np.float32), most)
