"""The program under test, and folders that are removed."""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SPHERE_STEPS = 24
# The scripts under test are for sh; install.ps1 is only parsed.
collect_ignore_glob = ["test_*.py"] if sys.platform == "win32" else []


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the command: TAOTIE, or that of the Python package under test."""
    given = os.environ.get("TAOTIE")
    if given:
        return Path(given).resolve()
    path = tmp_path_factory.mktemp("program") / "taotie"
    path.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m taotie._command "$@"\n')
    path.chmod(0o755)
    return path


@pytest.fixture(scope="session")
def scan() -> str:
    """Return a bumpy ball as OBJ."""
    lines = []
    for row in range(SPHERE_STEPS + 1):
        for column in range(SPHERE_STEPS):
            polar, around = math.pi * row / SPHERE_STEPS, 2 * math.pi * column / SPHERE_STEPS
            radius = 1 + 0.05 * math.sin(5 * around) * math.sin(polar)
            x, y = radius * math.sin(polar) * math.cos(around), radius * math.sin(polar) * math.sin(around)
            lines.append(f"v {x:.6f} {radius * math.cos(polar):.6f} {-y:.6f}")
    for row in range(SPHERE_STEPS):
        for column in range(SPHERE_STEPS):
            here, right = row * SPHERE_STEPS + column + 1, row * SPHERE_STEPS + (column + 1) % SPHERE_STEPS + 1
            lines.append(f"f {here} {here + SPHERE_STEPS} {right + SPHERE_STEPS} {right}")
    return "\n".join(lines) + "\n"
