"""Measures the errors of normal maps against the scan, in degrees: accuracy.py SCAN.ply LOW.npz NAME=MAP.png...

The reference is independent of the bakers: Embree casts rays from random points of the low-poly mesh along its
interpolated normal, outward and inward; the nearest hit that faces the same way counts, with the scan's vertex
normals interpolated there. A map is looked up bilinearly at the same point and converted from tangent space as glTF
specifies: by the interpolated normal and tangent, not normalised. Prints JSON.
"""

import json
import sys

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from PIL import Image

import files
import frames
from frames import unit

POINTS = 20_000
SEED = 7
# Anything farther away is another part of the scan; model units.
REACH = 0.05


def random_points(low):
    """Triangles and barycentrics (n, 3) of points distributed uniformly over the low-poly mesh's area."""
    random = np.random.default_rng(SEED)
    corners = low["positions"][low["triangles"]].astype(np.float64)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=-1)
    triangle = random.choice(len(area), POINTS, p=area / area.sum())
    root, share = np.sqrt(random.random(POINTS)), random.random(POINTS)
    return low["triangles"][triangle], np.stack([1 - root, root * (1 - share), root * share], -1)


def interpolate(values, corners, weights):
    return (values[corners].astype(np.float64) * weights[..., None]).sum(1)


def truth(scan, points, directions):
    """The scan's unit normals (n, 3) for the points, and which points have one."""
    positions, triangles = scan
    scene = EmbreeScene()
    TriangleMesh(scene, positions.astype(np.float32), triangles.astype(np.int32))
    normals = frames.vertex_normals(positions, triangles)
    nearest, found = np.full(len(points), REACH), np.zeros_like(points)
    for way in (directions, -directions):
        hit = scene.run(points.astype(np.float32), way.astype(np.float32), output=True)
        met = np.flatnonzero(hit["primID"] >= 0)
        corners = triangles[hit["primID"][met]]
        u, v = hit["u"][met].astype(np.float64), hit["v"][met].astype(np.float64)
        a, b, c = np.moveaxis(positions[corners].astype(np.float64), 1, 0)
        same_way = (np.cross(b - a, c - a) * directions[met]).sum(-1) > 0
        taken = same_way & (hit["tfar"][met] < nearest[met])
        nearest[met[taken]] = hit["tfar"][met[taken]]
        found[met[taken]] = interpolate(normals, corners, np.stack([1 - u - v, u, v], -1))[taken]
    return unit(found), nearest < REACH


def looked_up(path, uvs):
    """Tangent-space normals at uvs with v upward, from an image whose first row is its top."""
    image = np.asarray(Image.open(path).convert("RGB"))
    height, width = image.shape[:2]
    x = np.clip(uvs[:, 0] * width - 0.5, 0, width - 1)
    y = np.clip((1 - uvs[:, 1]) * height - 0.5, 0, height - 1)
    left, top = np.minimum(x.astype(int), width - 2), np.minimum(y.astype(int), height - 2)
    x, y = (x - left)[:, None], (y - top)[:, None]

    def texel(right, down):
        return image[top + down, left + right] / 127.5 - 1.0

    upper = texel(0, 0) * (1 - x) + texel(1, 0) * x
    lower = texel(0, 1) * (1 - x) + texel(1, 1) * x
    return upper * (1 - y) + lower * y


def angles(a, b):
    """Angles between unit vectors, in degrees; also accurate for small angles."""
    return np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)))


def figures(error):
    mean, (median, p95) = error.mean(), np.percentile(error, [50, 95])
    return {"mean": float(mean), "median": float(median), "p95": float(p95)}


def main(scan, low, maps):
    low = np.load(low)
    corners, weights = random_points(low)
    names = ("positions", "normals", "tangents", "uvs")
    points, normal, tangent, uvs = (interpolate(low[name], corners, weights) for name in names)
    expected, hit = truth(files.read_ply(scan), points, unit(normal))
    frame = np.stack([tangent, np.cross(normal, tangent), normal], 1)
    result = {"points": POINTS, "missed": int((~hit).sum()), "maps": {}}
    result["maps"]["no map"] = figures(angles(unit(normal), expected)[hit])
    for name, path in maps:
        shown = unit(np.einsum("nk,nkc->nc", looked_up(path, uvs), frame))
        result["maps"][name] = figures(angles(shown, expected)[hit])
    print(json.dumps(result))


if __name__ == "__main__":
    main(*sys.argv[1:3], [item.split("=", 1) for item in sys.argv[3:]])
