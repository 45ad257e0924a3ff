"""The scans: the third-party models with the most triangles."""

import dataclasses
import os

import inspected
import subject

# Folders of scans and of models scanned or modelled in detail, with a subfolder for every object.
FOLDERS = ("odedstein-meshes", "polyhaven-models")
MODELS = (".obj", ".gltf", ".glb")
COUNT = 6


@dataclasses.dataclass(frozen=True)
class Scan:
    """A model as glTF, its triangles, and whether it has textures."""

    name: str
    path: str
    bytes: int
    triangles: int
    is_textured: bool


def scans(data, folder, program):
    """The `COUNT` scans with the most triangles, in descending order. OBJ is converted into `folder`."""
    objects = [entry for name in FOLDERS for entry in entries(os.path.join(data, name)) if os.path.isdir(entry)]
    found = [scan(os.path.basename(entry), model, folder, program) for entry in objects if (model := finest(entry))]
    return sorted(found, key=lambda scan: -scan.triangles)[:COUNT]


def entries(folder):
    return sorted(os.path.join(folder, name) for name in os.listdir(folder)) if os.path.isdir(folder) else []


def finest(folder):
    """The largest model of a folder, which may also contain coarser ones; None if it contains none."""
    return max((path for path in entries(folder) if path.endswith(MODELS)), key=os.path.getsize, default=None)


def scan(name, path, folder, program):
    model = subject.of(name, path, folder)
    counts = inspected.of(program, model.path)["counts"]
    return Scan(name, model.path, model.bytes, counts["triangles_drawn"], counts["textures"] > 0)
