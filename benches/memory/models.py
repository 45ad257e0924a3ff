"""Generated models: grids in every format, and glTF with many images, copies and text."""

import array
import base64
import json
import math
import os
import random
import struct

MEANINGS = ["baseColorTexture", "metallicRoughnessTexture", "normalTexture", "occlusionTexture", "emissiveTexture"]


class Grid:
    """A sheet with waves of `side` × `side` squares."""

    def __init__(self, side):
        self.side = side
        self.count = (side + 1) ** 2

    def positions(self):
        for y in range(self.side + 1):
            for x in range(self.side + 1):
                u, v = x / self.side, y / self.side
                yield u, v, 0.02 * math.sin(40 * u) * math.sin(40 * v)

    def triangles(self):
        row = self.side + 1
        for y in range(self.side):
            for x in range(self.side):
                a = y * row + x
                yield a, a + 1, a + row
                yield a + 1, a + row + 1, a + row


def obj(path, side, has_uvs=False, texture=None):
    grid = Grid(side)
    with open(path, "w", encoding="ascii") as file:
        if texture:
            stem = os.path.splitext(path)[0]
            with open(stem + ".mtl", "w", encoding="ascii") as library:
                library.write(f"newmtl m\nmap_Kd {texture}\n")
            file.write(f"mtllib {os.path.basename(stem)}.mtl\nusemtl m\n")
        for x, y, z in grid.positions():
            file.write(f"v {x:.6f} {y:.6f} {z:.6f}\n")
        if has_uvs or texture:
            for x, y, _ in grid.positions():
                file.write(f"vt {x:.6f} {y:.6f}\n")
            file.writelines("f {0}/{0} {1}/{1} {2}/{2}\n".format(*(i + 1 for i in t)) for t in grid.triangles())
        else:
            file.writelines("f {} {} {}\n".format(*(i + 1 for i in t)) for t in grid.triangles())


def ply(path, side, is_ascii=False, has_colors=False):
    grid = Grid(side)
    colors = "".join(f"property uchar {name}\n" for name in ("red", "green", "blue")) if has_colors else ""
    with open(path, "wb") as file:
        file.write(
            f"ply\nformat {'ascii' if is_ascii else 'binary_little_endian'} 1.0\nelement vertex {grid.count}\n"
            f"property float x\nproperty float y\nproperty float z\n{colors}element face {2 * side * side}\n"
            "property list uchar int vertex_indices\nend_header\n".encode()
        )
        if is_ascii:
            rest = " 128 128 128" if has_colors else ""
            file.writelines(f"{x:.6f} {y:.6f} {z:.6f}{rest}\n".encode() for x, y, z in grid.positions())
            file.writelines("3 {} {} {}\n".format(*t).encode() for t in grid.triangles())
        else:
            rest = b"\x80\x80\x80" if has_colors else b""
            file.writelines(struct.pack("<fff", *p) + rest for p in grid.positions())
            file.writelines(struct.pack("<Biii", 3, *t) for t in grid.triangles())


def stl(path, side, is_ascii=False):
    grid = Grid(side)
    places = array.array("f", (x for p in grid.positions() for x in p))
    corner = lambda i: tuple(places[3 * i:3 * i + 3])
    with open(path, "wb") as file:
        if is_ascii:
            file.write(b"solid sheet\n")
            for t in grid.triangles():
                file.write(b"facet normal 0 0 1\nouter loop\n")
                file.writelines("vertex {:.6f} {:.6f} {:.6f}\n".format(*corner(i)).encode() for i in t)
                file.write(b"endloop\nendfacet\n")
            file.write(b"endsolid sheet\n")
        else:
            file.write(bytes(80) + struct.pack("<I", 2 * side * side))
            file.writelines(struct.pack("<12fH", 0, 0, 1, *(x for i in t for x in corner(i)), 0) for t in grid.triangles())


def soup(path, count):
    """Binary STL of triangles that share no corner."""
    by_chance = random.Random(1)
    with open(path, "wb") as file:
        file.write(bytes(80) + struct.pack("<I", count))
        for _ in range(count):
            file.write(struct.pack("<12fH", 0, 0, 1, *(by_chance.random() for _ in range(9)), 0))


def ascii_soup(path, count):
    """ASCII STL of triangles that share no corner, in few bytes each."""
    side = 150
    corners = (f"vertex {n % side} {n // side // side} {n // side % side}\n" for n in range(3 * count))
    with open(path, "w", encoding="ascii") as file:
        file.write("solid soup\n")
        for _ in range(count):
            three = next(corners) + next(corners) + next(corners)
            file.write(f"facet normal 0 0 0\nouter loop\n{three}endloop\nendfacet\n")
        file.write("endsolid soup\n")


