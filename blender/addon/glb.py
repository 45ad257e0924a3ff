"""Binary glTF files as JSON and bytes, where Blender's exporter and importer leave something to do."""

import json
import struct
from pathlib import Path

import numpy as np

from . import meshopt
from .problem import Problem

VERTEX, TRIANGLES, FLOAT = 34962, 4, 5126
NUMBERS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Glb:
    """A binary glTF file: its JSON and the bytes of its buffer views."""

    def __init__(self, path):
        data = Path(path).read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json = json.loads(data[20 : 20 + length])
        body = data[28 + length :]
        self.views = [_view_bytes(view, body) for view in self.json.get("bufferViews", [])]
        for name in ("extensionsUsed", "extensionsRequired"):
            kept = [used for used in self.json.pop(name, []) if used != meshopt.NAME]
            self.json |= {name: kept} if kept else {}

    def save(self, path):
        body = bytearray()
        for view, data in zip(self.json.get("bufferViews", []), self.views):
            view |= {"buffer": 0, "byteOffset": len(body), "byteLength": len(data)}
            body += data + bytes(-len(data) % 4)
        self.json["buffers"] = [{"byteLength": len(body)}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(body), 0x004E4942) + body
        Path(path).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)

    def nodes(self):
        """Returns the nodes with meshes in the order in which the program reads them: parents before children."""
        return [node for number in self._shown() if "mesh" in (node := self.json["nodes"][number])]

    def _shown(self):
        waiting = list(reversed(self.json["scenes"][self.json.get("scene", 0)]["nodes"]))
        while waiting:
            yield (number := waiting.pop())
            waiting.extend(reversed(self.json["nodes"][number].get("children", [])))

    def keep_shown(self):
        """Drops nodes outside the scene, such as coarser levels of detail, which Blender would show too."""
        shown = list(self._shown())
        numbers = {node: number for number, node in enumerate(shown)}
        self.json["nodes"] = [self.json["nodes"][node] for node in shown]
        for node in self.json["nodes"]:
            node.get("extensions", {}).pop("MSFT_lod", None)
        for parent in (*self.json["nodes"], *self.json["scenes"]):
            for name in ("children", "nodes"):
                if name in parent:
                    parent[name] = [numbers[child] for child in parent[name] if child in numbers]

    def primitives(self, node):
        return self.json["meshes"][node["mesh"]]["primitives"]

    def read(self, accessor):
        """Returns the values of an accessor, one row for each element, as stored."""
        described = self.json["accessors"][accessor]
        view = self.json["bufferViews"][described["bufferView"]]
        kind, width = np.dtype(NUMBERS[described["componentType"]]), COMPONENTS[described["type"]]
        stride = view.get("byteStride", kind.itemsize * width)
        start = described.get("byteOffset", 0)
        data = np.frombuffer(self.views[described["bufferView"]], np.uint8)
        rows = np.lib.stride_tricks.as_strided(data[start:], (described["count"], kind.itemsize * width), (stride, 1))
        return np.ascontiguousarray(rows).view(kind).reshape(described["count"], width)

    def add(self, values, like):
        """Adds an accessor for rows of numbers, with the other members of `like`; returns its index."""
        values = np.ascontiguousarray(values)
        size = values.dtype.itemsize * values.shape[1]
        padded = np.zeros((len(values), size + -size % 4), np.uint8)
        padded[:, :size] = values.view(np.uint8).reshape(len(values), size)
        self.views.append(padded.tobytes())
        self.json["bufferViews"].append({"byteStride": padded.shape[1], "target": VERTEX})
        described = {**like, "bufferView": len(self.views) - 1, "byteOffset": 0, "count": len(values)}
        self.json["accessors"].append(described)
        return len(self.json["accessors"]) - 1

    def unwrap(self):
        """Gives each triangle of primitives without UVs a separate cell of a grid, so that they can have an error map."""
        for mesh in self.json["meshes"]:
            for primitive in mesh["primitives"]:
                if "TEXCOORD_0" not in primitive["attributes"] and primitive.get("mode", TRIANGLES) == TRIANGLES:
                    self._unwrap(primitive)

    def _unwrap(self, primitive):
        attributes = primitive["attributes"]
        count = self.json["accessors"][attributes["POSITION"]]["count"]
        corners = self.read(primitive.pop("indices"))[:, 0] if "indices" in primitive else np.arange(count)
        for name, accessor in attributes.items():
            attributes[name] = self.add(self.read(accessor)[corners], self.json["accessors"][accessor])
        side = int(np.ceil(np.sqrt(len(corners) // 3)))
        number = np.arange(len(corners)) // 3
        cell = np.stack([number % side, number // side], axis=1)
        inside = np.array([(0.1, 0.1), (0.9, 0.1), (0.1, 0.9)])[np.arange(len(corners)) % 3]
        uvs = ((cell + inside) / side).astype("<f4")
        attributes["TEXCOORD_0"] = self.add(uvs, {"componentType": FLOAT, "type": "VEC2"})


def _view_bytes(view, body):
    extensions = view.pop("extensions", {})
    packed = extensions.pop(meshopt.NAME, None)
    if extensions:
        raise Problem(f"cannot import {', '.join(extensions)} into Blender: omit the option that asks for it")
    where = packed or view
    start = where.get("byteOffset", 0)
    data = body[start : start + where["byteLength"]]
    return meshopt.unpack(packed, data) if packed else data
