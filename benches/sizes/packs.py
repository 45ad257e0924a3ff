"""Selects the settings of gltfpack to measure for a model.

Their full product is too large, so there are stages, each of which starts from the promising assets so far:
the textures with the whole mesh; fewer triangles; ratios halfway between; other precisions.
"""

import dataclasses
import math

from point import promising
from tools import Setting


@dataclasses.dataclass(frozen=True)
class Pack:
    """A setting of gltfpack: the textures to convert to WebP first, the ratio of triangles, and further options."""

    before: Setting | None
    ratio: float = 1
    precision: tuple[str, ...] = ()

    def setting(self, tool):
        """Simplifies without an error limit, so that the ratio is reached, and moves the remaining vertices (`-sv`)."""
        simplified = ("-si", f"{self.ratio:.3g}", "-se", "1", "-sv") if self.ratio < 1 else ()
        return Setting(tool, simplified + self.precision, self.before)


class Search:
    """The packs of a model with textures of at most `side` texels; `measure` returns the point of a setting or None."""

    def __init__(self, tools, side, measure):
        self.tools, self.side, self.measure = tools, side, measure
        self.points = {}

    def run(self, grid):
        """All points."""
        self.add([Pack(source) for source in self.sources(grid)])
        self.add([changed(pack, ratio=ratio) for pack, _ in self.best() for ratio in grid.ratios])
        close = [pack for pack, point in self.best() if point.degrees <= grid.most_degrees]
        self.add([changed(pack, ratio=ratio) for pack in close for ratio in around(pack.ratio, grid.ratios)])
        finer = [(pack, own) for pack, point in self.best() for own in grid.precisions_at(point.degrees)]
        self.add([changed(pack, precision=own) for pack, own in finer])
        return list(self.points.values())

    def add(self, packs):
        for pack in packs:
            if pack not in self.points and (point := self.measure(pack.setting(self.tools.gltfpack))):
                self.points[pack] = point

    def best(self):
        """The promising packs with their points."""
        kept = set(promising(self.points.values()))
        return [(pack, point) for pack, point in self.points.items() if point in kept]

    def sources(self, grid):
        """The input of gltfpack: the model unchanged, or with its textures as WebP of each size and quality."""
        sizes = grid.sides_below(self.side)
        webp = [Setting(self.tools.webp, (str(side), str(quality))) for side in sizes for quality in grid.qualities]
        return [None, *webp] if grid.is_original_tried or not webp else webp


def changed(pack, **fields):
    return dataclasses.replace(pack, **fields)


def around(ratio, ratios):
    """Halfway to the next larger and the next smaller of the ratios."""
    larger, smaller = [r for r in ratios if r > ratio], [r for r in ratios if r < ratio]
    near = ([min(larger)] if larger else []) + ([max(smaller)] if smaller else [])
    return [math.sqrt(ratio * other) for other in near]
