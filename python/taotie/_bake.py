"""From a scan to an asset and its proof."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from . import _taotie
from ._arrays import Array, PathLike, sides
from ._error import invalid, warn
from ._model import Model, _from_glb, scan_models, scan_options, unchanged_file
from ._model import model as a_model
from ._options import Codecs, Device, Map, Unit, check, takes
from ._proof import Proof, VerifyOptions, measured
from ._run import Progress, log, running

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: The stages of a bake with their shares of its time.
STAGES = {
    "read the scan": 0.05,
    "join the scan": 0.05,
    "inspect the scan": 0.05,
    "measure the noise": 0.01,
    "remove the noise": 0.1,
    "read the low-poly mesh": 0.02,
    "search": 0.3,
    "remesh the scan": 0.1,
    "simplify": 0.2,
    "sort the scan": 0.05,
    "fit normals": 0.05,
    "unwrap": 0.05,
    "tangents": 0.02,
    "measure the gap": 0.02,
    "bake": 0.2,
    "store": 0.05,
    "levels of detail": 0.1,
}


class Written:
    """An asset written to files. Created by `Asset.save`.

    Examples
    --------
    >>> written = asset.save("asset.glb")
    >>> written
    <taotie.Written 'asset.glb'>
    >>> written.files
    ['asset.glb']
    """

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

    @takes(VerifyOptions)
    def verify(self, scan: Any, **options: Unpack[VerifyOptions]) -> Proof:
        """Read the files back and measure how far they are from the scan.

        Parameters
        ----------
        scan : path, Model, or a mesh of another package; or a list of them
            The scan that was baked.
        **options
            See `VerifyOptions`.

        Returns
        -------
        Proof

        Examples
        --------
        >>> proof = asset.save("asset.glb", images="webp").verify(scan, points=1000, view=64)
        """
        check("Written.verify", options, VerifyOptions)
        high = scan_models(scan)
        return measured(lambda chosen, run: self._native.verify(high, chosen, run), options)

    def report(self, proof: Proof | None = None, require: Sequence[str] = ()) -> dict[str, Any]:
        """Return the report that ``taotie bake`` writes next to the asset, as plain data.

        Parameters
        ----------
        proof : Proof, optional
            The proof to report.
        require : sequence of str
            The requirements to report, as for `Proof.require`.

        Examples
        --------
        >>> report = asset.save("asset.glb").report(proof, ["mean-angle=2"])
        >>> report["kind"]
        'taotie bake'
        """
        proved = None
        if proof is not None:
            proved = {"figures": dict(proof.figures), "maps": list(proof.maps), "options": dict(proof.options)}
        report: dict[str, Any] = json.loads(self._native.report(proved, list(require)))
        return report

    def __repr__(self) -> str:
        return f"<taotie.Written {self.path!r}>"


class Asset:
    """A low-poly mesh with baked maps. Created by `bake`; immutable.

    Examples
    --------
    >>> asset
    <taotie.Asset 300 triangles, 64x64 texels>
    >>> image = tt.render(asset, size=32)
    """

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
        """Counts of the bake (samples, missed, lost, shared, texels, missed_texels)."""
        return dict(self._facts["counts"])

    @property
    def warnings(self) -> tuple[tuple[str, int], ...]:
        """Problems of scan, mesh and maps, and omissions, with their counts."""
        return tuple(self._native.warnings())

    def levels(self) -> list[dict[str, Array]]:
        """Return the arrays of each level of detail, as `Model.arrays` does.

        Examples
        --------
        >>> [len(level["faces"]) for level in asset.levels()]
        [300]
        """
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

        Examples
        --------
        >>> asset.maps()["normal"].shape
        (64, 64, 3)
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
        channels: Sequence[str] = (),
        progress: Progress = None,
    ) -> Written:
        """Write the asset.

        Parameters
        ----------
        path : str or path
            ``.glb``, or ``.gltf`` with its files next to it; ``.png``, ``.tiff``, ``.exr``, ``.tga``, ``.dds`` or
            ``.webp`` for standalone maps.
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
        channels : sequence of str
            Further textures that pack maps into their channels: ``"orm"``, ``"unreal"``, ``"unity-mask"``, or a list
            such as ``"dirt:R=ao,G=curvature,B=1-height"``.

        Returns
        -------
        Written

        Examples
        --------
        >>> asset.save("asset.glb", images="webp", meshopt=True).files
        ['asset.glb']
        """
        packing = {
            "images": images,
            "meshopt": meshopt,
            "codecs": codecs,
            "provenance": None if provenance is None else os.fspath(provenance),
            "green": green,
            "channels": list(channels),
        }
        with running(progress, None) as run:
            native = self._native.write({"path": os.fspath(path), "packing": packing}, run)
        warn(native.warnings())
        written = Written(native)
        log.info("wrote %s", ", ".join(written.files))
        return written

    @takes(VerifyOptions)
    def verify(self, scan: Any, **options: Unpack[VerifyOptions]) -> Proof:
        """Write the asset as PNG and glTF to a temporary folder, and measure the written files.

        Parameters
        ----------
        scan : path, Model, or a mesh of another package; or a list of them
            The scan that was baked.
        **options
            See `VerifyOptions`. To measure another packing, save the asset and verify that.

        Examples
        --------
        >>> asset.verify(scan, points=1000, view=64).require(mean_angle=20)[0].met
        True
        """
        check("Asset.verify", options, VerifyOptions)
        with tempfile.TemporaryDirectory(prefix="taotie-") as folder:
            return self.save(os.path.join(folder, "asset.glb")).verify(scan, **options)

    @cached_property
    def model(self) -> Model:
        """The asset as a model, as read back from a GLB; it renders like the file."""
        return _from_glb(self.glb(), None)

    def glb(self) -> bytes:
        """Return the asset as a GLB with PNG textures.

        Examples
        --------
        >>> asset.glb()[:4]
        b'glTF'
        """
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
        triangles = " + ".join(map(str, self.triangles))
        return f"<taotie.Asset {triangles} triangles, {width}x{height} texels>"


def bake(
    scan: Any,
    *,
    low: Any = None,
    triangles: int | None = None,
    remesh: bool = False,
    error: float | None = None,
    goal: Sequence[str] = (),
    images: Sequence[Literal["png", "jpeg", "webp", "avif", "ktx2"]] = (),
    codecs: Codecs = "portable",
    lods: Sequence[int | str] = (),
    size: int | tuple[int, int] | Literal["auto"] | None = None,
    maps: Sequence[Map | Literal["auto"]] = ("auto",),
    space: Literal["tangent", "object"] = "tangent",
    samples: Literal[1, 4, 9, 16, 25, 36, 49, 64] = 4,
    bits: Literal[8, 16, 32] = 8,
    dilation: int | Literal["auto"] = "auto",
    ao_rays: int = 64,
    ao_distance: float | None = None,
    roughness: float | None = None,
    bevel_radius: float | None = None,
    ray_distance: float | Literal["auto"] = "auto",
    cage: Any = None,
    match: Literal["by-name", "isolated", "nearest", "uv"] = "by-name",
    sizes: Mapping[str, int] | Literal["even", "same"] = "same",
    new_uvs: bool = False,
    udim: bool = False,
    ray_colors: bool = False,
    skew: str | os.PathLike[str] = "auto",
    noise: Literal["keep", "remove"] | None = None,
    crease_angle: float | None = None,
    scan_green: Literal["auto", "up", "down"] = "auto",
    unit: Unit | None = None,
    device: Device = "cpu",
    memory_limit: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Asset:
    """Bake a high-poly scan to a low-poly asset with a normal map. Names and defaults are those of ``taotie bake``.

    Parameters
    ----------
    scan : path, Model, or a mesh of another package; or a list of them
        The high-poly scan. The models of a list are one scan: their surfaces are joined, each with its own materials.
        Objects without a name have that of their file, so that ``lid_high.ply`` matches ``lid_low`` of `low`.
    low : path, Model, or a mesh of another package, optional
        The low-poly mesh; its UVs and triangles are kept. By default created from the scan.
    triangles : int, optional
        Triangles of the low-poly mesh; disables the search. Defaults to 50,000 if only `size` is given, or if a
        search is not possible.
    remesh : bool
        Make the low-poly mesh from a watertight outer surface of the scan, built from voxels of 0.25 % of its
        diagonal. Holes narrower than 2 % are closed, inner parts left out, and sheets become thin shells.
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
        height, bent, curvature, roughness, metallic-roughness, emission, alpha, occlusion, and those of `Map`.
    space : {"tangent", "object"}
        Space of the normal map.
    samples : int
        Samples per texel, a square number.
    bits : {8, 16, 32}
        Bits per channel of normal maps; 8-bit maps are dithered if banding would be visible. 32 stores all maps as floats, for
        ``asset.save("normal.exr")`` or ``.tiff``.
    dilation : int or "auto"
        Padding around UV islands, texels; auto fills the map.
    ao_rays : int
        Rays per texel over the hemisphere, for ao and bent.
    ao_distance : float, optional
        Largest distance at which the scan occludes, model units.
    roughness : float, optional
        Roughness of the scan's surface; defaults to that of its material.
    bevel_radius : float, optional
        Radius of rounded edges for bevel, model units; defaults to 1 % of the scan's diagonal.
    ray_distance : float or "auto"
        Length of the projection rays, model units; auto measures the gap between the meshes.
    cage : path, Model, or a mesh of another package, optional
        The low-poly mesh with its vertices moved outward.
    match : {"by-name", "isolated", "nearest", "uv"}
        How points of the low-poly mesh find the scan. By name, ``X_low`` shows only ``X_high``, if such names exist;
        isolated, so do rays for occlusion, bent normals, thickness and bevel; by UV, points of the same UV correspond.
    sizes : dict, "even" or "same"
        The sizes of the maps of the materials of `low`: by name, or ``"even"`` for texels of the same width on the surface,
        with `size` for the largest maps.
    new_uvs : bool
        Ignore the UVs and materials of `low`: it is unwrapped, and gets the scan's materials.
    udim : bool
        The UVs of `low` are on UDIM tiles, each of which gets its own maps: for ``asset.save("rock.<UDIM>.png")``.
    ray_colors : bool
        Multiply ray distances, also those of a cage, by the red channel of the vertex colours of `low`, linear.
    skew : "auto", "keep" or path
        Skew correction. Auto: projection rays follow flat faces, except near their edges, where the scan does, so that
        relief is not shifted by averaged normals; keep: averaged normals everywhere; or a mask on the UVs of `low`:
        triangle normals where white. A cage overrides auto.
    noise : {"keep", "remove"}, optional
        Measure the scan's noise, and keep or remove it; with remove, everything is made from the scan without it, and
        the proof still compares with the scan as given. By default it is kept and not measured.
    crease_angle : float, optional
        As in `load`; defaults to the value that the scan was loaded with.
    scan_green : {"auto", "up", "down"}
        As in `load`; auto keeps the value that the scan was loaded with.
    unit : {"mm", "cm", "m", "in"}, optional
        As in `load`; defaults to the value that the scan was loaded with. If the unit is known, the asset is written
        in metres, by the scale of its root node.
    device : {"cpu", "gpu", "auto"}
        Device that casts the rays of projections, ao and bent; auto is a GPU if there is one that is not a software
        implementation. Only maps by the CPU are bit-identical everywhere.
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

    Examples
    --------
    >>> asset = tt.bake(scan, triangles=300, size=64, maps=["normal", "ao"], ao_rays=16)
    >>> sorted(asset.maps())
    ['normal', 'orm']
    """
    if isinstance(maps, str):
        raise invalid(f"maps {maps!r}", "use a sequence of names, e.g. ['normal', 'ao']")
    width, height = ("auto", "auto") if isinstance(size, str) and size == "auto" else sides("size", 2048 if size is None else size)
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
    if noise not in (None, "keep", "remove"):
        raise invalid(f"noise {noise!r}", "expected one of: keep, remove")
    options = {
        "low": low_file,
        "triangles": 50_000 if triangles is None else triangles,
        "remesh": remesh,
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
        "bevel_radius": bevel_radius,
        "match": match,
        "sizes": sizes if isinstance(sizes, str) else ",".join(f"{name}={side}" for name, side in sizes.items()) or "same",
        "new_uvs": new_uvs,
        "udim": udim,
        "keep_uvs": udim,
        "ray_distance": _distance(ray_distance, cage_file),
        "ray_colors": ray_colors,
        "straighten": skew != "keep",
        "skew_mask": None if skew in ("auto", "keep") else os.fspath(skew),
        "noise": noise,
        "inspect": True,
    }
    request = {
        "options": options,
        "low": low_mesh,
        "cage": cage_mesh,
        "may_drop_goal": may_drop_goal,
        "memory_limit": memory_limit,
        "device": device,
    }
    high = scan_models(scan)
    if crease_angle is not None or scan_green != "auto" or unit is not None:
        reading = scan_options(crease_angle, scan_green, unit)
        high = [part.as_scan(reading) for part in high] if isinstance(high, list) else high.as_scan(reading)
    with running(progress, threads, STAGES) as run:
        native = _taotie.bake(high, request, run)
    warn(native.warnings())
    asset = Asset(native)
    log.info("baked %r", asset)
    return asset


def _source(mesh: Any) -> tuple[Any, Any]:
    """Return a mesh as a file for the options, or as a native model."""
    if mesh is None:
        return None, None
    if isinstance(mesh, (str, os.PathLike)):
        return {"file": os.fspath(mesh)}, None
    model = a_model(mesh)
    file = unchanged_file(model)
    if file is not None:
        return {"file": file}, None
    if model.path is not None:
        warn([(f"{model.path} has changed or is gone since it was loaded: its mesh in memory is used, without materials", 1)])
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


__all__ = ["Asset", "Written", "bake"]
