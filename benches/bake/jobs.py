"""The bakes, and their command lines."""

import dataclasses
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
# Distance of the rays' origins from the low-poly mesh, model units: beyond the relief and the chords of the low-poly
# mesh.
EXTRUSION = 0.05
MARGIN = 16


@dataclasses.dataclass(frozen=True)
class Job:
    """One bake onto the low-poly mesh, or onto a generated one of `triangles`. `samples` per texel, or rays for ao;
    `rounds` is the default number of rounds."""

    name: str
    title: str
    scan: str
    size: int = 2048
    kind: str = "normal"
    samples: int = 1
    triangles: int | None = None
    blender: bool = False
    rounds: int = 1


JOBS = (
    Job("normal-1m", "1 M → 2048², normals, 1 sample", "1m", blender=True, rounds=3),
    Job("normal-1m-4", "1 M → 2048², normals, 4 samples", "1m", samples=4, rounds=3),
    Job("ao-1m", "1 M → 2048², occlusion, 16 rays", "1m", kind="ao", samples=16, blender=True, rounds=3),
    Job("normal-8m", "8 M → 4096², normals, 1 sample", "8m", size=4096, blender=True, rounds=3),
    Job("normal-20m", "20 M → 2048², normals, 4 samples", "20m", samples=4),
    Job("made-20m", "20 M → 50,000 triangles generated, 2048², normals, 4 samples", "20m", samples=4, triangles=50_000),
)


class Paths:
    """The paths of the files in a folder."""

    def __init__(self, folder):
        self.folder = folder

    def scan(self, job):
        return self.scan_named(job.scan)

    def scan_named(self, name):
        return os.path.join(self.folder, f"scan-{name}.ply")

    def low(self, extension):
        return os.path.join(self.folder, f"low.{extension}")

    def output(self, job, tool, extension):
        return os.path.join(self.folder, f"{job.name}-{tool}.{extension}")


def taotie(program, job, paths):
    """The command that bakes the job with Taotie, without the proof, since Blender has none."""
    command = [program, "bake", paths.scan(job), "-o", paths.output(job, "taotie", "glb")]
    command += ["--triangles", str(job.triangles)] if job.triangles else ["--low", paths.low("glb")]
    command += ["--size", str(job.size), "--maps", job.kind]
    rays = ["--ao-rays", str(job.samples), "--samples", "1"]
    command += rays if job.kind == "ao" else ["--samples", str(job.samples)]
    return command + ["--no-verify"]


def blender(job, paths):
    """The command that bakes the job with Blender, which also calls rays samples."""
    command = [sys.executable, os.path.join(HERE, "blender.py"), paths.scan(job), paths.low("npz")]
    command += [paths.output(job, "blender", "png"), "--map", job.kind, "--size", str(job.size)]
    return command + ["--samples", str(job.samples), "--extrusion", str(EXTRUSION), "--margin", str(MARGIN)]
