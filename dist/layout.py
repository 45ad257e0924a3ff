"""The content of a program's archive. Installers and recipes rely on these names."""

from __future__ import annotations

from pathlib import Path

import archive
import pages
import place
from targets import Target


def shared(third_party: bytes, runnable: Path) -> dict[str, bytes]:
    """Return the files that all archives have: licences, and the pages that a program writes which runs here."""
    ours = {name: (place.ROOT / name).read_bytes() for name in place.LICENCES}
    return ours | {"THIRD-PARTY.html": third_party} | pages.made_by(runnable)


def write(folder: Path, target: Target, program: Path, files: dict[str, bytes]) -> Path:
    """Write the archive of a program; return its path."""
    path = folder / f"taotie-{place.version()}-{target.triple}.{'zip' if target.is_windows else 'tar.gz'}"
    archive.write(path, files | {target.program: program.read_bytes()}, place.epoch())
    return path
