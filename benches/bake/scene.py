"""Generates missing scans and the low-poly mesh in a folder: scene.py FOLDER SCAN..."""

import os
import sys

import numpy as np

import files
import frames
import vessel

# Cells around and from foot to mouth; two triangles each.
SCANS = {"1m": (1000, 500), "8m": (2840, 1410), "20m": (4500, 2250)}
LOW = (32, 32)
# Fraction of the map that stays empty along each side, as around any UV island.
BORDER = 1 / 64
# Number of rows of a scan in memory at a time.
ROWS = 64


def cells(row, around, columns):
    """The triangles (2·around, 3) of one row of cells; `columns` vertices per row, the last joined to the first."""
    here = np.arange(around) + row * columns
    right = (np.arange(around) + 1) % columns + row * columns
    lower = np.stack([here, right, right + columns], -1)
    upper = np.stack([here, right + columns, here + columns], -1)
    return np.concatenate([lower, upper], -1).reshape(-1, 3)


def write_scan(path, around, along):
    """A closed band without duplicate vertices, normals or uvs, as scanners write it."""
    u, v = np.arange(around) / around, np.linspace(0, 1, along + 1)
    relief = vessel.Relief(u)
    with files.written(path) as file:
        file.write(files.ply_header(around * (along + 1), 2 * around * along))
        for start in range(0, along + 1, ROWS):
            positions = vessel.rows(u, v[start : start + ROWS], relief)
            file.write(positions.astype("<f4").tobytes())
        for row in range(along):
            faces = np.empty(2 * around, np.dtype([("n", "u1"), ("corners", "<i4", 3)]))
            faces["n"], faces["corners"] = 3, cells(row, around, around)
            file.write(faces.tobytes())


def write_low(folder):
    """The low-poly mesh, split along the seam of its uvs: low.glb for Taotie, low.npz with v upward for the others.

    Its normals are computed from its own triangles, not from the outline. Some bakers use the normals of the file and
    some those of the triangles; here the two are equal, so every baker searches for the scan along the same lines.
    """
    around, along = LOW
    u, v = np.linspace(0, 1, around + 1), np.linspace(0, 1, along + 1)
    positions = vessel.rows(u, v)
    welded = np.concatenate([cells(row, around, around) for row in range(along)])
    normals = frames.vertex_normals(positions[:, :-1].reshape(-1, 3), welded).reshape(along + 1, around, 3)
    normals = np.concatenate([normals, normals[:, :1]], 1).reshape(-1, 3)
    positions = positions.reshape(-1, 3)
    uvs = np.stack(np.meshgrid(u, v), -1).reshape(-1, 2) * (1 - 2 * BORDER) + BORDER
    triangles = np.concatenate([cells(row, around, around + 1) for row in range(along)])
    directions = frames.tangents(positions, normals, uvs, triangles)
    low = {"positions": positions, "normals": normals, "uvs": uvs, "tangents": directions}
    low = {name: array.astype(np.float32) for name, array in low.items()}
    attributes = {
        "POSITION": low["positions"],
        "NORMAL": low["normals"],
        "TANGENT": np.pad(low["tangents"], ((0, 0), (0, 1)), constant_values=1),
        "TEXCOORD_0": np.stack([low["uvs"][:, 0], 1 - low["uvs"][:, 1]], -1),
    }
    files.write_glb(os.path.join(folder, "low.glb"), attributes, triangles)
    with files.written(os.path.join(folder, "low.npz")) as file:
        np.savez(file, triangles=triangles.astype(np.int32), **low)


def main(folder, names):
    os.makedirs(folder, exist_ok=True)
    if not all(os.path.exists(os.path.join(folder, name)) for name in ("low.glb", "low.npz")):
        write_low(folder)
    for name in names:
        path = os.path.join(folder, f"scan-{name}.ply")
        if not os.path.exists(path):
            print(f"generating {path}", file=sys.stderr)
            write_scan(path, *SCANS[name])


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
