"""The programs, each as the commands that make an asset from a scan."""

import dataclasses
import hashlib
import importlib.metadata
import os
import sys
from collections.abc import Callable

from scans import Scan

HERE = os.path.dirname(os.path.abspath(__file__))
# Bits of the normals of a whole scan; gltfpack's default is 8.
NORMAL_BITS = 12
# Side of textures and baked maps, texels: the first unless bytes are limited.
SIDES = (1024, 724, 512, 362, 256, 181, 128)


@dataclasses.dataclass(frozen=True)
class Order:
    """A requested asset: `triangles` triangles, with textures of at most `side` texels per side."""

    scan: Scan
    triangles: int
    side: int = SIDES[0]

    @property
    def ratio(self):
        return f"{self.triangles / self.scan.triangles:.6f}"


@dataclasses.dataclass(frozen=True)
class Program:
    """A program. `commands(order, source, out)` write `out`; `identity` changes whenever their result may.

    `keeps_textures`: it cannot resize textures, so gltf-transform resizes them first if they should be smaller.
    `has_own_maps`: `side` matters even if the scan has no textures.
    """

    name: str
    identity: str
    commands: Callable[[Order, str, str], list]
    keeps_textures: bool = False
    has_own_maps: bool = False


def resizer(node):
    transform = node.program("gltf-transform")

    def commands(order, source, out):
        return [[transform, "resize", source, out, "--width", str(order.side), "--height", str(order.side)]]

    return Program("gltf-transform resize", node.identity(), commands)


def whole(node):
    """The simplest alternatives: every triangle, packed."""
    bits = ["-vn", str(NORMAL_BITS)]
    return [gltfpack(node, "gltfpack -cc", []), gltfpack(node, f"gltfpack -cc {' '.join(bits)}", bits)]


def reducing(node, taotie_program):
    """Programs that reduce triangles."""
    # The error is not limited, so that the ratio is reached.
    pack = gltfpack(node, "gltfpack -si", ["-se", "1"])
    return [pack, gltf_transform(node), meshoptimizer(node), blender(), taotie(taotie_program)]


def gltfpack(node, name, options):
    program = node.program("gltfpack")

    def commands(order, source, out):
        simplify = ["-si", order.ratio] if order.triangles < order.scan.triangles else []
        return [[program, "-i", source, "-o", out, "-cc", *simplify, *options]]

    return Program(name, node.identity(), commands, keeps_textures=True)


def gltf_transform(node):
    program = node.program("gltf-transform")

    def commands(order, source, out):
        simplify = ["--simplify-ratio", order.ratio, "--simplify-error", "1"]
        textures = ["--texture-compress", "webp", "--texture-size", str(order.side)]
        return [[program, "optimize", source, out, *simplify, *textures]]

    return Program("gltf-transform", node.identity(), commands)


def meshoptimizer(node):
    script = os.path.join(HERE, "simplify.mjs")

    def commands(order, source, out):
        return [["node", script, node.path, source, out, order.ratio]]

    return Program("meshoptimizer", node.identity() + content_hash(script), commands, keeps_textures=True)


def blender():
    script = os.path.join(HERE, "blender.py")

    def commands(order, source, out):
        return [[sys.executable, script, source, out, "--ratio", order.ratio, "--side", str(order.side)]]

    return Program("Blender", blender_version() + content_hash(script), commands, has_own_maps=True)


def blender_version():
    try:
        return importlib.metadata.version("bpy")
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def taotie(program):
    def commands(order, source, out):
        size = ["--triangles", str(order.triangles), "--size", str(order.side)]
        return [[program, "bake", source, "-o", out, *size, "--meshopt", "--images", "webp:85", "--no-verify"]]

    return Program("taotie, fixed size", content_hash(program), commands, has_own_maps=True)


def content_hash(*paths):
    """SHA-256 of the files' bytes, one after the other."""
    sha = hashlib.sha256()
    for path in paths:
        with open(path, "rb") as file:
            sha.update(hashlib.file_digest(file, "sha256").digest())
    return sha.hexdigest()
