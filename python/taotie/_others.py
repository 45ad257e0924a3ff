"""Meshes of trimesh, PyVista and Open3D as models.

Objects are recognised by their classes, since attributes mislead: a trimesh has ``triangles`` too. All three packages
have the origin of UVs at the bottom left.
"""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from ._arrays import Array, affine, image
from ._error import invalid

__all__ = ["ROLES", "WHITE", "Arrays", "Parts", "flip_v", "parts_of"]

Arrays: TypeAlias = dict[str, Any]

#: Textures by role, with their names in trimesh's materials, which are glTF's.
ROLES = {
    "base_color_texture": "baseColorTexture",
    "metallic_roughness_texture": "metallicRoughnessTexture",
    "normal_texture": "normalTexture",
    "occlusion_texture": "occlusionTexture",
    "emissive_texture": "emissiveTexture",
}

#: Textures by role, with their names in Open3D's materials.
_OPEN3D_ROLES = {
    "base_color_texture": "albedo",
    "normal_texture": "normal",
    "occlusion_texture": "ambient_occlusion",
}

#: The material of meshes without one, whose faces are often wound inconsistently.
_BARE = {"double_sided": True}
WHITE = [1.0, 1.0, 1.0, 1.0]


class Parts:
    """A scene for the native module: meshes, materials and images, each once, and counts of what was left out."""

    def __init__(self) -> None:
        self.meshes: list[Arrays] = []
        self.materials: list[Arrays] = []
        self.images: list[Any] = []
        self.instances: list[Arrays] = []
        self.left_out: Counter[str] = Counter()
        self._numbers: dict[int, tuple[int, Any]] = {}

    def mesh(self, arrays: Arrays) -> int:
        """Add a mesh; return its number."""
        self.meshes.append(arrays)
        return len(self.meshes) - 1

    def material(self, factors: Mapping[str, Any], textures: Mapping[str, Any] | None = None) -> int:
        """Add a material with its images by role; return its number."""
        used = {role: self._image(role, texture) for role, texture in (textures or {}).items()}
        self.materials.append({"factors": dict(factors), "textures": used})
        return len(self.materials) - 1

    def place(self, mesh: int, material: int, transform: Any = None) -> None:
        """Place a mesh with a material, by a matrix ``(4, 4)`` from object to world."""
        columns = None if transform is None else affine("transform", transform).T.tolist()
        self.instances.append({"mesh": mesh, "material": material, "world_from_object": columns})

    def leave_out(self, what: str, count: int = 1) -> None:
        """Count something that cannot be carried over."""
        if count:
            self.left_out[what] += count

    def usable_textures(self, textures: Mapping[str, Any], arrays: Arrays) -> dict[str, Any]:
        """Return the textures that a mesh can have: none without UVs."""
        found = {role: texture for role, texture in textures.items() if texture is not None}
        if found and arrays.get("uvs") is None:
            self.leave_out("left out a texture of a mesh without UVs", len(found))
            return {}
        return found

    def _image(self, role: str, texture: Any) -> int:
        if id(texture) not in self._numbers:
            self.images.append(image(role, texture))
            # The image is kept, so that no other can get its id.
            self._numbers[id(texture)] = len(self.images) - 1, texture
        return self._numbers[id(texture)][0]


def parts_of(thing: Any) -> Parts | None:
    """Return the parts of a mesh or scene of another package, or of an object with ``vertices`` and ``faces``."""
    parts = Parts()
    for kind in type(thing).__mro__:
        package = kind.__module__.partition(".")[0]
        reader = _READERS.get((package, kind.__name__))
        if reader is not None:
            reader(parts, thing)
            break
    else:
        if not (hasattr(thing, "vertices") and hasattr(thing, "faces")):
            return None
        arrays = {"vertices": thing.vertices, "faces": thing.faces}
        parts.place(parts.mesh(arrays), parts.material(_look(False)))
    if not parts.instances:
        raise invalid(f"model of type {type(thing).__name__}", "it has no triangles; expected a mesh")
    return parts


def _look(is_colored: bool) -> Arrays:
    """Return the factors of a mesh without a material: white if it has colours or textures."""
    return {**_BARE, "base_color": WHITE} if is_colored else dict(_BARE)


def flip_v(uvs: Any) -> npt.NDArray[np.float64]:
    """Convert UVs between origins at the bottom left and at the top left."""
    flipped: npt.NDArray[np.float64] = np.asarray(uvs, dtype=np.float64)[:, :2] * [1.0, -1.0] + [0.0, 1.0]
    return flipped


# Splitting of vertices: our meshes have one of everything per vertex.


