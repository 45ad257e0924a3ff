"""Generates missing parts of scenes in a folder: variants.py FOLDER PART...

A part is `environment`, `mesh MESH`, `maps SIDE` or `scene MESH SIDE LIGHTS`, joined by `:`. A scene is a small glTF
file for each shading that refers to the buffer of a mesh and the images of maps.
"""

import json
import os
import sys

import files
import maps
import shape
import surroundings
from command import say
from measured import GRIDS, SHADINGS
from staging import attributes, camera_and_lights, material

# PNG compression level: files this large should not take long, and are not kept.
EFFORT = 1


def mesh(folder, name):
    """Writes NAME.bin, and its glTF description in NAME.json, which is written last."""
    if os.path.exists(os.path.join(folder, f"{name}.json")):
        return
    say(f"generating the vessel of {name} triangles")
    vessel, buffer = shape.vessel(*GRIDS[name]), files.Buffer()
    primitive = buffer.primitive(attributes(vessel), vessel["triangles"])
    about = {"accessors": buffer.accessors, "views": buffer.views, "primitive": primitive, "bytes": len(buffer.bytes)}
    write(os.path.join(folder, f"{name}.bin"), buffer.bytes)
    write(os.path.join(folder, f"{name}.json"), json.dumps(about).encode())


def maps_of(folder, side):
    """Writes three images, the last one last."""
    if os.path.exists(picture(folder, maps.NAMES[-1], side)):
        return
    say(f"generating maps of {side}²")
    for name, data in maps.maps(int(side), EFFORT).items():
        write(picture(folder, name, side), data)


def picture(folder, name, side):
    return os.path.join(folder, f"{name}-{side}.png")


def environment(folder):
    path = os.path.join(folder, "environment.hdr")
    if not os.path.exists(path):
        write(path, surroundings.radiance_hdr(surroundings.picture()))


def scene(folder, name, side, lights):
    """Writes a scene, which is small, so it is written every time."""
    with open(os.path.join(folder, f"{name}.json"), encoding="utf-8") as file:
        about = json.load(file)
    for shading in SHADINGS:
        used = maps.NAMES if shading == "ggx" else maps.NAMES[:2]
        document = files.gltf([material(shading)], about["accessors"], about["views"], [about["primitive"]])
        document |= files.textures([{"uri": os.path.basename(picture(folder, map, side))} for map in used])
        document |= camera_and_lights(int(lights))
        document["buffers"] = [{"uri": f"{name}.bin", "byteLength": about["bytes"]}]
        write(os.path.join(folder, f"{name}-{side}-{lights}-{shading}.gltf"), json.dumps(document).encode())


PARTS = {"environment": environment, "mesh": mesh, "maps": maps_of, "scene": scene}


def write(path, data):
    with files.written(path) as file:
        file.write(data)


def main(folder, parts):
    os.makedirs(folder, exist_ok=True)
    for part in parts:
        kind, *rest = part.split(":")
        PARTS[kind](folder, *rest)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
