"""Runs Taotie for the site, each command once until it or the program changes."""

from __future__ import annotations

import hashlib
import json
import shlex
import subprocess
from pathlib import Path


class Program:
    """The program, and the folder that its commands run in."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.path, self.folder = path, folder
        folder.mkdir(parents=True, exist_ok=True)
        self._record = folder / "done.json"
        self._done: dict[str, str] = json.loads(self._record.read_text()) if self._record.exists() else {}
        self._identity = hashlib.sha256(path.read_bytes()).hexdigest()

    def run(self, command: str) -> None:
        """Run a command as the page shows it, unless this program has run it before."""
        if self._done.get(command) == self._identity:
            return
        print(command, flush=True)
        name, *words = shlex.split(command)
        if name != "taotie":
            raise ValueError(f"`{command}`: expected a command of taotie")
        done = subprocess.run([self.path, *words], cwd=self.folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"`{command}` ended with {done.returncode}:\n{done.stderr}")
        self._done[command] = self._identity
        self._record.write_text(json.dumps(self._done, indent=1))
