"""Sections of docs/benchmarks.md, each between two marks with the Makefile target that writes it."""

import math
import textwrap


# Instead of a figure that was measured while other programs used the processor.
BUSY = "busy"


class Unmarked(Exception):
    """A page without the marks."""


def two_digits(x):
    """3.1, 12, 130, 0.87."""
    digits = 1 - math.floor(math.log10(x))
    return f"{round(x, digits):.{max(digits, 0)}f}"


def seconds(x):
    return f"{x:.2f}" if x < 10 else f"{x:.1f}"


def wrapped(prose):
    """Wraps prose at the line length of the page."""
    return textwrap.fill(prose, 120, break_long_words=False, break_on_hyphens=False)


def row(cells):
    return f"| {' | '.join(cells)} |"


def table(head, rows, texts=(0,)):
    """The columns `texts` are aligned to the left, figures to the right."""
    rule = "".join("---|" if column in texts else "---:|" for column in range(len(head)))
    return [row(head), f"|{rule}", *map(row, rows)]


def marks(target):
    return f"<!-- make {target}: begin -->", f"<!-- make {target}: end -->"


def around(path, target):
    """The parts of the page before the first mark and after the second."""
    with open(path, encoding="utf-8") as file:
        page = file.read()
    first, second = marks(target)
    before, begin, rest = page.partition(first)
    _, end, after = rest.partition(second)
    if not (begin and end):
        raise Unmarked(f"{path} has no place for the section: it needs the lines {first} and {second}")
    return before, after


def write(path, target, content):
    """Replaces the content between the marks of the page; the rest is unchanged."""
    before, after = around(path, target)
    begin, end = marks(target)
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"{before}{begin}\n{content}\n{end}{after}")
