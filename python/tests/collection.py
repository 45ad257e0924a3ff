"""A small collection, built by code."""

from __future__ import annotations

import math
from pathlib import Path

OPTIONS = """
output = "{output}"
[[source]]
folder = "scans"
[bake]
triangles = 60
size = 64
[verify]
points = 1000
map = 64
view = 32
[thumbnail]
size = 32
"""


def ball(waves: float) -> str:
    """Return a ball of 16 by 8 quads as OBJ."""
    places = [
        (radius * math.sin(t) * math.cos(p), radius * math.cos(t), -radius * math.sin(t) * math.sin(p))
        for i in range(9)
        for j in range(16)
        for t, p in [(math.pi * (0.02 + 0.96 * i / 8), math.tau * j / 16)]
        for radius in [1 + waves * math.sin(5 * t)]
    ]
    corners = [(i * 16 + j, i * 16 + 16 + j, i * 16 + 16 + (j + 1) % 16, i * 16 + (j + 1) % 16) for i in range(8) for j in range(16)]
    lines = ["v {} {} {}".format(*place) for place in places]
    return "\n".join(lines + ["f " + " ".join(str(corner + 1) for corner in face) for face in corners]) + "\n"


def write(folder: Path, scans: int, outputs: tuple[str, ...]) -> None:
    """Write balls, a broken file, and a collection's file for each output."""
    (folder / "scans").mkdir(parents=True)
    for index in range(scans):
        (folder / f"scans/{index}.obj").write_text(ball(0.01 * index))
    (folder / "scans/broken.obj").write_text("v 1 2\n")
    for name in outputs:
        (folder / f"{name}.toml").write_text(OPTIONS.format(output=name))


def objects(folder: Path) -> dict[str, bytes]:
    """Return the bytes of all objects by path."""
    files = (path for path in (folder / "objects").rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}
