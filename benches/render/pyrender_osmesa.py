"""pyrender on OSMesa: metallic-roughness with one light; its only ambient light is a constant."""

import os

os.environ.setdefault("PYOPENGL_PLATFORM", "osmesa")

import answer
import numpy as np
import view
from PIL import Image

# pyrender 0.1.45 predates NumPy 2 and uses a removed name.
np.infty = np.inf

import pyrender

LINEAR, TRILINEAR, REPEAT, CLAMP, TRIANGLES = 9729, 9987, 10497, 33071, 4
AMBIENT = 0.2


class Pyrender:
    def __init__(self, folder, mesh):
        sampler = pyrender.Sampler(magFilter=LINEAR, minFilter=TRILINEAR, wrapS=REPEAT, wrapT=CLAMP)

        def map(name, channels="RGB"):
            picture = Image.open(os.path.join(folder, f"{name}.png"))
            return pyrender.Texture(source=picture, source_channels=channels, sampler=sampler)

        material = pyrender.MetallicRoughnessMaterial(
            baseColorTexture=map("albedo"),
            normalTexture=map("normal"),
            # Its shader reads roughness from red and metalness from green.
            metallicRoughnessTexture=map("orm", "GB"),
            occlusionTexture=map("orm", "R"),
            metallicFactor=1.0,
            roughnessFactor=1.0,
        )
        vessel = np.load(os.path.join(folder, f"{mesh}.npz"))
        body = pyrender.Primitive(
            positions=vessel["positions"],
            normals=vessel["normals"],
            tangents=vessel["tangents"],
            texcoord_0=vessel["uvs"],
            indices=vessel["triangles"],
            material=material,
            mode=TRIANGLES,
        )
        ground = [code / 255 for code in view.BACKGROUND]
        self.scene = pyrender.Scene(bg_color=ground, ambient_light=[AMBIENT] * 3)
        self.body = self.scene.add(pyrender.Mesh([body]))
        camera = pyrender.PerspectiveCamera(yfov=np.radians(view.FOV), znear=view.NEAR, zfar=view.FAR)
        self.scene.add(camera, pose=view.world_from_camera())
        place = np.eye(4)
        place[:3, 3] = view.LIGHT
        self.scene.add(pyrender.PointLight(color=np.ones(3), intensity=view.INTENSITY), pose=place)
        self.renderer = None

    def resize(self, width, height):
        if self.renderer is None:
            self.renderer = pyrender.OffscreenRenderer(width, height)
        self.renderer.viewport_width, self.renderer.viewport_height = width, height

    def frame(self, angle):
        self.scene.set_pose(self.body, view.turned(angle))
        self.pixels, _ = self.renderer.render(self.scene)

    def picture(self):
        return self.pixels

    def about(self):
        from OpenGL.GL import GL_RENDERER, GL_VERSION, glGetString

        return (
            f"pyrender {pyrender.__version__}, {glGetString(GL_RENDERER).decode()}, {glGetString(GL_VERSION).decode()}"
        )


if __name__ == "__main__":
    args = answer.arguments(__doc__, ["ggx"])
    answer.run(args, Pyrender(args.folder, args.mesh))
