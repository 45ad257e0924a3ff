"""A third-party model as glTF, which every program reads."""

import dataclasses
import json
import os
import urllib.parse

import files
import numpy as np


@dataclasses.dataclass(frozen=True)
class Subject:
    """A model as glTF, with the bytes of all its files."""

    name: str
    path: str
    bytes: int


def of(name, path, folder):
    """Converts OBJ to GLB in `folder`; other files are used unchanged."""
    if path.endswith(".obj"):
        glb = os.path.join(folder, f"{name}.glb")
        positions, triangles = read_obj(path)
        attributes = {"POSITION": positions, "NORMAL": vertex_normals(positions, triangles)}
        files.write_glb(glb, attributes, triangles)
        path = glb
    return Subject(name, path, sum(map(os.path.getsize, parts(path))))


def parts(path):
    """The file itself, and those it refers to."""
    if path.endswith(".glb"):
        return [path]
    with open(path, encoding="utf-8") as file:
        gltf = json.load(file)
    named = [part.get("uri", "data:") for part in gltf.get("buffers", []) + gltf.get("images", [])]
    others = {urllib.parse.unquote(uri) for uri in named if not uri.startswith("data:")}
    return [path, *(os.path.join(os.path.dirname(path), name) for name in sorted(others))]


def read_obj(path):
    """Positions (n, 3) and triangles (m, 3) of a file that contains nothing else."""
    with open(path, encoding="utf-8") as file:
        rows = [line.split() for line in file]
    positions = [row[1:4] for row in rows if row and row[0] == "v"]
    corners = [[corner.split("/")[0] for corner in row[1:]] for row in rows if row and row[0] == "f"]
    return np.array(positions, np.float32), np.array(corners, np.uint32) - 1


def vertex_normals(positions, triangles):
    """Unit normals (n, 3): the area-weighted mean of those of the adjacent triangles."""
    a, b, c = np.moveaxis(positions.astype(np.float64)[triangles], 1, 0)
    sums = np.zeros_like(positions, np.float64)
    for corner in range(3):
        np.add.at(sums, triangles[:, corner], np.cross(b - a, c - a))
    return sums / np.maximum(np.linalg.norm(sums, axis=1, keepdims=True), 1e-30)
