"""Models: what a file holds, or a mesh of arrays."""

from __future__ import annotations

import os
import tempfile
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import Array, PathLike, mesh_of, rows, triangles
from ._error import invalid, warn
from ._options import Material, Unit, material as a_material
from ._run import Progress, running

if TYPE_CHECKING:
    from ._image import Image
    from ._inspect import Inspection


class Model:
    """A scene: meshes, materials, lights and cameras. Made by `load` or `Mesh`; it does not change."""

    _native: _taotie.Model
    _path: str | None

    def __init__(self, native: _taotie.Model, path: str | None = None) -> None:
        self._native, self._path = native, path

    @property
    def path(self) -> str | None:
        """The file that it was read from; None in memory."""
        return self._path

    @property
    def triangles(self) -> int:
        """The number of triangles over all instances."""
        return self._native.triangles()

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """The least and the greatest corner, ``(2, 3)``, world space; NaN without triangles."""
        bounds = self._native.bounds()
        return np.full((2, 3), np.nan) if bounds is None else np.array(bounds)

    @property
    def warnings(self) -> tuple[tuple[str, int], ...]:
        """What was wrong with the file, or is left out of it, and how often."""
        return tuple(self._native.warnings())

    def arrays(self) -> dict[str, Array]:
        """Return all triangles as one mesh in world space.

        Returns
        -------
        dict
            ``vertices`` (n, 3) float32, ``faces`` (m, 3) uint32, ``normals`` (n, 3), and where there are any ``uvs``
            (n, 2) with their origin top left, ``tangents`` (n, 4) and ``colors`` (n, 4), linear RGBA.
        """
        return self._native.arrays()

    def with_material(self, material: Material | PathLike) -> Model:
        """Return the same model of another material; a name is that of a preset or a TOML file."""
        return Model(self._native.dressed(a_material(material)._options()))

    def inspect(self) -> Inspection:
        """Return what the model holds and what is wrong with it."""
        from ._inspect import inspection

        return inspection(self)

    def glb(self) -> bytes:
        """Return the scene as a GLB. What glTF cannot say is warned of."""
        data, left = self._native.glb()
        warn(left)
        return data

    def to_trimesh(self) -> Any:
        """Return a ``trimesh.Trimesh`` in world space; its uvs have their origin bottom left."""
        import trimesh

        arrays = self.arrays()
        uvs = arrays.get("uvs")
        visual = None if uvs is None else trimesh.visual.TextureVisuals(uv=uvs * [1.0, -1.0] + [0.0, 1.0])
        return trimesh.Trimesh(
            arrays["vertices"], arrays["faces"], vertex_normals=arrays.get("normals"), visual=visual, process=False
        )

    def to_pyvista(self) -> Any:
        """Return a ``pyvista.PolyData`` in world space."""
        import pyvista

        arrays = self.arrays()
        mesh = pyvista.PolyData.from_regular_faces(arrays["vertices"], arrays["faces"].astype(np.int64))
        mesh.point_data["Normals"] = arrays["normals"]
        if "uvs" in arrays:
            mesh.active_texture_coordinates = arrays["uvs"] * [1.0, -1.0] + [0.0, 1.0]
        return mesh

    def _preview(self) -> Image:
        from ._render import render

        return render(self, size=(480, 480), env="studio", background="transparent")

    def _repr_png_(self) -> bytes | None:
        return self._preview()._repr_png_()

    def __repr__(self) -> str:
        name = "" if self._path is None else f"{self._path!r}, "
        return f"<taotie.{type(self).__name__} {name}{self.triangles} triangles>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_glb, (self._native.glb()[0], self._path)


