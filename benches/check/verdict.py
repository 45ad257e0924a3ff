"""The verdict on times that were taken in pairs: a loss, a gain, or neither.

A virtual machine changes its speed by a third from minute to minute. The two of a pair stand side by side, so a ratio of
theirs is worth more than one of means; the median leaves out the pairs in between which the machine changed; and
where the builds are the same a quarter of the pairs lies below 1 as good as always, wherever the median strays.
"""

import statistics

LOSS, GAIN, SAME = "loss", "gain", "same"


def ratio(pairs):
    """The median of now by base; a pair is (base, now)."""
    return statistics.median(_ratios(pairs))


def verdict(pairs, limit):
    """A loss has a median above `limit` and its lower quartile above 1; a gain is the same the other way round."""
    if _is_beyond(_ratios(pairs), limit):
        return LOSS
    return GAIN if _is_beyond([1 / ratio for ratio in _ratios(pairs)], limit) else SAME


def _is_beyond(ratios, limit):
    lower_quartile = statistics.quantiles(ratios, method="inclusive")[0]
    return statistics.median(ratios) > limit and lower_quartile > 1


def _ratios(pairs):
    return [now / base for base, now in pairs]
