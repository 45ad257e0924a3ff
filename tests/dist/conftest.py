"""The program under test, and folders that are removed."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "dist"))

import smoke  # noqa: E402

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
    return smoke.ball(24)
