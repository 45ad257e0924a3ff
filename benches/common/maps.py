"""The three maps of the vessel: bronze with patina where the relief is low."""

import io

import numpy as np
import vessel
from PIL import Image

NAMES = ("albedo", "normal", "orm")
SIZE = 2048
# Number of rows generated at a time.
BAND = 256
# Height of the relief, model units, where the pattern is 1.
RELIEF = 0.02
# Approximate model units along u and v over the whole map.
LENGTHS = (2 * np.pi * 0.8, 2.6)

BRONZE, PATINA = (0.72, 0.47, 0.22), (0.16, 0.36, 0.27)
# Cells around and from bottom to top, and amounts, of smooth noise.
CLOUDS = ((16, 9, 0.5), (60, 34, 0.3), (300, 170, 0.2))
GRAIN = ((300, 170, 0.4), (900, 500, 0.6))
SEED = 7


def lattices(cells, u, random):
    """Layers of smooth noise, with their amounts."""
    return [(vessel.Lattice(random.uniform(-1, 1, (high, wide)), u), amount) for wide, high, amount in cells]


def noise(cells, v):
    """Smooth noise in [-1, 1]."""
    return sum(amount * lattice(v) for lattice, amount in cells)


def codes(values):
    """The sRGB codes of numbers in [0, 1]."""
    return np.clip(np.round(values * 255), 0, 255).astype(np.uint8)


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


def png(values, effort):
    file = io.BytesIO()
    Image.fromarray(values).save(file, "PNG", compress_level=effort)
    return file.getvalue()


def normals(height):
    """Normals, with +Y upward, towards the first row. `height` has one more row on either side."""
    size = height.shape[1]
    middle = height[1:-1]
    x = (np.roll(middle, -1, 1) - np.roll(middle, 1, 1)) * RELIEF * size / (2 * LENGTHS[0])
    y = (height[:-2] - height[2:]) * RELIEF * size / (2 * LENGTHS[1])
    n = np.stack([-x, -y, np.ones_like(middle)], -1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


class Bronze:
    """The material values of the maps, row by row."""

    def __init__(self, size):
        self.u = (np.arange(size) + 0.5) / size
        random = np.random.default_rng(SEED)
        self.relief = vessel.Relief(self.u)
        self.clouds, self.grains = lattices(CLOUDS, self.u, random), lattices(GRAIN, self.u, random)

    def codes(self, start, end):
        """The texels of rows, by map."""
        v = 1 - self.u
        height = self.relief(v[np.clip(np.arange(start - 1, end + 1), 0, len(v) - 1)])
        # At the map's ends, nothing changes along v.
        if start == 0:
            height[0] = height[2]
        if end == len(v):
            height[-1] = height[-3]
        normal = normals(height)
        v, height = v[start:end], height[1:-1]
        patina = 1 / (1 + np.exp(-(8 * noise(self.clouds, v) - 3 * (height - 0.3))))
        grain = noise(self.grains, v)
        p = patina[..., None]
        albedo = (np.array(BRONZE) * (1 - p) + np.array(PATINA) * p) * (0.88 + 0.12 * grain[..., None])
        occlusion = np.clip(0.75 + 0.3 * (height - 0.3), 0.4, 1)
        roughness = np.clip(0.30 + 0.45 * patina + 0.05 * grain, 0.05, 1)
        values = {"albedo": srgb(albedo), "normal": normal * 0.5 + 0.5}
        values["orm"] = np.stack([occlusion, roughness, 1 - patina], -1)
        return {name: codes(array) for name, array in values.items()}


def maps(size=SIZE, effort=6):
    """PNG files by name: albedo (sRGB), normal (linear, +Y up), orm (occlusion, roughness, metallic). `effort`, 0 to
    9, is the compression level."""
    bronze = Bronze(size)
    whole = {name: np.empty((size, size, 3), np.uint8) for name in NAMES}
    for start in range(0, size, BAND):
        end = min(start + BAND, size)
        for name, rows in bronze.codes(start, end).items():
            whole[name][start:end] = rows
    return {name: png(values, effort) for name, values in whole.items()}
