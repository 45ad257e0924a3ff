"""Reads and writes PLY, GLB and textures inside GLB, using only the standard library except for the arrays' bytes."""

import contextlib
import json
import os
import struct

FLOAT, U32 = 5126, 5125
VERTICES, INDICES = 34962, 34963
LINEAR, TRILINEAR, REPEAT, CLAMP = 9729, 9987, 10497, 33071


@contextlib.contextmanager
def written(path):
    """A file that gets its name only once it is complete."""
    with open(f"{path}.part", "wb") as file:
        yield file
    os.replace(f"{path}.part", path)


def ply_header(vertices, triangles):
    """The header of a binary PLY with only positions and triangles."""
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {vertices}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"element face {triangles}", "property list uchar int vertex_indices", "end_header", ""]
    return "\n".join(lines).encode()


def read_ply(path):
    """Positions (n, 3) and triangles (m, 3) of a file with this header."""
    import numpy as np

    with open(path, "rb") as file:
        header = file.read(4096).split(b"end_header\n")[0]
        counts = [int(line.split()[2]) for line in header.splitlines() if line.startswith(b"element")]
        file.seek(len(header) + len(b"end_header\n"))
        positions = np.fromfile(file, "<f4", 3 * counts[0]).reshape(-1, 3)
        triangles = np.fromfile(file, np.dtype([("n", "u1"), ("corners", "<i4", 3)]), counts[1])["corners"]
    return positions, triangles


BARE = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.6}}


class Buffer:
    """The bytes of a glTF file, and their description in its JSON."""

    def __init__(self):
        self.bytes, self.views, self.accessors = bytearray(), [], []

    def view(self, data, **more):
        """Adds bytes; returns the index of their buffer view."""
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data), **more})
        self.bytes.extend(data)
        self.bytes.extend(bytes(-len(data) % 4))
        return len(self.views) - 1

    def accessor(self, array, component, target, kind):
        """Adds an array; returns the index of its accessor."""
        accessor = {"bufferView": self.view(array.tobytes(), target=target), "componentType": component, "type": kind}
        accessor |= {"count": len(array), "min": array.min(0).tolist(), "max": array.max(0).tolist()}
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def primitive(self, attributes, triangles, material=0):
        """A primitive with the material of this index and the float attributes of these names."""
        names = {
            name: self.accessor(a.astype("<f4"), FLOAT, VERTICES, f"VEC{a.shape[1]}") for name, a in attributes.items()
        }
        indices = self.accessor(triangles.astype("<u4").reshape(-1, 1), U32, INDICES, "SCALAR")
        return {"attributes": names, "indices": indices, "material": material}


def gltf(materials, accessors, views, primitives):
    """The JSON of one mesh, as a dictionary; it has neither textures nor buffer yet."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "meshes": [{"primitives": primitives}],
    }


def textures(images):
    """Texture i shows image i, repeated along u and clamped along v, trilinear; `images` are those of glTF."""
    if not images:
        return {}
    return {
        "images": images,
        "samplers": [{"magFilter": LINEAR, "minFilter": TRILINEAR, "wrapS": REPEAT, "wrapT": CLAMP}],
        "textures": [{"source": i, "sampler": 0} for i in range(len(images))],
    }


def write_glb(path, attributes, triangles, material=BARE, images=(), extra=None):
    """One mesh with the float attributes of these names; `images` and `extra` as for `write_parts`."""
    write_parts(path, [(attributes, triangles, material)], images, extra)


def write_parts(path, parts, images=(), extra=None):
    """One mesh of parts, each of float attributes by their names, triangles and a material.

    `images` are the bytes of PNG files; texture i of the materials shows image i, see `textures`. `extra` is merged
    into the file's JSON: nodes in addition to the mesh's, which is number 0, and their requirements.
    """
    buffer = Buffer()
    primitives = [buffer.primitive(*part[:2], material=number) for number, part in enumerate(parts)]
    document = gltf([material for _, _, material in parts], buffer.accessors, buffer.views, primitives)
    document |= textures([{"bufferView": buffer.view(image), "mimeType": "image/png"} for image in images])
    write_document(path, document | (extra or {}), buffer.bytes)


def write_document(path, document, blob):
    """A GLB of this JSON, as a dictionary without the buffer, and these bytes."""
    text = json.dumps(document | {"buffers": [{"byteLength": len(blob)}]}).encode()
    text += b" " * (-len(text) % 4)
    with written(path) as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(blob)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(blob), b"BIN\0") + blob)


def texture_of(path, name):
    """The bytes of the PNG for a texture of the first material of a GLB, such as normalTexture."""
    with open(path, "rb") as file:
        file.seek(12)
        gltf = json.loads(_chunk(file))
        blob = _chunk(file)
    texture = gltf["textures"][gltf["materials"][0][name]["index"]]
    view = gltf["bufferViews"][gltf["images"][texture["source"]]["bufferView"]]
    start = view.get("byteOffset", 0)
    return blob[start : start + view["byteLength"]]


def _chunk(file):
    return file.read(struct.unpack("<I4s", file.read(8))[0])
