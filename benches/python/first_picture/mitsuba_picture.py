import sys

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")
model, picture = sys.argv[1:]
mesh = mi.load_dict({"type": "ply", "filename": model})
box = mesh.bbox()
center, radius = np.array(box.center()), np.linalg.norm(box.extents()) / 2
eye = center + [0, 0, radius / np.sin(np.radians(20))]
scene = mi.load_dict(
    {
        "type": "scene",
        "integrator": {"type": "direct"},
        "sensor": {
            "type": "perspective",
            "fov": 40,
            "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(origin=eye.tolist(), target=center.tolist(), up=[0, 1, 0]),
            "film": {"type": "hdrfilm", "width": 640, "height": 480},
            "sampler": {"type": "independent", "sample_count": 4},
        },
        "light": {"type": "directional", "direction": [0.6, -0.5, -0.7], "irradiance": 3.0},
        "fill": {"type": "constant", "radiance": 0.1},
        "mesh": mesh,
    }
)
mi.util.write_bitmap(picture, mi.render(scene))
