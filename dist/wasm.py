#!/usr/bin/env python3
"""Builds the command for WebAssembly into target/wasm/taotie.wasm: WASI preview 1, one thread, SIMD128."""

from __future__ import annotations

from pathlib import Path

import libraries
import licences
import packages
import place
import toolchain
from targets import WASM

OUTPUT = place.ROOT / "target/wasm/taotie.wasm"
OPTIMISER = place.ROOT / "npm/taotie-wasm/node_modules/.bin/wasm-opt"
# What rustc's target and +simd128 permit; all engines that have SIMD have these.
FEATURES = ("bulk-memory", "multivalue", "mutable-globals", "nontrapping-float-to-int", "reference-types", "sign-ext", "simd")


def main() -> None:
    toolchain.add_targets({WASM})
    environment = toolchain.environment()
    environment["CARGO_ENCODED_RUSTFLAGS"] += "\x1f-Ctarget-feature=+simd128"
    toolchain.run([
        "cargo-zigbuild", "rustc", "--locked", "--profile", "wasm", "--package", "taotie-cli", "--bin", "taotie", "--no-default-features", "--target", WASM,
        "--", f"-Clink-arg={allocation()}",
    ], environment)
    OUTPUT.parent.mkdir(parents=True, exist_ok=True)
    shrink(place.BUILD / WASM / "wasm/taotie.wasm")
    crates = packages.crates()
    OUTPUT.with_name("THIRD-PARTY.html").write_bytes(licences.page(crates + libraries.all_of(crates)))
    print(f"{OUTPUT.relative_to(place.ROOT)}: {OUTPUT.stat().st_size:,} bytes")


def shrink(program: Path) -> None:
    """Optimise the program for size: minutes for a seventh of the download. No figure changes."""
    toolchain.run([OPTIMISER, "-Os", *(f"--enable-{feature}" for feature in FEATURES), program, "--output", OUTPUT])


def allocation() -> Path:
    """Compile C++'s allocation functions: all that the C++ libraries need of its standard library."""
    compiled = place.BUILD / "allocation.o"
    compiled.parent.mkdir(parents=True, exist_ok=True)
    source = Path(__file__).with_name("allocation.cpp")
    toolchain.run([toolchain.tool("python-zig"), "c++", "-target", "wasm32-wasi", "-O2", "-c", source, "-o", compiled])
    return compiled


if __name__ == "__main__":
    main()
