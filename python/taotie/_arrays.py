"""Checked conversion of arrays, and of meshes from other packages."""

from __future__ import annotations

import os
from typing import Any, TypeAlias, Union

import numpy as np
import numpy.typing as npt

from ._error import Error, invalid

Array: TypeAlias = npt.NDArray[Any]
PathLike: TypeAlias = Union[str, "os.PathLike[str]"]


def rows(name: str, values: npt.ArrayLike, widths: tuple[int, ...]) -> Array:
    """Return rows of numbers as a contiguous float32 or float64 array; refuse everything else."""
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] not in widths:
        wanted = " or ".join(f"(n, {width})" for width in widths)
        raise invalid(name, f"an array of shape {array.shape}, dtype {array.dtype}; expected {wanted}, float32 or float64")
    if array.dtype.kind in "iu":
        array = array.astype(np.float64)
    if array.dtype not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise invalid(name, f"an array of dtype {array.dtype}, shape {array.shape}; expected float32 or float64")
    return np.ascontiguousarray(array)


def triangles(name: str, values: npt.ArrayLike) -> npt.NDArray[np.uint32]:
    """Return triangles as a contiguous array of uint32 indices."""
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise invalid(name, f"an array of shape {array.shape}, dtype {array.dtype}; expected (n, 3), uint32 or another integer")
    if array.dtype != np.uint32:
        if array.size and (array.min() < 0 or array.max() > np.iinfo(np.uint32).max):
            raise invalid(name, "an index below 0 or above 2^32 - 1; vertices are numbered from 0")
        array = array.astype(np.uint32)
    return np.ascontiguousarray(array)


def image(name: str, values: Any) -> Any:
    """Return an image in the form that the native module takes: a path, or texels ``(height, width, channels)``.

    Booleans are refused; float64 is rounded to float32; PIL images are converted to arrays.
    """
    if isinstance(values, (str, os.PathLike)):
        return os.fspath(values)
    array = np.asarray(values)
    if array.dtype == np.float64 or array.dtype == np.float16:
        array = array.astype(np.float32)
    if array.ndim == 2:
        array = array[:, :, None]
    known = array.dtype in (np.dtype(np.uint8), np.dtype(np.uint16), np.dtype(np.float32))
    if array.ndim != 3 or not 1 <= array.shape[2] <= 4 or not known:
        raise invalid(
            name,
            f"an array of shape {np.shape(values)}, dtype {np.asarray(values).dtype}; expected (height, width) or "
            "(height, width, 1 to 4), uint8, uint16 or float32",
        )
    return np.ascontiguousarray(array)


def mesh_of(other: Any) -> dict[str, Any] | None:
    """Return the arrays of a mesh from trimesh, Open3D, PyVista, or anything with ``vertices`` and ``faces``."""
    if hasattr(other, "regular_faces") and hasattr(other, "points"):
        return _of_pyvista(other)
    if hasattr(other, "vertices") and hasattr(other, "triangles"):
        return _of_open3d(other)
    if hasattr(other, "vertices") and hasattr(other, "faces"):
        return _of_faces(other)
    if hasattr(other, "to_geometry"):
        return _of_faces(other.to_geometry())
    return None


def _of_faces(mesh: Any) -> dict[str, Any]:
    arrays: dict[str, Any] = {"vertices": np.asarray(mesh.vertices), "faces": np.asarray(mesh.faces)}
    visual: Any = getattr(mesh, "visual", None)
    uv = getattr(visual, "uv", None)
    if uv is not None and len(uv) == len(arrays["vertices"]):
        # Its origin is bottom left.
        arrays["uvs"] = np.asarray(uv, dtype=np.float64)[:, :2] * [1.0, -1.0] + [0.0, 1.0]
    if getattr(visual, "kind", None) == "vertex":
        arrays["colors"] = _linear(np.asarray(visual.vertex_colors) / 255.0)
    return arrays


def _of_open3d(mesh: Any) -> dict[str, Any]:
    arrays: dict[str, Any] = {"vertices": np.asarray(mesh.vertices), "faces": np.asarray(mesh.triangles)}
    if len(getattr(mesh, "vertex_normals", ())):
        arrays["normals"] = np.asarray(mesh.vertex_normals)
    if len(getattr(mesh, "vertex_colors", ())):
        arrays["colors"] = _linear(np.asarray(mesh.vertex_colors))
    return arrays


def _of_pyvista(mesh: Any) -> dict[str, Any]:
    mesh = mesh if mesh.is_all_triangles else mesh.triangulate()
    arrays: dict[str, Any] = {"vertices": np.asarray(mesh.points), "faces": np.asarray(mesh.regular_faces)}
    uv = getattr(mesh, "active_texture_coordinates", None)
    if uv is not None:
        arrays["uvs"] = np.asarray(uv, dtype=np.float64) * [1.0, -1.0] + [0.0, 1.0]
    return arrays


def _linear(srgb: Array) -> Array:
    """Convert sRGB to linear RGBA; alpha is kept, or 1 if missing."""
    rgb = srgb[:, :3]
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    alpha = srgb[:, 3:4] if srgb.shape[1] == 4 else np.ones((len(srgb), 1))
    return np.concatenate([linear, alpha], axis=1)


__all__ = ["Array", "Error", "PathLike", "image", "mesh_of", "rows", "triangles"]
