"""Models: from a file, or from the arrays of a mesh."""

from __future__ import annotations

import json
import os
import tempfile
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import Array, PathLike, path as a_path
from ._error import invalid, warn
from ._export import to_open3d, to_pyvista, to_trimesh
from ._image import Image
from ._inspect import Inspection, inspection
from ._native import native_model, native_of_arrays
from ._material import Material, material as a_material
from ._options import Unit
from ._render import render
from ._run import Progress, log, running


class Model:
    """A scene of meshes, materials, lights and cameras. Created by `load`, `Mesh` or `Scene`; immutable.

    Examples
    --------
    >>> scan = tt.load("scan.ply")
    >>> scan
    <taotie.Model 'scan.ply', 1520 triangles>
    >>> scan.bounds.shape
    (2, 3)
    """

    _native: _taotie.Model
    _path: str | None
    _stamp: tuple[int, int] | None

    def __init__(self, native: _taotie.Model, path: str | None = None, stamp: tuple[int, int] | None = None) -> None:
        self._native, self._path, self._stamp = native, path, stamp

    @property
    def path(self) -> str | None:
        """The file that it was read from; None if it is in memory."""
        return self._path

    @property
    def triangles(self) -> int:
        """The number of triangles over all instances."""
        return self._native.triangles()

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """The minimum and maximum corner, ``(2, 3)``, world space; NaN without triangles."""
        bounds = self._native.bounds()
        return np.full((2, 3), np.nan) if bounds is None else np.array(bounds)

    @property
    def warnings(self) -> tuple[tuple[str, int], ...]:
        """Problems of the file, and omissions, with their counts."""
        return tuple(self._native.warnings())

    def arrays(self) -> dict[str, Array]:
        """Return all triangles as one mesh in world space.

        Returns
        -------
        dict
            ``vertices`` (n, 3) float32, ``faces`` (m, 3) uint32, ``normals`` (n, 3), and if present ``uvs``
            (n, 2) with their origin top left, ``tangents`` (n, 4) and ``colors`` (n, 4), linear RGBA.

        Examples
        --------
        >>> scan.arrays()["faces"].shape
        (1520, 3)
        """
        return self._native.arrays()

    def with_material(self, material: Material | PathLike) -> Model:
        """Return the same model with another material, a `Material`, the name of a preset, or a TOML file.

        Examples
        --------
        >>> bronze = scan.with_material("bronze")
        >>> worn = scan.with_material(tt.Material("bronze", roughness=0.6))
        """
        return Model(self._native.dressed(a_material(material)._request()))

    def inspect(self) -> Inspection:
        """Return the content of the model and its defects.

        Examples
        --------
        >>> scan.inspect().format
        'PLY'
        """
        return inspection(self._native)

    def glb(self) -> bytes:
        """Return the scene as a GLB. Warns about everything that glTF cannot express.

        Examples
        --------
        >>> scan.glb()[:4]
        b'glTF'
        """
        data, left = self._native.glb()
        warn(left)
        return data

    def save(self, path: PathLike) -> None:
        """Write the scene as glTF, with materials, textures, lights and cameras, but without animations.

        Parameters
        ----------
        path : str or path
            ``.glb``, or ``.gltf`` with its data and textures next to it.

        Raises
        ------
        Error
            If the name ends otherwise, the file is one that the model was read from, or it cannot be written.

        Warns
        -----
        TaotieWarning
            About everything that glTF cannot express.

        Examples
        --------
        >>> scan.save("scan.glb")
        >>> tt.load("scan.glb").triangles == scan.triangles
        True
        """
        file = a_path("path", path)
        warn(_taotie.save_model(self._native, file))
        log.info("wrote %s", file)

    def to_trimesh(self) -> Any:
        """Return a ``trimesh.Trimesh`` in world space, with normals, UVs, colours and materials.

        Several materials become a ``MultiMaterial``. Textures have 8 bits per channel and need Pillow.

        Warns
        -----
        TaotieWarning
            About everything that trimesh cannot hold.

        Examples
        --------
        >>> mesh = scan.to_trimesh()  # doctest: +SKIP
        """
        parts, left_out = self._native.parts()
        return to_trimesh(parts, left_out)

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.PolyData`` in world space, with normals, UVs and colours (``RGBA``, sRGB).

        Warns
        -----
        TaotieWarning
            About materials and textures, which PyVista keeps apart from meshes.

        Examples
        --------
        >>> mesh = scan.to_pyvista()  # doctest: +SKIP
        """
        return to_pyvista(*self._native.parts())

    def to_open3d(self) -> Any:
        """Return an ``open3d.geometry.TriangleMesh`` in world space, with normals, UVs, colours and colour textures.

        Warns
        -----
        TaotieWarning
            About everything else of materials, which that class cannot hold.

        Examples
        --------
        >>> mesh = scan.to_open3d()  # doctest: +SKIP
        """
        return to_open3d(*self._native.parts())

    def _preview(self) -> Image:
        return render(self, size=(480, 480), env="studio", background="transparent")

    def _native_model(self) -> _taotie.Model:
        return self._native

    def _repr_png_(self) -> bytes | None:
        return self._preview()._repr_png_()

    def __repr__(self) -> str:
        name = "" if self._path is None else f"{self._path!r}, "
        return f"<taotie.{type(self).__name__} {name}{self.triangles} triangles>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_glb, (self._native.glb()[0], self._path, self._stamp, self._native.reading())


class Mesh(Model):
    """A model of one mesh, created from arrays. They are copied once; float64 is rounded to float32.

    Parameters
    ----------
    vertices : array_like
        Points, ``(n, 3)``, float32 or float64.
    faces : array_like
        Counter-clockwise triangles, ``(m, 3)``, uint32 or another integer.
    normals : array_like, optional
        Unit normals, ``(n, 3)``.
    uvs : array_like, optional
        Texture coordinates, ``(n, 2)``; the origin is top left, as in glTF.
    colors : array_like, optional
        RGB or RGBA, ``(n, 3)`` or ``(n, 4)``: linear floats in [0, 1], or sRGB codes of uint8; alpha is linear in both.
    material : Material or str, optional
        Its material: a `Material`, the name of a preset, or a TOML file.

    Raises
    ------
    InvalidValue
        If an array has another shape, an index is out of range, or a number is not finite or out of range.
    InvalidType
        If an array has another dtype.

    Examples
    --------
    >>> square = tt.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> square
    <taotie.Mesh 2 triangles>
    >>> uvs = [[0, 1], [1, 1], [1, 0], [0, 0]]
    >>> paint = tt.Material(base_color_map=np.zeros((8, 8, 3), np.uint8), roughness=0.4)
    >>> painted = tt.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], uvs=uvs, material=paint)
    """

    def __init__(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike,
        normals: npt.ArrayLike | None = None,
        uvs: npt.ArrayLike | None = None,
        colors: npt.ArrayLike | None = None,
        *,
        material: Material | PathLike | None = None,
    ) -> None:
        super().__init__(native_of_arrays(vertices, faces, normals, uvs, colors, material=material))


def _from_glb(
    data: bytes, path: str | None = None, stamp: tuple[int, int] | None = None, reading: str = "{}"
) -> Model:
    with tempfile.TemporaryDirectory(prefix="taotie-") as folder:
        file = os.path.join(folder, "model.glb")
        with open(file, "wb") as opened:
            opened.write(data)
        with running(None, None) as run:
            native = _taotie.load(file, {"material": a_material(None)._request(), "options": {}}, run)
    return Model(native.without_file().as_scan(json.loads(reading)), path, stamp)


def _stamp(path: str) -> tuple[int, int] | None:
    """Return the time and size of a file; None if it does not exist."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def unchanged_file(model: Model) -> str | None:
    """Return the file of a model if it is the same as when the model was read."""
    path = model.path
    return path if path is not None and model._stamp is not None and _stamp(path) == model._stamp else None


