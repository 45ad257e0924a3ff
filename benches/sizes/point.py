"""A measured asset, and the best of many."""

import dataclasses

# The tolerance of a limit of degrees or bytes, as a fraction, for assets of any tool.
TOLERANCE = 0.02
# A ΔE counts as no worse if it is higher by at most this, about a tenth of a just noticeable difference.
COLOR_TOLERANCE = 0.1
# Gains below this, as a fraction of degrees and in ΔE, are not worth further measurements.
MARGIN, COLOR_MARGIN = 0.05, 0.03


@dataclasses.dataclass(frozen=True)
class Point:
    """An asset: its tool and options, bytes without metadata, the judge's figures, and the seconds it took to make."""

    tool: str
    label: str
    bytes: int
    triangles: int
    degrees: float
    degrees_p95: float
    color: float
    color_p95: float
    image: float
    missed: float
    seconds: float

    def is_within(self, degrees):
        return self.degrees <= degrees * (1 + TOLERANCE)

    def makes_needless(self, larger):
        """Returns true if the larger asset is not much better in any way."""
        return self.degrees <= larger.degrees * (1 + MARGIN) and self.color <= larger.color + COLOR_MARGIN

    def is_no_worse_in_color(self, other):
        return self.color <= other.color + COLOR_TOLERANCE


def smallest(points):
    """The point with the fewest bytes, or None if there are no points."""
    return min(points, key=lambda p: (p.bytes, p.degrees), default=None)


def nearest(points):
    """The point with the fewest degrees, or None if there are no points."""
    return min(points, key=lambda p: (p.degrees, p.bytes), default=None)


def frontier(points):
    """The points that no other beats in both bytes and degrees, from small to large."""
    kept = []
    for point in sorted(points, key=lambda p: (p.bytes, p.degrees)):
        if not kept or point.degrees < kept[-1].degrees:
            kept.append(point)
    return kept


def promising(points):
    """The points for which no smaller one is about as good in degrees and in ΔE."""
    kept = []
    for point in sorted(points, key=lambda p: (p.bytes, p.degrees)):
        if not any(better.makes_needless(point) for better in kept):
            kept.append(point)
    return kept
