"""Models as meshes of trimesh, PyVista and Open3D."""

from __future__ import annotations

import importlib
import json
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ._arrays import Array
from ._error import warn
from ._others import ROLES, Arrays, flip_v

__all__ = ["to_open3d", "to_pyvista", "to_trimesh"]


# The base colour of a material that states none.
_PLAIN = np.array([0.6, 0.6, 0.6, 1.0], np.float32)


class _Joined:
    """The parts of a native model as one mesh, with a material for each face."""

    def __init__(self, parts: Sequence[Arrays]) -> None:
        self.parts = parts
        self.vertices = self._all("vertices", 3, 0.0)
        starts = np.cumsum([0, *(len(part["vertices"]) for part in parts)])
        faces = [part["faces"].astype(np.int64) + start for part, start in zip(parts, starts)]
        self.faces = np.concatenate(faces) if faces else np.empty((0, 3), np.int64)
        self.normals = self._all("normals", 3, 0.0)
        self.uvs = self._all("uvs", 2, 0.0) if any("uvs" in part for part in parts) else None
        self.has_colors = any("colors" in part for part in parts)
        self.factors: list[Arrays] = [json.loads(part["factors"]) for part in parts]
        self.kinds = np.repeat(np.arange(len(parts)), [len(part["faces"]) for part in parts])
        self.is_plain = all(part["is_plain"] for part in parts)
        self.left_out: Counter[str] = Counter()

    def _all(self, name: str, width: int, missing: float) -> npt.NDArray[np.float32]:
        given = [part.get(name, np.full((len(part["vertices"]), width), missing, np.float32)) for part in self.parts]
        return np.concatenate(given) if given else np.empty((0, width), np.float32)

    def colors(self) -> npt.NDArray[np.float32]:
        """The vertex colours, linear RGBA."""
        return self._all("colors", 4, 1.0)

    def surface_colors(self) -> npt.NDArray[np.uint8] | None:
        """The vertex colours times those of the materials, as sRGB codes; None if there are none."""
        tints = [np.asarray(factors["base_color"], np.float32) for factors in self.factors]
        is_textured = all("base_color_texture" in part["textures"] for part in self.parts)
        is_same = all(np.array_equal(tint, tints[0]) for tint in tints)
        if not self.has_colors and is_same and (is_textured or np.array_equal(tints[0], _PLAIN)):
            return None
        tint = np.repeat(tints, [len(part["vertices"]) for part in self.parts], axis=0)
        return _codes(self.colors() * tint)


def _codes(linear: Array) -> npt.NDArray[np.uint8]:
    """Return linear colours, of one to four channels, as sRGB codes; alpha stays linear."""
    clipped = np.clip(linear.astype(np.float64), 0.0, 1.0)
    colors = linear.shape[-1] - (linear.shape[-1] % 2 == 0)
    seen = clipped[..., :colors]
    encoded = np.where(seen <= 0.0031308, seen * 12.92, 1.055 * seen ** (1 / 2.4) - 0.055)
    return np.rint(np.concatenate([encoded, clipped[..., colors:]], axis=-1) * 255.0).astype(np.uint8)


def to_trimesh(parts: Sequence[Arrays], left_out: Sequence[tuple[str, int]]) -> Any:
    """Return the parts of a native model as a ``trimesh.Trimesh``."""
    trimesh: Any = importlib.import_module("trimesh")
    joined = _Joined(parts)
    visual: Any
    if joined.uvs is None and joined.is_plain:
        colors = joined.surface_colors()
        visual = None if colors is None else trimesh.visual.ColorVisuals(vertex_colors=colors)
    else:
        materials = [_to_trimesh_material(joined, number) for number in range(len(parts))]
        several = {} if len(materials) == 1 else {"face_materials": joined.kinds}
        whole = materials[0] if len(materials) == 1 else trimesh.visual.material.MultiMaterial(materials)
        uvs = None if joined.uvs is None else flip_v(joined.uvs)
        visual = trimesh.visual.TextureVisuals(uv=uvs, material=whole, **several)
        if joined.has_colors:
            # Linear codes, as trimesh reads them from glTF, and writes them there.
            visual.vertex_attributes["color"] = np.rint(np.clip(joined.colors(), 0, 1) * 255).astype(np.uint8)
    warn([*left_out, *joined.left_out.items()], stacklevel=4)
    normals = joined.normals if len(joined.normals) else None
    return trimesh.Trimesh(joined.vertices, joined.faces, vertex_normals=normals, visual=visual, process=False)


def _to_trimesh_material(joined: _Joined, number: int) -> Any:
    trimesh: Any = importlib.import_module("trimesh")
    factors, part = joined.factors[number], joined.parts[number]
    given: dict[str, Any] = {
        "name": factors["name"] or None,
        "baseColorFactor": np.rint(np.clip(factors["base_color"], 0, 1) * 255).astype(np.uint8),
        "metallicFactor": factors["metallic"],
        "roughnessFactor": factors["roughness"],
        "emissiveFactor": factors["emissive"] if any(factors["emissive"]) else None,
        "alphaMode": factors["alpha"],
        "alphaCutoff": factors["alpha_cutoff"] if factors["alpha"] == "MASK" else None,
        "doubleSided": factors["double_sided"],
    }
    for role, texels in part["textures"].items():
        if role in ROLES:
            given[ROLES[role]] = _to_pil(joined, _eight_bits(role, texels, part["is_green_down"]))
        else:
            joined.left_out[f"left out a {role.replace('_', ' ')}, which trimesh does not support"] += 1
    for name in ("normal_scale", "occlusion_strength"):
        if factors[name] != 1.0:
            joined.left_out[f"left out a {name.replace('_', ' ')}, which trimesh does not support"] += 1
    return trimesh.visual.material.PBRMaterial(**given)


