"""The targets of a release, and what is built for each."""

from __future__ import annotations

import platform
import sys
from dataclasses import dataclass

MANYLINUX = "manylinux2014"
MUSLLINUX = "musllinux_1_2"
# The command for browsers and Node: `make wasm`.
WASM = "wasm32-wasip1"


@dataclass(frozen=True)
class Wheel:
    """A wheel: the target of its native half, and the platform of its name (that of the target if empty)."""

    triple: str
    platform: str = ""


@dataclass(frozen=True)
class Target:
    """A target of programs, and the wheels of its system and processor."""

    triple: str
    wheels: tuple[Wheel, ...]

    @property
    def is_static(self) -> bool:
        """Return whether the program is static: then it cannot load graphics drivers."""
        return self.triple.endswith("-musl")

    @property
    def is_windows(self) -> bool:
        return "windows" in self.triple

    @property
    def is_apple(self) -> bool:
        return "apple" in self.triple

    @property
    def program(self) -> str:
        return "taotie.exe" if self.is_windows else "taotie"

    @property
    def can_link(self) -> bool:
        """Return whether programs can be linked here: those for macOS need the frameworks of Apple's SDK."""
        return not self.is_apple or sys.platform == "darwin"

    @property
    def runs_here(self) -> bool:
        return self.triple == host()


def linux(processor: str) -> Target:
    wheels = (Wheel(f"{processor}-unknown-linux-gnu", MANYLINUX), Wheel(f"{processor}-unknown-linux-musl", MUSLLINUX))
    return Target(f"{processor}-unknown-linux-musl", wheels)


def other(triple: str) -> Target:
    return Target(triple, (Wheel(triple),))


ALL = (linux("x86_64"), linux("aarch64"), other("x86_64-apple-darwin"), other("aarch64-apple-darwin"),
       other("x86_64-pc-windows-gnu"))


def host() -> str:
    """Return the triple of programs for this machine."""
    processor = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())
    system = {"linux": "unknown-linux-musl", "darwin": "apple-darwin", "win32": "pc-windows-gnu"}
    return f"{processor}-{system.get(sys.platform, sys.platform)}"


def triples(chosen: list[Target] | tuple[Target, ...]) -> set[str]:
    """Return the triples of programs and wheels."""
    return {target.triple for target in chosen} | {wheel.triple for target in chosen for wheel in target.wheels}


def chosen(names: list[str]) -> list[Target]:
    """Return the named targets; without names that of this machine, with only the first of its wheels."""
    if names == ["all"]:
        return list(ALL)
    known = {target.triple: target for target in ALL}
    unknown = [name for name in names or [host()] if name not in known]
    if unknown:
        raise SystemExit(f"make dist: unknown target `{unknown[0]}`; expected all, or some of: {' '.join(known)}")
    if not names:
        target = known[host()]
        return [Target(target.triple, target.wheels[:1])]
    return [known[name] for name in names]
