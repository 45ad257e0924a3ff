"""The Python package: wheels, and the source that pip builds."""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from pathlib import Path

import place
import toolchain
from targets import MANYLINUX, MUSLLINUX, Wheel

# The newest C library that a wheel of each platform may need.
NEWEST = {MANYLINUX: ("manylinux", 2, 17), MUSLLINUX: ("musllinux", 1, 2)}


def build(wheel: Wheel, third_party: bytes) -> None:
    """Build a wheel with the licences of what it contains, and check it."""
    with tempfile.TemporaryDirectory() as folder:
        platform = ["--compatibility", wheel.platform] if wheel.platform else []
        linker = [] if "apple" in wheel.triple else ["--zig"]
        options = ["--locked", "--profile", "dist", "--target", wheel.triple, "--out", folder, *platform, *linker]
        toolchain.run([toolchain.tool("maturin"), "build", *options], toolchain.environment())
        (built,) = Path(folder).glob("*.whl")
        finished = with_licences(built, third_party)
    if wheel.platform:
        audit(finished, NEWEST[wheel.platform])


def with_licences(built: Path, third_party: bytes) -> Path:
    """Add the licences to a wheel, and give all its entries one date."""
    with tempfile.TemporaryDirectory() as folder:
        environment = toolchain.environment()
        toolchain.run([sys.executable, "-m", "wheel", "unpack", "--dest", folder, str(built)], environment)
        (unpacked,) = Path(folder).iterdir()
        (information,) = unpacked.glob("*.dist-info")
        (information / "licenses/THIRD-PARTY.html").write_bytes(third_party)
        facts = information / "METADATA"
        first = "License-File: LICENSE-MIT\n"
        text = facts.read_text(encoding="utf-8")
        if first not in text:
            raise SystemExit(f"make dist: {built.name}: METADATA lacks `{first.strip()}`: correct dist/wheels.py")
        facts.write_text(text.replace(first, f"{first}License-File: THIRD-PARTY.html\n", 1), encoding="utf-8", newline="\n")
        # The tool sorts the platforms in the name.
        toolchain.run([sys.executable, "-m", "wheel", "pack", "--dest-dir", folder, str(unpacked)], environment)
        (packed,) = Path(folder).glob("*.whl")
        return Path(shutil.move(packed, place.OUTPUT / packed.name))


def audit(wheel: Path, newest: tuple[str, int, int]) -> None:
    """Check with auditwheel that a wheel for Linux needs no newer C library than its name states."""
    report = toolchain.output([toolchain.tool("auditwheel"), "show", wheel])
    print(report, flush=True)
    if not fits(report, newest):
        raise SystemExit(f"make dist: {wheel.name}: auditwheel finds that it needs more than its name states, see above")


def fits(report: str, newest: tuple[str, int, int]) -> bool:
    """Return whether the platform in a report of auditwheel is a given one, or an older one of its kind."""
    found = re.search(r'platform\s+tag:\s+"(\w+linux)_(\d+)_(\d+)_', report)
    return found is not None and found[1] == newest[0] and (int(found[2]), int(found[3])) <= newest[1:]


def source() -> Path:
    """Write the source distribution."""
    with tempfile.TemporaryDirectory() as folder:
        toolchain.run([toolchain.tool("maturin"), "sdist", "--out", folder], toolchain.environment())
        (built,) = Path(folder).glob("*.tar.gz")
        return Path(shutil.move(built, place.OUTPUT / built.name))
