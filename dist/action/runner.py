"""The runner's side of an action: inputs, annotations, outputs and the summary."""

from __future__ import annotations

import os
import secrets
import sys
from pathlib import Path


def prepare() -> None:
    """Let every file name be printed, and line feeds as they are, on every system."""
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(encoding="utf-8", errors="backslashreplace", newline="\n", line_buffering=True)


def asked(name: str) -> str:
    """Return an input of the action; `action.yml` passes each as an environment variable."""
    return os.environ.get(f"INPUT_{name.upper().replace('-', '_')}", "").strip()


def annotate(level: str, message: str, **properties: str) -> None:
    """Print an annotation: `level` is `error`, `warning` or `notice`, properties are `file` and `title`."""
    listed = ",".join(f"{name}={escaped(value, ':,')}" for name, value in properties.items())
    print(f"::{level} {listed}::{escaped(message)}")


def escaped(text: str, also: str = "") -> str:
    """Return text that the runner reads back as it is; in properties, `:` and `,` are special too."""
    for character in "%\r\n" + also:
        text = text.replace(character, f"%{ord(character):02X}")
    return text


class Quoted:
    """Text by others, in which the runner obeys no commands; folded into a group of the log."""

    def __init__(self, title: str) -> None:
        self.title = title
        self.token = secrets.token_hex(16)

    def __enter__(self) -> None:
        print(f"::group::{escaped(self.title)}")
        print(f"::stop-commands::{self.token}")

    def __exit__(self, *_: object) -> None:
        print(f"::{self.token}::")
        print("::endgroup::")


def output(name: str, value: str) -> None:
    """Set an output of the step."""
    mark = secrets.token_hex(16)
    append("GITHUB_OUTPUT", f"{name}<<{mark}\n{value}\n{mark}\n")


def summarise(text: str) -> None:
    """Add Markdown to the page of the job."""
    append("GITHUB_STEP_SUMMARY", text)


def append(variable: str, text: str) -> None:
    path = os.environ.get(variable)
    if path:
        with Path(path).open("a", encoding="utf-8", errors="backslashreplace", newline="\n") as file:
            file.write(text)
