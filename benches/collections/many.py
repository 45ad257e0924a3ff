"""Bakes a collection of many tiny scans, kills it at random moments, and measures the time per asset.

    python3 benches/collections/many.py target/release/taotie --assets 10000 --kills 10

After each kill (SIGKILL of the driver, whose processes then end) the next call resumes. At the end every asset is done,
no object was made twice, and `--check` finds no fault.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import resource
import subprocess
import tempfile
import time
from collections import Counter
from pathlib import Path

OPTIONS = """
[[source]]
folder = "scans"
[bake]
triangles = 100
size = 64
"""

# Small numbers of points and pixels: the time of a default proof does not depend on the size of an asset.
LIGHT = """
[verify]
points = 1000
map = 64
view = 32
[thumbnail]
size = 64
"""


def ball(waves: float, rings: int = 8, meridians: int = 16) -> str:
    """Return a wavy ball as OBJ."""
    lines = []
    for ring in range(rings + 1):
        for meridian in range(meridians):
            polar, azimuth = math.pi * ring / rings, 2 * math.pi * meridian / meridians
            radius = 1 + waves * math.sin(3 * polar) * math.cos(5 * azimuth)
            x, y, z = math.sin(polar) * math.cos(azimuth), math.cos(polar), math.sin(polar) * math.sin(azimuth)
            lines.append(f"v {radius * x:.6f} {radius * y:.6f} {radius * z:.6f}")
    for ring in range(rings):
        for meridian in range(meridians):
            a, b = ring * meridians + meridian + 1, ring * meridians + (meridian + 1) % meridians + 1
            c, d = a + meridians, b + meridians
            lines += [f"f {a} {b} {c}"] * (ring > 0) + [f"f {b} {d} {c}"] * (ring < rings - 1)
    return "\n".join(lines) + "\n"


def records(folder: Path) -> list[dict]:
    """Return all whole records of the manifest."""
    path = folder / "assets/manifest.jsonl"
    found = []
    for line in path.read_bytes().splitlines() if path.exists() else []:
        try:
            found.append(json.loads(line))
        except ValueError:
            print("a torn line")
    return found


class Growth:
    """The number of lines of the manifest, read as it grows."""

    def __init__(self, folder: Path) -> None:
        self._path, self._offset, self.lines = folder / "assets/manifest.jsonl", 0, 0

    def look(self) -> int:
        if self._path.exists():
            with self._path.open("rb") as file:
                file.seek(self._offset)
                added = file.read()
            self._offset += len(added)
            self.lines += added.count(b"\n")
        return self.lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--assets", type=int, default=10_000)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--default-proof", action="store_true", help="measure and report as by default")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    chance = random.Random(given.seed)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "scans").mkdir()
        for index in range(given.assets):
            (folder / f"scans/{index:06}.obj").write_text(ball(0.02 + 1e-5 * index))
        (folder / "collection.toml").write_text(OPTIONS + ("" if given.default_proof else LIGHT))
        jobs = ["--jobs", str(given.jobs)] if given.jobs else []
        command = [given.program.resolve(), "batch", folder / "collection.toml", "-q", *jobs]
        kill_at = sorted(chance.uniform(0.02, 0.98) * given.assets for _ in range(given.kills))
        start, killed, growth = time.monotonic(), 0, Growth(folder)
        while True:
            driver = subprocess.Popen(command, stdout=subprocess.DEVNULL)
            while driver.poll() is None:
                time.sleep(0.05)
                if kill_at and growth.look() >= kill_at[0]:
                    kill_at.pop(0)
                    time.sleep(chance.uniform(0, 0.2))
                    driver.kill()
                    killed += 1
            if driver.returncode >= 0:
                break
        seconds, used = time.monotonic() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        last = {record["id"]: record for record in records(folder)}
        states = Counter(record["state"] for record in last.values())
        assert driver.returncode == 0 and states == {"done": given.assets}, (driver.returncode, states)
        made = Counter(part["address"] for record in records(folder) for part in record["parts"] if not part["reused"])
        assert max(made.values()) == 1, "an object was made twice"
        subprocess.run([*command, "--check", "--proofs", "5"], check=True)
        stages = sum(stage["milliseconds"] for record in last.values() for stage in record["stages"])
        whole = sum(1000 * record["seconds"] for record in last.values())
        each = [1000 * (used.ru_utime + used.ru_stime), 1000 * seconds, whole, whole - stages]
        form = "{:.0f} ms of CPU time and {:.0f} ms each; {:.0f} ms per process, of them {:.1f} outside its stages"
        print(f"{given.assets} assets, {killed} kills: " + form.format(*(value / given.assets for value in each)))


if __name__ == "__main__":
    main()
