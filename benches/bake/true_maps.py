"""Maps of a pair (pair.py) computed independently of Taotie and Blender: rays by Embree at the centres of texels."""

import dataclasses

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

import frames
import pair
from frames import onto_plane, unit

# Rays at a time.
CHUNK = 1 << 20
SEED = 5
# Rays start this far from their own surface, model units.
OFFSET = 1e-4
# Of differences, model units.
STEP = 2e-4


@dataclasses.dataclass
class Texels:
    """Texels inside UV islands, and the points of the low-poly mesh at their centres."""

    # Rows and columns of the map.
    rows: np.ndarray
    columns: np.ndarray
    # Distance from the border of the island, and from the nearest edge of the triangle, texels.
    inside: np.ndarray
    edge: np.ndarray
    positions: np.ndarray
    # Interpolated and normalised.
    normals: np.ndarray
    # The axes (n, 3, 3) of tangent space: tangent, bitangent, normal.
    frames: np.ndarray

    def image(self, values, size, chosen=slice(None)):
        """A map of values at chosen texels; others are NaN."""
        image = np.full((size, size, *values.shape[1:]), np.nan)
        image[self.rows[chosen], self.columns[chosen]] = values
        return image

    def in_tangent_space(self, vectors, chosen=slice(None)):
        return np.einsum("nij,nj->ni", self.frames[chosen], vectors)