def _with_face_colors(arrays: Arrays, colors: Array) -> Arrays:
    """Return a mesh with a colour for each face, with vertices split where faces of different colours meet."""
    _, kinds = np.unique(colors, axis=0, return_inverse=True)
    corner = np.repeat(kinds.reshape(-1), 3)
    found, first = _split(arrays, [corner])
    found["colors"] = np.repeat(colors, 3, axis=0)[first]
    return found


def _with_corner_uvs(arrays: Arrays, uvs: Array) -> Arrays:
    """Return a mesh with UVs for each corner of each face, ``(3 m, 2)``, with vertices split along seams."""
    found, first = _split(arrays, [uvs[:, 0], uvs[:, 1]])
    found["uvs"] = uvs[first]
    return found


def _split(arrays: Arrays, values: Sequence[Array]) -> tuple[Arrays, Array]:
    """Return a mesh with a vertex for each vertex and value of its corners, and the first corner of each."""
    faces = np.asarray(arrays["faces"])
    corners = faces.reshape(-1)
    order = np.lexsort((*values, corners))
    is_new = np.zeros(len(order), bool)
    is_new[:1] = True
    for one in (corners, *values):
        ordered = one[order]
        is_new[1:] |= ordered[1:] != ordered[:-1]
    split = np.empty(len(order), np.int64)
    split[order] = np.cumsum(is_new) - 1
    first = order[is_new]
    return _taken(arrays, corners[first], split.reshape(faces.shape)), first


def _subset(arrays: Arrays, is_used: Array) -> Arrays:
    """Return the mesh of some faces, with the vertices that they use."""
    faces = np.asarray(arrays["faces"])[is_used]
    used, split = np.unique(faces, return_inverse=True)
    return _taken(arrays, used, split.reshape(faces.shape))


def _taken(arrays: Arrays, vertices: Array, faces: Array) -> Arrays:
    taken = {name: np.asarray(array)[vertices] for name, array in arrays.items() if name != "faces" and array is not None}
    return {**taken, "faces": faces}


# trimesh


def _scene_of_trimesh(parts: Parts, scene: Any) -> None:
    numbers: dict[str, list[tuple[int, int]]] = {}
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        geometry = scene.geometry[name]
        if not hasattr(geometry, "faces"):
            parts.leave_out("left out a geometry without faces")
            continue
        if name not in numbers:
            numbers[name] = _meshes_of_trimesh(parts, geometry)
        for mesh, material in numbers[name]:
            parts.place(mesh, material, transform)


def _of_trimesh(parts: Parts, mesh: Any) -> None:
    for number, material in _meshes_of_trimesh(parts, mesh):
        parts.place(number, material)


def _meshes_of_trimesh(parts: Parts, mesh: Any) -> list[tuple[int, int]]:
    """Add a mesh, or one for each of its materials; return their numbers with those of the materials."""
    arrays: Arrays = {"vertices": np.asarray(mesh.vertices), "faces": np.asarray(mesh.faces)}
    # Only normals that have been set or asked for: trimesh's own exporters do the same.
    if "vertex_normals" in mesh._cache:
        arrays["normals"] = np.asarray(mesh.vertex_normals)
    visual = mesh.visual
    if visual.kind != "texture":
        if visual.kind == "vertex":
            arrays["colors"] = np.asarray(visual.vertex_colors)
        elif visual.kind == "face":
            arrays = _with_face_colors(arrays, np.asarray(visual.face_colors))
        return [(parts.mesh(arrays), parts.material(_look("colors" in arrays)))]
    if visual.uv is not None and len(visual.uv) == len(arrays["vertices"]):
        arrays["uvs"] = flip_v(visual.uv)
    colors = visual.vertex_attributes.get("color")
    if colors is not None and len(colors) == len(arrays["vertices"]):
        arrays["colors"] = _linear_share(np.asarray(colors))
    listed = getattr(visual.material, "materials", None)
    if listed is None:
        return [(parts.mesh(arrays), _material_of_trimesh(parts, visual.material, arrays))]
    kinds = getattr(visual, "face_materials", None)
    kinds = np.zeros(len(arrays["faces"]), int) if kinds is None else np.asarray(kinds)
    found = []
    for kind in np.unique(kinds):
        own = _subset(arrays, kinds == kind)
        found.append((parts.mesh(own), _material_of_trimesh(parts, listed[kind], own)))
    return found


def _linear_share(colors: Array) -> Array:
    """Return colours of a glTF file as trimesh keeps them: linear, and integers are shares of their maximum."""
    return colors if colors.dtype.kind == "f" else colors.astype(np.float64) / np.iinfo(colors.dtype).max


