"""A Mitsuba process that traces paths: mitsuba_paths.py SCENE VARIANT ENVIRONMENT SIDE THREADS.

A request is a line `PATHS SEED FILE.npy`; the answer a line of JSON with `seconds`, those of rendering, and `first`,
those of the first image with this number of paths, for which the scene's code is compiled; it is not the timed one.
"""

import json
import sys
import time

import drjit
import numpy as np
import scenes
import view
from mitsuba_found import mi


# The Mitsuba sampler with the least error here; its default, `independent`, has several times as much.
SAMPLER = "multijitter"


def transform():
    """The camera's position and direction."""
    return mi.ScalarTransform4f().look_at(origin=view.EYE, target=view.TARGET, up=[0, 1, 0])


def bsdf(body):
    color = {"type": "rgb", "value": list(body.color)}
    if body.roughness:
        metal = {"type": "roughconductor", "distribution": "ggx", "alpha": body.roughness**2, "material": "none"}
        return metal | {"specular_reflectance": color}
    return {"type": "twosided", "matte": {"type": "diffuse", "reflectance": color}}


def mesh(body):
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf(body))
    made = mi.Mesh("body", len(body.positions), len(body.triangles), has_vertex_normals=True, props=properties)
    parameters = mi.traverse(made)
    parameters["vertex_positions"] = body.positions.ravel()
    parameters["vertex_normals"] = body.normals.ravel()
    parameters["faces"] = body.triangles.ravel()
    parameters.update()
    return made


def light(scene, environment):
    if scene.environment:
        turn = mi.ScalarTransform4f().rotate([0, 1, 0], 90)
        return {"type": "envmap", "filename": environment, "to_world": turn}
    strength = {"type": "rgb", "value": view.INTENSITY}
    return {"type": "point", "position": list(view.LIGHT), "intensity": strength}


def loaded(scene, environment, side):
    """The light of Taotie's first reflection has depth 2 here."""
    film = {"type": "hdrfilm", "width": side, "height": side, "pixel_format": "rgb", "rfilter": {"type": "box"}}
    lens = {"type": "perspective", "fov": view.FOV, "fov_axis": "y", "to_world": transform(), "film": film}
    lens |= {"near_clip": view.NEAR, "far_clip": view.FAR, "sampler": {"type": SAMPLER}}
    paths = {"type": "path", "max_depth": scene.bounces + 2, "hide_emitters": True}
    bodies = {f"body{number}": mesh(body) for number, body in enumerate(scene.bodies())}
    return mi.load_dict({"type": "scene", "paths": paths, "lens": lens, "light": light(scene, environment), **bodies})


class Renderer:
    def __init__(self, scene, environment, side):
        self.scene = loaded(scene, environment, side)
        self.first = {}

    def answer(self, paths, seed, path):
        if paths not in self.first:
            self.first[paths], _ = self.timed(paths, 0)
        seconds, picture = self.timed(paths, seed)
        np.save(path, picture)
        return {"seconds": seconds, "first": self.first[paths]}

    def timed(self, paths, seed):
        """Seconds until the image is in memory, and the image."""
        start = time.perf_counter()
        picture = np.array(mi.render(self.scene, spp=paths, seed=seed))
        return time.perf_counter() - start, picture


def main(name, variant, environment, side, threads):
    mi.set_variant(variant)
    drjit.set_thread_count(int(threads))
    renderer = Renderer(scenes.SCENES[name], environment, int(side))
    for line in sys.stdin:
        paths, seed, path = line.split()
        print(json.dumps(renderer.answer(int(paths), int(seed), path)), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
