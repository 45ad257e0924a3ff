"""Runs of the program and their outcome."""

from __future__ import annotations

import json
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any
from urllib.parse import quote

from pairs import Pair, Unusable
from runner import Quoted

# The message prefixes of the program.
ERROR, WARNING = "taotie: error: ", "taotie: warning: "


@dataclass
class Result:
    """The outcome of one pair: `passed`, `not met`, or `failed` without a proof."""

    pair: Pair
    verdict: str
    figures: list[dict[str, Any]] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


class Program:
    """The program, with the options of all runs, and the folder that results are collected in."""

    def __init__(self, path: str, options: list[str], results: Path) -> None:
        self.path = path
        self.options = options
        self.results = results

    def bake(self, pair: Pair) -> Result:
        """Bake a scan; asset and proof are also copied to the results."""
        asset = Path(pair.asset)
        asset.parent.mkdir(parents=True, exist_ok=True)
        result, report = self.run(pair, ["bake", argument(pair.scan), "-o", argument(pair.asset)])
        pages = [asset.with_suffix(f".report.{kind}") for kind in ("html", "json")]
        for name in report.get("files", []):
            written = asset.parent / name
            place = self.results / portable(written.as_posix())
            place.parent.mkdir(parents=True, exist_ok=True)
            # Proofs are results; the asset stays in the repository too.
            (shutil.move if written in pages else shutil.copy)(written, place)
        return result

    def verify(self, pair: Pair) -> Result:
        """Verify an asset; the proof is written to the results."""
        page = self.results / portable(f"{pair.asset}.html")
        page.parent.mkdir(parents=True, exist_ok=True)
        return self.run(pair, ["verify", argument(pair.asset), "--scan", argument(pair.scan), "-o", str(page)])[0]

    def run(self, pair: Pair, arguments: list[str]) -> tuple[Result, dict[str, Any]]:
        command = [self.path, *arguments, "--json", *self.options]
        with Quoted(shlex.join(arguments)), TemporaryFile() as out:
            # A file, since a pipe that nobody reads yet would block the program.
            try:
                running = subprocess.Popen(command, stdout=out, stderr=subprocess.PIPE)
            except OSError as error:
                raise Unusable(f"program: cannot run `{self.path}`: {error.strerror}") from None
            messages = shown(running)
            code = running.wait()
            out.seek(0)
            text = out.read()
        report = json.loads(text) if code in (0, 1) and text else {}
        # Other programs, such as an interpreter without the package, also end with 1.
        verdict = {0: "passed", 1: "not met"}.get(code, "failed") if report else "failed"
        errors = [line[len(ERROR):] for line in messages if line.startswith(ERROR)]
        warnings = [line[len(WARNING):] for line in messages if line.startswith(WARNING)]
        # Requirements that are not met come as warnings.
        unmet = [line for line in warnings if line.startswith("requirement")]
        errors += unmet
        if verdict == "failed" and not errors:
            errors = [f"{self.path} ended with exit code {code}"]
        # With --no-verify, the certificate is null.
        figures = (report.get("certificate") or {}).get("required", [])
        return Result(pair, verdict, figures, errors, [line for line in warnings if line not in unmet]), report


def shown(running: subprocess.Popen[bytes]) -> list[str]:
    """Pass the program's messages on to the log as they come, and return them."""
    messages = []
    for line in running.stderr or ():
        message = line.decode(errors="backslashreplace").rstrip()
        messages.append(message)
        print(message)
    return messages


def argument(path: str) -> str:
    """Return a path that is not taken for an option."""
    return f"./{path}" if path.startswith("-") else path


def portable(path: str) -> str:
    """Return a path without the characters that artifacts may not have in names."""
    return quote(path, safe="/ !#$&'()+,;=@[]{}~^`")
