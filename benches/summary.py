"""The summary at the top of docs/benchmarks.md."""

import math
import statistics

import page
import quiet

# The greatest fraction of a part's measurements that other programs may disturb; one is tolerated in any case.
TOLERATED = 0.1
PEER_WINS, GOAL_MISSED, REST, DISTURBED = range(4)


def group(row):
    """Where the row is listed: groups in rising order."""
    if row.is_busy():
        return DISTURBED
    if row.ratio() < 1:
        return PEER_WINS
    return GOAL_MISSED if row.goal and row.ratio() < row.goal else REST


def ordered(rows):
    """By group, and the lowest ratio first."""
    return sorted(rows, key=lambda row: (group(row), 0 if row.is_busy() else row.ratio(), row.case, row.peer))


def shown(rows):
    """The ordered rows without those, of the rest without a goal, whose case has a peer nearer to Taotie."""
    kept, cases = [], set()
    for row in ordered(rows):
        if group(row) != REST or row.goal or row.case not in cases:
            kept.append(row)
        if not row.is_busy():
            cases.add(row.case)
    return kept


def verdict(row):
    if row.is_busy():
        return "busy: no conclusion"
    least, greatest = row.spread()
    who = "the peer wins" if row.ratio() < 1 else "Taotie wins"
    who += " (rounds disagree)" if least < 1 < greatest else ""
    if row.goal is None:
        return who
    return f"{who}; goal {'met' if row.ratio() >= row.goal else 'missed'}"


def figure(x):
    """Three digits, or all of a whole number."""
    return f"{x:,.{max(0, 2 - math.floor(math.log10(x)))}f}" if x > 0 else "0"


def cells(row):
    goal = "–" if row.goal is None else f"{row.goal:g}"
    if row.is_busy():
        return [row.case, row.peer, "–", "–", "–", goal, verdict(row)]
    own, other = (f"{figure(statistics.median(some))} {row.unit}" for some in (row.own, row.other))
    return [row.case, row.peer, own, other, row.ratio_text(), goal, verdict(row)]


def table(rows):
    head = ["comparison", "peer", "Taotie", "peer's", "ratio", "goal", "verdict"]
    return page.table(head, list(map(cells, rows)), texts=(0, 1, 6))


def counts(rows):
    """A sentence with the number of rows in each group."""
    wins, disturbed = (sum(group(row) == wanted for row in rows) for wanted in (PEER_WINS, DISTURBED))
    aims = [row for row in rows if row.goal is not None and not row.is_busy()]
    missed = sum(row.ratio() < row.goal for row in aims)
    return (
        f"Comparisons: {len(rows)}; won by peers: {wins}; without a conclusion: {disturbed}. "
        f"Goals: {len(aims)}; missed: {missed}."
    )


def is_refused(report):
    """Whether other programs disturbed too many measurements or rows of the part for a page."""
    disturbed = sum(row.is_busy() for row in report.rows)
    return report.busy > max(1, TOLERATED * report.measured) or disturbed > TOLERATED * len(report.rows)


def versions(reports):
    """The peers' versions as a sentence; a peer of several parts is named once."""
    found = {}
    for report in reports:
        found |= report.versions
    return "".join(f"{title}: {version}. " for title, version in found.items()).rstrip()


def text(machine, dates, reports):
    """The Markdown of the summary. `machine` and `dates` are phrases."""
    rows = [row for report in reports for row in report.rows]
    about = ABOUT.format(limit=100 * quiet.LIMIT)
    lines = [page.wrapped(about), "", page.wrapped(f"Measured on {dates}: {machine}. {versions(reports)}")]
    lines += ["", counts(rows), "", *table(shown(rows))] if rows else []
    return "\n".join(lines)


ABOUT = (
    "`make bench` runs Taotie and each peer in alternation. A ratio is the peer's time or memory divided by Taotie's, "
    "the median over the rounds, with the least and greatest in brackets: above 1, Taotie is better. Rounds disagree if "
    "some are above 1 and some below. First come the rows that a peer wins, then missed goals, then the rest, of which rows without "
    "a goal only name the nearest peer of a comparison: the others are in the sections below, as multiples of Taotie's. "
    "A measurement during which other programs, or other virtual machines, used more than {limit:.0f} % of the processor "
    "is repeated once; if it is disturbed again, it has no ratio."
)
