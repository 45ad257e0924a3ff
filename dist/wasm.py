#!/usr/bin/env python3
"""Builds the command for WebAssembly into target/wasm/taotie.wasm: WASI preview 1, one thread, SIMD128."""

from __future__ import annotations

import shutil
from pathlib import Path

import libraries
import licences
import packages
import place
import toolchain
from targets import WASM

OUTPUT = place.ROOT / "target/wasm/taotie.wasm"


def main() -> None:
    toolchain.add_targets({WASM})
    environment = toolchain.environment()
    environment["CARGO_ENCODED_RUSTFLAGS"] += "\x1f-Ctarget-feature=+simd128"
    toolchain.run([
        "cargo-zigbuild", "rustc", "--locked", "--profile", "dist", "--config", "profile.dist.lto=\"fat\"", "--config", "profile.dist.codegen-units=1",
        "--package", "taotie-cli", "--bin", "taotie", "--no-default-features", "--target", WASM,
        "--", f"-Clink-arg={allocation()}",
    ], environment)
    OUTPUT.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(place.BUILD / WASM / "dist/taotie.wasm", OUTPUT)
    crates = packages.crates()
    OUTPUT.with_name("THIRD-PARTY.html").write_bytes(licences.page(crates + libraries.all_of(crates)))
    print(f"{OUTPUT.relative_to(place.ROOT)}: {OUTPUT.stat().st_size:,} bytes")


def allocation() -> Path:
    """Compile C++'s allocation functions: all that the C++ libraries need of its standard library."""
    compiled = place.BUILD / "allocation.o"
    compiled.parent.mkdir(parents=True, exist_ok=True)
    source = Path(__file__).with_name("allocation.cpp")
    toolchain.run([toolchain.tool("python-zig"), "c++", "-target", "wasm32-wasi", "-O2", "-c", source, "-o", compiled])
    return compiled


if __name__ == "__main__":
    main()
