"""Generates missing parts of the scene of all participants in a folder: scene.py FOLDER MESH..."""

import os
import sys

import files
import maps
import numpy as np
import shape
import surroundings
from measured import GRIDS, SHADINGS
from staging import attributes, camera_and_lights, material


def write_mesh(folder, name):
    """Writes NAME.npz with v upward, and a GLB for each shading."""
    vessel = shape.vessel(*GRIDS[name])
    pictures = [read(os.path.join(folder, f"{map}.png")) for map in maps.NAMES]
    for shading in SHADINGS:
        path = os.path.join(folder, f"{name}-{shading}.glb")
        used = pictures if shading == "ggx" else pictures[:2]
        files.write_glb(path, attributes(vessel), vessel["triangles"], material(shading), used, camera_and_lights())
    with files.written(os.path.join(folder, f"{name}.npz")) as file:
        np.savez(file, **vessel)


def read(path):
    with open(path, "rb") as file:
        return file.read()


def write_pictures(folder):
    pictures = {f"{name}.png": data for name, data in maps.maps().items()}
    radiance = surroundings.picture()
    pictures["environment.hdr"] = surroundings.radiance_hdr(radiance)
    for name, data in pictures.items():
        with files.written(os.path.join(folder, name)) as file:
            file.write(data)
    with files.written(os.path.join(folder, "split-sum.npz")) as file:
        np.savez(file, **surroundings.split_sum(radiance))


def main(folder, names):
    os.makedirs(folder, exist_ok=True)
    if not os.path.exists(os.path.join(folder, "split-sum.npz")):
        print("generating maps and environment", file=sys.stderr)
        write_pictures(folder)
    for name in names:
        if not os.path.exists(os.path.join(folder, f"{name}.npz")):
            print(f"generating the vessel of {name} triangles", file=sys.stderr)
            write_mesh(folder, name)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
