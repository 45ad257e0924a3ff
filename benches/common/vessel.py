"""The baked shape: a vessel of revolution, open at foot and mouth, with carved bands, a fret, bosses and rough skin.

Angles go around the y axis; u in [0, 1] around, v in [0, 1] from foot to mouth. Lengths are model units; the vessel is
two units high.
"""

import numpy as np

# Height of the relief, model units, where the pattern is 1.
RELIEF = 0.012

# v and radius of the smooth outline. It is vertical at both ends, so that rays along normals do not leave it there.
OUTLINE = np.array(
    [
        (0.00, 0.50), (0.05, 0.50), (0.14, 0.43), (0.30, 0.68), (0.48, 0.86),
        (0.64, 0.80), (0.78, 0.54), (0.87, 0.43), (0.95, 0.50), (1.00, 0.51),
    ]
)  # fmt: skip

# One figure of the fret, carved once for each repeat around the belly; # is raised.
FRET = (
    "############",
    "............",
    "##########..",
    "##......##..",
    "##..##..##..",
    "##..##..##..",
    "##..######..",
    "##..........",
    "##.#########",
    "............",
    "############",
)
FRET_REPEATS = 20
FRET_SPAN = (0.37, 0.59)

# Raised rings: v of the centre, half the width in v, height.
RINGS = ((0.09, 0.010, 0.7), (0.335, 0.012, 1.0), (0.625, 0.012, 1.0), (0.83, 0.008, 0.8), (0.90, 0.006, 0.6))

BOSSES = 14
BOSS_V = 0.705
BOSS_RADIUS = (0.024, 0.036)

# The skin: cells around, cells from foot to mouth, height.
SKIN = ((60, 30, 0.20), (170, 80, 0.12), (420, 200, 0.08))
SEED = 20240


def smoothstep(x):
    """0 below 0, 1 above 1, a cubic in between."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def outline(v):
    """Radius and its derivative by v."""
    return spline(OUTLINE, v)


def spline(points, v):
    """Value and derivative at v of a cubic Hermite spline through (position, value), level at both ends."""
    at, values = points.T
    slope = np.gradient(values, at)
    slope[[0, -1]] = 0.0
    i = np.clip(np.searchsorted(at, v, side="right") - 1, 0, len(at) - 2)
    width = at[i + 1] - at[i]
    t = (v - at[i]) / width
    a, b, m, n = values[i], values[i + 1], slope[i] * width, slope[i + 1] * width
    value = a + t * (m + t * (3 * (b - a) - 2 * m - n + t * (2 * (a - b) + m + n)))
    derivative = m + t * (2 * (3 * (b - a) - 2 * m - n) + 3 * t * (2 * (a - b) + m + n))
    return value, derivative / width


def taps(x, cells, periodic):
    """Indices and weights, each (len(x), 4), of a cubic B-spline over `cells` equal cells of [0, 1]."""
    x = np.asarray(x) * cells
    first = np.floor(x).astype(np.int64)
    t = x - first
    weights = np.stack([(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, 3 * (t + t**2 - t**3) + 1, t**3], -1) / 6.0
    index = first[:, None] + np.arange(-1, 3)
    return (index % cells if periodic else np.clip(index, 0, cells - 1)), weights


class Lattice:
    """Values on a grid, smooth in between, periodic around. Columns of `u` are selected once, rows of v on demand."""

    def __init__(self, values, u):
        index, weights = taps(u, values.shape[1], periodic=True)
        self.columns = np.einsum("rck,ck->rc", values[:, index], weights)

    def __call__(self, v):
        index, weights = taps(v, len(self.columns), periodic=False)
        return np.einsum("rkc,rk->rc", self.columns[index], weights)


class Relief:
    """Heights, as fractions of RELIEF, at fixed u and any rows of v: an array (len(v), len(u))."""

    def __init__(self, u):
        self.u = u
        figure = np.array([[mark == "#" for mark in row] for row in FRET[::-1]], float)
        self.fret = Lattice(np.tile(figure, (1, FRET_REPEATS)), u)
        random = np.random.default_rng(SEED)
        self.skin = [(Lattice(random.uniform(-1, 1, (high, wide)), u), height) for wide, high, height in SKIN]

    def __call__(self, v):
        height = self._fret(v) + self._bosses(v) + self._rings(v)[:, None]
        for lattice, amount in self.skin:
            height += amount * lattice(v)
        # None at the ends, where the low-poly mesh and the scan share their borders.
        return height * smoothstep(np.minimum(v, 1 - v) / 0.03)[:, None]

    def _fret(self, v):
        low, high = FRET_SPAN
        inside = smoothstep((v - low) / 0.006) * smoothstep((high - v) / 0.006)
        carved = smoothstep((self.fret(np.clip((v - low) / (high - low), 0, 1)) - 0.25) / 0.5)
        return 0.8 * carved * inside[:, None]

    def _rings(self, v):
        return sum(height * smoothstep((half - np.abs(v - middle)) / 0.004 + 0.5) for middle, half, height in RINGS)

    def _bosses(self, v):
        across = ((self.u * BOSSES) % 1 - 0.5) / BOSSES / BOSS_RADIUS[0]
        along = (v - BOSS_V) / BOSS_RADIUS[1]
        return 1.4 * np.sqrt(smoothstep(1 - across[None, :] ** 2 - along[:, None] ** 2))


def rows(u, v, relief=None):
    """Positions (len(v), len(u), 3); the relief is along the smooth outline's normals."""
    radius, slope = outline(v)
    long = np.hypot(2.0, slope)  # y rises by 2 while v rises by 1
    out, up = 2.0 / long, -slope / long
    sin, cos = np.sin(2 * np.pi * u), np.cos(2 * np.pi * u)

    def around(r, y):
        return np.stack(np.broadcast_arrays(r[:, None] * sin, y[:, None], r[:, None] * cos), -1)

    positions = around(radius, 2.0 * v - 1.0)
    if relief is not None:
        positions += around(out, up) * (RELIEF * relief(v))[..., None]
    return positions
