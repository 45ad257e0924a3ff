"""Bakes with Blender's Cycles, from the selected object to the active one; Blender itself has a module `cycles`."""

import bpy


def set_up(samples, extrusion, margin):
    """Creates an empty scene, and disables everything in Cycles that would change the number of samples."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    bake = scene.render.bake
    bake.use_selected_to_active = True
    bake.cage_extrusion = extrusion
    bake.max_ray_distance = 0.0
    bake.margin = margin
    bake.normal_space = "TANGENT"


def add_image(material, size):
    """The texture node of a new image to bake into: the active node of the material."""
    image = bpy.data.images.new("map", size, size, alpha=False, float_buffer=False)
    image.colorspace_settings.name = "Non-Color"
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    return node


def bake(scan, low, kind):
    bpy.ops.object.select_all(action="DESELECT")
    scan.select_set(True)
    low.select_set(True)
    bpy.context.view_layer.objects.active = low
    bpy.ops.object.bake(type=kind.upper())
