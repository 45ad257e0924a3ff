"""Makes what all participants show in a folder, where it is absent: scene.py FOLDER MESH..."""

import math
import os
import sys

import files
import maps
import numpy as np
import shape
import surroundings
import view

# Cells around and from bottom to top; two triangles each.
MESHES = {"2k": (32, 32), "200k": (320, 312), "2m": (1000, 1000)}


def material(shading):
    """As glTF has it. `cook-torrance` is bare metal, whose slope is α = roughness²."""
    values = {"baseColorTexture": {"index": 0}, "metallicFactor": 1.0, "roughnessFactor": 1.0}
    if shading == "cook-torrance":
        values["roughnessFactor"] = math.sqrt(view.SLOPE)
        return {"pbrMetallicRoughness": values, "normalTexture": {"index": 1}}
    values["metallicRoughnessTexture"] = {"index": 2}
    return {"pbrMetallicRoughness": values, "normalTexture": {"index": 1}, "occlusionTexture": {"index": 2}}


def camera_and_light():
    """The nodes beside the mesh's."""
    camera = {"yfov": math.radians(view.FOV), "znear": view.NEAR, "zfar": view.FAR}
    light = {"type": "point", "intensity": view.INTENSITY, "color": [1, 1, 1]}
    nodes = [
        {"mesh": 0, "name": "vessel"},
        {"camera": 0, "name": "camera", "matrix": view.world_from_camera().T.ravel().tolist()},
        {"name": "light", "translation": view.LIGHT, "extensions": {"KHR_lights_punctual": {"light": 0}}},
    ]
    return {
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [light]}},
        "cameras": [{"type": "perspective", "name": "camera", "perspective": camera}],
        "nodes": nodes,
        "scenes": [{"nodes": [0, 1, 2]}],
    }


def write_mesh(folder, name):
    """NAME.npz with v upward, and a GLB for each shading."""
    vessel = shape.vessel(*MESHES[name])
    uvs = vessel["uvs"] * np.float32([1, -1]) + np.float32([0, 1])
    attributes = {"POSITION": vessel["positions"], "NORMAL": vessel["normals"], "TANGENT": vessel["tangents"]}
    pictures = [read(os.path.join(folder, f"{map}.png")) for map in ("albedo", "normal", "orm")]
    for shading in ("cook-torrance", "ggx"):
        path = os.path.join(folder, f"{name}-{shading}.glb")
        used = pictures if shading == "ggx" else pictures[:2]
        files.write_glb(
            path, attributes | {"TEXCOORD_0": uvs}, vessel["triangles"], material(shading), used, camera_and_light()
        )
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
        print("making maps and environment", file=sys.stderr)
        write_pictures(folder)
    for name in names:
        if not os.path.exists(os.path.join(folder, f"{name}.npz")):
            print(f"making the vessel of {name} triangles", file=sys.stderr)
            write_mesh(folder, name)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