def _material_of_trimesh(parts: Parts, material: Any, arrays: Arrays) -> int:
    if not hasattr(material, "baseColorFactor"):
        return _simple_material(parts, material, arrays)
    factors: Arrays = {
        "name": material.name or "",
        "base_color": WHITE if material.baseColorFactor is None else _fractions(material.baseColorFactor),
        "metallic": _default(material.metallicFactor, 1.0),
        "roughness": _default(material.roughnessFactor, 1.0),
        "emissive": [float(x) for x in _default(material.emissiveFactor, (0.0, 0.0, 0.0))],
        "alpha": material.alphaMode or "OPAQUE",
        "alpha_cutoff": _default(material.alphaCutoff, 0.5),
        "double_sided": bool(material.doubleSided),
    }
    textures = {role: getattr(material, name) for role, name in ROLES.items()}
    return parts.material(factors, parts.usable_textures(textures, arrays))


def _default(value: Any, default: Any) -> Any:
    return default if value is None else value


def _fractions(codes: Any) -> list[float]:
    """Return factors in [0, 1] from the codes in which trimesh keeps them; they are linear, as in glTF and OBJ."""
    return [int(code) / 255.0 for code in codes]


def _simple_material(parts: Parts, material: Any, arrays: Arrays) -> int:
    """Add the material of an OBJ file, as our own reader does."""
    textures = parts.usable_textures({"base_color_texture": getattr(material, "image", None)}, arrays)
    color = _fractions(_default(getattr(material, "diffuse", None), (255, 255, 255, 255)))
    # With a texture, black and trimesh's default grey mean that no colour was given.
    if textures and (max(color[:3]) == 0.0 or color == _fractions((102, 102, 102, 255))):
        color = WHITE
    factors = {**_BARE, "name": getattr(material, "name", None) or "", "base_color": color}
    shininess = getattr(material, "_glossiness", None)
    if shininess is not None:
        factors["roughness"] = (2 / (max(shininess, 0.0) + 2)) ** 0.25
    if color[3] < 1.0:
        factors["alpha"] = "BLEND"
    return parts.material(factors, textures)


# PyVista


def _blocks_of_pyvista(parts: Parts, blocks: Any) -> None:
    for block in blocks:
        if block is None:
            continue
        (_blocks_of_pyvista if hasattr(block, "n_blocks") else _of_pyvista)(parts, block)


def _of_pyvista(parts: Parts, data: Any) -> None:
    mesh = data if hasattr(data, "is_all_triangles") else _surface(data)
    lost = int(mesh.n_lines) + int(mesh.n_verts)
    parts.leave_out("left out a line or point of a mesh", lost)
    if lost or not mesh.is_all_triangles:
        mesh = mesh.triangulate()
    if not mesh.n_cells:
        return
    arrays: Arrays = {"vertices": np.asarray(mesh.points), "faces": np.asarray(mesh.regular_faces)}
    normals = mesh.point_data.active_normals
    if normals is not None:
        arrays["normals"] = np.asarray(normals)
    uvs = mesh.active_texture_coordinates
    if uvs is not None:
        arrays["uvs"] = flip_v(uvs)
    colors = _colors_of_pyvista(parts, mesh.point_data)
    of_faces = None if colors is not None else _colors_of_pyvista(parts, mesh.cell_data)
    if colors is not None:
        arrays["colors"] = colors
    elif of_faces is not None:
        arrays = _with_face_colors(arrays, of_faces)
    parts.place(parts.mesh(arrays), parts.material(_look("colors" in arrays)))


def _surface(data: Any) -> Any:
    with warnings.catch_warnings():
        # Newer versions want an argument that older ones do not have.
        warnings.simplefilter("ignore")
        return data.extract_surface()


def _colors_of_pyvista(parts: Parts, data: Any) -> Array | None:
    """Return the colours among the arrays of a mesh: RGB or RGBA of uint8, the active ones first."""
    names = [name for name in (data.active_scalars_name, *data.keys()) if name in data.keys()]
    found = {name: np.asarray(data[name]) for name in names}
    for array in found.values():
        if array.dtype == np.uint8 and array.ndim == 2 and array.shape[1] in (3, 4):
            return array
    other = [name for name in found if name.lower() in ("rgb", "rgba", "color", "colors")]
    parts.leave_out("left out colours of a PyVista mesh that are not uint8", len(other))
    return None


# Open3D


