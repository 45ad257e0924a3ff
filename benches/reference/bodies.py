"""The bodies of the scenes, as arrays."""

import dataclasses

import frames
import numpy as np
import shape
import vessel

# Cells around and upward, two triangles each.
SMOOTH, CARVED = (100, 100), (600, 300)
SILVER, ROUGHNESS = (1.0, 1.0, 1.0), 0.4
STONE = (0.6, 0.55, 0.5)
# A room around vessel, camera and lamp: its minimum and maximum corners, and the colours of its sides.
LEAST, GREATEST = (-3.0, -1.0, -2.0), (3.0, 3.6, 5.0)
WALLS = ((0.6, 0.1, 0.1), (0.1, 0.5, 0.15), (0.5, 0.5, 0.5), (0.7, 0.7, 0.7), (0.6, 0.6, 0.6), (0.3, 0.3, 0.5))


@dataclasses.dataclass(frozen=True)
class Body:
    """A mesh of one material: metal if it has a roughness, else matte and double-sided."""

    positions: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    color: tuple
    roughness: float = 0.0


def metal():
    """The smooth vessel."""
    arrays = shape.vessel(*SMOOTH)
    return [Body(arrays["positions"], arrays["normals"], arrays["triangles"], SILVER, ROUGHNESS)]


def room():
    """The smooth vessel between six walls."""
    return [*metal(), *(wall(axis, end) for axis in range(3) for end in range(2))]


def wall(axis, end):
    """The side of the room at one end of an axis."""
    others = [other for other in range(3) if other != axis]
    positions = np.empty((4, 3), np.float32)
    for number, corner in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
        positions[number, axis] = (LEAST, GREATEST)[end][axis]
        positions[number, others] = [(LEAST, GREATEST)[k][other] for k, other in zip(corner, others)]
    normals = np.zeros_like(positions)
    normals[:, axis] = 1 - 2 * end
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    a, b, c = positions[:3]
    faces_in = np.cross(b - a, c - a) @ normals[0] > 0
    return Body(positions, normals, triangles if faces_in else triangles[:, ::-1].copy(), WALLS[2 * axis + end])


def relief():
    """The carved vessel, open at its mouth."""
    around, along = CARVED
    u, v = np.arange(around) / around, np.linspace(0, 1, along + 1)
    positions = vessel.rows(u, v, vessel.Relief(u)).reshape(-1, 3).astype(np.float32)
    here = (np.arange(along)[:, None] * around + np.arange(around)).ravel()
    right = (np.arange(along)[:, None] * around + (np.arange(around) + 1) % around).ravel()
    lower, upper = [here, right, right + around], [here, right + around, here + around]
    triangles = np.concatenate([np.stack(lower, -1), np.stack(upper, -1)]).astype(np.uint32)
    normals = frames.vertex_normals(positions, triangles).astype(np.float32)
    return [Body(positions, normals, triangles, STONE)]
