"""Finds the number of triangles for a given number of bytes."""

import dataclasses

from programs import SIDES, Order

# Tolerance of an asset's bytes around the budget.
TOLERANCE = 0.05
# Textures and maps are made smaller until this fraction of the triangles fits.
LEAST_SHARE = 0.05
STEPS = 8


def fitted(make, scan, budget, is_sided):
    """Of the assets tried, the one nearest to the budget, as (order, asset). `make(order)` returns an asset."""
    least = max(4, round(scan.triangles * LEAST_SHARE))
    tried = []
    for side in SIDES if is_sided else SIDES[:1]:
        order = Order(scan, least, side)
        tried = [(order, make(order))]
        if tried[0][1].bytes <= budget:
            break
    while not is_near(tried[-1], budget) and len(tried) < STEPS:
        count = guess(tried, budget, scan.triangles)
        if count in [order.triangles for order, _ in tried]:
            break
        order = dataclasses.replace(tried[0][0], triangles=count)
        tried.append((order, make(order)))
    return min(tried, key=lambda pair: abs(pair[1].bytes - budget))


def is_near(pair, budget):
    return abs(pair[1].bytes / budget - 1) <= TOLERANCE


def guess(tried, budget, most):
    """The count at which bytes, interpolated between the nearest trials below and above, reach the budget."""
    points = sorted((order.triangles, asset.bytes) for order, asset in tried)
    below = [point for point in points if point[1] <= budget]
    above = [point for point in points if point[1] > budget]
    if not above:
        count, size = below[-1]
        return min(most, round(count * min(budget / size * 1.2, 4)))
    if not below:
        count, size = above[0]
        return max(4, round(count * max(budget / size * 0.8, 0.25)))
    (low, low_bytes), (high, high_bytes) = below[-1], above[0]
    share = (budget - low_bytes) / (high_bytes - low_bytes)
    return round(low + min(max(share, 0.1), 0.9) * (high - low))
