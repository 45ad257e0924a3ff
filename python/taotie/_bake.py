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
        The most that it may be: degrees, parts of 1, pixels or bytes; metres if `is_length`.
    is_length : bool
        True if limit, value and interval are lengths in metres.
    level : int or None
        The level of detail, 0 the finest; None for a figure of the whole asset.
    value : float or None
        What was measured; None where it could not be.
    interval : tuple of float, or None
        The value lies between these two, with a confidence of 99 % if it is estimated from samples.
    met : bool
        True if the whole interval keeps to the limit.
    text : str
        All that in words.
    within : float or None
        Of figures that are the share of the surface within a limit, such as ``within-5deg``: that limit, in degrees, ΔE, or
        parts of the diagonal.
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
    """How far an asset, as it was written and read back, is from its scan.

    Attributes
    ----------
    figures : dict
        All figures, as in the command's report under ``proof``.
    error_map : ndarray or None
        ``(H, W)`` float32: degrees between the normals of asset and scan at each texel, on the surface; NaN between UV
        islands. None if the asset has no uvs.
    color_map : ndarray or None
        ``(H, W)`` float32: CIEDE2000 between the base colours; None where the scan says nothing of its material.
    detail_map : ndarray or None
        ``(H, W)`` float32: how many times wider than the scan's finest detail the asset's texels are; None without textures.
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
        """The mean angle between the normals as seen, at the same pixel, degrees; NaN if no pixel was compared."""
        return self._angle("mean")

    @property
    def p95_deg(self) -> float:
        """The 95th percentile of these angles, degrees."""
        return self._angle("p95")

    @property
    def max_deg(self) -> float:
        """The largest of these angles, degrees: a maximum over samples."""
        return self._angle("max")

    @property
    def missed(self) -> float:
        """The share of the visible surface where the other shows nothing, the worse of scan and asset, [0, 1]."""
        coverage = self._finest["coverage"]
        return float(max(coverage["missed_of_scan"], coverage["missed_of_asset"]))

    @property
    def hausdorff(self) -> float:
        """The upper bound of the largest distance between the visible surfaces, as a part of the diagonal."""
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
        """Demand that figures are at most so large, as ``taotie bake --require`` does.

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
            Visible surface that the other lacks, per cent.
        hausdorff : float or str, optional
            Upper bound of the largest distance, per cent of the diagonal, or a length such as ``"0.2mm"`` if the unit of
            the scan is known.
        bytes : float or str, optional
            Of the asset with the files that it names.

        Returns
        -------
        list of Met

        Raises
        ------
        NotMet
            Where a figure is larger, or could not be measured.
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
    """Return what the native module found as a proof, and warn of what it noted."""
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
        The asset (.gltf, .glb, .obj, .ply, .stl), in the place of the scan: glTF in metres if the scan's unit is known,
        others in that unit.
    scan : path, Model, or a mesh of another package
        What it should look like. It is read as it was for the bake, if the asset records that, unless it was loaded with
        other options.
    points : int
        Pixels of the overview and points of each surface that are compared, at least 10.
    map : int
        Texels along a side of ``error_map``, at most.
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
    """An asset in its files."""

    def __init__(self, native: _taotie.Written) -> None:
        self._native = native

    @property
    def files(self) -> list[str]:
        """The files, the model or the first map first."""
        return [os.fspath(path) for path in self._native.files()]

    @property
    def path(self) -> str:
        """The model's file; of maps alone the first one's."""
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
            What was baked from.
        points : int
            Pixels of the overview and points of each surface that are compared, at least 10.
        map : int
            Texels along a side of ``error_map``, at most.
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
        """Return the report that ``taotie bake`` writes beside the asset, as plain data."""
        proved = None if proof is None else {"figures": dict(proof.figures), "options": dict(proof.options)}
        report: dict[str, Any] = json.loads(self._native.report(proved, list(require)))
        return report

    def __repr__(self) -> str:
        return f"<taotie.Written {self.path!r}>"


