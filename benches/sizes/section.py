"""The section of docs/sizes.md."""

import math
import statistics

import compare
from page import row, wrapped
from point import smallest

NONE = "–"
PICTURE = "![Bytes against mean angle: every asset of each model, and the frontier of each tool](images/sizes.svg)"
# Fields of compare.Frontiers and compare.Match.
NAMES = ("taotie", "gltfpack", "gltf_transform")
FEWEST = ["model", "at most", "Taotie kB", "ΔE", "gltfpack kB", "ΔE", "kB, ΔE no worse", "gltf-transform kB", "ΔE",
          "Taotie ÷ gltfpack", "ΔE no worse"]  # fmt: skip
EQUAL = ["model", "at most", "Taotie kB", "°", "ΔE", "gltfpack °", "ΔE", "°, ΔE no worse", "Taotie ÷ gltfpack",
         "ΔE no worse"]  # fmt: skip
ASSETS = ["model", "option", "triangles", "kB", "mean °", "p95 °", "ΔE", "pixels missed", "gltfpack kB",
          "kB, ΔE no worse", "Taotie ÷ gltfpack", "ΔE no worse"]  # fmt: skip
SUMMARY = ["at most", "any ΔE", "models", "ΔE no worse", "models"]
EQUAL_BYTES = (
    "Taotie's assets are those of the first table. gltfpack's are the most accurate of at most the same size, with any "
    "ΔE and with a ΔE no worse."
)
LOSSES = (
    "Taotie's bytes as a multiple of those of the smallest asset of any other tool; in brackets as a multiple of "
    "gltfpack's with a ΔE no worse. Models for which neither is above 1 are omitted."
)


def text(machine, versions, found):
    """The section's Markdown."""
    at_limits = [(titled(one), [compare.at_limit(one, degrees) for degrees in compare.LIMITS]) for one in found]
    at_assets = [(titled(one), [compare.at_asset(one, asset) for asset in one.taotie]) for one in found]
    parts = [
        PICTURE,
        wrapped(f"Measured on: {machine}; {versions}. {counts(found)} {times(found)}"),
        "### Fewest bytes within a mean angle",
        table(FEWEST, at_limits, fewest),
        wrapped(most_missed(at_limits)),
        "### Geometric means of Taotie's bytes to gltfpack's",
        summary(at_limits),
        "### Fewest degrees within Taotie's bytes",
        wrapped(EQUAL_BYTES),
        table(EQUAL, at_limits, equal),
        "### Every asset of Taotie, and gltfpack's smallest of at most its degrees",
        table(ASSETS, at_assets, asset),
        "### Where Taotie loses",
        wrapped(LOSSES),
        losses(at_limits),
    ]
    return "\n\n".join(parts)


def titled(one):
    """The model with its original size."""
    return f"{one.name}, {one.bytes / 1000:,.0f} kB"


def table(head, matches, cells):
    """A row per match; the name of the model is in the first of its rows."""
    lines = [row(head), "|---|" + "---:|" * (len(head) - 1)]
    for name, some in matches:
        lines += [row([name if i == 0 else "", *cells(match)]) for i, match in enumerate(some)]
    return "\n".join(lines)


def fewest(match):
    return [
        f"{match.degrees:g}°",
        *(kilobytes(match.taotie), colors(match.taotie)),
        *(kilobytes(match.gltfpack), colors(match.gltfpack), kilobytes(match.gltfpack_color)),
        *(kilobytes(match.gltf_transform), colors(match.gltf_transform)),
        *(ratio(match.bytes_ratio()), ratio(match.color_bytes_ratio())),
    ]


def equal(match):
    return [
        f"{match.degrees:g}°",
        *(kilobytes(match.taotie), angle(match.taotie), colors(match.taotie)),
        *(angle(match.at_bytes), colors(match.at_bytes), angle(match.at_bytes_color)),
        *(ratio(match.degrees_ratio()), ratio(match.color_degrees_ratio())),
    ]


def asset(match):
    own = match.taotie
    return [
        own.label,
        f"{own.triangles:,}",
        *(kilobytes(own), angle(own), f"{own.degrees_p95:.2f}", colors(own), percent(own.missed)),
        *(kilobytes(match.gltfpack), kilobytes(match.gltfpack_color)),
        *(ratio(match.bytes_ratio()), ratio(match.color_bytes_ratio())),
    ]


def kilobytes(point):
    return f"{point.bytes / 1000:,.1f}" if point else NONE


def angle(point):
    return f"{point.degrees:.2f}" if point else NONE


def colors(point):
    """Mean and 95 % quantile."""
    return f"{point.color:.2f} / {point.color_p95:.2f}" if point else NONE


def ratio(value):
    """Bold if Taotie loses."""
    if value is None:
        return NONE
    return f"**{value:.2f}**" if value > 1 else f"{value:.2f}"


def counts(found):
    own, pack, transform = (sum(len(getattr(one, name)) for one in found) for name in NAMES)
    return f"{own + pack + transform:,} assets: {own} of Taotie, {pack:,} of gltfpack, {transform} of gltf-transform."


def times(found):
    """Median times to make an asset."""
    own, pack, transform = (median([p.seconds for one in found for p in getattr(one, name)]) for name in NAMES)
    return f"The median time to make one: Taotie {own}, gltfpack {pack}, gltf-transform {transform}."


def median(seconds):
    return f"{statistics.median(seconds):.2g} s" if seconds else NONE


def summary(at_limits):
    """Geometric means over the models on which both tools have an asset."""
    lines = [row(SUMMARY), "|---|" + "---:|" * (len(SUMMARY) - 1)]
    for i, degrees in enumerate(compare.LIMITS):
        some = [matches[i] for _, matches in at_limits]
        any_color, same = [m.bytes_ratio() for m in some], [m.color_bytes_ratio() for m in some]
        lines.append(row([f"{degrees:g}°", *mean(any_color), *mean(same)]))
    return "\n".join(lines)


def mean(ratios):
    """Cells: the geometric mean, and the number of models."""
    values = [value for value in ratios if value is not None]
    return [ratio(geometric(values) if values else None), str(len(values))]


def geometric(values):
    return math.exp(statistics.fmean(map(math.log, values)))


def losses(at_limits):
    """A line for each limit."""
    lines = [loss(degrees, [(name, some[i]) for name, some in at_limits]) for i, degrees in enumerate(compare.LIMITS)]
    return "\n".join(lines)


def loss(degrees, matches):
    some = [f"{name.partition(',')[0]} {words}" for name, match in matches if (words := lost(match))]
    return f"- {degrees:g}°: {'; '.join(some) or 'none'}."


def lost(match):
    """The ratio of Taotie's asset to the smallest of the others if it is larger, else None."""
    best = smallest([point for point in (match.gltfpack, match.gltf_transform) if point])
    if best is None:
        return None
    if match.taotie is None:
        return f"not reached (kB of {best.tool}: {kilobytes(best)})"
    times, same = match.taotie.bytes / best.bytes, match.color_bytes_ratio()
    if times <= 1 and not (same and same > 1):
        return None
    return f"{times:.2f} ({f'{same:.2f}' if same else NONE})"


def most_missed(at_limits):
    """The largest fraction of pixels that any asset of the first table lacks."""
    own, pack, transform = (most([getattr(match, name) for _, some in at_limits for match in some]) for name in NAMES)
    return f"Most pixels missed by any of these assets: Taotie {own}, gltfpack {pack}, gltf-transform {transform}."


def most(points):
    return percent(max((point.missed for point in points if point), default=0))


def percent(share):
    return f"{share * 100:.2f} %"