def _eight_bits(role: str, texels: Array, is_green_down: bool) -> npt.NDArray[np.uint8]:
    """Return texels with 8 bits per channel, and green up."""
    if texels.dtype == np.float32:
        # Floats are linear in every texture.
        is_color = role in ("base_color_texture", "emissive_texture")
        channels = texels.reshape(*texels.shape[:2], -1)
        texels = _codes(channels).reshape(texels.shape) if is_color else np.rint(np.clip(texels, 0, 1) * 255).astype(np.uint8)
    elif texels.dtype == np.uint16:
        texels = np.rint(texels / 257.0).astype(np.uint8)
    if role == "normal_texture" and is_green_down:
        texels = texels.copy()
        texels[:, :, 1] = 255 - texels[:, :, 1]
    return texels


def _to_pil(joined: _Joined, texels: npt.NDArray[np.uint8]) -> Any:
    try:
        from PIL import Image
    except ImportError:
        joined.left_out["left out a texture, since Pillow is not installed"] += 1
        return None
    return Image.fromarray(np.ascontiguousarray(texels))


def to_pyvista(parts: Sequence[Arrays], omitted: Sequence[tuple[str, int]]) -> Any:
    """Return the parts of a native model as a ``pyvista.PolyData``."""
    pyvista: Any = importlib.import_module("pyvista")
    joined = _Joined(parts)
    mesh = pyvista.PolyData.from_regular_faces(joined.vertices, joined.faces)
    if len(joined.normals):
        mesh.point_data["Normals"] = joined.normals
        mesh.point_data.active_normals_name = "Normals"
    if joined.uvs is not None:
        mesh.active_texture_coordinates = flip_v(joined.uvs)
    colors = joined.surface_colors()
    if colors is not None:
        mesh.point_data["RGBA"] = colors
        mesh.set_active_scalars("RGBA", preference="point")
    textures = sum(len(part["textures"]) for part in parts)
    others = sum(not part["is_plain"] and not part["textures"] for part in parts)
    left_out = [pair for pair in omitted if "texture" not in pair[0]]
    left_out.append(("left out a texture: a PyVista mesh holds none; pass it to plotter.add_mesh", textures))
    left_out.append(("left out a material's metalness, roughness and layers: a PyVista mesh holds none", others))
    warn(left_out, stacklevel=4)
    return mesh


def to_open3d(parts: Sequence[Arrays], omitted: Sequence[tuple[str, int]]) -> Any:
    """Return the parts of a native model as an ``open3d.geometry.TriangleMesh``."""
    open3d: Any = importlib.import_module("open3d")
    joined, vectors = _Joined(parts), open3d.utility
    mesh = open3d.geometry.TriangleMesh(
        vectors.Vector3dVector(joined.vertices.astype(np.float64)), vectors.Vector3iVector(joined.faces.astype(np.int32))
    )
    mesh.vertex_normals = vectors.Vector3dVector(joined.normals.astype(np.float64))
    colors = joined.surface_colors()
    if colors is not None:
        mesh.vertex_colors = vectors.Vector3dVector(colors[:, :3] / 255.0)
    images = [_color_image(part) for part in parts]
    if joined.uvs is not None and any(image is not None for image in images):
        mesh.triangle_uvs = vectors.Vector2dVector(flip_v(joined.uvs)[joined.faces.reshape(-1)])
        # Its first row is the bottom one.
        white = np.full((1, 1, 3), 255, np.uint8)
        flipped = [np.ascontiguousarray((white if image is None else image)[::-1]) for image in images]
        mesh.textures = [open3d.geometry.Image(image) for image in flipped]
        mesh.triangle_material_ids = vectors.IntVector(joined.kinds.astype(np.int32))
    others = sum(len(part["textures"]) for part in parts) - sum(image is not None for image in images)
    factors = sum(not part["is_plain"] for part in parts)
    other = "left out a texture other than of the base colour: Open3D's TriangleMesh holds none"
    left_out = [*omitted, (other, others)]
    left_out.append(("left out a material's factors: Open3D's TriangleMesh holds none", factors))
    warn(left_out, stacklevel=4)
    return mesh


def _color_image(part: Arrays) -> npt.NDArray[np.uint8] | None:
    """Return the texture of the base colour, RGB."""
    texels = part["textures"].get("base_color_texture")
    if texels is None:
        return None
    texels = _eight_bits("base_color_texture", texels, False)
    if texels.ndim == 2 or texels.shape[2] < 3:
        grey = texels.reshape(*texels.shape[:2], -1)[:, :, :1]
        return np.repeat(grey, 3, axis=2)
    return texels[:, :, :3]
