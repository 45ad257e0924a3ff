"""The verdict on paired times: a loss, a gain, or neither.

The speed of a virtual machine varies by a third from minute to minute. The two runs of a pair are adjacent, so the
ratio of a pair is more reliable than a ratio of means; the median ignores the pairs during which the speed changed;
and if the builds are equal, a quarter of the pairs is nearly always below 1, wherever the median strays.
"""

import statistics

LOSS, GAIN, SAME = "loss", "gain", "same"


def ratio(pairs):
    """The median of now divided by base; a pair is (base, now)."""
    return statistics.median(_ratios(pairs))


def verdict(pairs, limit):
    """A loss has a median above `limit` and its lower quartile above 1; a gain is the reverse."""
    if _is_beyond(_ratios(pairs), limit):
        return LOSS
    return GAIN if _is_beyond([1 / ratio for ratio in _ratios(pairs)], limit) else SAME


def _is_beyond(ratios, limit):
    lower_quartile = statistics.quantiles(ratios, method="inclusive")[0]
    return statistics.median(ratios) > limit and lower_quartile > 1


def _ratios(pairs):
    return [now / base for base, now in pairs]
