"""The pair of meshes of `make bench-maps`: three objects with four materials, and a low-poly mesh of known layout.

Body and low-poly mesh are cubes blown up to balls, whose six faces are the UV islands. The layout is known as a
formula, so the comparison needs no rasteriser: any UV belongs to a face, a cell of its grid and one of the cell's two
triangles.
"""

import dataclasses

import numpy as np

import files
import frames
from frames import unit

# Normal, and the directions of columns and rows, of each face.
FACES = np.array(
    [
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)), ((-1, 0, 0), (0, 0, 1), (0, 1, 0)),
        ((0, 1, 0), (0, 0, 1), (1, 0, 0)), ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
        ((0, 0, 1), (1, 0, 0), (0, 1, 0)), ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    ],
    float,
)  # fmt: skip
# Cells along each side of a face.
LOW, BODY, STUD = 10, 112, 16
STUDS = 8
# Cells along the belt and around its tube.
AROUND, ACROSS = 240, 60
# Radius of the studs and of the belt's tube, and how far their centres are below the low-poly mesh: deeper than the
# body's relief, so that they overhang nowhere.
RADIUS, DEPTH = 0.32, 0.29
BELT_AXIS = unit(np.array((0.3, -0.2, 1.0)))
SEED = 11
# Planes through the grooves: normals, and distances from the origin.
GROOVES = (((0, 0, 1.0), 0.55), ((1.0, 1.0, 0.2), -0.3), ((-1.0, 0.7, 0.5), 0.4))
# UVs: side of an island, and its distance from the corner of its third of a row.
ISLAND, INSET = 0.30, 1 / 60
# This island is mirrored.
MIRRORED = 5
MATERIALS = ("clay", "slate", "brass", "glaze")
# Base colour, linear; roughness; metalness.
LOOKS = {
    "clay": ((0.45, 0.2, 0.1), 0.9, 0.0),
    "slate": ((0.05, 0.07, 0.09), 0.6, 0.0),
    "brass": ((0.8, 0.6, 0.3), 0.25, 1.0),
    "glaze": ((0.1, 0.5, 0.4), 0.1, 0.0),
}


@dataclasses.dataclass
class Part:
    """A closed object of the scan. `materials` are the numbers of its triangles' materials."""

    name: str
    positions: np.ndarray
    triangles: np.ndarray
    materials: np.ndarray

    def __post_init__(self):
        self.positions = self.positions.astype(np.float32)
        self.normals = frames.vertex_normals(self.positions, self.triangles).astype(np.float32)
        # Linear RGB in [0, 1].
        self.colors = (0.5 + 0.45 * np.sin(self.positions * 5 + (0, 1, 2))).astype(np.float32)


def grid_triangles(columns, rows, random=None):
    """Triangles of a grid of cells, each cell's two after each other; diagonals at random if there is a generator."""
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    corner = (y * (columns + 1) + x).ravel()
    a, b, c, d = corner, corner + 1, corner + columns + 2, corner + columns + 1
    cells = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], 1)
    if random is not None:
        other = np.stack([np.stack([a, b, d], -1), np.stack([b, c, d], -1)], 1)
        cells = np.where(random.random(len(a))[:, None, None] < 0.5, cells, other)
    return cells.reshape(-1, 3)


def face_directions(side):
    """Unit directions (6, (side + 1)², 3) of the grids of all faces, with cells of about equal angles."""
    t = np.tan((np.linspace(0, 1, side + 1) - 0.5) * np.pi / 2)
    x, y = (axis.ravel()[:, None] for axis in np.meshgrid(t, t))
    return unit(np.stack([normal + across * x + up * y for normal, across, up in FACES]))


def welded(positions, triangles):
    """The mesh with one vertex for each position, and the vertex of each of the old ones."""
    keys = np.round(positions * 1e6).astype(np.int64)
    _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    number = number.reshape(-1)
    return positions[first], number[triangles], number


def ball(side, random=None):
    """Unit directions, triangles, and the number of each point of the faces' grids among the directions."""
    directions = face_directions(side)
    grid = grid_triangles(side, side, random)
    triangles = np.concatenate([grid + face * (side + 1) ** 2 for face in range(6)])
    return welded(directions.reshape(-1, 3), triangles)


def smooth_radius(d):
    """The radius of the low-poly mesh in a direction."""
    x, y, z = np.moveaxis(d, -1, 0)
    return 1 + 0.05 * np.sin(2.1 * x + 0.4) * np.cos(1.7 * y) + 0.04 * np.sin(2.6 * z + x)


def groove(x):
    return np.exp(-((x / 0.1) ** 2))


def bumps(d):
    """The relief of the body: bumps and grooves, above the low-poly mesh's radius."""
    x, y, z = np.moveaxis(d, -1, 0)
    rough = np.sin(11 * x + 1) * np.sin(9 * y) * np.sin(13 * z + 2) + 0.5 * np.sin(23 * x) * np.sin(19 * (y + z))
    grooves = 1 - np.prod([1 - groove(d @ unit(np.array(axis)) - at) for axis, at in GROOVES], 0)
    return 0.03 * rough - 0.22 * grooves


def body_level(points):
    """A function that is 0 on the body, and above 0 outside."""
    radius = np.linalg.norm(points, axis=-1)
    d = points / radius[:, None]
    return radius - smooth_radius(d) - bumps(d)


