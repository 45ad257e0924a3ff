"""Archives with the same bytes for the same content: entries sorted, one date, no owner."""

from __future__ import annotations

import gzip
import io
import tarfile
import time
import zipfile
from pathlib import Path

PROGRAMS = ("taotie", "taotie.exe")


def write(path: Path, content: dict[str, bytes], date: int) -> None:
    """Write a .tar.gz or .zip file with the content by name, in a folder with the name of the archive."""
    is_zip = path.suffix == ".zip"
    folder = path.name.removesuffix(".zip" if is_zip else ".tar.gz")
    entries = [(f"{folder}/{name}", content[name], mode(name)) for name in sorted(content)]
    path.write_bytes(zipped(entries, date) if is_zip else tarred(entries, date))


def mode(name: str) -> int:
    return 0o755 if name in PROGRAMS else 0o644


def tarred(entries: list[tuple[str, bytes, int]], date: int) -> bytes:
    packed = io.BytesIO()
    # Neither the name nor the date of the archive is in its header.
    with (
        gzip.GzipFile("", "wb", 9, packed, mtime=0) as stream,
        tarfile.open(fileobj=stream, mode="w", format=tarfile.USTAR_FORMAT) as tar,
    ):
        for name, content, permissions in entries:
            entry = tarfile.TarInfo(name)
            entry.size, entry.mtime, entry.mode = len(content), date, permissions
            tar.addfile(entry, io.BytesIO(content))
    return packed.getvalue()


def zipped(entries: list[tuple[str, bytes, int]], date: int) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content, permissions in entries:
            entry = zipfile.ZipInfo(name, time.gmtime(date)[:6])
            # Unix, so that permissions count; the same on every system.
            entry.create_system, entry.external_attr = 3, (0o100000 | permissions) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content)
    return packed.getvalue()
