"""The measurements, and their JSON file, from which the plot is drawn."""

import dataclasses
import json
import statistics

import quiet


@dataclasses.dataclass
class Record:
    """A point of an axis under a shading: the milliseconds of all its frames, or why there are none; the fraction of
    the image covered by the vessel, and the peak memory of the process up to then, MiB."""

    axis: str
    line: str
    shading: str
    amount: float
    label: str
    pixels: int
    ms: list = dataclasses.field(default_factory=list)
    why: str = ""
    coverage: float = 0.0
    mib: float = 0.0
    # The milliseconds of a frame before the timed ones.
    first: float = 0.0
    # The part of the processor that other programs used during its frames.
    load: float = 0.0

    def is_busy(self):
        return self.load > quiet.LIMIT

    @property
    def median(self):
        """The median of the frames' milliseconds; None if it failed or was disturbed."""
        return statistics.median(self.ms) if self.ms and not self.why and not self.is_busy() else None


def lines(records, axis):
    """The records of an axis, by shading and name of the line."""
    found = {}
    for record in records:
        if record.axis == axis:
            found.setdefault((record.shading, record.line), []).append(record)
    return found


def save(path, records):
    with open(path, "w", encoding="utf-8") as file:
        json.dump([dataclasses.asdict(record) for record in records], file, indent=1)


def load(path):
    with open(path, encoding="utf-8") as file:
        return [Record(**record) for record in json.load(file)]
