"""Vertex normals and tangents, as computed by both programs."""

import numpy as np


def unit(vectors):
    """Normalises the vectors; zero stays zero."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def onto_plane(vectors, normals):
    """The part of the vectors that is perpendicular to the unit normals, normalised."""
    return unit(vectors - normals * (vectors * normals).sum(-1, keepdims=True))


def vertex_normals(positions, triangles):
    """The normals (n, 3) of the triangles around each vertex, weighted by their angles there."""
    corners = positions[triangles].astype(np.float64)
    facing = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    sums = np.zeros((len(positions), 3))
    for k in range(3):
        after = unit(corners[:, (k + 1) % 3] - corners[:, k])
        before = unit(corners[:, (k + 2) % 3] - corners[:, k])
        weighted = facing * np.arccos(np.clip((after * before).sum(-1), -1, 1))[:, None]
        for axis in range(3):
            sums[:, axis] += np.bincount(triangles[:, k], weighted[:, axis], len(positions))
    return unit(sums)


def tangents(positions, normals, uvs, triangles):
    """MikkTSpace's unit tangents (n, 3), along rising u; the bitangent, along rising v, is cross(normal, tangent).

    Each triangle's direction of u is projected onto the plane of the vertex normal and weighted by the triangle's
    angle in that plane (Mikkelsen 2008). Vertices are those of the arrays: two at one position with two uvs are two
    vertices.
    For meshes whose uvs are neither mirrored nor degenerate.
    """
    corners, places = positions[triangles], uvs[triangles]
    edge, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    du, dv = places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]
    along = unit(dv[:, 1:] * edge - du[:, 1:] * other)
    sums = np.zeros_like(positions)
    for k in range(3):
        normal = normals[triangles[:, k]]
        after = onto_plane(corners[:, (k + 1) % 3] - corners[:, k], normal)
        before = onto_plane(corners[:, (k + 2) % 3] - corners[:, k], normal)
        angle = np.arccos(np.clip((after * before).sum(-1), -1, 1))
        np.add.at(sums, triangles[:, k], onto_plane(along, normal) * angle[:, None])
    return unit(sums)
