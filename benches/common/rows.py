"""Rows of the summary: Taotie and a peer, in alternation; and what a benchmark reports."""

import dataclasses
import json
import statistics

import quiet
from page import two_digits


@dataclasses.dataclass(frozen=True)
class Row:
    """The figures of Taotie and a peer in each round, in `unit`: s, ms or MiB. `goal` is the minimum ratio, None
    without one; `load` the share of CPU time that other programs used meanwhile."""

    case: str
    peer: str
    unit: str
    own: list
    other: list
    goal: float | None = None
    load: float = 0.0

    def is_busy(self):
        return self.load > quiet.LIMIT

    def ratios(self):
        """The peer's figure divided by Taotie's, by round: above 1, Taotie is better."""
        return [other / own for own, other in zip(self.own, self.other)]

    def ratio(self):
        return statistics.median(self.ratios())

    def spread(self):
        """The least and the greatest ratio."""
        return min(self.ratios()), max(self.ratios())

    def spread_text(self):
        """1.6–1.8; one number if both are the same to two digits."""
        return "–".join(dict.fromkeys(map(two_digits, self.spread())))

    def ratio_text(self):
        """1.7 (1.6–1.8); without a spread if there was one round."""
        ratio = two_digits(self.ratio())
        return f"{ratio} ({self.spread_text()})" if len(self.ratios()) > 1 else ratio


@dataclasses.dataclass(frozen=True)
class Report:
    """What a benchmark reports: rows of the summary, the versions of its peers by title, the section's Markdown, and
    how many of how many measurements were disturbed by other programs."""

    rows: list
    versions: dict
    section: str
    busy: int
    measured: int

    def save(self, path):
        with open(path, "w", encoding="utf-8") as file:
            json.dump(dataclasses.asdict(self), file, ensure_ascii=False, indent=1)


def load(path):
    with open(path, encoding="utf-8") as file:
        fields = json.load(file)
    return Report(**fields | {"rows": [Row(**row) for row in fields["rows"]]})