class Mesh(Model):
    """A model of one mesh, made of arrays. They are copied once, and rounded where they are float64.

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
        Linear RGB or RGBA, ``(n, 3)`` or ``(n, 4)``.
    material : Material or str, optional
        What it is made of; a name is that of a preset or a TOML file.

    Raises
    ------
    Error
        For another shape or dtype, an index out of range, and a number that is not finite.
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
        arrays: dict[str, Any] = {
            "vertices": rows("vertices", vertices, (3,)),
            "faces": triangles("faces", faces),
            "normals": None if normals is None else rows("normals", normals, (3,)),
            "uvs": None if uvs is None else rows("uvs", uvs, (2,)),
            "colors": None if colors is None else _rgba(rows("colors", colors, (3, 4))),
        }
        request = {"material": a_material(material)._options()}
        super().__init__(_taotie.model_of_arrays(arrays, request))


def _rgba(colors: Array) -> Array:
    if colors.shape[1] == 4:
        return colors
    return np.ascontiguousarray(np.concatenate([colors, np.ones((len(colors), 1), colors.dtype)], axis=1))


def _from_glb(data: bytes, path: str | None) -> Model:
    with tempfile.TemporaryDirectory(prefix="taotie-") as folder:
        file = os.path.join(folder, "model.glb")
        with open(file, "wb") as opened:
            opened.write(data)
        with running(None, None) as run:
            return Model(_taotie.load(file, {}, run).without_file(), path)


def scan_options(crease_angle: float | None, green: str, unit: str | None) -> dict[str, Any]:
    """Return how a scan is read, as native options."""
    if unit not in (None, "mm", "cm", "m", "in"):
        raise invalid(f"unit {unit!r}", "give mm, cm, m or in")
    if green not in ("auto", "up", "down"):
        raise invalid(f"scan_green {green!r}", "give auto, up or down")
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
    """Read a model: glTF, GLB, OBJ, PLY or STL.

    Parameters
    ----------
    path : str or path
        The file.
    material : Material or str, optional
        What its materials are made of; a name is that of a preset or a TOML file.
    crease_angle : float, optional
        For a scan without normals, or with one for each facet: the angle between facets from which an edge is hard,
        degrees; 0 keeps all facets flat. By default only the hard edges of modelled shapes are kept.
    scan_green : {"auto", "up", "down"}
        Direction of green in the normal maps of a scan; auto trusts the file unless the pixels contradict it.
    unit : {"mm", "cm", "m", "in"}, optional
        Unit of the coordinates of a scan, also of one in glTF that is not in metres. By default the metre for glTF, else
        unknown.
    memory_limit : str, optional
        The most memory to use, such as ``"4G"``; what the machine has free if not given.
    allow_outside : bool
        Read the files that the model names outside its own folder too.
    progress : bool or callable, optional
        True for a bar; a callable gets stage and fraction, and stops the work by returning False.

    Returns
    -------
    Model

    Raises
    ------
    Error
        With ``path``, ``where`` and ``remedy``.

    Warns
    -----
    TaotieWarning
        Of what was wrong with the file and could be mended, or is left out.
    """
    request = {
        "material": a_material(material)._options(),
        "scan": scan_options(crease_angle, scan_green, unit),
        "memory_limit": memory_limit,
        "allow_outside": allow_outside,
    }
    with running(progress, None) as run:
        native = _taotie.load(os.fspath(path), request, run)
    warn(native.warnings())
    return Model(native, None if material is not None else os.fspath(path))


def model(thing: Any, material: Material | PathLike | None = None, bump_scale: float | None = None) -> Model:
    """Return a model from a path, a model, an asset, or a mesh of another package."""
    from ._bake import Asset

    seen: Any = thing.model if isinstance(thing, Asset) else thing
    if isinstance(seen, (str, os.PathLike)):
        seen = load(os.fspath(seen))
    found = seen if isinstance(seen, Model) else _of_other(seen)
    if material is None and bump_scale is None:
        return found
    return Model(found._native.dressed(a_material(material)._options(bump_scale)))


def _of_other(mesh: Any) -> Mesh:
    arrays = mesh_of(mesh)
    if arrays is None:
        wanted = "a path, a Model, a Mesh, an Asset, or a mesh with vertices and faces"
        raise invalid("a model", f"an object of type {type(mesh).__name__}; wanted is {wanted}")
    return Mesh(**arrays)
