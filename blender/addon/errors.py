"""The measured error of an asset as colours on its surface."""

import gzip
import json

import bpy
import numpy as np

from .glb import Glb
from .objects import load
from .problem import Problem

# The face attribute of error objects, in degrees; below 0 where nothing was measured.
ERROR = "taotie_error_deg"
# Red, green and blue of texels that were not measured, as in the program's viewer.
UNKNOWN = (96, 96, 96)


class Errors:
    """Angles between the normals of an asset and its scan, one map for each surface, from `taotie view --folder`."""

    def __init__(self, folder):
        data = json.loads(gzip.decompress((folder / "data.bin").read_bytes()))["errors"]
        self.codes = np.frombuffer(gzip.decompress((folder / "errors.bin").read_bytes()), "<u2")
        self.maps, self.top, self.stops, self.steps = data["maps"], data["top"], data["stops"], data["steps"]

    def degrees(self, surface):
        """Returns the map as rows from the top, NaN where nothing was measured; None if there is no map."""
        described = self.maps[surface]
        if described is None:
            return None
        width, height, start = described["width"], described["height"], described["from"]
        codes = self.codes[start : start + width * height].reshape(height, width)
        return np.where(codes == 0xFFFF, np.nan, codes / self.steps)

    def colors(self, degrees):
        """Returns sRGB colours in [0, 1]."""
        places = np.linspace(0, self.top, len(self.stops))
        stops = np.array(self.stops, float)
        colors = np.stack([np.interp(degrees, places, stops[:, i]) for i in range(3)], axis=-1)
        return np.where(np.isnan(degrees)[..., None], UNKNOWN, colors) / 255


def show_errors(context, path, folder, collection):
    """Imports the asset into a collection in the colours of its errors, which are face attributes too."""
    glb, errors, first = Glb(path), Errors(folder), 0
    for node in glb.nodes():
        node["extras"] = {"taotie_surface": first}
        first += len(glb.primitives(node))
    if first != len(errors.maps):
        raise Problem(f"the program measured {len(errors.maps)} surfaces of {first}; update the add-on")
    glb.save(path)
    for thing in load(context, path, collection):
        _show_errors_of(thing, errors)
    return errors


def remove(collection):
    """Removes objects in the colours of their errors, with all that they consist of."""
    meshes = [thing.data for thing in collection.objects]
    materials = [material for mesh in meshes for material in mesh.materials]
    images = [node.image for material in materials for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]
    bpy.data.batch_remove([*collection.objects, collection, *meshes, *materials, *images])


def _show_errors_of(thing, errors):
    mesh, first = thing.data, thing["taotie_surface"]
    slots = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", slots)
    layers = [_uvs_of(layer) for layer in mesh.uv_layers]
    uvs, faces = np.zeros((len(mesh.loops), 2)), np.full(len(mesh.polygons), -1.0, np.float32)
    for slot in range(max(1, len(mesh.materials))):
        described, degrees = errors.maps[first + slot], errors.degrees(first + slot)
        if degrees is not None:
            corners = np.repeat(slots == slot, 3)
            a, b, c, d, e, f = described["transform"]
            u, v = layers[described["uv_set"]][corners].T
            uvs[corners] = np.stack([a * u + b * v + e, c * u + d * v + f], axis=1)
            faces[slots == slot] = _means(degrees, uvs[corners].reshape(-1, 3, 2))
        material = _error_material(f"{thing.name} error {slot}", errors, degrees)
        mesh.materials.append(material) if slot >= len(mesh.materials) else mesh.materials.__setitem__(slot, material)
    for layer in list(mesh.uv_layers):
        mesh.uv_layers.remove(layer)
    uvs[:, 1] = 1 - uvs[:, 1]
    mesh.uv_layers.new(name="error").data.foreach_set("uv", uvs.astype(np.float32).ravel())
    mesh.attributes.new(ERROR, "FLOAT", "FACE").data.foreach_set("value", faces)


def _uvs_of(layer):
    uvs = np.empty(2 * len(layer.data), np.float32)
    layer.data.foreach_get("uv", uvs)
    uvs = uvs.reshape(-1, 2).astype(float)
    uvs[:, 1] = 1 - uvs[:, 1]
    return uvs


def _means(degrees, triangles, side=8):
    """Returns the mean of the measured texels at points of each triangle; below 0 without any."""
    height, width = degrees.shape
    total, count = np.zeros(len(triangles)), np.zeros(len(triangles))
    for i, j in ((i, j) for i in range(side) for j in range(side - i)):
        u, v = (i + 1 / 3) / side, (j + 1 / 3) / side
        x, y = (triangles[:, 0] * (1 - u - v) + triangles[:, 1] * u + triangles[:, 2] * v).T
        found = degrees[np.floor(y * height).astype(int) % height, np.floor(x * width).astype(int) % width]
        total += np.nan_to_num(found)
        count += ~np.isnan(found)
    return np.where(count, total / np.maximum(count, 1), -1)


def _error_material(name, errors, degrees):
    degrees = np.full((1, 1), np.nan) if degrees is None else degrees
    image = bpy.data.images.new(name, degrees.shape[1], degrees.shape[0])
    pixels = np.ones((*degrees.shape, 4), np.float32)
    pixels[..., :3] = errors.colors(degrees)[::-1]
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0):
        material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    texture, light, output = (nodes.new(f"ShaderNode{kind}") for kind in ("TexImage", "Emission", "OutputMaterial"))
    texture.image, texture.interpolation = image, "Closest"
    links.new(texture.outputs["Color"], light.inputs["Color"])
    links.new(light.outputs["Emission"], output.inputs["Surface"])
    nodes.active = texture
    return material
