"""Open3D's OffscreenRenderer, which is Filament, under its own environment: it cannot read .hdr."""

import os

os.environ.setdefault("EGL_PLATFORM", "surfaceless")

import answer
import numpy as np
import open3d
import view
from open3d.visualization import rendering

# Its lights are in lumen and its environment in lux; these are about as bright as the others'.
LUMEN, LUX = 3e6, 30_000


class Open3d:
    def __init__(self, folder, mesh):
        vessel = np.load(os.path.join(folder, f"{mesh}.npz"))
        points = open3d.utility.Vector3dVector(vessel["positions"].astype(np.float64))
        body = open3d.geometry.TriangleMesh(points, open3d.utility.Vector3iVector(vessel["triangles"].astype(np.int32)))
        body.vertex_normals = open3d.utility.Vector3dVector(vessel["normals"].astype(np.float64))
        corners = vessel["uvs"][vessel["triangles"].ravel()].astype(np.float64)
        body.triangle_uvs = open3d.utility.Vector2dVector(corners)
        material = rendering.MaterialRecord()
        material.shader = "defaultLit"
        names = {"albedo_img": "albedo", "normal_img": "normal", "ao_rough_metal_img": "orm"}
        for slot, name in names.items():
            setattr(material, slot, open3d.io.read_image(os.path.join(folder, f"{name}.png")))
        material.base_metallic = material.base_roughness = 1.0
        self.body, self.material, self.size, self.now = body, material, None, None

    def resize(self, width, height):
        if self.size != (width, height):
            self.size, self.now = (width, height), None
            self.now = self.renderer(width, height)

    def renderer(self, width, height):
        renderer = rendering.OffscreenRenderer(width, height)
        scene = renderer.scene
        scene.add_geometry("vessel", self.body, self.material)
        scene.set_background([*(code / 255 for code in view.BACKGROUND), 1])
        scene.scene.enable_sun_light(False)
        scene.scene.enable_indirect_light(True)
        scene.scene.set_indirect_light_intensity(LUX)
        scene.scene.add_point_light("light", [1, 1, 1], view.LIGHT, LUMEN, 50.0, False)
        renderer.setup_camera(view.FOV, list(view.TARGET), list(view.EYE), [0, 1, 0], view.NEAR, view.FAR)
        return renderer

    def frame(self, angle):
        self.now.scene.set_geometry_transform("vessel", view.turned(angle))
        self.pixels = np.asarray(self.now.render_to_image())

    def picture(self):
        return self.pixels

    def about(self):
        return f"Open3D {open3d.__version__}"


if __name__ == "__main__":
    args = answer.arguments(__doc__, ["ggx"])
    answer.run(args, Open3d(args.folder, args.mesh))
    # It occasionally hangs or fails on exit.
    import sys

    sys.stdout.flush()
    os._exit(0)
