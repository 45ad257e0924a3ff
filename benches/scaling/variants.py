"""Makes parts of what is shown in a folder, where they are absent: variants.py FOLDER PART...

A part is `environment`, `mesh MESH`, `maps SIDE` or `scene MESH SIDE LIGHTS`, in one word with `:` between. A scene is
a small glTF file for each shading that names the buffer of a mesh and the pictures of maps.
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

# Of PNG's compression: files this large should not take long, and nobody keeps them.
EFFORT = 1


def mesh(folder, name):
    """NAME.bin, and what glTF says of it in NAME.json, which comes last."""
    if os.path.exists(os.path.join(folder, f"{name}.json")):
        return
    say(f"making the vessel of {name} triangles")
    vessel, buffer = shape.vessel(*GRIDS[name]), files.Buffer()
    primitive = buffer.primitive(attributes(vessel), vessel["triangles"])
    about = {"accessors": buffer.accessors, "views": buffer.views, "primitive": primitive, "bytes": len(buffer.bytes)}
    write(os.path.join(folder, f"{name}.bin"), buffer.bytes)
    write(os.path.join(folder, f"{name}.json"), json.dumps(about).encode())


def maps_of(folder, side):
    """Three pictures, of which the last is written last."""
    if os.path.exists(picture(folder, maps.NAMES[-1], side)):
        return
    say(f"making maps of {side}²")
    for name, data in maps.maps(int(side), EFFORT).items():
        write(picture(folder, name, side), data)


def picture(folder, name, side):
    return os.path.join(folder, f"{name}-{side}.png")


def environment(folder):
    path = os.path.join(folder, "environment.hdr")
    if not os.path.exists(path):
        write(path, surroundings.radiance_hdr(surroundings.picture()))


def scene(folder, name, side, lights):
    """Small, so it is written every time."""
    with open(os.path.join(folder, f"{name}.json"), encoding="utf-8") as file:
        about = json.load(file)
    for shading in SHADINGS:
        used = maps.NAMES if shading == "ggx" else maps.NAMES[:2]
        told = files.gltf([material(shading)], about["accessors"], about["views"], [about["primitive"]])
        told |= files.textures([{"uri": os.path.basename(picture(folder, map, side))} for map in used])
        told |= camera_and_lights(int(lights))
        told["buffers"] = [{"uri": f"{name}.bin", "byteLength": about["bytes"]}]
        write(os.path.join(folder, f"{name}-{side}-{lights}-{shading}.gltf"), json.dumps(told).encode())


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
