import sys

import bpy
from mathutils import Vector

model, picture = sys.argv[1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.ply_import(filepath=model, forward_axis="Y", up_axis="Z")
mesh = bpy.context.selected_objects[0]
corners = [Vector(corner) for corner in mesh.bound_box]
center, radius = sum(corners, Vector()) / 8, (corners[6] - corners[0]).length / 2
scene = bpy.context.scene
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.data.angle_y = camera.data.angle = 0.9
camera.location = center + Vector((0, 0, radius / 0.34))
camera.data.clip_end = radius * 100
lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
lamp.data.energy = 3
lamp.rotation_euler = (0.5, 0.5, 0)
scene.collection.objects.link(camera)
scene.collection.objects.link(lamp)
scene.camera = camera
scene.render.engine = "CYCLES"
scene.cycles.samples = 4
scene.render.resolution_x, scene.render.resolution_y = 640, 480
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
