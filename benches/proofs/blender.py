"""Reduces a scan with Blender's Decimate; one without textures also gets UVs and a normal map baked with Cycles."""

import argparse
import math

import bpy
import cycles_bake

# Fraction of the diagonal: distance of the rays' origins outside the reduced mesh.
EXTRUSION = 0.01
MARGIN = 8
SAMPLES = 4
# Maximum angle in degrees between faces of one island; Blender's default.
ISLAND_ANGLE = 66


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scan", help="glTF")
    parser.add_argument("output", help="GLB to write")
    parser.add_argument("--ratio", type=float, required=True, help="fraction of triangles to keep")
    parser.add_argument("--side", type=int, required=True, help="maximum side of textures in texels")
    return parser.parse_args()


def meshes():
    return [thing for thing in bpy.context.scene.objects if thing.type == "MESH"]


def decimate(thing, ratio):
    bpy.context.view_layer.objects.active = thing
    modifier = thing.modifiers.new("decimate", "DECIMATE")
    modifier.ratio = ratio
    modifier.use_collapse_triangulate = True
    bpy.ops.object.modifier_apply(modifier=modifier.name)


def duplicate(thing):
    copy = thing.copy()
    copy.data = thing.data.copy()
    bpy.context.collection.objects.link(copy)
    return copy


def unwrap(thing, side):
    bpy.ops.object.select_all(action="DESELECT")
    thing.select_set(True)
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.smart_project(angle_limit=math.radians(ISLAND_ANGLE), island_margin=2 / side)
    bpy.ops.object.mode_set(mode="OBJECT")


def show_map(material, image_node):
    """Sets the image as the material's normal map."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    surface = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    normal = nodes.new("ShaderNodeNormalMap")
    links.new(image_node.outputs["Color"], normal.inputs["Color"])
    links.new(normal.outputs["Normal"], surface.inputs["Normal"])


def bake_normals(scan, ratio, side):
    """Replaces the scan with a reduced, unwrapped mesh and its normal map."""
    low = duplicate(scan)
    decimate(low, ratio)
    if low.data.has_custom_normals:
        bpy.ops.mesh.customdata_custom_splitnormals_clear()  # the scan's are of little use on the reduced mesh
    low.data.shade_smooth()
    unwrap(low, side)
    material = scan.data.materials[0].copy()
    low.data.materials[0] = material
    image_node = cycles_bake.add_image(material, side)
    bpy.context.scene.render.bake.cage_extrusion = EXTRUSION * scan.dimensions.length
    cycles_bake.bake(scan, low, "normal")
    show_map(material, image_node)
    bpy.data.objects.remove(scan)


def shrink_textures(side):
    for image in bpy.data.images:
        scale = side / max(*image.size, 1)
        if scale < 1:
            image.scale(*(max(1, round(texels * scale)) for texels in image.size))


def main():
    args = arguments()
    cycles_bake.set_up(SAMPLES, 0.0, MARGIN)
    bpy.ops.import_scene.gltf(filepath=args.scan, merge_vertices=True)
    if bpy.data.images:
        for thing in meshes():
            decimate(thing, args.ratio)
        shrink_textures(args.side)
    else:
        bake_normals(meshes()[0], args.ratio, args.side)
    bpy.ops.export_scene.gltf(
        filepath=args.output,
        export_format="GLB",
        export_image_format="WEBP",
        export_draco_mesh_compression_enable=True,
    )


if __name__ == "__main__":
    main()
