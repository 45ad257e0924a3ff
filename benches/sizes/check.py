"""Measures two small models at a few settings, and fails if Taotie's assets are too large next to gltfpack's."""

import compare
import measure

# The mean angle at which sizes are compared.
DEGREES = 1
# Maximum of Taotie's bytes as a multiple of gltfpack's with a ΔE no worse. Lower it when Taotie's assets get smaller.
FACTOR = 1.25


def run(found):
    """Prints the figures of each model; raises `measure.Failed` if any exceeds the factor."""
    matches = {one.name: compare.at_limit(one, DEGREES) for one in found}
    for name, match in matches.items():
        print(f"{name}: {line(match)}")
    too_large = [name for name, match in matches.items() if is_too_large(match)]
    if too_large:
        raise measure.Failed(f"larger than {FACTOR:g} times gltfpack's asset: {', '.join(too_large)}")


def is_too_large(match):
    """Returns true if Taotie's asset is too large, or if it has none within the limit."""
    if match.taotie is None:
        return True
    ratio = match.color_bytes_ratio()
    return ratio is not None and ratio > FACTOR


def line(match):
    ratio = match.color_bytes_ratio()
    shown = f"{ratio:.2f} times (at most {FACTOR:g})" if ratio else "nothing to compare"
    others = f"gltfpack {asset(match.gltfpack_color)}, with any ΔE {asset(match.gltfpack)}"
    return f"Taotie {asset(match.taotie)}; {others}: {shown}"


def asset(point):
    if point is None:
        return f"none within {DEGREES:g}°"
    return f"{point.bytes:,} bytes, {point.degrees:.2f}°, ΔE {point.color:.2f} ({point.label})"
