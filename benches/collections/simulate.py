"""Estimates the time for a large collection on a cluster, from the durations recorded in a manifest.

    python3 benches/collections/simulate.py assets/manifest.jsonl --assets 100000 --triangles 5000000 --cores 1000

Each asset takes the time of a recorded one of at least a million triangles, drawn at random and scaled to its
triangles. One queue hands out the largest first, like `taotie.ray`; shards are assigned in advance by hashes of ids,
like those of `--shard`. Nodes may be lost at a given rate: their current tasks are repeated from the start.
"""

from __future__ import annotations

import argparse
import hashlib
import heapq
import json
import random
from pathlib import Path


# : Triangles of the smallest scan whose time is representative of large ones.
LEAST = 1_000_000


def durations(manifest: Path) -> list[float]:
    """Return the seconds per million triangles of each asset."""
    records = (json.loads(line) for line in manifest.read_text(encoding="utf-8").splitlines())
    made = [record for record in records if record["figures"] and record["stages"]]
    large = [record for record in made if record["figures"]["triangles_in"] >= LEAST]
    return [record["seconds"] / (record["figures"]["triangles_in"] / 1e6) for record in large]


def triangles(mean: float, spread: float, chance: random.Random) -> float:
    """Return the triangles of a scan, log-normally distributed with this mean."""
    return chance.lognormvariate(0, spread) * mean / 2.718281828 ** (spread * spread / 2)


class Cluster:
    """Cores that run one task after the other, and may be lost during a task."""

    def __init__(self, cores: int, lost_a_day: float, seed: int) -> None:
        self.free = [(0.0, core) for core in range(cores)]
        self.busy = 0.0
        self.wasted = 0.0
        self._rate = lost_a_day / 86_400
        self._chance = random.Random(seed)

    def run(self, seconds: float) -> float:
        """Run a task on the first free core; return its end time."""
        start, core = heapq.heappop(self.free)
        while self._rate and (until := self._chance.expovariate(self._rate)) < seconds:
            self.wasted += until
            start += until
        self.busy += seconds
        heapq.heappush(self.free, (start + seconds, core))
        return start + seconds


def one_queue(tasks: list[float], cluster: Cluster) -> float:
    """Return the total time with one queue that hands out the largest first."""
    return max(cluster.run(seconds) for seconds in sorted(tasks, reverse=True))


def shards(tasks: list[float], cores: int) -> float:
    """Return the total time with one shard per core, by hashes."""
    ends = [0.0] * cores
    for index, seconds in enumerate(tasks):
        place = int(hashlib.sha256(f'"{index}"'.encode()).hexdigest()[:16], 16) % cores
        ends[place] += seconds
    return max(ends)


def main() -> None:
    """Read the arguments and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("manifest", type=Path)
    parser.add_argument("--assets", type=int, default=100_000)
    parser.add_argument("--triangles", type=float, default=5e6, help="mean triangles per scan")
    parser.add_argument("--spread", type=float, default=0.8, help="standard deviation of the logarithm of triangles")
    parser.add_argument("--core-seconds", type=float, help="seconds per million triangles [default: recorded median]")
    parser.add_argument("--cores", type=int, default=1000)
    parser.add_argument("--cores-an-hour", type=float, default=0.04, help="price of a core-hour in dollars")
    parser.add_argument("--lost-a-day", type=float, default=0.05, help="fraction of the cores lost per day")
    parser.add_argument("--bytes-in", type=float, default=19.0, help="bytes of a scan per triangle")
    parser.add_argument("--bytes-out", type=float, default=4e6, help="bytes of an asset with its pages")
    args = parser.parse_args()
    chance, known = random.Random(1), durations(args.manifest)
    if args.core_seconds:
        median = sorted(known)[len(known) // 2]
        known = [seconds / median * args.core_seconds for seconds in known]
    sizes = [triangles(args.triangles, args.spread, chance) for _ in range(args.assets)]
    tasks = [size / 1e6 * chance.choice(known) for size in sizes]
    cluster = Cluster(args.cores, args.lost_a_day, 2)
    queue, fixed = one_queue(tasks, cluster), shards(tasks, args.cores)
    core_hours = (cluster.busy + cluster.wasted) / 3600
    least = sum(tasks) / args.cores / 3600
    print(f"core-hours          {core_hours:,.0f}, of which {cluster.wasted / 3600:,.1f} lost with nodes")
    print(f"cost                {core_hours * args.cores_an_hour:,.0f} dollars")
    print(f"one queue           {queue / 3600:.2f} h, {least / (queue / 3600):.1%} of the cores' time used")
    print(f"one shard per core  {fixed / 3600:.2f} h, {least / (fixed / 3600):.1%}")
    print(f"assets per second   {args.assets / queue:.1f}")
    print(f"read                {sum(sizes) * args.bytes_in / 1e12:.1f} TB, {sum(sizes) * args.bytes_in / queue / 1e9:.2f} GB per second")
    print(f"written             {args.assets * args.bytes_out / 1e12:.2f} TB")


if __name__ == "__main__":
    main()
