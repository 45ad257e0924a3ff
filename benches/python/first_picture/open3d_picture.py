import os
import sys

os.environ["EGL_PLATFORM"] = "surfaceless"

import numpy as np
import open3d
from open3d.visualization import rendering

model, picture = sys.argv[1:]
mesh = open3d.io.read_triangle_mesh(model)
mesh.compute_vertex_normals()
box = mesh.get_axis_aligned_bounding_box()
center, radius = box.get_center(), np.linalg.norm(box.get_extent()) / 2
material = rendering.MaterialRecord()
material.shader = "defaultLit"
renderer = rendering.OffscreenRenderer(640, 480)
renderer.scene.add_geometry("mesh", mesh, material)
renderer.scene.set_lighting(renderer.scene.LightingProfile.MED_SHADOWS, (0.6, -0.5, -0.7))
renderer.setup_camera(40.0, center, center + [0, 0, radius / np.sin(np.radians(20))], [0, 1, 0])
open3d.io.write_image(picture, renderer.render_to_image())
