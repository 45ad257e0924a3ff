"""The tools, each as the commands that make an asset of a model."""

import dataclasses
from collections.abc import Callable

# Triangles of the asset by those of the model, and texels along a side of its textures.
RATIO = 0.1
TEXELS = 1024


@dataclasses.dataclass(frozen=True)
class Job:
    """What is made of what: the model, its triangles, the asset."""

    source: str
    triangles: int
    out: str


@dataclasses.dataclass(frozen=True)
class Tool:
    """A tool by its name; `commands` of a job are run one after the other."""

    name: str
    commands: Callable[[Job], list]


def taotie(program):
    def commands(job):
        wanted = str(max(4, int(job.triangles * RATIO)))
        options = ["--for", "web", "--triangles", wanted, "--size", str(TEXELS), "--no-verify"]
        return [[program, "bake", job.source, "-o", job.out, *options]]

    return Tool("taotie bake --for web", commands)


def gltf_transform(node):
    def commands(job):
        simplify = ["--simplify-ratio", str(RATIO), "--simplify-error", "1"]
        textures = ["--texture-compress", "webp", "--texture-size", str(TEXELS)]
        return [[node.program("gltf-transform"), "optimize", job.source, job.out, *simplify, *textures]]

    return Tool("gltf-transform optimize", commands)


def gltfpack(node, native):
    """With `native`, a build that packs textures, KTX2; npm's cannot: gltf-transform packs them as WebP before it."""
    if native:
        return Tool("gltfpack -si -tc", lambda job: [[*pack(native, job.source, job), "-tc", "-tl", str(TEXELS)]])
    transform = node.program("gltf-transform")
    side = ["--width", str(TEXELS), "--height", str(TEXELS)]

    def commands(job):
        between = f"{job.out}.textures.glb"
        resize, webp = [transform, "resize", job.source, between, *side], [transform, "webp", between, between]
        return [resize, webp, pack(node.program("gltfpack"), between, job)]

    return Tool("gltfpack -si, WebP", commands)


def pack(gltfpack, source, job):
    """The error is not limited, so that the ratio is reached; geometry is compressed as far as it can be."""
    return [gltfpack, "-i", source, "-o", job.out, "-si", str(RATIO), "-se", "1", "-cc"]
