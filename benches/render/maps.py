"""The three maps of the vessel: bronze with patina where the relief is low."""

import io

import numpy as np
import vessel
from PIL import Image

SIZE = 2048
# Height of the relief, model units, where the pattern is 1.
RELIEF = 0.02
# Model units along u and v over the whole map, about.
LENGTHS = (2 * np.pi * 0.8, 2.6)

BRONZE, PATINA = (0.72, 0.47, 0.22), (0.16, 0.36, 0.27)
# Cells around and from bottom to top, and amounts, of smooth noise.
CLOUDS = ((16, 9, 0.5), (60, 34, 0.3), (300, 170, 0.2))
GRAIN = ((300, 170, 0.4), (900, 500, 0.6))
SEED = 7


def noise(cells, u, v, random):
    """Smooth, in [-1, 1]."""
    return sum(a * vessel.Lattice(random.uniform(-1, 1, (high, wide)), u)(v) for wide, high, a in cells)


def codes(values):
    """Of numbers in [0, 1]."""
    return np.clip(np.round(values * 255), 0, 255).astype(np.uint8)


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


def png(values):
    file = io.BytesIO()
    Image.fromarray(values).save(file, "PNG")
    return file.getvalue()


def normals(height):
    """+Y upward, which is towards the first row."""
    x = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * RELIEF * SIZE / (2 * LENGTHS[0])
    y = np.zeros_like(height)
    y[1:-1] = (height[:-2] - height[2:]) * RELIEF * SIZE / (2 * LENGTHS[1])
    n = np.stack([-x, -y, np.ones_like(height)], -1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


def maps():
    """PNG files by name: albedo (sRGB), normal (linear, +Y up), orm (occlusion, roughness, metallic)."""
    u = (np.arange(SIZE) + 0.5) / SIZE
    v = 1 - u
    random = np.random.default_rng(SEED)
    height = vessel.Relief(u)(v)
    patina = 1 / (1 + np.exp(-(8 * noise(CLOUDS, u, v, random) - 3 * (height - 0.3))))
    grain = noise(GRAIN, u, v, random)
    p = patina[..., None]
    albedo = (np.array(BRONZE) * (1 - p) + np.array(PATINA) * p) * (0.88 + 0.12 * grain[..., None])
    occlusion = np.clip(0.75 + 0.3 * (height - 0.3), 0.4, 1)
    roughness = np.clip(0.30 + 0.45 * patina + 0.05 * grain, 0.05, 1)
    return {
        "albedo": png(codes(srgb(albedo))),
        "normal": png(codes(normals(height) * 0.5 + 0.5)),
        "orm": png(codes(np.stack([occlusion, roughness, 1 - patina], -1))),
    }
