"""Selects the settings of Taotie and gltf-transform to measure for a model; those of gltfpack are in packs.py.

Every search gets `measure`, which makes the asset of a setting and returns its point, or None if that failed. It
returns all points.
"""

from point import TOLERANCE
from tools import Setting

# Maximum number of assets for each value of Taotie's `--error`, and the fraction of it that an asset must use.
TRIES = 3
CLOSE = 0.97


def taotie(tool, grid, measure):
    """The default options, and assets for each value of `--error`.

    The judge's views are not those of Taotie's search, so it measures different angles. An asset that it finds beyond
    the limit is made again with a proportionally smaller error, as a user with this judge would do; one far within,
    with a larger one.
    """
    found = []
    for error in grid.errors:
        aim, before = error, None
        for _ in range(TRIES if error else 1):
            point = measure(Setting(tool, () if error is None else ("--error", f"{aim:.3g}")))
            found.append(point)
            is_final = point is None or error is None or CLOSE * error <= point.degrees <= error * (1 + TOLERANCE)
            # If colours decide, another error produces the same asset.
            if is_final or before == (before := point.bytes):
                break
            aim *= error / point.degrees
    return [point for point in found if point is not None]


def gltf_transform(tool, grid, side, measure):
    """Every ratio with every size of textures; `optimize` has no option for their quality."""
    sizes = [("--texture-size", str(most or side)) for most in grid.sides_below(side)] or [()]
    ratios = [("--simplify-ratio", f"{ratio:g}", "--simplify-error", "1") for ratio in grid.transform_ratios]
    return points([Setting(tool, ratio + size) for size in sizes for ratio in ratios], measure)


def points(settings, measure):
    """The points of the settings that succeeded."""
    return [point for setting in settings if (point := measure(setting)) is not None]
