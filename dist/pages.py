"""Manual pages and completions, from a program that runs here: they are the same for all targets."""

from __future__ import annotations

import tempfile
from pathlib import Path

import toolchain

# The name that each shell expects.
COMPLETIONS = {
    "bash": "completions/bash/taotie",
    "fish": "completions/fish/taotie.fish",
    "zsh": "completions/zsh/_taotie",
    "powershell": "completions/powershell/_taotie.ps1",
}


def made_by(program: Path) -> dict[str, bytes]:
    """Return the pages and scripts by their names in archives."""
    scripts = {name: toolchain.output([program, "completions", shell]).encode() for shell, name in COMPLETIONS.items()}
    with tempfile.TemporaryDirectory() as folder:
        toolchain.output([program, "man-pages", folder])
        return scripts | {f"man/{page.name}": page.read_bytes() for page in Path(folder).iterdir()}
