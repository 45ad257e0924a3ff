"""Mitsuba 3 at one sample per pixel, direct light, compiled for this CPU (llvm_ad_rgb)."""

import os

import answer
import numpy as np
import view
from mitsuba_found import mi


class Mitsuba:
    def __init__(self, folder, mesh, shading):
        mi.set_variant("llvm_ad_rgb")
        self.folder, self.seed = folder, 0
        scene = {"type": "scene", "integrator": {"type": "direct"}, "vessel": self.body(mesh, shading)}
        scene["light"] = {
            "type": "point",
            "position": list(view.LIGHT),
            "intensity": {"type": "rgb", "value": view.INTENSITY},
        }
        if shading == "ggx":
            turn = mi.ScalarTransform4f().rotate([0, 1, 0], 90)
            picture = os.path.join(folder, "environment.hdr")
            scene["environment"] = {"type": "envmap", "filename": picture, "to_world": turn}
        self.scene = mi.load_dict(scene)

    def map(self, name, raw=True):
        return {"type": "bitmap", "filename": os.path.join(self.folder, f"{name}.png"), "raw": raw}

    def channel(self, index):
        texels = np.array(mi.Bitmap(os.path.join(self.folder, "orm.png")))[..., index : index + 1]
        return {"type": "bitmap", "bitmap": mi.Bitmap(texels.astype(np.float32) / 255), "raw": True}

    def body(self, mesh, shading):
        if shading == "ggx":
            metal = {"type": "principled", "base_color": self.map("albedo", raw=False), "specular": 0.5}
            metal |= {"roughness": self.channel(1), "metallic": self.channel(2)}
        else:
            metal = {"type": "roughconductor", "distribution": "beckmann", "alpha": view.SLOPE, "material": "none"}
            metal["specular_reflectance"] = self.map("albedo", raw=False)
        surface = mi.load_dict({"type": "normalmap", "normalmap": self.map("normal"), "bsdf": metal})
        vessel = np.load(os.path.join(self.folder, f"{mesh}.npz"))
        properties = mi.Properties()
        properties["bsdf"] = surface
        counts = (len(vessel["positions"]), len(vessel["triangles"]))
        body = mi.Mesh("vessel", *counts, has_vertex_normals=True, has_vertex_texcoords=True, props=properties)
        parameters = mi.traverse(body)
        parameters["vertex_positions"] = vessel["positions"].ravel()
        parameters["vertex_normals"] = vessel["normals"].ravel()
        parameters["vertex_texcoords"] = (vessel["uvs"] * np.float32([1, -1]) + np.float32([0, 1])).ravel()
        parameters["faces"] = vessel["triangles"].ravel()
        parameters.update()
        return body

    def resize(self, width, height):
        film = {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb"}
        film["rfilter"] = {"type": "box"}
        self.film = film

    def camera(self, angle):
        """Rotates the view the other way: moving the vessel itself would rebuild its tree."""
        turn = mi.ScalarTransform4f().rotate([0, 1, 0], -np.degrees(angle))
        look = mi.ScalarTransform4f().look_at(origin=view.EYE, target=view.TARGET, up=[0, 1, 0])
        lens = {"type": "perspective", "fov": view.FOV, "fov_axis": "y", "film": self.film}
        lens |= {"near_clip": view.NEAR, "far_clip": view.FAR, "to_world": turn @ look}
        return mi.load_dict(lens)

    def frame(self, angle):
        self.seed += 1
        radiance = mi.render(self.scene, sensor=self.camera(angle), spp=1, seed=self.seed)
        picture = mi.Bitmap(radiance).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.UInt8, srgb_gamma=True)
        self.pixels = np.array(picture)

    def picture(self):
        return self.pixels

    def about(self):
        return f"Mitsuba {mi.__version__}"


if __name__ == "__main__":
    args = answer.arguments(__doc__, ["cook-torrance", "ggx"])
    answer.run(args, Mitsuba(args.folder, args.mesh, args.shading))