def tangents(low):
    """Unit tangents (n, 3, 3) of the corners of triangles, and the handedness of each triangle."""
    vertices, uvs, triangles = pair.split(low)
    mirrored = np.repeat(np.arange(6) == pair.MIRRORED, len(triangles) // 6)
    sign = np.where(mirrored, -1.0, 1.0)
    flip = np.ones(len(vertices))
    flip[triangles[mirrored]] = -1
    turned = np.stack([uvs[:, 0] * flip, uvs[:, 1]], -1)
    positions, normals = (a[vertices].astype(float) for a in (low.positions, low.normals))
    along = frames.tangents(positions, normals, turned, triangles) * flip[:, None]
    return along[triangles], sign


def texels(low, size):
    """All texels whose centre is inside an island."""
    rows, columns = (a.ravel() for a in np.mgrid[0:size, 0:size])
    u, v = (columns + 0.5) / size, 1 - (rows + 0.5) / size
    face = np.minimum(u * 3, 2).astype(int) + 3 * (v >= 0.5)
    x = (u - face % 3 / 3 - pair.INSET) / pair.ISLAND
    y = (v - face // 3 / 2 - pair.INSET) / pair.ISLAND
    x = np.where(face == pair.MIRRORED, 1 - x, x)
    inside = np.minimum(np.minimum(x, 1 - x), np.minimum(y, 1 - y))
    kept = inside >= 0
    rows, columns, face, x, y, inside = (a[kept] for a in (rows, columns, face, x, y, inside))
    side = pair.ISLAND * size
    cell_x, cell_y = (np.minimum(a * pair.LOW, pair.LOW - 1).astype(int) for a in (x, y))
    s, t = x * pair.LOW - cell_x, y * pair.LOW - cell_y
    # Each cell has the triangles (0, 0), (1, 0), (1, 1) and (0, 0), (1, 1), (0, 1).
    lower = s >= t
    weights = np.where(lower[:, None], np.stack([1 - s, s - t, t], -1), np.stack([1 - t, s, t - s], -1))
    triangle = 2 * ((face * pair.LOW + cell_y) * pair.LOW + cell_x) + ~lower
    # The heights of the corners above the opposite edges, in cells.
    root = np.sqrt(0.5)
    heights = np.where(lower[:, None], (1, root, 1), (1, 1, root))
    edge = (weights * heights).min(1) * side / pair.LOW

    def interpolate(corners):
        return (corners * weights[..., None]).sum(1)

    normals = unit(interpolate(low.normals[low.triangles[triangle]].astype(float)))
    along, sign = tangents(low)
    along = onto_plane(interpolate(along[triangle]), normals)
    across = np.cross(normals, along) * sign[triangle][:, None]
    axes = np.stack([along, across, normals], 1)
    positions = interpolate(low.positions[low.triangles[triangle]].astype(float))
    return Texels(rows, columns, inside * side, edge, positions, normals, axes)


def mean_curvatures(points):
    """Mean curvature of the body's formula at points, 1 / model unit, above 0 where it is convex: half the divergence
    of the normal, by central differences."""
    steps = STEP * np.eye(3)

    def normals(at):
        return unit(np.stack([pair.body_level(at + step) - pair.body_level(at - step) for step in steps], -1))

    changes = [normals(points + step) - normals(points - step) for step in steps]
    return sum(change[:, axis] for axis, change in enumerate(changes)) / (4 * STEP)


class Scan:
    """The objects as one mesh with rays."""

    def __init__(self, parts):
        counts = np.cumsum([0, *(len(part.positions) for part in parts)])
        self.positions = np.concatenate([part.positions for part in parts]).astype(float)
        self.normals = np.concatenate([part.normals for part in parts]).astype(float)
        self.triangles = np.concatenate([part.triangles + n for part, n in zip(parts, counts)])
        self.objects = np.repeat(np.arange(len(parts)), [len(part.triangles) for part in parts])
        self.scene = EmbreeScene()
        TriangleMesh(self.scene, self.positions.astype(np.float32), self.triangles.astype(np.int32))

    def hits(self, origins, directions):
        """Triangles, barycentrics (n, 3) and distances; triangle −1 and infinity if there is none."""
        hit = self.scene.run(origins.astype(np.float32), directions.astype(np.float32), output=True)
        u, v = hit["u"].astype(float), hit["v"].astype(float)
        met = hit["primID"] >= 0
        return hit["primID"], np.stack([1 - u - v, u, v], -1), np.where(met, hit["tfar"], np.inf)

    def interpolate(self, values, triangle, weights):
        corners = values[self.triangles[triangle]]
        return np.einsum("nk,nk...->n...", weights, corners)


@dataclasses.dataclass
class Found:
    """The points of the scan that the texels show: the first along their normals from outside."""

    points: np.ndarray
    normals: np.ndarray
    facets: np.ndarray
    heights: np.ndarray
    # Numbers of their objects.
    objects: np.ndarray
    met: np.ndarray


def found(scan, texels, extrusion):
    origins = texels.positions + texels.normals * extrusion
    triangle, weights, distance = scan.hits(origins, -texels.normals)
    met = distance <= 2 * extrusion
    triangle = np.where(met, triangle, 0)
    a, b, c = np.moveaxis(scan.positions[scan.triangles[triangle]], 1, 0)
    return Found(
        points=scan.interpolate(scan.positions, triangle, weights),
        normals=unit(scan.interpolate(scan.normals, triangle, weights)),
        facets=unit(np.cross(b - a, c - a)),
        heights=extrusion - distance,
        objects=scan.objects[triangle],
        met=met,
    )


def hemisphere(normals, numbers, shifts):
    """A direction for each normal, distributed like the cosine: points of a low-discrepancy sequence (Roberts 2018, R2)
    of these numbers, shifted differently for each normal."""
    u, v = np.moveaxis((numbers[:, None] * (0.7548776662466927, 0.5698402909980532) + shifts) % 1, -1, 0)
    other = np.where(np.abs(normals[:, :1]) < 0.7, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    tangents = onto_plane(other, normals)
    ring, angle = np.sqrt(u)[:, None], 2 * np.pi * v[:, None]
    across = np.cross(normals, tangents)
    return ring * (np.cos(angle) * tangents + np.sin(angle) * across) + np.sqrt(1 - u)[:, None] * normals


def around(found, chosen, rays):
    """Batches of rays from chosen points, cosine-weighted over their smooth normals: numbers, points, facets,
    directions."""
    shifts = np.random.default_rng(SEED).random((len(chosen), 2))
    for start in range(0, len(chosen) * rays, CHUNK):
        number, k = np.divmod(np.arange(start, min(start + CHUNK, len(chosen) * rays)), rays)
        which = chosen[number]
        ways = hemisphere(found.normals[which], k, shifts[number])
        yield number, found.points[which], found.facets[which], ways


def sky(scan, found, chosen, rays, distance):
    """Unoccluded share of the hemisphere at chosen points, and the mean open direction, unit; surfaces farther away
    than `distance` do not occlude. Directions below the facet do not count."""
    counted, seen = np.zeros(len(chosen)), np.zeros(len(chosen))
    direction = np.zeros((len(chosen), 3))
    for number, points, facets, ways in around(found, chosen, rays):
        above = (ways * facets).sum(-1) > 0
        _, _, far = scan.hits(points + facets * OFFSET, ways)
        is_open = above & (far > distance)
        counted += np.bincount(number, above, len(chosen))
        seen += np.bincount(number, is_open, len(chosen))
        for axis in range(3):
            direction[:, axis] += np.bincount(number, is_open * ways[:, axis], len(chosen))
    return seen / counted, unit(direction)


def thickness(scan, found, chosen, rays):
    """Mean distance through the scan at chosen points, cosine-weighted."""
    total, counted = np.zeros(len(chosen)), np.zeros(len(chosen))
    for number, points, facets, ways in around(found, chosen, rays):
        _, _, far = scan.hits(points - facets * OFFSET, -ways)
        counts = ((ways * facets).sum(-1) > 0) & np.isfinite(far)
        total += np.bincount(number, np.where(counts, far, 0) + OFFSET * counts, len(chosen))
        counted += np.bincount(number, counts, len(chosen))
    return total / counted


def rounded(scan, found, chosen, radius):
    """Mean normals around chosen points over the surface within a radius, weighted by area and
    (1 − distance / radius)³: a sum over quarters of quarters of triangles, without rays. Surfaces that face away by
    more than 120° do not count."""
    weights = np.array([[(1, 0, 0), (0, 1, 0), (0, 0, 1)]], float)
    for _ in range(2):
        a, b, c = np.moveaxis(weights, 1, 0)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        weights = np.concatenate([np.stack(t, 1) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
    middles = weights.mean(1)
    corners, normals = scan.positions[scan.triangles], scan.normals[scan.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=-1)
    centers = corners.mean(1)
    result = np.empty((len(chosen), 3))
    for k, which in enumerate(chosen):
        point, facet = found.points[which], found.facets[which]
        near = np.flatnonzero(((centers - point) ** 2).sum(-1) < (2 * radius) ** 2)
        points, ways = (np.einsum("sk,nki->nsi", middles, a[near]).reshape(-1, 3) for a in (corners, normals))
        ways = unit(ways)
        away = np.maximum(1 - np.linalg.norm(points - point, axis=-1) / radius, 0)
        amount = np.repeat(areas[near], len(middles)) * away**3 * (ways @ facet >= -0.5)
        result[k] = amount @ ways
    return unit(result)
