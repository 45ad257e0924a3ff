"""The vessel: a closed body of revolution around y, with normals and tangents from its outline.

u in [0, 1] goes around from +z, counter-clockwise as seen from above; v in [0, 1] from the bottom to the top.
"""

import numpy as np
from vessel import spline

# v and radius of the outline before it is closed at both ends.
OUTLINE = np.array(
    [
        (0.00, 0.66), (0.04, 0.65), (0.10, 0.62), (0.25, 0.77), (0.48, 0.86),
        (0.66, 0.81), (0.80, 0.66), (0.88, 0.60), (0.95, 0.67), (1.00, 0.69),
    ]
)  # fmt: skip
HALF_HEIGHT = 0.98
# The part of v along which an end narrows, and the radius of the remaining hole: no triangle is degenerate.
CLOSING = 0.015
LEAST_RADIUS = 0.01


def radius(v):
    closed = np.sqrt(np.clip(np.minimum(v, 1 - v) / CLOSING, 0, 1))
    open_radius, _ = spline(OUTLINE, v)
    return np.maximum(open_radius * closed, LEAST_RADIUS)


def vessel(around, along):
    """2 · around · along triangles, as arrays of float32: positions, normals, tangents (x, y, z, 1), uvs with v
    upward, triangles. cross(normal, tangent) is along increasing v."""
    u, v = np.linspace(0, 1, around + 1), np.linspace(0, 1, along + 1)
    step = 1e-5
    before, after = np.clip(v - step, 0, 1), np.clip(v + step, 0, 1)
    slope = (radius(after) - radius(before)) / (after - before)
    long = np.hypot(2 * HALF_HEIGHT, slope)
    out, up = 2 * HALF_HEIGHT / long, -slope / long
    sin, cos = np.sin(2 * np.pi * u), np.cos(2 * np.pi * u)

    def turned(r, y):
        return np.stack(np.broadcast_arrays(r[:, None] * sin, y[:, None], r[:, None] * cos), -1).reshape(-1, 3)

    flat = np.zeros_like(u)
    tangents = np.stack([cos, flat, -sin, flat + 1], -1)
    here = np.arange(along)[:, None] * (around + 1) + np.arange(around)
    corners = [here, here + 1, here + around + 2, here, here + around + 2, here + around + 1]
    arrays = {
        "positions": turned(radius(v), HALF_HEIGHT * (2 * v - 1)),
        "normals": turned(out, up),
        "tangents": np.tile(tangents, (along + 1, 1)),
        "uvs": np.stack(np.meshgrid(u, v), -1).reshape(-1, 2),
    }
    arrays = {name: np.ascontiguousarray(a, np.float32) for name, a in arrays.items()}
    return arrays | {"triangles": np.stack(corners, -1).reshape(-1, 3).astype(np.uint32)}
