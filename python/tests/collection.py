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


def write_photographs(folder: Path, outputs: tuple[str, ...]) -> None:
    """Write photographs of a matt dome under 12 lights, of 32 by 32 pixels, and a collection's file for each output."""
    side, count = 32, 12
    place = folder / "photographs/dome"
    place.mkdir(parents=True)
    lights = [(0.6 * math.cos(math.tau * k / count), 0.6 * math.sin(math.tau * k / count), 0.8) for k in range(count)]
    (place / "dome.lp").write_text("\n".join([str(count), *(f"p{k}.tga {x} {y} {z}" for k, (x, y, z) in enumerate(lights))]))
    centres = [(2 * i + 1) / side - 1 for i in range(side)]
    for k, light in enumerate(lights):
        normals = [(0.5 * x, -0.5 * y, math.sqrt(1 - 0.25 * (x * x + y * y))) for y in centres for x in centres]
        pixels = bytes(round(200 * max(0.0, sum(map(float.__mul__, normal, light)))) for normal in normals)
        # Grey, from the top left corner.
        header = bytes([0, 0, 3, *[0] * 9, side, 0, side, 0, 8, 0x20])
        (place / f"p{k}.tga").write_bytes(header + pixels)
    for name in outputs:
        text = OPTIONS.format(output=name).replace("scans", "photographs")
        (folder / f"{name}.toml").write_text(text + '[photometric]\nencoding = "linear"\nrelight = ["openlime"]\n')


def objects(folder: Path) -> dict[str, bytes]:
    """Return the bytes of all objects by path."""
    files = (path for path in (folder / "objects").rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}
