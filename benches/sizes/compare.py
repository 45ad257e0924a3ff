"""Compares the frontiers of the tools, at equal degrees and at equal bytes."""

import dataclasses

from point import TOLERANCE, Point, nearest, smallest

# Mean angles at the same pixel, degrees.
LIMITS = (0.3, 0.5, 1, 2, 4)


@dataclasses.dataclass(frozen=True)
class Frontiers:
    """All points of a model by tool; `bytes` are those of the model itself."""

    name: str
    bytes: int
    taotie: list[Point]
    gltfpack: list[Point]
    gltf_transform: list[Point]


@dataclasses.dataclass(frozen=True)
class Match:
    """An asset of Taotie, and the alternatives of the other tools; None if they have none.

    `gltfpack` and `gltf_transform` are the smallest assets of at most `degrees`; `gltfpack_color` is the smallest of
    them with a ΔE no worse than Taotie's. `at_bytes` has the fewest degrees among gltfpack's assets no larger than
    Taotie's, `at_bytes_color` among those with a ΔE no worse.
    """

    degrees: float
    taotie: Point | None
    gltfpack: Point | None
    gltfpack_color: Point | None
    gltf_transform: Point | None
    at_bytes: Point | None
    at_bytes_color: Point | None

    def bytes_ratio(self):
        """Ratio of Taotie's bytes to gltfpack's, with any ΔE."""
        return ratio(self.taotie, self.gltfpack, lambda p: p.bytes)

    def color_bytes_ratio(self):
        """Ratio of Taotie's bytes to gltfpack's with a ΔE no worse."""
        return ratio(self.taotie, self.gltfpack_color, lambda p: p.bytes)

    def degrees_ratio(self):
        """Ratio of Taotie's degrees to gltfpack's at no more bytes, with any ΔE."""
        return ratio(self.taotie, self.at_bytes, lambda p: p.degrees)

    def color_degrees_ratio(self):
        """Ratio of Taotie's degrees to gltfpack's at no more bytes, with a ΔE no worse."""
        return ratio(self.taotie, self.at_bytes_color, lambda p: p.degrees)


def ratio(own, other, figure):
    return figure(own) / figure(other) if own and other and figure(other) else None


def at_limit(frontiers, degrees):
    """The smallest assets of at most this many degrees."""
    return matched(frontiers, smallest(within(frontiers.taotie, degrees)), degrees)


def at_asset(frontiers, asset):
    """An asset of Taotie compared with others of at most its degrees."""
    return matched(frontiers, asset, asset.degrees)


def matched(frontiers, taotie, degrees):
    pack, transform = within(frontiers.gltfpack, degrees), within(frontiers.gltf_transform, degrees)
    light = [p for p in frontiers.gltfpack if taotie and p.bytes <= taotie.bytes * (1 + TOLERANCE)]

    def same_color(points):
        return [p for p in points if taotie and p.is_no_worse_in_color(taotie)]

    return Match(
        degrees=degrees,
        taotie=taotie,
        gltfpack=smallest(pack),
        gltfpack_color=smallest(same_color(pack)),
        gltf_transform=smallest(transform),
        at_bytes=nearest(light),
        at_bytes_color=nearest(same_color(light)),
    )


def within(points, degrees):
    return [p for p in points if p.is_within(degrees)]
