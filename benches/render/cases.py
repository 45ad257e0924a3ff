"""What is measured: meshes, shadings, sizes, and the programs that take part."""

import dataclasses
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
MESHES = {"2k": "2,048", "200k": "199,680", "2m": "2,000,000"}
SHADINGS = ("cook-torrance", "ggx")
SIZES = ((1024, 1024), (1920, 1080))


@dataclasses.dataclass(frozen=True)
class Participant:
    """A renderer. `talks` begins the command of the process that answers requests (see talk.py), given folder, mesh and
    shading; `cold` the command that writes one picture and ends, given the same, width, height and path."""

    name: str
    title: str
    shadings: tuple
    talks: callable
    cold: callable
    # What is different in what it shows or does; shown below the tables.
    note: str = ""
    environment: dict = dataclasses.field(default_factory=dict)


def python(script, name, title, shadings, note="", **environment):
    def talks(folder, mesh, shading):
        return [sys.executable, os.path.join(HERE, script), folder, mesh, shading]

    def cold(folder, mesh, shading, width, height, path):
        return [*talks(folder, mesh, shading), "--cold", str(width), str(height), path]

    return Participant(name, title, shadings, talks, cold, note, environment)


def taotie(programs, name="taotie", title="Taotie", note="", more=()):
    """`programs` is the folder that holds taotie and frames (or examples/frames)."""
    frames = next(
        path for path in (os.path.join(programs, *p) for p in (("examples", "frames"), ("frames",))) if os.path.exists(path)
    )

    def talks(folder, mesh, shading):
        command = [frames, os.path.join(folder, f"{mesh}-{shading}.glb"), "--shading", shading, "--ask", *more]
        return command + light(folder, shading, "--environment")

    def cold(folder, mesh, shading, width, height, path):
        command = [os.path.join(programs, "taotie"), "render", os.path.join(folder, f"{mesh}-{shading}.glb")]
        command += ["-o", path, "--size", f"{width}x{height}", "--samples", "1", "--camera", "camera"]
        return command + ["--shading", shading, "--tone", "linear", *light(folder, shading, "--env")]

    return Participant(name, title, SHADINGS, talks, cold, note)


def light(folder, shading, option):
    return [option, os.path.join(folder, "environment.hdr")] if shading == "ggx" else ["--ambient", "0.04"]


def peers():
    """All but Taotie; the first is the one that counts."""
    return [
        python("llvmpipe.py", "llvmpipe", "llvmpipe, own shaders", SHADINGS),
    ]
