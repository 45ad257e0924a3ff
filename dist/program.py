"""The program of a target."""

from __future__ import annotations

from pathlib import Path

import place
import toolchain
from targets import Target


def build(target: Target) -> Path:
    """Build the program; return its path."""
    command = ["cargo", "build"] if target.is_apple else ["cargo-zigbuild", "zigbuild"]
    toolchain.run([*command, *options(target)], toolchain.environment())
    return place.BUILD / target.triple / "dist" / target.program


def check(target: Target) -> None:
    """Compile everything but code: a target that cannot be linked here."""
    toolchain.run(["cargo-zigbuild", "check", *options(target)], toolchain.environment())


def options(target: Target) -> list[str | Path]:
    features = ["--no-default-features"] if target.is_static else []
    return ["--locked", "--profile", "dist", "--package", "taotie-cli", *features, *toolchain.FEATURES, "--target", target.triple]
