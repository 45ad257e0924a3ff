"""A lamp for the gallery: a globe with an occlusion texture, whose shade has openings and glows; and its parts."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from PIL import Image

COLUMNS, ROWS, SIDE = 96, 48, 512


def write(folder: Path) -> None:
    """Write `lamp.gltf` with its buffer and textures."""
    u, v = np.meshgrid(np.linspace(0, 1, COLUMNS + 1), np.linspace(0.02, 0.98, ROWS + 1))
    azimuth, polar = 2 * np.pi * u, np.pi * v
    points = np.stack([np.sin(polar) * np.sin(azimuth), np.cos(polar), np.sin(polar) * np.cos(azimuth)], -1)
    corner = (np.arange(ROWS)[:, None] * (COLUMNS + 1) + np.arange(COLUMNS)).ravel()
    below = corner + COLUMNS + 1
    faces = np.stack([corner, below, corner + 1, corner + 1, below, below + 1], -1)
    arrays = [points.reshape(-1, 3).astype("<f4"), np.stack([u, v], -1).reshape(-1, 2).astype("<f4"), faces.astype("<u4").ravel()]
    (folder / "lamp.bin").write_bytes(b"".join(array.tobytes() for array in arrays))
    textures(folder)
    (folder / "lamp.gltf").write_text(json.dumps(document(arrays), indent=1))
    (folder / "lamp-parts.obj").write_text(parts(arrays[0], faces.reshape(-1, 3)))


def parts(points: np.ndarray, faces: np.ndarray) -> str:
    """Return the globe in four rings of two materials, with vertex colours, as OBJ."""
    shades = 0.5 + 0.5 * points[:, [0, 2, 1]]
    lines = [f"v {' '.join(map(str, [*point, *shade]))}" for point, shade in zip(points, shades.round(3))]
    for ring, part in enumerate(np.array_split(faces, 4)):
        lines += [f"o ring{ring}_high", f"usemtl {'brass' if ring % 2 else 'ivory'}"]
        lines += [f"f {a} {b} {c}" for a, b, c in part + 1]
    return "\n".join(lines) + "\n"


def textures(folder: Path) -> None:
    """Write colour with alpha, emission and occlusion."""
    x, y = np.meshgrid(np.arange(SIDE) / SIDE, np.arange(SIDE) / SIDE)
    openings = np.cos(2 * np.pi * 16 * x) * np.cos(2 * np.pi * 12 * y)
    colour = np.zeros((SIDE, SIDE, 4), np.uint8)
    colour[..., :3] = (190, 170, 140)
    colour[..., 3] = np.where(openings > 0.6, 0, 255)
    glow = np.clip(1 - np.abs(openings), 0, 1)[..., None] ** 2 * np.array([255, 170, 80])
    occlusion = np.clip(255 * (0.6 + 0.4 * np.cos(2 * np.pi * 12 * y)), 0, 255).astype(np.uint8)
    Image.fromarray(colour).save(folder / "lamp-colour.png")
    Image.fromarray(glow.astype(np.uint8)).save(folder / "lamp-glow.png")
    Image.fromarray(occlusion).convert("RGB").save(folder / "lamp-occlusion.png")


def document(arrays: list[np.ndarray]) -> dict[str, object]:
    """Return the glTF document."""
    starts = np.cumsum([0] + [array.nbytes for array in arrays]).tolist()
    views = [{"buffer": 0, "byteOffset": start, "byteLength": array.nbytes} for start, array in zip(starts, arrays)]
    points, coordinates, indices = arrays
    bounds = {"min": points.min(0).tolist(), "max": points.max(0).tolist()}
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", **bounds},
        {"bufferView": 1, "componentType": 5126, "count": len(coordinates), "type": "VEC2"},
        {"bufferView": 2, "componentType": 5125, "count": len(indices), "type": "SCALAR"},
    ]
    material = {
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.7},
        "emissiveTexture": {"index": 1}, "emissiveFactor": [1, 1, 1],
        "occlusionTexture": {"index": 2}, "alphaMode": "MASK", "doubleSided": True,
    }
    return {
        "asset": {"version": "2.0"},
        "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [material],
        "textures": [{"source": index} for index in range(3)],
        "images": [{"uri": f"lamp-{name}.png"} for name in ("colour", "glow", "occlusion")],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"uri": "lamp.bin", "byteLength": starts[-1]}],
    }
