"""Generated objects for tests and pictures."""

import bpy


def clear():
    """Leaves an empty scene in metres."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    units = bpy.context.scene.unit_settings
    units.system, units.scale_length = "METRIC", 1


def sphere(name, segments, material=None):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=segments, ring_count=segments // 2, radius=1)
    bpy.ops.object.shade_smooth()
    thing = bpy.context.object
    thing.name = name
    if material:
        thing.data.materials.append(material)
    return thing


def displace(thing, strength=0.08, scale=0.25):
    texture = bpy.data.textures.new("clouds", "CLOUDS")
    texture.noise_scale = scale
    modifier = thing.modifiers.new("displace", "DISPLACE")
    modifier.texture, modifier.strength, modifier.mid_level = texture, strength, 0.5


def colored(name, color):
    """A material with an image texture of two colours."""
    image = bpy.data.images.new(name, 64, 64)
    other = [0.5 * value for value in color]
    image.pixels = [value for y in range(64) for x in range(64) for value in (*(color if (x ^ y) & 8 else other), 1)]
    image.pack()
    material = bpy.data.materials.new(name)
    nodes = material.node_tree.nodes
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    material.node_tree.links.new(texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
    return material


def pair():
    """A sphere with relief from a modifier, and a plain sphere."""
    high = sphere("Über scan", 192, colored("clay", (0.8, 0.45, 0.3)))
    displace(high)
    return high, sphere("low one", 48)
