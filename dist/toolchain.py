"""Cargo and the compilers, without any path of this machine in what they write."""

from __future__ import annotations

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import place

# The features of released programs, in addition to the default ones.
FEATURES = ["--features", "taotie-cli/mcp"]


def run(command: list[str | Path], environment: dict[str, str] | None = None) -> None:
    """Run a command in the repository and show its output; end with a message if it fails."""
    print("+", *command, flush=True)
    code = subprocess.run(command, cwd=place.ROOT, env=environment, check=False).returncode
    if code != 0:
        raise SystemExit(f"make dist: `{command[0]}` failed with exit code {code}: see its messages above")


def output(command: list[str | Path]) -> str:
    """Return what a command in the repository prints."""
    return subprocess.run(command, cwd=place.ROOT, stdout=subprocess.PIPE, text=True, encoding="utf-8", check=True).stdout


def tool(name: str) -> Path:
    """Return the path of a tool that pip installed."""
    return Path(sys.executable).parent / name


def add_targets(triples: set[str]) -> None:
    """Install the standard library of Rust for targets, if rustup is there to do it."""
    missing = [triple for triple in sorted(triples) if not (standard_library() / triple / "lib").is_dir()]
    if missing:
        run(["rustup", "target", "add", *missing])


def standard_library() -> Path:
    return sysroot() / "lib/rustlib"


def sysroot() -> Path:
    return Path(output(["rustc", "--print", "sysroot"]).strip())


def environment() -> dict[str, str]:
    """Return the environment of reproducible builds: paths are replaced by names, in Rust, C and C++."""
    flags = [f"--remap-path-prefix={path}={name}" for path, name in renamed().items()]
    # For the macro __FILE__. There is C and C++ only in crates.
    maps = " ".join(f"-ffile-prefix-map={path}={name}" for path, name in renamed().items() if path in (cargo_home(), place.BUILD))
    settings = tomllib.loads((place.ROOT / ".cargo/config.toml").read_text())["env"]
    compilers = {name: f"{settings[name]} {maps}" for name in ("CFLAGS", "CXXFLAGS")}
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    return {
        **os.environ, **compilers, "PATH": path, "CARGO_INCREMENTAL": "0", "CARGO_TARGET_DIR": str(place.BUILD),
        "CARGO_ENCODED_RUSTFLAGS": "\x1f".join(flags), "SOURCE_DATE_EPOCH": str(place.epoch()),
    }


def renamed() -> dict[Path, str]:
    """Return the names that replace paths. The last one that matches counts, so that folders follow those around them."""
    commit = next(line.split()[1] for line in output(["rustc", "-vV"]).splitlines() if line.startswith("commit-hash"))
    ours = {place.BUILD: "/taotie/target", place.ROOT: "/taotie"}
    outer_first = sorted(ours.items(), key=lambda pair: len(pair[0].parts))
    return {standard_library() / "src/rust": f"/rustc/{commit}", cargo_home(): "/cargo", **dict(outer_first)}


def cargo_home() -> Path:
    return Path(os.environ.get("CARGO_HOME", Path.home() / ".cargo")).resolve()
