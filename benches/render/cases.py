"""The measured cases: meshes, shadings, sizes, and the participating programs."""

import dataclasses
import os
import sys

from measured import SHADINGS, frames, light, triangles

HERE = os.path.dirname(os.path.abspath(__file__))
MESHES = {name: f"{triangles(name):,}" for name in ("2k", "200k", "2m")}
SIZES = ((1024, 1024), (1920, 1080))


# The size for whole processes.
COLD_MESH, COLD_SIZE = "2k", (1024, 1024)
# Three maps of 2048², four bytes per texel, without smaller levels; MiB.
DECODED_MAPS = 3 * 2048**2 * 4 / 2**20
# Positions, normals, tangents and uvs as floats, and three indices per triangle; bytes.
VERTEX, TRIANGLE = 48, 12


@dataclasses.dataclass(frozen=True, eq=False)
class Participant:
    """A renderer. `talks` returns the command of the process that answers requests (see talk.py), given folder, mesh
    and shading; `cold` the command that writes one image and ends, given also width, height and path."""

    name: str
    title: str
    shadings: tuple
    talks: callable
    cold: callable
    # How its image differs; stated below the tables.
    note: str = ""
    environment: dict = dataclasses.field(default_factory=dict)
    # The sizes of its frames: for peers that come nearest to Taotie, all.
    sizes: tuple = SIZES[:1]
    # Whether its process can only render images of one size.
    one_size: bool = False
    # Returns the command to run before anything else, given the folder and a mesh.
    first: callable = None


def taotie(programs, name="taotie", title="Taotie", more=()):
    """`programs` is the folder that contains taotie, and frames or examples/frames."""

    def kept(folder):
        return os.path.join(folder, f"environment-{name}.kept")

    def first(folder, mesh):
        command = [frames(programs), os.path.join(folder, f"{mesh}-ggx.glb"), "--frames", "0"]
        return [*command, *light(folder, "ggx", "--environment"), "--keep", kept(folder)]

    def talks(folder, mesh, shading):
        command = [frames(programs), os.path.join(folder, f"{mesh}-{shading}.glb"), "--shading", shading, "--ask"]
        around = ["--environment", kept(folder)] if shading == "ggx" else light(folder, shading, "")
        return [*command, *more, *around]

    def cold(folder, mesh, shading, width, height, path):
        command = [os.path.join(programs, "taotie"), "render", os.path.join(folder, f"{mesh}-{shading}.glb")]
        command += ["-o", path, "--size", f"{width}x{height}", "--samples", "1", "--camera", "camera"]
        command += ["--shading", shading, "--tone", "linear", *light(folder, shading, "--env")]
        return command

    return Participant(name, title, SHADINGS, talks, cold, first=first, sizes=SIZES)


def script(command, name, title, shadings, more=(), **rest):
    """A peer that is a script: its command, then folder, mesh and shading."""

    def talks(folder, mesh, shading):
        return [*command, folder, mesh, shading, *more]

    def cold(folder, mesh, shading, width, height, path):
        return [*talks(folder, mesh, shading), "--cold", str(width), str(height), path]

    return Participant(name, title, shadings, talks, cold, **rest)


def python(name, *rest, **more):
    return script([sys.executable, os.path.join(HERE, name)], *rest, **more)


def peers(folder):
    """All except Taotie; the first is the one that counts. `folder` is where install.sh puts everything but Python."""
    three = script(
        ["node", os.path.join(HERE, "three.mjs")],
        "three",
        "three.js, Chromium",
        ("ggx",),
        [os.path.join(folder, "node")],
        note="its memory while rendering frames is that of all processes of the browser",
    )
    return [
        python("llvmpipe.py", "llvmpipe", "llvmpipe, own shaders", SHADINGS, sizes=SIZES),
        python("lavapipe.py", "lavapipe", "wgpu, lavapipe, own shaders", ("ggx",), sizes=SIZES),
        python("vtk_pbr.py", "vtk", "VTK", ("ggx",)),
        python(
            "pyrender_osmesa.py",
            "pyrender",
            "pyrender",
            ("ggx",),
            note="without an environment, which it does not support, but with constant ambient light",
        ),
        python(
            "mitsuba_1spp.py",
            "mitsuba",
            "Mitsuba, 1 sample",
            SHADINGS,
            note="one noisy ray per pixel, Smith's masking instead of V-shaped grooves",
        ),
        three,
        python(
            "f3d_view.py", "f3d", "F3D", ("ggx",), note="its lights have no falloff, so its image is darker"
        ),
        python(
            "open3d_filament.py",
            "open3d",
            "Open3D (Filament)",
            ("ggx",),
            note="under its own environment",
            one_size=True,
        ),
    ]