class Gltf:
    """A grid as glTF, to which a case adds its subject."""

    def __init__(self, side=1, has_normals=True):
        grid = Grid(side)
        positions = array.array("f", (x for p in grid.positions() for x in p))
        normals = array.array("f", [0, 0, 1] * grid.count)
        uvs = array.array("f", (x for p in grid.positions() for x in p[:2]))
        triangles = array.array("I", (i for t in grid.triangles() for i in t))
        parts = [positions, normals, uvs, triangles]
        self.bytes = b"".join(part.tobytes() for part in parts)
        lengths = [4 * len(part) for part in parts]
        views = [{"buffer": 0, "byteOffset": sum(lengths[:i]), "byteLength": lengths[i]} for i in range(4)]
        accessors = [
            {"bufferView": 0, "componentType": 5126, "count": grid.count, "type": "VEC3", "min": [0, 0, -1], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5126, "count": grid.count, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": grid.count, "type": "VEC2"},
            {"bufferView": 3, "componentType": 5125, "count": len(triangles), "type": "SCALAR"},
        ]
        attributes = {"POSITION": 0, "TEXCOORD_0": 2} | ({"NORMAL": 1} if has_normals else {})
        self.json = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": attributes, "indices": 3}]}],
            "bufferViews": views, "accessors": accessors, "buffers": [{"byteLength": len(self.bytes)}],
        }

    def textured(self, uris, meanings=("baseColorTexture",), copies=1):
        """A material for each image, with the roles `meanings`, and an image for each of `copies`."""
        images = [uri for uri in uris for _ in range(copies)]
        self.json |= {
            "images": [{"uri": uri} for uri in images], "textures": [{"source": i} for i in range(len(images))],
            "materials": [material(i, meanings) for i in range(len(images))],
        }
        first = self.json["meshes"][0]["primitives"][0]
        self.json["meshes"] = [{"primitives": [first | {"material": i}]} for i in range(len(images))]
        self.json["nodes"] = [{"mesh": i} for i in range(len(images))]
        self.json["scenes"] = [{"nodes": list(range(len(images)))}]
        return self

    def repeated(self, count):
        """Adds `count` nodes that show the first mesh."""
        self.json["nodes"] = [{"mesh": 0, "translation": [i % 100, i // 100, 0]} for i in range(count)]
        self.json["scenes"] = [{"nodes": list(range(count))}]
        return self

    def with_materials(self, count):
        """Adds `count` unused materials."""
        self.json["materials"] = [{"name": f"m{i}", "doubleSided": True} for i in range(count)]
        return self

    def with_extras(self, count):
        """Adds `count` numbers in the extras of the file."""
        self.json["extras"] = {"numbers": list(range(count))}
        return self

    def write(self, path, is_embedded=False):
        """Writes `.glb`, or `.gltf` with a separate `.bin` or a `data:` URI."""
        if path.endswith(".glb"):
            self.write_glb(path)
            return
        if is_embedded:
            uri = "data:application/octet-stream;base64," + base64.b64encode(self.bytes).decode()
        else:
            uri = os.path.basename(path) + ".bin"
            with open(path + ".bin", "wb") as file:
                file.write(self.bytes)
        self.json["buffers"][0]["uri"] = uri
        with open(path, "w", encoding="utf-8") as file:
            json.dump(self.json, file)

    def write_glb(self, path):
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        content = self.bytes + bytes(-len(self.bytes) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<III", 0x46546C67, 2, 28 + len(text) + len(content)))
            file.write(struct.pack("<II", len(text), 0x4E4F534A) + text)
            file.write(struct.pack("<II", len(content), 0x004E4942) + content)


def material(image, meanings):
    """A material that uses an image in the roles `meanings`."""
    found = {}
    for meaning in meanings:
        is_metal = meaning in MEANINGS[:2]
        place = found.setdefault("pbrMetallicRoughness", {}) if is_metal else found
        place[meaning] = {"index": image}
    return found | ({"emissiveFactor": [1, 1, 1]} if "emissiveTexture" in meanings else {})


def embedded(picture, kind):
    """An image as a `data:` URI."""
    with open(picture, "rb") as file:
        return f"data:image/{kind};base64," + base64.b64encode(file.read()).decode()