def scan_options(crease_angle: float | None, green: str, unit: str | None) -> dict[str, Any]:
    """Return the options for reading a scan, for the native module."""
    if unit not in (None, "mm", "cm", "m", "in"):
        raise invalid(f"unit {unit!r}", "unknown; expected one of: mm, cm, m, in")
    if green not in ("auto", "up", "down"):
        raise invalid(f"scan_green {green!r}", "expected auto, up or down")
    return {"crease_angle_deg": crease_angle, "green": None if green == "auto" else green, "unit": unit}


def load(
    path: PathLike,
    *,
    material: Material | PathLike | None = None,
    crease_angle: float | None = None,
    scan_green: Literal["auto", "up", "down"] = "auto",
    unit: Unit | None = None,
    memory_limit: str | None = None,
    allow_outside: bool = False,
    progress: Progress = None,
) -> Model:
    """Read a model: glTF, GLB, OBJ, PLY, STL or FBX.

    Parameters
    ----------
    path : str or path
        The file.
    material : Material or str, optional
        The material to apply: a `Material`, the name of a preset, or a TOML file.
    crease_angle : float, optional
        For a scan without normals, or with one normal per facet: the angle between facets from which an edge is hard,
        degrees; 0 keeps all facets flat. By default only the hard edges of modelled shapes are kept.
    scan_green : {"auto", "up", "down"}
        Direction of green in the normal maps of a scan; auto trusts the file unless the pixels contradict it.
    unit : {"mm", "cm", "m", "in"}, optional
        Unit of the coordinates of a scan, including glTF that is not in metres. Defaults to the metre for glTF,
        otherwise unknown.
    memory_limit : str, optional
        The most memory to use, such as ``"4G"``; defaults to the machine's free memory.
    allow_outside : bool
        Also read files that the model references outside its own folder.
    progress : bool or callable, optional
        True for a progress bar; a callable receives stage and fraction, and stops the work by returning False.

    Returns
    -------
    Model

    Raises
    ------
    FileError
        If the file cannot be read or violates its format; `MissingFile` if it does not exist.

    Warns
    -----
    TaotieWarning
        If something was wrong with the file and has been fixed, or was left out.

    Examples
    --------
    >>> scan = tt.load("scan.ply", unit="mm")
    """
    options = {
        "scan": scan_options(crease_angle, scan_green, unit),
        "memory_limit": memory_limit,
        "allow_outside": allow_outside,
    }
    request = {"material": a_material(material)._request(), "options": options}
    file = a_path("path", path)
    stamp = _stamp(file)
    with running(progress, None) as run:
        native = _taotie.load(file, request, run)
    warn(native.warnings())
    model = Model(native) if material is not None else Model(native, file, stamp)
    log.info("read %s: %d triangles", file, model.triangles)
    return model


def scan_models(scan: Any) -> _taotie.Model | list[_taotie.Model]:
    """Return the native model of a scan, or those of a list of models that are one scan."""
    if isinstance(scan, (list, tuple)):
        return [model(part)._native for part in scan]
    return model(scan)._native


def model(thing: Any, material: Material | PathLike | None = None, bump_scale: float | None = None) -> Model:
    """Return a model from a path, a model, an asset, or a mesh of another package."""
    is_unchanged = material is None and bump_scale is None
    if isinstance(thing, Model) and is_unchanged:
        return thing
    file = os.fspath(thing) if is_unchanged and isinstance(thing, (str, os.PathLike)) else None
    return Model(native_model(thing, material, bump_scale), file)
