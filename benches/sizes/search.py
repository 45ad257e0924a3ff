"""Which settings of Taotie and gltf-transform are measured for a model; those of gltfpack are in packs.py.

Every search gets `measure`, which makes the asset of a setting and returns its point, or None if that failed. It
returns all points.
"""

from tools import Setting


def taotie(tool, grid, measure):
    options = [() if error is None else ("--error", f"{error:g}") for error in grid.errors]
    return points([Setting(tool, own) for own in options], measure)


def gltf_transform(tool, grid, side, measure):
    """Every ratio with every size of textures; `optimize` has no option for their quality."""
    sizes = [("--texture-size", str(most or side)) for most in grid.sides_below(side)] or [()]
    ratios = [("--simplify-ratio", f"{ratio:g}", "--simplify-error", "1") for ratio in grid.transform_ratios]
    return points([Setting(tool, ratio + size) for size in sizes for ratio in ratios], measure)


def points(settings, measure):
    """The points of the settings that succeeded."""
    return [point for setting in settings if (point := measure(setting)) is not None]
