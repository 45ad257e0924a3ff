"""F3D, a viewer built on VTK, through its Python module."""

import os

import answer
import f3d
import numpy as np
import view


# The light of the file has no falloff here; this is its remaining intensity at the vessel. It also dims the
# environment.
LIGHT = float(1 / np.sum(np.square(view.LIGHT)))


class F3d:
    def __init__(self, folder, mesh):
        self.engine = f3d.Engine.create_egl()
        hdri = {"render.hdri.file": os.path.join(folder, "environment.hdr"), "render.hdri.ambient": True}
        ground = [code / 255 for code in view.BACKGROUND]
        self.engine.options.update(hdri | {"render.background.color": ground, "render.light.intensity": LIGHT})
        self.engine.scene.add(os.path.join(folder, f"{mesh}-ggx.glb"))

    def resize(self, width, height):
        self.size = (width, height)
        self.engine.window.size = self.size
        camera = self.engine.window.camera
        camera.focal_point, camera.view_up, camera.view_angle = view.TARGET, (0, 1, 0), view.FOV

    def frame(self, angle):
        """Its objects cannot move, so the camera rotates the other way."""
        camera = self.engine.window.camera
        camera.position = tuple((view.turned(-angle) @ [*view.EYE, 1])[:3])
        camera.focal_point, camera.view_up = view.TARGET, (0, 1, 0)
        self.image = self.engine.window.render_to_image()
        self.pixels = self.image.content

    def picture(self):
        channels = self.image.channel_count
        return np.frombuffer(self.pixels, np.uint8).reshape(self.size[1], self.size[0], channels)[::-1]

    def about(self):
        return f"F3D {f3d.Engine.get_lib_info().version}"


if __name__ == "__main__":
    args = answer.arguments(__doc__, ["ggx"])
    answer.run(args, F3d(args.folder, args.mesh))