class Asset:
    """A low-poly mesh with baked maps. Made by `bake`; it does not change."""

    def __init__(self, native: _taotie.Asset) -> None:
        self._native = native
        self._facts: dict[str, Any] = json.loads(native.facts())

    @property
    def triangles(self) -> list[int]:
        """Triangles of each level of detail, the finest first."""
        return list(self._facts["triangles"])

    @property
    def size(self) -> tuple[int, int]:
        """Texels across and down."""
        width, height = self._facts["size"]
        return width, height

    @property
    def counts(self) -> dict[str, int]:
        """What became of the samples: samples, missed, lost, shared, texels, missed_texels."""
        return dict(self._facts["counts"])

    @property
    def warnings(self) -> tuple[tuple[str, int], ...]:
        """What is wrong with scan, mesh and maps, or was left out, and how often."""
        return tuple(self._native.warnings())

    def levels(self) -> list[dict[str, Array]]:
        """Return the arrays of each level of detail, as `Model.arrays` does."""
        return self._native.levels()

    def maps(self, material: str = "") -> dict[str, Array]:
        """Return the maps as they are stored, ``(height, width)`` or ``(height, width, channels)``.

        Parameters
        ----------
        material : str
            The material, where the asset has several.

        Returns
        -------
        dict
            ``normal``; ``albedo`` in sRGB; ``orm``, which is occlusion, roughness and metallic; ``emission``; and by
            their own names those that stand beside the model.
        """
        sets = self._native.maps()
        if material not in sets:
            raise invalid(f"material {material!r}", f"there is none of this name; choose from: {', '.join(sets)}")
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
            ``.glb``, or ``.gltf`` with its files beside it; ``.png``, ``.webp`` or ``.exr`` for maps alone.
        images : str
            Format of textures: ``"png"``, ``"webp"`` (lossless), ``"ktx2"``, or with a loss of colours: ``"webp:85"``,
            ``"jpeg:85"``, ``"avif:80"``, ``"ktx2:2"``; those of colours, normals and numbers: ``"jpeg:90/webp/webp:75"``. Not read if the
            asset was searched for.
        meshopt : bool
            Compress geometry by meshoptimizer.
        codecs : {"portable", "web-latest"}
            The extension that compresses it: EXT_meshopt_compression, or KHR_meshopt_compression. Not read if the asset was
            searched for.
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
        """Write the asset as PNG and glTF into a folder that is removed again, and measure what was written.

        Parameters
        ----------
        scan : path, Model, or a mesh of another package
            What was baked from.
        **options
            As those of `Written.verify`. To measure another packing, save the asset and verify that.
        """
        with tempfile.TemporaryDirectory(prefix="taotie-") as folder:
            return self.save(os.path.join(folder, "asset.glb")).verify(scan, **options)

    @cached_property
    def model(self) -> Model:
        """The asset as a model, as it is read back from a GLB; it renders like the file."""
        return _from_glb(self.glb(), None)

    def glb(self) -> bytes:
        """Return the asset as a GLB with PNG textures."""
        with tempfile.TemporaryDirectory(prefix="taotie-") as folder:
            path = self.save(os.path.join(folder, "asset.glb")).path
            with open(path, "rb") as file:
                return file.read()

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
        The low-poly mesh; its uvs and triangles stay. Made from the scan if not given.
    triangles : int, optional
        Triangles of the low-poly mesh; nothing is searched for then. 50,000 if only `size` is given, or if nothing can be
        searched for.
    error : float, optional
        Find the asset of the fewest bytes whose mean normal error as seen is at most so many degrees: made of the scan, with
        a normal map or without, or the scan itself, packed. Packing options are not read.
    goal : sequence of str, optional
        Find the asset of the fewest bytes that meets these requirements, such as ``["p95-angle=2", "mean-color=0.5"]``, as
        far as they are about angles and colours as seen, within the ceilings among them, such as ``"triangles=50000"`` and
        ``"gpu-memory=64MB"``; with ``"bytes=500kB"`` the nearest of at most that size. ``["web"]``, ``["archive"]`` and
        ``["engine"]`` are those of ``--preset``; give the last one ``images=["ktx2"]`` and
        ``lods=["256px", "128px", "64px"]``, too. If none of `triangles`, `size`, `error` and `goal` is given, it is one that
        is ``visually-lossless``, unless `low`, or maps are asked for that a search cannot judge.
    images : sequence of str
        Image formats that a search may choose from; those of `codecs` if empty.
    codecs : {"portable", "web-latest"}
        Codecs that a search may choose from: PNG, JPEG, WebP and EXT_meshopt_compression, or for the newest web viewers AVIF as
        well, and KHR_meshopt_compression.
    lods : sequence of int or str
        Coarser levels of detail. ``"128px"`` is the lightest one that meets the goal where the object fills 128² pixels, 32 to
        511; a number is one of so many triangles, which is shown where it meets the goal.
    size : int, (width, height) or "auto", optional
        Texels of the maps; nothing is searched for then. 2048 if only `triangles` is given. Auto is the smallest power of
        two, 256 to 8192, that preserves the scan's detail.
    maps : sequence of str
        Maps to bake: auto (normal, and whatever varies in the scan's materials), normal, ao, albedo, height, bent,
        curvature, roughness, metallic-roughness, emission, alpha, occlusion.
    space : {"tangent", "object"}
        Space of the normal map.
    samples : int
        Samples a texel, a square number.
    bits : {8, 16}
        Bits per channel of normal maps; 8-bit maps are dithered where they would show bands.
    dilation : int or "auto"
        Padding around UV islands, texels; auto fills the map.
    ao_rays : int
        Rays per texel over the hemisphere, for ao and bent.
    ao_distance : float, optional
        Largest distance at which the scan occludes, model units.
    roughness : float, optional
        Roughness of the scan's surface; that of its material if not given.
    ray_distance : float or "auto"
        Length of the projection rays, model units; auto measures the gap between the meshes.
    cage : path, Model, or a mesh of another package, optional
        The low-poly mesh with its vertices moved outward.
    crease_angle : float, optional
        As in `load`; what the scan was loaded with if not given.
    scan_green : {"auto", "up", "down"}
        As in `load`; what the scan was loaded with if auto.
    unit : {"mm", "cm", "m", "in"}, optional
        As in `load`; what the scan was loaded with if not given. The asset is written in metres then, by the scale of its
        root node.
    memory_limit : str, optional
        The most memory to use, such as ``"4G"``.
    threads : int, optional
        All of the machine's if not given. Results do not depend on it.
    progress : bool or callable, optional
        True for a bar; a callable gets stage and fraction, and stops the work by returning False.

    Returns
    -------
    Asset

    Raises
    ------
    Error
        With ``path``, ``where`` and ``remedy``.
    """
    if isinstance(maps, str):
        raise invalid(f"maps {maps!r}", "give a sequence of names, such as ['normal', 'ao']")
    side: int | tuple[int, int] | str = 2048 if size is None else size
    width, height = (side, side) if isinstance(side, int | str) else side
    if isinstance(images, str):
        raise invalid(f"images {images!r}", "give a sequence of formats, such as ['webp', 'png']")
    if isinstance(goal, str):
        raise invalid(f"goal {goal!r}", "give a sequence of requirements, such as ['mean-angle=1']")
    if error is not None and not 0 < error < 180:
        raise invalid(f"an error of {error}", "give degrees above 0 and below 180")
    wanted = list(goal) if error is None else [f"mean-angle={error}", *goal]
    is_by_hand = triangles is not None or size is not None or bits != 8
    if wanted and is_by_hand:
        raise invalid("goal", "a search chooses triangles, size and bits; leave them out")
    may_drop_goal = not wanted
    if not wanted and not is_by_hand:
        wanted = ["visually-lossless"]
    low_file, low_mesh = _source(low)
    cage_file, cage_mesh = _source(cage)
    if cage is not None and ray_distance != "auto":
        raise invalid("cage", "it says how far rays reach; leave out ray_distance")
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
        raise invalid(f"samples {samples}", "give a square number: 1, 4, 9, 16, 25, 36, 49 or 64")
    return side


def _distance(distance: float | str, cage: Any) -> Any:
    if cage is not None:
        return {"cage": cage}
    return "auto" if distance == "auto" else {"uniform": float(distance)}


__all__ = ["Asset", "Met", "Model", "Proof", "Written", "bake"]
