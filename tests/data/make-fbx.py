"""Writes meshes/blender.fbx with Blender: pip install bpy==5.0.1, which needs Python 3.11."""

from pathlib import Path

import bpy

FOLDER = Path(__file__).with_name("meshes")


def material(name: str, **inputs: object) -> bpy.types.Material:
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    for key, value in inputs.items():
        made.node_tree.nodes["Principled BSDF"].inputs[key.replace("_", " ")].default_value = value
    return made


def textured() -> bpy.types.Material:
    """A material with an embedded image of 4 × 4 texels."""
    image = bpy.data.images.new("stripes", 4, 4)
    image.pixels = [value for texel in range(16) for value in ((1, 0, 0, 1) if texel % 2 else (0, 0, 1, 1))]
    image.pack()
    made = material("stripes", Roughness=0.5)
    node = made.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    made.node_tree.links.new(node.outputs[0], made.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    return made


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.object.empty_add(location=(1, 2, 3), rotation=(0, 0, 0.5))
parent = bpy.context.object
bpy.ops.mesh.primitive_cylinder_add(vertices=7, location=(0.5, 0, 0), rotation=(0.25, 0, 0))
prism = bpy.context.object
prism.name, prism.parent, prism.scale = "prism_high", parent, (1, 2, 0.5)
prism.data.materials.append(material("red", Base_Color=(0.8, 0.1, 0.05, 1), Roughness=0.3, Metallic=0.75))
prism.data.materials.append(textured())
for face in prism.data.polygons:
    face.material_index = face.index % 2
copy = prism.copy()
copy.name, copy.location = "prism_copy", (0, 4, 0)
bpy.context.collection.objects.link(copy)
bpy.ops.export_scene.fbx(filepath=str(FOLDER / "blender.fbx"), path_mode="COPY", embed_textures=True, add_leaf_bones=False, bake_anim=False)
