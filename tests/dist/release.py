"""A release on a local server."""

from __future__ import annotations

import hashlib
import http.server
import platform
import tarfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

VERSION = "1.2.3"
# The files of an archive for Linux or macOS.
FILES = ["taotie", "LICENSE-MIT", "LICENSE-APACHE", "THIRD-PARTY.html", "man/taotie.1", "man/taotie-bake.1", "completions/bash/taotie",
         "completions/fish/taotie.fish", "completions/zsh/_taotie", "completions/powershell/_taotie.ps1"]


class Release:
    """A folder with an archive and its checksum."""

    def __init__(self, folder: Path, program: Path) -> None:
        self.folder = folder
        self.name = f"taotie-{VERSION}-{platform.machine()}-unknown-linux-musl"
        self.archive = folder / f"{self.name}.tar.gz"
        files = {path: b"" for path in FILES} | {"taotie": f'#!/bin/sh\nexec "{program}" "$@"\n'.encode()}
        tree = folder / "tree"
        for name, content in files.items():
            path = tree / self.name / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        (tree / self.name / "taotie").chmod(0o755)
        with tarfile.open(self.archive, "w:gz") as file:
            file.add(tree / self.name, self.name)
        self.list(hashlib.sha256(self.archive.read_bytes()).hexdigest())

    def list(self, checksum: str) -> None:
        other = "0" * 64
        (self.folder / "SHA256SUMS").write_text(
            f"{other}  taotie-{VERSION}-x86_64-pc-windows-gnu.zip\n{checksum}  {self.archive.name}\n{other}  taotie-{VERSION}.sdist\n")

    @contextmanager
    def serving(self) -> Iterator[Release]:
        """Serve the folder at `address`."""
        handler = partial(Handler, directory=str(self.folder))
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            self.address = f"http://127.0.0.1:{server.server_port}/"
            yield self
            server.shutdown()


class Handler(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Log nothing."""
