"""Bakes the maps of a pair (pair.py) with Blender, selected to active: blender_maps.py PAIR.npz OUT.npz COLORS.json ...

Images are floats, rows from the top. Normals, bevels and positions are stored as Blender bakes them; pointiness is what
its Geometry node returns.
"""

import argparse
import json

import bpy
import numpy as np

import cycles_bake
import pair


# Of the node, for each sample of the bake.
BEVEL_SAMPLES = 16


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pair", help="pair.npz")
    parser.add_argument("output", help="NPZ to write")
    parser.add_argument("colors", help="JSON: RGB in [0, 1] of each material and object, by map and name")
    parser.add_argument("--size", type=int, required=True, help="texels")
    parser.add_argument("--samples", type=int, required=True, help="rays per texel for ao, samples for bevel")
    parser.add_argument("--extrusion", type=float, required=True, help="distance of the rays' origins, model units")
    parser.add_argument("--ao-distance", type=float, required=True, help="model units")
    parser.add_argument("--bevel-radius", type=float, required=True, help="model units")
    return parser.parse_args()


def build(name, positions, triangles):
    """A smooth object of these vertices; Blender computes the same normals as frames.py."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.loops.add(triangles.size)
    mesh.loops.foreach_set("vertex_index", triangles.ravel().astype(np.int32))
    mesh.polygons.add(len(triangles))
    mesh.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.shade_smooth()
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def build_part(arrays, name, materials):
    thing = build(name, arrays[f"{name}.positions"], arrays[f"{name}.triangles"])
    mesh = thing.data
    colors = np.pad(arrays[f"{name}.colors"], ((0, 0), (0, 1)), constant_values=1)
    mesh.color_attributes.new("colors", "FLOAT_COLOR", "POINT").data.foreach_set("color", colors.ravel())
    for material in materials:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", arrays[f"{name}.materials"].astype(np.int32))
    return thing


def build_low(arrays, size):
    """The low-poly mesh, and the image that its material bakes into."""
    low = build("low", arrays["low.positions"], arrays["low.triangles"])
    low.data.uv_layers.new(name="uv").data.foreach_set("uv", arrays["low.uvs"].ravel())
    image = bpy.data.images.new("map", size, size, alpha=True, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    material = bpy.data.materials.new("low")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    low.data.materials.append(material)
    return low, image


def fresh(material):
    """The nodes and links of a material that shows nothing yet, and the socket for its surface."""
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    return tree.nodes, tree.links, output.inputs["Surface"]


def emit(material, source):
    """Makes a material emit the socket that `source` returns from its nodes."""
    nodes, links, surface = fresh(material)
    emission = nodes.new("ShaderNodeEmission")
    links.new(source(nodes, links), emission.inputs["Color"])
    links.new(emission.outputs["Emission"], surface)


def principled(material, normal=None):
    """Gives a material its roughness, and the normal that `normal` returns from its nodes."""
    nodes, links, surface = fresh(material)
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Roughness"].default_value = pair.LOOKS[material.name][1]
    if normal:
        links.new(normal(nodes), shader.inputs["Normal"])
    links.new(shader.outputs["BSDF"], surface)


def flat(color):
    def source(nodes, _):
        node = nodes.new("ShaderNodeRGB")
        node.outputs[0].default_value = (*color, 1)
        return node.outputs[0]

    return source


def of_object(nodes, _):
    return nodes.new("ShaderNodeObjectInfo").outputs["Color"]


def of_vertices(nodes, _):
    node = nodes.new("ShaderNodeVertexColor")
    node.layer_name = "colors"
    return node.outputs["Color"]


def tinted(color):
    """The colours of vertices times that of the material."""

    def source(nodes, links):
        node = nodes.new("ShaderNodeVectorMath")
        node.operation = "MULTIPLY"
        links.new(of_vertices(nodes, links), node.inputs[0])
        node.inputs[1].default_value = color
        return node.outputs[0]

    return source


def pointiness(nodes, _):
    return nodes.new("ShaderNodeNewGeometry").outputs["Pointiness"]


def bevel(radius):
    def normal(nodes):
        node = nodes.new("ShaderNodeBevel")
        node.samples = BEVEL_SAMPLES
        node.inputs["Radius"].default_value = radius
        return node.outputs["Normal"]

    return normal


class Bakes:
    """Bakes maps one by one; `maps` has their texels, rows from the top."""

    def __init__(self, parts, low, image):
        self.parts, self.low, self.image, self.maps = parts, low, image, {}

    def bake(self, name, kind, samples=1, space="TANGENT"):
        scene = bpy.context.scene
        scene.cycles.samples = samples
        scene.render.bake.normal_space = space
        bpy.ops.object.select_all(action="DESELECT")
        for thing in (*self.parts, self.low):
            thing.select_set(True)
        bpy.context.view_layer.objects.active = self.low
        bpy.ops.object.bake(type=kind)
        width, height = self.image.size
        texels = np.empty(width * height * 4, np.float32)
        self.image.pixels.foreach_get(texels)
        self.maps[name] = texels.reshape(height, width, 4)[::-1, :, :3].copy()


def main():
    args = arguments()
    arrays = np.load(args.pair)
    with open(args.colors, encoding="utf-8") as file:
        colors = json.load(file)
    cycles_bake.set_up(1, args.extrusion, 0)
    # Clears what an earlier bake drew; texels that no ray fills stay black.
    bpy.context.scene.render.bake.use_clear = True
    bpy.context.scene.world.light_settings.distance = args.ao_distance
    materials = [bpy.data.materials.new(name) for name in pair.MATERIALS]
    parts = [build_part(arrays, str(name), materials) for name in arrays["parts"]]
    for part in parts:
        part.color = (*colors["object-id"][part.name], 1)
    bakes = Bakes(parts, *build_low(arrays, args.size))
    for material in materials:
        principled(material)
    bakes.bake("normal", "NORMAL")
    bakes.bake("world-normal", "NORMAL", space="OBJECT")
    bakes.bake("position", "POSITION")
    bakes.bake("roughness", "ROUGHNESS")
    bakes.bake("ao", "AO", samples=args.samples)
    for material in materials:
        principled(material, bevel(args.bevel_radius))
    bakes.bake("bevel", "NORMAL", samples=-(-args.samples // BEVEL_SAMPLES))
    sources = {
        "material-id": lambda name: flat(colors["material-id"][name]),
        "object-id": lambda _: of_object,
        "vertex-color": lambda _: of_vertices,
        "albedo": lambda name: tinted(pair.LOOKS[name][0]),
        "metalness": lambda name: flat([pair.LOOKS[name][2]] * 3),
        "pointiness": lambda _: pointiness,
    }
    for name, source in sources.items():
        for material in materials:
            emit(material, source(material.name))
        bakes.bake(name, "EMIT")
    np.savez(args.output, version=bpy.app.version_string, **bakes.maps)


if __name__ == "__main__":
    main()
