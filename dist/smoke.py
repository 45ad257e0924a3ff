"""A static program at work in an empty root file system: that it needs nothing there, and bakes."""

from __future__ import annotations

import math
import os
import subprocess
import tempfile
from pathlib import Path

# The start of the message for what a static program cannot do.
NO_GPU = "--device gpu: this build cannot load graphics drivers"


def check(program: bytes) -> None:
    """Bake and render a ball; without the right to change the root, in an ordinary folder."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "taotie").write_bytes(program)
        (folder / "taotie").chmod(0o755)
        (folder / "scan.obj").write_text(ball())
        expect(folder, ["bake", "scan.obj", "-o", "asset.glb", "--triangles", "200", "--size", "64"], 0, "")
        expect(folder, ["render", "asset.glb", "-o", "picture.png", "--size", "64x64"], 0, "")
        expect(folder, ["render", "asset.glb", "-o", "gpu.png", "--device", "gpu"], 2, NO_GPU)
        missing = [made for made in ("asset.glb", "asset.report.html", "picture.png") if not (folder / made).is_file()]
        if missing:
            raise SystemExit(f"make dist: the static program did not write {', '.join(missing)}")


def expect(folder: Path, arguments: list[str], code: int, message: str) -> None:
    """Run the program in the folder as its root; end unless it returns the code and prints the message."""
    is_root = hasattr(os, "geteuid") and os.geteuid() == 0
    enter = (lambda: os.chroot(folder)) if is_root else None
    done = subprocess.run(
        ["/taotie" if is_root else str(folder / "taotie"), *arguments], cwd=folder, env={}, preexec_fn=enter,
        capture_output=True, text=True, encoding="utf-8", check=False,
    )
    if done.returncode != code or message not in done.stderr:
        raise SystemExit(f"make dist: taotie {' '.join(arguments)}: exit code {done.returncode}, expected {code} with `{message}`:\n{done.stderr}")


def ball(steps: int = 16) -> str:
    """Return a bumpy ball as OBJ."""
    lines = []
    for row in range(steps + 1):
        for column in range(steps):
            polar, around = math.pi * row / steps, 2 * math.pi * column / steps
            radius = 1 + 0.05 * math.sin(5 * around) * math.sin(polar)
            x, y = radius * math.sin(polar) * math.cos(around), radius * math.sin(polar) * math.sin(around)
            lines.append(f"v {x:.6f} {radius * math.cos(polar):.6f} {-y:.6f}")
    for row in range(steps):
        for column in range(steps):
            here, right = row * steps + column + 1, row * steps + (column + 1) % steps + 1
            lines.append(f"f {here} {here + steps} {right + steps} {right}")
    return "\n".join(lines) + "\n"
