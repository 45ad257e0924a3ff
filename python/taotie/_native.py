"""Native models: from paths, from arrays, and from objects that have one."""

from __future__ import annotations

import os
from typing import Any, Protocol, runtime_checkable

import numpy.typing as npt

from . import _taotie
from ._arrays import PathLike, colors as rgba, rows, triangles
from ._error import invalid, invalid_type, warn
from ._material import Material, material as a_material
from ._others import WHITE, Parts, parts_of
from ._run import running


@runtime_checkable
class HasModel(Protocol):
    """An object with a native model: a `Model` or an `Asset`."""

    def _native_model(self) -> _taotie.Model: ...


def native_model(
    thing: Any, material: Material | PathLike | None = None, bump_scale: float | None = None
) -> _taotie.Model:
    """Return the native model of a path, a model, an asset, or a mesh of another package."""
    if isinstance(thing, HasModel):
        found = thing._native_model()
    elif isinstance(thing, (str, os.PathLike)):
        with running(None, None) as run:
            found = _taotie.load(os.fspath(thing), {"material": a_material(None)._request(), "options": {}}, run)
        warn(found.warnings())
    else:
        found = _of_other(thing)
    if material is None and bump_scale is None:
        return found
    return found.dressed(a_material(material)._request(bump_scale))


def native_of_arrays(
    vertices: npt.ArrayLike,
    faces: npt.ArrayLike,
    normals: npt.ArrayLike | None = None,
    uvs: npt.ArrayLike | None = None,
    colors: npt.ArrayLike | None = None,
    *,
    material: Material | PathLike | None = None,
) -> _taotie.Model:
    """Return the native model of a mesh, with parameters as for `Mesh`."""
    parts = Parts()
    # Vertex colours and textures are the surface's own, not tints of the default grey.
    is_colored = colors is not None or a_material(material).base_color_map is not None
    look = parts.material({"base_color": WHITE} if is_colored else {})
    given = {"vertices": vertices, "faces": faces, "normals": normals, "uvs": uvs, "colors": colors}
    parts.place(parts.mesh(given), look)
    return native_of_parts(parts, material)


def native_of_parts(parts: Parts, material: Material | PathLike | None = None) -> _taotie.Model:
    """Return the native model of meshes, materials and images; issue the warnings about omissions."""
    warn(parts.left_out.items())
    checked = {
        "meshes": [_checked(mesh) for mesh in parts.meshes],
        "materials": parts.materials,
        "images": parts.images,
        "instances": parts.instances,
    }
    return _taotie.model_of_parts(checked, a_material(material)._request())


def _checked(mesh: dict[str, Any]) -> dict[str, Any]:
    """Return the arrays of a mesh in the form that the native module takes."""
    vertices = rows("vertices", mesh["vertices"], (3,))
    arrays: dict[str, Any] = {"vertices": vertices, "faces": triangles("faces", mesh["faces"], len(vertices))}
    normals, uvs, colors = (mesh.get(name) for name in ("normals", "uvs", "colors"))
    arrays["normals"] = None if normals is None else rows("normals", normals, (3,))
    arrays["uvs"] = None if uvs is None else rows("uvs", uvs, (2,))
    arrays["colors"] = None if colors is None else rgba("colors", colors)
    for name in ("normals", "uvs", "colors"):
        array = arrays[name]
        if array is not None and len(array) != len(vertices):
            raise invalid(name, f"{len(array)} rows; expected {len(vertices)}, one for each vertex")
    return arrays


def _of_other(mesh: Any) -> _taotie.Model:
    parts = parts_of(mesh)
    if parts is None:
        wanted = "a path, a Model, a Mesh, an Asset, a mesh of trimesh, Open3D or PyVista, or one with vertices and faces"
        raise invalid_type("model", mesh, wanted)
    return native_of_parts(parts)
