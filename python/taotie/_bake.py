"""From a scan to an asset and its proof."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import Array, PathLike
from ._error import NotMet, invalid, warn
from ._model import Model, _from_glb, scan_options
from ._model import model as a_model
from ._options import Codecs, Map, Unit
from ._run import Progress, running

Floats: TypeAlias = npt.NDArray[np.float32]


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


@dataclass(frozen=True, eq=False)
class Proof:
    """How far an asset, as written and read back, is from its scan.

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
    """

    figures: Mapping[str, Any]
    error_map: Floats | None = field(repr=False)
    color_map: Floats | None = field(default=None, repr=False)
    detail_map: Floats | None = field(default=None, repr=False)
    options: Mapping[str, int] = field(default_factory=dict)

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
        """The largest of these angles, in degrees: a maximum over samples."""
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
        """Return the figures as plain data."""
        return dict(self.figures)


def _met(met: str, text: str) -> Met:
    """Return a requirement's outcome from JSON."""
    facts = json.loads(met)
    interval = facts.pop("interval")
    return Met(text=text, interval=None if interval is None else tuple(interval), **facts)


def _proof(found: Mapping[str, Any], options: Mapping[str, int]) -> Proof:
    """Create a proof from the results of the native module, and issue its warnings."""
    warn(found["warnings"])
    maps = {name: found[name] for name in ("error_map", "color_map", "detail_map")}
    return Proof(json.loads(found["figures"]), **maps, options=options)


def verify(
    asset: str | os.PathLike[str],
    scan: Any,
    *,
    points: int = 20_000,
    map: int = 1024,
    view: int = 384,
    threads: int | None = None,
    progress: Progress = None,
) -> Proof:
    """Compare an asset's file, made by any program, with the scan that it should look like.

    Parameters
    ----------
    asset : path
        The asset (.gltf, .glb, .obj, .ply, .stl), at the position of the scan: glTF in metres if the scan's unit is
        known, other formats in that unit.
    scan : path, Model, or a mesh of another package
        The scan that it should look like. It is read with the options of the bake, if the asset records them, unless
        it was loaded with other options.
    points : int
        Pixels of the overview and points on each surface to compare, at least 10.
    map : int
        The most texels along a side of ``error_map``.
    view : int
        Pixels along a side of the images from all sides, at least 11.

    Returns
    -------
    Proof

    Examples
    --------
    >>> proof = tt.verify("packed.glb", "scan.ply")  # doctest: +SKIP
    >>> proof.require("standard")  # doctest: +SKIP
    """
    options = {"points": points, "map": map, "view": view}
    high = a_model(scan)
    with running(progress, threads) as run:
        found = _taotie.verify(os.fspath(asset), high._native, options, run)
    return _proof(found, options)


