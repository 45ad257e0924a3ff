"""EXT_meshopt_compression, which Blender's importer cannot read. Formats and filters: appendices A and B of the extension."""

import numpy as np

from .problem import Problem


NAME = "EXT_meshopt_compression"


def unpack(described, data):
    """Returns the bytes of a buffer view from its packed ones."""
    count, stride, mode = described["count"], described["byteStride"], described["mode"]
    if (mode, data[0]) == ("TRIANGLES", 0xE1):
        return unpack_triangles(data, count).astype(f"<u{stride}").tobytes()
    if (mode, data[0]) == ("ATTRIBUTES", 0xA0):
        return _filtered(unpack_attributes(data, count, stride), described.get("filter", "NONE")).tobytes()
    raise Problem(f"cannot read the asset: unknown packing {mode} {data[0]:#x}; update the add-on")


def unpack_attributes(data, count, stride):
    """Returns (count, stride) bytes: differences to the preceding element, by byte, in groups of 16."""
    out = np.empty((count, stride), np.uint8)
    last = np.frombuffer(data[-stride:], np.uint8)
    at, most = 1, min(8192 // stride & ~15, 256)
    for start in range(0, count, most):
        size = min(most, count - start)
        for byte in range(stride):
            deltas, at = _unpack_groups(data, at, size)
            steps = (deltas >> 1) ^ -(deltas & 1)
            out[start : start + size, byte] = np.cumsum(steps, dtype=np.uint8) + last[byte]
        last = out[start + size - 1]
    return out


def _unpack_groups(data, at, size):
    groups = -(-size // 16)
    header, at = data[at : at + -(-groups // 4)], at + -(-groups // 4)
    values = bytearray()
    for group in range(groups):
        bits = (0, 2, 4, 8)[header[group // 4] >> group % 4 * 2 & 3]
        codes, at = data[at : at + 2 * bits], at + 2 * bits
        if bits in (0, 8):
            values += codes or bytes(16)
            continue
        escape = (1 << bits) - 1
        for code in (byte >> shift & escape for byte in codes for shift in range(8 - bits, -1, -bits)):
            values.append(data[at] if code == escape else code)
            at += code == escape
    return np.frombuffer(bytes(values[:size]), np.uint8).astype(np.int16), at


def _filtered(rows, name):
    if name == "OCTAHEDRAL":
        stored = rows.view("i1" if rows.shape[1] == 4 else "<i2")
        top = np.iinfo(stored.dtype).max
        x, y, one = (stored[:, i].astype(np.float64) for i in range(3))
        z = one - abs(x) - abs(y)
        fold = np.minimum(z, 0)
        vectors = np.stack([x + np.where(x >= 0, fold, -fold), y + np.where(y >= 0, fold, -fold), z], axis=1)
        vectors *= top / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
        return np.column_stack([np.rint(vectors).astype(stored.dtype), stored[:, 3]])
    if name == "EXPONENTIAL":
        stored = rows.view("<i4")
        return np.ldexp((stored << 8 >> 8).astype("<f4"), stored >> 24)
    if name != "NONE":
        raise Problem(f"cannot read the asset: unknown filter {name}; update the add-on")
    return rows


class _Recent:
    """The 16 most recent values; 0 is the latest."""

    def __init__(self):
        self.values, self.next = [0] * 16, 0

    def push(self, value):
        self.values[self.next & 15] = value
        self.next += 1

    def __getitem__(self, back):
        return self.values[(self.next - 1 - back) & 15]


class _Triangles:
    """The state of the decoder of indices."""

    def __init__(self, data, count):
        self.data, self.codes, self.at = data, data[1 : 1 + count // 3], 1 + count // 3
        self.edges, self.vertices, self.new, self.last = _Recent(), _Recent(), 0, 0

    def explicit(self):
        value = shift = 0
        while True:
            byte, self.at = self.data[self.at], self.at + 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                self.last += (value >> 1) ^ -(value & 1)
                return self.last

    def fresh(self):
        self.new += 1
        return self.new - 1

    def triangle(self, code):
        if code < 0xF0:
            return self.at_edge(*self.edges[code >> 4], code & 15)
        if code < 0xFE:
            aux, first = self.data[len(self.data) - 16 + (code & 15)], 0
        else:
            aux, first = self.data[self.at], 0 if code == 0xFE else 15
            self.at += 1
            self.new = 0 if aux == 0 else self.new
        kinds = (first, aux >> 4, aux & 15)
        free = code >= 0xFE
        corners = [self.fresh() if k == 0 else None if free and k == 15 else self.vertices[k - 1] for k in kinds]
        a, b, c = (self.explicit() if corner is None else corner for corner in corners)
        for corner, kind in zip((a, b, c), kinds):
            if kind == 0 or free and kind == 15:
                self.vertices.push(corner)
        for edge in ((b, a), (c, b), (a, c)):
            self.edges.push(edge)
        return a, b, c

    def at_edge(self, a, b, kind):
        if 0 < kind < 13:
            c = self.vertices[kind]
        else:
            if kind in (13, 14):
                self.last += 2 * kind - 27
            c = self.fresh() if kind == 0 else self.last if kind < 15 else self.explicit()
            self.vertices.push(c)
        self.edges.push((c, b))
        self.edges.push((a, c))
        return a, b, c


def unpack_triangles(data, count):
    """Returns the indices of triangles, each of which repeats recent edges and vertices."""
    state = _Triangles(data, count)
    return np.array([state.triangle(code) for code in state.codes], np.uint32).ravel()