def body(random):
    d, triangles, _ = ball(BODY, random)
    middles = d[triangles].mean(1)
    slate = np.sin(5 * middles[:, 0]) + np.sin(4 * middles[:, 1]) > np.sin(6 * middles[:, 2])
    return Part("body", d * (smooth_radius(d) + bumps(d))[:, None], triangles, slate.astype(int))


def belt(random):
    along, across = np.meshgrid(np.arange(AROUND) / AROUND, np.arange(ACROSS) / ACROSS)
    along, across = along.ravel() * 2 * np.pi, across.ravel() * 2 * np.pi
    first = unit(np.cross(BELT_AXIS, (0, 1, 0)))
    second = np.cross(BELT_AXIS, first)
    out = first * np.cos(along)[:, None] + second * np.sin(along)[:, None]
    tube = out * np.cos(across)[:, None] + BELT_AXIS * np.sin(across)[:, None]
    center = out * (smooth_radius(out) - DEPTH)[:, None]
    grid = grid_triangles(AROUND, ACROSS, random)
    x, y = grid % (AROUND + 1) % AROUND, grid // (AROUND + 1) % ACROSS
    return Part("belt", center + tube * RADIUS, y * AROUND + x, np.full(len(grid), 2))


def studs(random):
    """Balls of which caps are outside the body, between the poles and the belt."""
    d, triangles, _ = ball(STUD, random)
    parts = []
    while len(parts) < STUDS:
        way = unit(random.normal(size=3))
        if abs(way @ BELT_AXIS) > 0.4 and all(way @ other < 0.9 for other, _ in parts):
            parts.append((way, way * (smooth_radius(way) - DEPTH) + d * RADIUS))
    positions = np.concatenate([positions for _, positions in parts])
    triangles = np.concatenate([triangles + k * len(d) for k in range(STUDS)])
    return Part("studs", positions, triangles, np.full(len(triangles), 3))


@dataclasses.dataclass
class Low:
    """The low-poly mesh: `positions` and `normals` are of welded vertices, `triangles` those of each face's cells, and
    `uvs` (n, 3, 2), v upward, of each triangle's corners."""

    positions: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    uvs: np.ndarray


def island(face, x, y):
    """UVs of a point of a face, both coordinates in [0, 1]."""
    x = 1 - x if face == MIRRORED else x
    return face % 3 / 3 + INSET + ISLAND * x, face // 3 / 2 + INSET + ISLAND * y


def low_mesh():
    d, triangles, number = ball(LOW)
    positions = (d * smooth_radius(d)[:, None]).astype(np.float32)
    t = np.linspace(0, 1, LOW + 1)
    x, y = np.meshgrid(t, t)
    points = np.concatenate([np.stack(island(face, x.ravel(), y.ravel()), -1) for face in range(6)])
    grid = grid_triangles(LOW, LOW)
    corners = np.concatenate([grid + face * (LOW + 1) ** 2 for face in range(6)])
    normals = frames.vertex_normals(positions, triangles).astype(np.float32)
    return Low(positions, normals, triangles, points[corners].astype(np.float32))


def scan():
    random = np.random.default_rng(SEED)
    return [body(random), belt(random), studs(random)]


def split(low):
    """Vertices of the low-poly mesh with one uv each: their welded numbers, uvs and triangles."""
    keys = np.concatenate([low.triangles.reshape(-1, 1), np.round(low.uvs.reshape(-1, 2) * 1e6)], 1)
    _, first, number = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    return low.triangles.ravel()[first], low.uvs.reshape(-1, 2)[first], number.reshape(-1, 3)


def gltf_material(name):
    color, roughness, metalness = LOOKS[name]
    factors = {"baseColorFactor": [*color, 1], "roughnessFactor": roughness, "metallicFactor": metalness}
    return {"name": name, "pbrMetallicRoughness": factors}


def write(folder):
    """Writes high.glb and low.glb for Taotie, and pair.npz for the others; returns scan and low-poly mesh."""
    parts, low = scan(), low_mesh()
    buffer = files.Buffer()
    meshes = []
    for part in parts:
        attributes = {"POSITION": part.positions, "NORMAL": part.normals, "COLOR_0": part.colors}
        used = np.unique(part.materials)
        primitives = [buffer.primitive(attributes, part.triangles[part.materials == k], int(k)) for k in used]
        meshes.append({"name": part.name, "primitives": primitives})
    nodes = [{"name": part.name, "mesh": k} for k, part in enumerate(parts)]
    materials = [gltf_material(name) for name in MATERIALS]
    document = files.gltf(materials, buffer.accessors, buffer.views, [])
    document |= {"meshes": meshes, "nodes": nodes, "scenes": [{"nodes": list(range(len(nodes)))}]}
    files.write_document(f"{folder}/high.glb", document, buffer.bytes)
    vertices, uvs, triangles = split(low)
    uvs = np.stack([uvs[:, 0], 1 - uvs[:, 1]], -1)
    attributes = {"POSITION": low.positions[vertices], "NORMAL": low.normals[vertices], "TEXCOORD_0": uvs}
    files.write_glb(f"{folder}/low.glb", attributes, triangles)
    arrays = {f"low.{name}": value for name, value in vars(low).items()}
    for part in parts:
        arrays |= {f"{part.name}.{name}": value for name, value in vars(part).items() if name != "name"}
    with files.written(f"{folder}/pair.npz") as file:
        np.savez(file, parts=[part.name for part in parts], **arrays)
    return parts, low
