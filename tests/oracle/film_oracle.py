"""Tone curves and the sRGB encoding in double precision, from their publications.

Writes film_oracle.json next to itself: `python3 tests/oracle/film_oracle.py` (needs NumPy).
Row vectors throughout; the Rust code uses columns.
"""

import json
from pathlib import Path

import numpy as np


def srgb(linear):
    """IEC 61966-2-1."""
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.power(linear, 1 / 2.4) - 0.055)


def neutral(color):
    """Khronos PBR Neutral specification: its three steps, one colour at a time."""
    f90, ks, kd = 0.04, 0.8 - 0.04, 0.15
    out = np.empty_like(color)
    for i, c in enumerate(color):
        x = c.min()
        f = x - x * x / (4 * f90) if x <= 2 * f90 else f90
        c = c - f
        p = c.max()
        if p > ks:
            pn = 1 - (1 - ks) ** 2 / (p + 1 - 2 * ks)
            g = 1 / (kd * (p - pn) + 1)
            c = c * (pn / p) * g + pn * (1 - g)
        out[i] = c
    return out


def reinhard(color):
    """Reinhard et al. 2002, equation 3, on each channel."""
    return 1 - 1 / (1 + color)


ACES_IN = np.array([[0.59719, 0.07600, 0.02840], [0.35458, 0.90834, 0.13383], [0.04823, 0.01566, 0.83777]])
ACES_OUT = np.array([[1.60475, -0.10208, -0.00327], [-0.53108, 1.10813, -0.07276], [-0.07367, -0.00605, 1.07602]])


def aces(color):
    """Hill's fit, after the factor 1/0.6."""
    v = (color / 0.6) @ ACES_IN
    v = np.polyval([1, 0.0245786, -0.000090537], v) / np.polyval([0.983729, 0.4329510, 0.238081], v)
    return v @ ACES_OUT


REC2020_FROM_SRGB = np.array([[0.6274, 0.0691, 0.0164], [0.3293, 0.9195, 0.0880], [0.0433, 0.0113, 0.8956]])
SRGB_FROM_REC2020 = np.array([[1.6605, -0.1246, -0.0182], [-0.5876, 1.1329, -0.1006], [-0.0728, -0.0083, 1.1187]])
AGX_IN = np.array([
    [0.856627153315983, 0.137318972929847, 0.11189821299995],
    [0.0951212405381588, 0.761241990602591, 0.0767994186031903],
    [0.0482516061458583, 0.101439036467562, 0.811302368396859],
])
AGX_OUT = np.array([
    [1.1271005818144368, -0.1413297634984383, -0.14132976349843826],
    [-0.11060664309660323, 1.157823702216272, -0.11060664309660294],
    [-0.016493938717834573, -0.016493938717834257, 1.2519364065950405],
])


def agx(color):
    """Log encoding over [-10, 6.5] stops around 0.18, polynomial sigmoid, gamma 2.2; base look."""
    low, high = np.log2(0.18) - 10, np.log2(0.18) + 6.5
    v = color @ REC2020_FROM_SRGB @ AGX_IN
    x = np.clip((np.log2(np.maximum(v, 1e-10)) - low) / (high - low), 0, 1)
    y = np.polyval([15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232], x)
    return np.maximum(y @ AGX_OUT, 0) ** 2.2 @ SRGB_FROM_REC2020


def main():
    rng = np.random.default_rng(2025)
    random = 2.0 ** rng.uniform(-14, 9, size=(160, 3))
    grey = np.repeat(2.0 ** np.linspace(-12, 10, 45), 3).reshape(-1, 3)
    corners = np.array([[x, y, z] for x in (0, 0.5, 4) for y in (0, 0.5, 4) for z in (0, 0.5, 4)], float)
    inputs = np.concatenate([corners, grey, random]).astype(np.float32).astype(np.float64)
    curves = {"neutral": neutral, "linear": lambda c: c, "reinhard": reinhard, "aces": aces, "agx": agx}
    encode = np.concatenate([np.linspace(0, 1, 129), 2.0 ** -np.arange(1, 20)]).astype(np.float32).astype(np.float64)
    result = {
        "inputs": inputs.tolist(),
        "curves": {name: np.clip(f(inputs), 0, 1).tolist() for name, f in curves.items()},
        "linear": encode.tolist(),
        "srgb": srgb(encode).tolist(),
    }
    Path(__file__).with_suffix(".json").write_text(json.dumps(result) + "\n")


if __name__ == "__main__":
    main()
