"""Native models: from paths, from arrays, and from objects that have one."""

from __future__ import annotations

import os
from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import Array, PathLike, mesh_of, rows, triangles
from ._error import invalid, warn
from ._options import Material, material as a_material
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
            found = _taotie.load(os.fspath(thing), {"material": a_material(None)._options()}, run)
        warn(found.warnings())
    else:
        found = _of_other(thing)
    if material is None and bump_scale is None:
        return found
    return found.dressed(a_material(material)._options(bump_scale))


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
    arrays: dict[str, Any] = {
        "vertices": rows("vertices", vertices, (3,)),
        "faces": triangles("faces", faces),
        "normals": None if normals is None else rows("normals", normals, (3,)),
        "uvs": None if uvs is None else rows("uvs", uvs, (2,)),
        "colors": None if colors is None else _rgba(rows("colors", colors, (3, 4))),
    }
    request = {"material": a_material(material)._options()}
    return _taotie.model_of_arrays(arrays, request)


def _rgba(colors: Array) -> Array:
    if colors.shape[1] == 4:
        return colors
    return np.ascontiguousarray(np.concatenate([colors, np.ones((len(colors), 1), colors.dtype)], axis=1))


def _of_other(mesh: Any) -> _taotie.Model:
    arrays = mesh_of(mesh)
    if arrays is None:
        wanted = "a path, a Model, a Mesh, an Asset, or a mesh with vertices and faces"
        raise invalid("a model", f"an object of type {type(mesh).__name__}; expected {wanted}")
    return native_of_arrays(**arrays)
