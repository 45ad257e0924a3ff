"""Comparisons of two maps: rows of the table of `make bench-maps`."""

import dataclasses

import numpy as np


def apart(a, b):
    return np.abs(a - b)


def most_apart(a, b):
    return np.abs(a - b).max(-1)


def lengths(a, b):
    return np.linalg.norm(a - b, axis=-1)


def differ(a, b):
    """1 where colours differ by more than half a code."""
    return (np.abs(a - b) > 0.5 / 255).any(-1).astype(float)


def ranks(values):
    return np.argsort(np.argsort(values)).astype(float)


def correlation(a, b):
    return float(np.corrcoef(a, b)[0, 1])


@dataclasses.dataclass
class Row:
    """A comparison: `difference` (size, size), NaN where nothing is compared. `target` is the largest mean
    difference, `wrong` that of a deliberately wrong map."""

    name: str
    other: str
    unit: str
    difference: np.ndarray
    target: float | None
    wrong: float

    @property
    def values(self):
        return self.difference[np.isfinite(self.difference)]

    @property
    def mean(self):
        return float(self.values.mean())

    def shown_without(self, texels):
        """The mean difference at all other texels."""
        return self.shown(np.nanmean(np.where(texels, np.nan, self.difference)))

    @property
    def is_met(self):
        return self.target is None or self.mean <= self.target

    @property
    def sees_faults(self):
        return self.target is None or self.wrong > self.target

    def cells(self):
        values = self.values
        numbers = (self.mean, np.percentile(values, 95), values.max(), self.wrong)
        mean, p95, most, wrong = (self.shown(number) for number in numbers)
        target = "–" if self.target is None else "equal" if self.target == 0 else f"≤ {self.shown(self.target)}"
        return [self.name, self.other, mean, p95, most, f"{len(values):,}", target, verdict(self), wrong]

    def shown(self, number):
        """A number with its unit; fractions of something in per cent."""
        if self.unit.startswith("of the"):
            return f"{two_digits(number * 100)} %"
        return two_digits(number) + (self.unit if self.unit == "°" else "")


def two_digits(number):
    return np.format_float_positional(float(f"{number:.2g}"), trim="-")


def verdict(row):
    return "–" if row.target is None else "yes" if row.is_met else "**no**"


@dataclasses.dataclass
class Correlated:
    """A comparison by correlation."""

    name: str
    other: str
    value: float
    target: float | None
    wrong: float
    texels: int

    @property
    def is_met(self):
        return self.target is None or self.value >= self.target

    @property
    def sees_faults(self):
        return self.target is None or self.wrong < self.target

    def cells(self):
        target = "–" if self.target is None else f"≥ {self.target}"
        value, wrong = f"r = {self.value:.4f}", f"r = {self.wrong:.4f}"
        return [self.name, self.other, value, "–", "–", f"{self.texels:,}", target, verdict(self), wrong]


class Comparison:
    """The rows of the table."""

    def __init__(self, mask):
        self.mask, self.rows = mask, []

    def add(self, name, other, a, b, difference, unit, target, mask=True, wrong=None):
        """Compares two maps, and a wrong one with the second: by default the first shifted by a texel."""
        wrong = np.roll(a, 1, 1) if wrong is None else wrong
        images = [np.where(self.mask & mask, difference(m, b), np.nan) for m in (a, wrong)]
        self.rows.append(Row(name, other, unit, images[0], target, float(np.nanmean(images[1]))))

    def correlate(self, name, other, a, b, target, by_rank=False):
        mask = self.mask & np.isfinite(a) & np.isfinite(b)
        order = ranks if by_rank else np.asarray
        value, wrong = (correlation(order(m[mask]), order(b[mask])) for m in (a, np.roll(a, 1, 1)))
        self.rows.append(Correlated(name, other, value, target, wrong, int(mask.sum())))


def uniform(image, reach=1):
    """Texels around which all within `reach` rows and columns have the same colour."""
    same = np.ones(image.shape[:2], bool)
    for down in range(-reach, reach + 1):
        for right in range(-reach, reach + 1):
            same &= differ(np.roll(image, (down, right), (0, 1)), image) == 0
    return same


@dataclasses.dataclass
class Result:
    """The comparison; `hidden` are texels at which Taotie shows a hidden point, `triangles` those of scan and low-poly
    mesh, and `version` is Blender's."""

    comparison: Comparison
    hidden: np.ndarray
    triangles: tuple
    version: str

    def blind(self):
        """The comparisons whose target a wrong map meets."""
        return [f"{row.name} ({row.other})" for row in self.comparison.rows if not row.sees_faults]
