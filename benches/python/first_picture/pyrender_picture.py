import os
import sys

os.environ["PYOPENGL_PLATFORM"] = "egl"

import numpy as np
import trimesh
from PIL import Image

np.infty = np.inf
import pyrender

model, picture = sys.argv[1:]
mesh = trimesh.load(model, force="mesh")
radius = np.linalg.norm(mesh.extents) / 2
pose = np.eye(4)
pose[:3, 3] = mesh.bounds.mean(0) + [0, 0, radius / np.sin(np.radians(20))]
scene = pyrender.Scene(bg_color=[0.2, 0.2, 0.2], ambient_light=[0.1] * 3)
scene.add(pyrender.Mesh.from_trimesh(mesh))
scene.add(pyrender.PerspectiveCamera(yfov=np.radians(40)), pose=pose)
scene.add(pyrender.DirectionalLight(intensity=3.0), pose=pose)
color, _ = pyrender.OffscreenRenderer(640, 480).render(scene)
Image.fromarray(color).save(picture)
