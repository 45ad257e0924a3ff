"""The folders of a build, the version and the date."""

from __future__ import annotations

import os
import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# What a release consists of.
OUTPUT = ROOT / "target/dist"
# Cargo's files. Not below OUTPUT, where cargo would put those of the profile `dist`.
BUILD = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target/dist-build")).resolve()
LICENCES = ("LICENSE-MIT", "LICENSE-APACHE")


def version() -> str:
    """Return the version of the workspace."""
    return str(tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"])


def epoch() -> int:
    """Return the time of all files in archives: SOURCE_DATE_EPOCH, or the date of the commit."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    if given:
        return int(given)
    done = subprocess.run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit("make dist: this is not a git repository: set SOURCE_DATE_EPOCH to the date of the release, in seconds")
    return int(done.stdout)