class Written:
    """An asset written to files."""

    def __init__(self, native: _taotie.Written) -> None:
        self._native = native

    @property
    def files(self) -> list[str]:
        """The files; the model or the first map comes first."""
        return [os.fspath(path) for path in self._native.files()]

    @property
    def path(self) -> str:
        """The model's file; for standalone maps, the first one's."""
        return self.files[0]

    def verify(
        self,
        scan: Any,
        *,
        points: int = 20_000,
        map: int = 1024,
        view: int = 384,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Proof:
        """Read the files back and measure how far they are from the scan.

        Parameters
        ----------
        scan : path, Model, or a mesh of another package
            The scan that was baked.
        points : int
            Pixels of the overview and points on each surface to compare, at least 10.
        map : int
            The most texels along a side of ``error_map``.
        view : int
            Pixels along a side of the images from all sides, at least 11.

        Returns
        -------
        Proof
        """
        options = {"points": points, "map": map, "view": view}
        high = a_model(scan)
        with running(progress, threads) as run:
            found = self._native.verify(high._native, options, run)
        return _proof(found, options)

    def report(self, proof: Proof | None = None, require: Sequence[str] = ()) -> dict[str, Any]:
        """Return the report that ``taotie bake`` writes next to the asset, as plain data."""
        proved = None if proof is None else {"figures": dict(proof.figures), "options": dict(proof.options)}
        report: dict[str, Any] = json.loads(self._native.report(proved, list(require)))
        return report

    def __repr__(self) -> str:
        return f"<taotie.Written {self.path!r}>"


class Asset:
    """A low-poly mesh with baked maps. Created by `bake`; immutable."""

    def __init__(self, native: _taotie.Asset) -> None:
        self._native = native
        self._facts: dict[str, Any] = json.loads(native.facts())

    @property
    def triangles(self) -> list[int]:
        """Triangles of each level of detail, the finest first."""
        return list(self._facts["triangles"])

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in texels."""
        width, height = self._facts["size"]
        return width, height

    @property
    def counts(self) -> dict[str, int]:
        """The outcome of the samples: samples, missed, lost, shared, texels, missed_texels."""
        return dict(self._facts["counts"])

    @property
    def warnings(self) -> tuple[tuple[str, int], ...]:
        """Problems of scan, mesh and maps, and omissions, with their counts."""
        return tuple(self._native.warnings())

    def levels(self) -> list[dict[str, Array]]:
        """Return the arrays of each level of detail, as `Model.arrays` does."""
        return self._native.levels()

    def maps(self, material: str = "") -> dict[str, Array]:
        """Return the maps as stored, ``(height, width)`` or ``(height, width, channels)``.

        Parameters
        ----------
        material : str
            The material, if the asset has several.

        Returns
        -------
        dict
            ``normal``; ``albedo`` in sRGB; ``orm``, which is occlusion, roughness and metallic; ``emission``; and by
            their own names those stored next to the model.
        """
        sets = self._native.maps()
        if material not in sets:
            raise invalid(f"material {material!r}", f"unknown; expected one of: {', '.join(sets)}")
        return sets[material]

    def save(
        self,
        path: PathLike,
        *,
        images: str = "png",
        meshopt: bool = False,
        codecs: Codecs = "portable",
        provenance: PathLike | None = None,
        green: Literal["up", "down"] = "up",
        progress: Progress = None,
    ) -> Written:
        """Write the asset.

        Parameters
        ----------
        path : str or path
            ``.glb``, or ``.gltf`` with its files next to it; ``.png``, ``.webp`` or ``.exr`` for standalone maps.
        images : str
            Texture format: ``"png"``, ``"webp"`` (lossless), ``"ktx2"``, or lossy for colours: ``"webp:85"``,
            ``"jpeg:85"``, ``"avif:80"``, ``"ktx2:2"``; different ones for colours, normals and numbers:
            ``"jpeg:90/webp/webp:75"``. Ignored if the asset comes from a search.
        meshopt : bool
            Compress geometry with meshoptimizer.
        codecs : {"portable", "web-latest"}
            The extension used for compression: EXT_meshopt_compression, or KHR_meshopt_compression. Ignored if the
            asset comes from a search.
        provenance : path, optional
            XMP metadata (JSON-LD) to add to that of the scan.
        green : {"up", "down"}
            Direction of green in maps for other programs.

        Returns
        -------
        Written
        """
        packing = {
            "images": images,
            "meshopt": meshopt,
            "codecs": codecs,
            "provenance": None if provenance is None else os.fspath(provenance),
            "green": green,
        }
        with running(progress, None) as run:
            native = self._native.write({"path": os.fspath(path), "packing": packing}, run)
        warn(native.warnings())
        return Written(native)

    def verify(self, scan: Any, **options: Any) -> Proof:
        """Write the asset as PNG and glTF to a temporary folder, and measure the written files.

        Parameters
        ----------
        scan : path, Model, or a mesh of another package
            The scan that was baked.
        **options
            The parameters of `Written.verify`. To measure another packing, save the asset and verify that.
        """
        with tempfile.TemporaryDirectory(prefix="taotie-") as folder:
            return self.save(os.path.join(folder, "asset.glb")).verify(scan, **options)

    @cached_property
    def model(self) -> Model:
        """The asset as a model, as read back from a GLB; it renders like the file."""
        return _from_glb(self.glb(), None)

    def glb(self) -> bytes:
        """Return the asset as a GLB with PNG textures."""
        with tempfile.TemporaryDirectory(prefix="taotie-") as folder:
            path = self.save(os.path.join(folder, "asset.glb")).path
            with open(path, "rb") as file:
                return file.read()

    def _native_model(self) -> _taotie.Model:
        return self.model._native

    def _repr_png_(self) -> bytes | None:
        return self.model._repr_png_()

    def __repr__(self) -> str:
        width, height = self.size
        return f"<taotie.Asset {self.triangles} triangles, {width}x{height} texels>"


def bake(
    scan: Any,
    *,
    low: Any = None,
    triangles: int | None = None,
    error: float | None = None,
    goal: Sequence[str] = (),
    images: Sequence[Literal["png", "jpeg", "webp", "avif", "ktx2"]] = (),
    codecs: Codecs = "portable",
    lods: Sequence[int | str] = (),
    size: int | tuple[int, int] | Literal["auto"] | None = None,
    maps: Sequence[Map | Literal["auto"]] = ("auto",),
    space: Literal["tangent", "object"] = "tangent",
    samples: Literal[1, 4, 9, 16, 25, 36, 49, 64] = 4,
    bits: Literal[8, 16] = 8,
    dilation: int | Literal["auto"] = "auto",
    ao_rays: int = 64,
    ao_distance: float | None = None,
    roughness: float | None = None,
    ray_distance: float | Literal["auto"] = "auto",
    cage: Any = None,
    crease_angle: float | None = None,
    scan_green: Literal["auto", "up", "down"] = "auto",
    unit: Unit | None = None,
    memory_limit: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Asset:
    """Bake a high-poly scan to a low-poly asset with a normal map. Names and defaults are those of ``taotie bake``.

    Parameters
    ----------
    scan : path, Model, or a mesh of another package
        The high-poly scan.
    low : path, Model, or a mesh of another package, optional
        The low-poly mesh; its UVs and triangles are kept. By default created from the scan.
    triangles : int, optional
        Triangles of the low-poly mesh; disables the search. Defaults to 50,000 if only `size` is given, or if a
        search is not possible.
    error : float, optional
        Find the smallest asset with a mean normal error as seen of at most this many degrees: one made from the
        scan, with or without a normal map, or the scan itself, packed. Packing options are ignored.
    goal : sequence of str, optional
        Find the smallest asset that meets these requirements, such as ``["p95-angle=2", "mean-color=0.5"]``, as far
        as they concern angles and colours as seen, within any ceilings among them, such as ``"triangles=50000"`` and
        ``"gpu-memory=64MB"``; with ``"bytes=500kB"`` the closest one of at most that size. ``["web"]``,
        ``["archive"]`` and ``["engine"]`` are those of ``--preset``; for the last, also pass ``images=["ktx2"]`` and
        ``lods=["256px", "128px", "64px"]``. If none of `triangles`, `size`, `error` and `goal` is given, the goal is
        ``visually-lossless``, unless `low`, or maps are requested that a search cannot judge.
    images : sequence of str
        Image formats that a search may choose from; if empty, those of `codecs`.
    codecs : {"portable", "web-latest"}
        Codecs that a search may choose from: PNG, JPEG, WebP and EXT_meshopt_compression, or for the latest web
        viewers also AVIF and KHR_meshopt_compression.
    lods : sequence of int or str
        Coarser levels of detail. ``"128px"`` is the lightest one that meets the goal when the object fills 128²
        pixels, 32 to 511; a number is one with that many triangles, which is shown at sizes where it meets the goal.
    size : int, (width, height) or "auto", optional
        Texels of the maps; disables the search. Defaults to 2048 if only `triangles` is given. Auto is the smallest
        power of two, 256 to 8192, that preserves the scan's detail.
    maps : sequence of str
        Maps to bake: auto (normal, and every property that varies in the scan's materials), normal, ao, albedo,
        height, bent, curvature, roughness, metallic-roughness, emission, alpha, occlusion.
    space : {"tangent", "object"}
        Space of the normal map.
    samples : int
        Samples per texel, a square number.
    bits : {8, 16}
        Bits per channel of normal maps; 8-bit maps are dithered if banding would be visible.
    dilation : int or "auto"
        Padding around UV islands, texels; auto fills the map.
    ao_rays : int
        Rays per texel over the hemisphere, for ao and bent.
    ao_distance : float, optional
        Largest distance at which the scan occludes, model units.
    roughness : float, optional
        Roughness of the scan's surface; defaults to that of its material.
    ray_distance : float or "auto"
        Length of the projection rays, model units; auto measures the gap between the meshes.
    cage : path, Model, or a mesh of another package, optional
        The low-poly mesh with its vertices moved outward.
    crease_angle : float, optional
        As in `load`; defaults to the value that the scan was loaded with.
    scan_green : {"auto", "up", "down"}
        As in `load`; auto keeps the value that the scan was loaded with.
    unit : {"mm", "cm", "m", "in"}, optional
        As in `load`; defaults to the value that the scan was loaded with. If the unit is known, the asset is written
        in metres, by the scale of its root node.
    memory_limit : str, optional
        The most memory to use, such as ``"4G"``.
    threads : int, optional
        Defaults to all of the machine's. Results do not depend on it.
    progress : bool or callable, optional
        True for a progress bar; a callable receives stage and fraction, and stops the work by returning False.

    Returns
    -------
    Asset

    Raises
    ------
    Error
        With ``path``, ``where`` and ``remedy``.
    """
    if isinstance(maps, str):
        raise invalid(f"maps {maps!r}", "use a sequence of names, e.g. ['normal', 'ao']")
    side: int | tuple[int, int] | str = 2048 if size is None else size
    width, height = (side, side) if isinstance(side, int | str) else side
    if isinstance(images, str):
        raise invalid(f"images {images!r}", "use a sequence of formats, e.g. ['webp', 'png']")
    if isinstance(goal, str):
        raise invalid(f"goal {goal!r}", "use a sequence of requirements, e.g. ['mean-angle=1']")
    if error is not None and not 0 < error < 180:
        raise invalid(f"an error of {error}", "use degrees above 0 and below 180")
    wanted = list(goal) if error is None else [f"mean-angle={error}", *goal]
    is_by_hand = triangles is not None or size is not None or bits != 8
    if wanted and is_by_hand:
        raise invalid("goal", "a search chooses triangles, size and bits itself; omit them")
    may_drop_goal = not wanted
    if not wanted and not is_by_hand:
        wanted = ["visually-lossless"]
    low_file, low_mesh = _source(low)
    cage_file, cage_mesh = _source(cage)
    if cage is not None and ray_distance != "auto":
        raise invalid("cage", "it defines how far rays reach; omit ray_distance")
    options = {
        "low": low_file,
        "triangles": 50_000 if triangles is None else triangles,
        "goal": ",".join(wanted) if wanted else None,
        "images": list(images),
        "codecs": codecs,
        "lods": list(lods),
        "size": width,
        "height": None if width == height else height,
        "maps": _named_maps(maps),
        "carry": "auto" in maps,
        "space": space,
        "side": _side(samples),
        "bits": bits,
        "dilation": None if dilation == "auto" else dilation,
        "ao_rays": ao_rays,
        "ao_distance": ao_distance,
        "roughness": roughness,
        "ray_distance": _distance(ray_distance, cage_file),
        "inspect": True,
    }
    request = {
        "options": options,
        "low": low_mesh,
        "cage": cage_mesh,
        "may_drop_goal": may_drop_goal,
        "memory_limit": memory_limit,
    }
    high = a_model(scan)._native
    if crease_angle is not None or scan_green != "auto" or unit is not None:
        high = high.as_scan(scan_options(crease_angle, scan_green, unit))
    with running(progress, threads) as run:
        native = _taotie.bake(high, request, run)
    warn(native.warnings())
    return Asset(native)


def _source(mesh: Any) -> tuple[Any, Any]:
    """Return a mesh as a file for the options, or as a native model."""
    if mesh is None:
        return None, None
    if isinstance(mesh, (str, os.PathLike)):
        return {"file": os.fspath(mesh)}, None
    model = a_model(mesh)
    if model.path is not None and os.path.exists(model.path):
        return {"file": model.path}, None
    return None, model._native


def _named_maps(maps: Sequence[str]) -> list[str]:
    named = [name for name in maps if name != "auto"]
    if "auto" in maps and "normal" not in named:
        named.insert(0, "normal")
    return named


def _side(samples: int) -> int:
    side = int(round(samples**0.5))
    if side * side != samples:
        raise invalid(f"samples {samples}", "use a square number: 1, 4, 9, 16, 25, 36, 49 or 64")
    return side


def _distance(distance: float | str, cage: Any) -> Any:
    if cage is not None:
        return {"cage": cage}
    return "auto" if distance == "auto" else {"uniform": float(distance)}


__all__ = ["Asset", "Met", "Model", "Proof", "Written", "bake"]
