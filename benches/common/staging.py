"""The vessel as glTF: attributes, material, camera and lights."""

import math

import numpy as np
import view


def attributes(vessel):
    """The arrays of shape.vessel by glTF's names, with v downward."""
    uvs = vessel["uvs"] * np.float32([1, -1]) + np.float32([0, 1])
    names = {"POSITION": "positions", "NORMAL": "normals", "TANGENT": "tangents"}
    return {name: vessel[array] for name, array in names.items()} | {"TEXCOORD_0": uvs}


def material(shading):
    """`cook-torrance` is bare metal, whose slope is α = roughness². Textures are those of maps.NAMES, in order."""
    values = {"baseColorTexture": {"index": 0}, "metallicFactor": 1.0, "roughnessFactor": 1.0}
    if shading == "cook-torrance":
        values["roughnessFactor"] = math.sqrt(view.SLOPE)
        return {"pbrMetallicRoughness": values, "normalTexture": {"index": 1}}
    values["metallicRoughnessTexture"] = {"index": 2}
    return {"pbrMetallicRoughness": values, "normalTexture": {"index": 1}, "occlusionTexture": {"index": 2}}


def camera_and_lights(count=1):
    """The nodes other than the mesh's. The lights share the intensity of one, on a ring around the vessel."""
    camera = {"yfov": math.radians(view.FOV), "znear": view.NEAR, "zfar": view.FAR}
    light = {"type": "point", "intensity": view.INTENSITY / max(count, 1), "color": [1, 1, 1]}
    lamp = {"name": "light", "extensions": {"KHR_lights_punctual": {"light": 0}}}
    nodes = [
        {"mesh": 0, "name": "vessel"},
        {"camera": 0, "name": "camera", "matrix": view.world_from_camera().T.ravel().tolist()},
        *(lamp | {"translation": place} for place in ring(count)),
    ]
    return {
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [light]}},
        "cameras": [{"type": "perspective", "name": "camera", "perspective": camera}],
        "nodes": nodes,
        "scenes": [{"nodes": list(range(len(nodes)))}],
    }


def ring(count):
    """Positions of `count` lights, the first of which is view.LIGHT."""
    turns = (view.turned(2 * math.pi * k / count)[:3, :3] for k in range(count))
    return [(turn @ view.LIGHT).tolist() for turn in turns]
