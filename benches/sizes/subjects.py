"""The models to reduce."""

import dataclasses
import os

import hashes
import inspected
import subject

SAMPLES, HAVEN = "khronos-gltf-sample-assets", "polyhaven-models"
# Modelled and scanned objects with textures, a shape without any, and the scan of a museum's bust, which is an OBJ
# file.
PATHS = {
    "WaterBottle": f"{SAMPLES}/WaterBottle/glTF/WaterBottle.gltf",
    "Suzanne": f"{SAMPLES}/Suzanne/glTF/Suzanne.gltf",
    "Camera_01": f"{HAVEN}/Camera_01/Camera_01.gltf",
    "tea_set_01": f"{HAVEN}/tea_set_01/tea_set_01_1k.gltf",
    "shaderball": "materialx/shaderball.glb",
    "nefertiti": "odedstein-meshes/nefertiti/nefertiti-lowres.obj",
}
# Both are small and measured in a few minutes.
QUICK = ("Suzanne", "WaterBottle")


@dataclasses.dataclass(frozen=True)
class Model:
    """A model as glTF; `side` is the width or height of its largest texture in texels, 0 without textures."""

    name: str
    path: str
    bytes: int
    side: int
    content: str


def models(program, data, folder, only):
    """The named models, or all, as far as the data folder contains them; OBJ is converted into `folder`."""
    wanted = {name: os.path.join(data, path) for name, path in PATHS.items() if not only or name in only}
    return [model(program, subject.of(name, path, folder)) for name, path in wanted.items() if os.path.exists(path)]


def model(program, found):
    about = inspected.of(program, found.path)
    sides = [max(t["width"], t["height"]) for m in about["materials"] for t in m["textures"]]
    content = hashes.of_files(*subject.parts(found.path))
    return Model(found.name, found.path, found.bytes, max(sides, default=0), content)