def _of_open3d(parts: Parts, mesh: Any) -> None:
    if ".t.geometry" in type(mesh).__module__:
        _of_open3d_tensors(parts, mesh.cpu())
        return
    arrays: Arrays = {"vertices": np.asarray(mesh.vertices), "faces": np.asarray(mesh.triangles)}
    if mesh.has_vertex_normals():
        arrays["normals"] = np.asarray(mesh.vertex_normals)
    if mesh.has_vertex_colors():
        arrays["colors"] = _decoded(np.asarray(mesh.vertex_colors))
    if mesh.has_triangle_uvs():
        arrays = _with_corner_uvs(arrays, flip_v(mesh.triangle_uvs))
    # Their first row is the bottom one.
    images = [None if one.is_empty() else np.asarray(one)[::-1] for one in mesh.textures]
    look = _look(bool(images) or "colors" in arrays)
    kinds = np.asarray(mesh.triangle_material_ids)
    if len(images) < 2 or len(kinds) != len(arrays["faces"]):
        textures = {"base_color_texture": images[0] if images else None}
        parts.leave_out("left out a texture that no triangle refers to", len(images[1:]))
        parts.place(parts.mesh(arrays), parts.material(look, parts.usable_textures(textures, arrays)))
        return
    for kind in np.unique(kinds):
        own = _subset(arrays, kinds == kind)
        textures = {"base_color_texture": images[kind] if 0 <= kind < len(images) else None}
        parts.place(parts.mesh(own), parts.material(look, parts.usable_textures(textures, own)))


def _of_open3d_tensors(parts: Parts, mesh: Any) -> None:
    vertex = {name: mesh.vertex[name].numpy() for name in mesh.vertex}
    face = {name: mesh.triangle[name].numpy() for name in mesh.triangle}
    arrays: Arrays = {"vertices": vertex["positions"], "faces": face["indices"], "normals": vertex.get("normals")}
    if "colors" in vertex:
        arrays["colors"] = _decoded(vertex["colors"])
    if "texture_uvs" in face:
        arrays = _with_corner_uvs(arrays, flip_v(face["texture_uvs"].reshape(-1, 2)))
    elif "texture_uvs" in vertex:
        arrays["uvs"] = flip_v(vertex["texture_uvs"])
    if "colors" in face and "colors" not in vertex:
        arrays = _with_face_colors(arrays, _decoded(face["colors"]))
    factors = _look("colors" in arrays)
    textures: dict[str, Any] = {}
    if mesh.has_valid_material():
        factors |= _factors_of_open3d(mesh.material)
        maps = {name: mesh.material.texture_maps[name].as_tensor().numpy() for name in mesh.material.texture_maps}
        textures = _textures_of_open3d(parts, maps)
    parts.place(parts.mesh(arrays), parts.material(factors, parts.usable_textures(textures, arrays)))


def _factors_of_open3d(material: Any) -> Arrays:
    numbers, vectors = material.scalar_properties, material.vector_properties
    factors: Arrays = {name: float(numbers[name]) for name in ("metallic", "roughness") if name in numbers}
    if "base_color" in vectors:
        factors["base_color"] = [float(x) for x in vectors["base_color"]]
    if "emissive_color" in vectors:
        factors["emissive"] = [float(x) for x in vectors["emissive_color"]][:3]
    return factors


def _first_share(texture: Array) -> Array:
    """Return the first channel of a texture, with integers as shares of their maximum."""
    first = texture.reshape(*texture.shape[:2], -1)[:, :, 0]
    return _linear_share(first).astype(np.float32)


def _textures_of_open3d(parts: Parts, maps: dict[str, Array]) -> dict[str, Any]:
    textures = {role: maps.pop(name) for role, name in _OPEN3D_ROLES.items() if name in maps}
    packed = maps.pop("ao_rough_metal", None)
    if packed is not None:
        textures["occlusion_texture"] = textures["metallic_roughness_texture"] = packed
    else:
        rough, metal = maps.pop("roughness", None), maps.pop("metallic", None)
        single = [one for one in (rough, metal) if one is not None]
        if single and len({one.shape[:2] for one in single}) == 1:
            ones = np.ones(single[0].shape[:2], np.float32)
            channels = [ones if one is None else _first_share(one) for one in (rough, metal)]
            textures["metallic_roughness_texture"] = np.dstack([ones, *channels])
        else:
            parts.leave_out("left out textures of roughness and metalness of different sizes", len(single))
    for name in maps:
        parts.leave_out(f"left out Open3D's texture {name}")
    return textures


def _decoded(colors: Array) -> Array:
    """Return colours of Open3D, which are sRGB codes or these as floats in [0, 1], as codes or linear floats."""
    if colors.dtype == np.uint8:
        return colors
    colors = np.asarray(colors, dtype=np.float64)
    rgb = colors[:, :3]
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((np.maximum(rgb, 0.0) + 0.055) / 1.055) ** 2.4)
    return np.concatenate([linear, colors[:, 3:]], axis=1)


_Reader = Callable[[Parts, Any], None]

#: The readers by package and class.
_READERS: dict[tuple[str, str], _Reader] = {
    ("trimesh", "Trimesh"): _of_trimesh,
    ("trimesh", "Scene"): _scene_of_trimesh,
    ("pyvista", "DataSet"): _of_pyvista,
    ("pyvista", "MultiBlock"): _blocks_of_pyvista,
    ("open3d", "TriangleMesh"): _of_open3d,
}
