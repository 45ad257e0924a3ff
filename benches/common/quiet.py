"""The share of CPU time that other programs use while something is measured; on Linux only."""

import contextlib
import ctypes
import dataclasses
import os
import time

from command import say

# The largest share at which a measurement counts. It is above the counting error, which was at most 4 % in 60 samples of
# half a second on two busy cores, and 1.7 % in 30 of 1.5 seconds. Another program that computes uses a third or more.
LIMIT = 0.05
# Fewer ticks than these are rounding, however short the measurement.
LEAST = 10
# The seconds of a sample while nothing is measured.
LOOK = 0.5
# PR_SET_CHILD_SUBREAPER of Linux's prctl.
ADOPT = 36


@dataclasses.dataclass(frozen=True)
class Load:
    """Clock ticks of this program's processors together, and those that other programs and machines used."""

    all: int = 0
    others: int = 0

    def __add__(self, other):
        return Load(self.all + other.all, self.others + other.others)

    def __sub__(self, other):
        return Load(self.all - other.all, self.others - other.others)

    def share(self):
        """The share in use by others, from 0 to 1. Ticks are counted separately for processes and the machine, so a few
        mean nothing."""
        return self.others / self.all if self.others >= LEAST else 0.0


class Watch:
    """The load of others during turns, summed by key."""

    def __init__(self):
        self.loads = {}

    @contextlib.contextmanager
    def turn(self, key):
        before = reading()
        try:
            yield
        finally:
            self.loads[key] = self.loads.get(key, Load()) + reading() - before

    def share(self, *keys):
        """The largest share in use by others during the turns of one of these keys."""
        return max((self.loads.get(key, Load()).share() for key in keys), default=0.0)

    def is_busy(self, *keys):
        """Whether others used too much during the turns of these keys."""
        return self.share(*keys) > LIMIT

    def most(self):
        """The largest share in use by others during the turns of a key."""
        return self.share(*self.loads)


def adopt_orphans(adopts=True):
    """Makes descendants that outlive their parent, such as a browser's, children of this process, so that they still
    count as its own. Linux only."""
    with contextlib.suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(ADOPT, int(adopts), 0, 0, 0)


def undisturbed(attempt):
    """The result of `attempt(watch)`, and the watch; of a second attempt if other programs disturbed the first."""
    adopt_orphans()
    result, watch = _watched(attempt)
    if watch.most() > LIMIT:
        say(f"measuring again: other programs used {100 * watch.most():.0f} % of the processor")
        result, watch = _watched(attempt)
    return result, watch


def _watched(attempt):
    watch = Watch()
    settle()
    return attempt(watch), watch


def settle(patience=10.0):
    """Waits until others use at most `LIMIT` of the processor, but no more than `patience` seconds; the share in use."""
    until = time.monotonic() + patience
    while True:
        before = reading()
        time.sleep(LOOK)
        share = (reading() - before).share()
        if share <= LIMIT or time.monotonic() > until:
            return share


def reading():
    """Ticks since the machine started. `others` is what neither this process nor its descendants used, with the time
    that the hypervisor gave to other machines. Zero if the system does not report it."""
    try:
        with open("/proc/stat", encoding="utf-8") as file:
            total, used = of_machine(file.read(), affinity())
    except OSError:
        return Load()
    return Load(total, used - of_family(processes(), os.getpid()))


def affinity():
    """The processors that this program may use."""
    return os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else range(os.cpu_count() or 1)


def of_machine(text, processors):
    """Ticks in total and in use, with those stolen, of some processors in /proc/stat. Guests are part of `user`."""
    names = {f"cpu{number}" for number in processors}
    lines = [line.split() for line in text.splitlines()]
    ticks = [[int(word) for word in words[1:9]] for words in lines if words and words[0] in names]
    total, unused = sum(map(sum, ticks)), sum(sum(each[3:5]) for each in ticks)
    return total, total - unused


def processes():
    """The parent of each process, and the ticks of the process with its children that ended; by number."""
    found = {}
    for name in os.listdir("/proc"):
        if name.isdigit():
            # A process may end in between.
            with contextlib.suppress(OSError), open(f"/proc/{name}/stat", encoding="utf-8", errors="replace") as file:
                found[int(name)] = of_process(file.read())
    return found


def of_process(text):
    """Parent and ticks in /proc/PID/stat; the program's name, in brackets, may contain anything."""
    fields = text.rpartition(")")[2].split()
    return int(fields[1]), sum(map(int, fields[11:15]))


def of_family(found, root):
    """Ticks of a process and all its descendants."""
    return sum(ticks for number, (_, ticks) in found.items() if is_descendant(found, number, root))


def is_descendant(found, number, root):
    """Whether a process is `root` or descends from it."""
    for _ in found:
        if number == root:
            return True
        if number not in found:
            return False
        number = found[number][0]
    return False
