"""The models that are made small."""

import os

import subject

SAMPLES, HAVEN = "khronos-gltf-sample-assets", "polyhaven-models"
# glTF by others, and a scan of a museum's statue, which comes as OBJ.
PATHS = {
    "WaterBottle": f"{SAMPLES}/WaterBottle/glTF/WaterBottle.gltf",
    "Suzanne": f"{SAMPLES}/Suzanne/glTF/Suzanne.gltf",
    "Camera_01": f"{HAVEN}/Camera_01/Camera_01.gltf",
    "tea_set_01": f"{HAVEN}/tea_set_01/tea_set_01_1k.gltf",
    "shaderball": "materialx/shaderball.glb",
    "nefertiti": "odedstein-meshes/nefertiti/nefertiti-lowres.obj",
}


def subjects(data, folder, only):
    """Those that the folder of data holds, by the names wanted, or all; OBJ is written anew into `folder`."""
    wanted = {name: path for name, path in PATHS.items() if not only or name in only}
    found = {name: os.path.join(data, path) for name, path in wanted.items()}
    return [subject.of(name, path, folder) for name, path in found.items() if os.path.exists(path)]
