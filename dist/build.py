#!/usr/bin/env python3
"""Builds a release into target/dist: programs, wheels, the source of the Python package, the bill of materials.

    make dist                             # for this machine: the static program, its wheel, and the source
    make dist TARGETS="TRIPLE TRIPLE"     # for others
    make dist TARGETS=all                 # for all; targets that cannot be linked here are only checked
"""

from __future__ import annotations

import argparse
import os
import shutil
from pathlib import Path

import bill
import layout
import libraries
import licences
import packages
import place
import program
import smoke
import sums
import targets
import toolchain
import wheels
from targets import Target


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="a target triple, or all [default: that of this machine]")
    chosen = targets.chosen(parser.parse_args().targets)
    # Wheels record the permissions of files.
    os.umask(0o022)
    shutil.rmtree(place.OUTPUT, ignore_errors=True)
    place.OUTPUT.mkdir(parents=True)
    # The licences and manual pages come from a program that runs here.
    toolchain.add_targets(targets.triples(chosen) | {targets.host()})

    third_party = write_bill()
    wheels.source()
    programs = {target: program.build(target) for target in chosen if target.can_link}
    pack(programs, third_party)
    for target in chosen:
        if target.can_link:
            for wheel in target.wheels:
                wheels.build(wheel, third_party)
        else:
            program.check(target)
            print(f"make dist: checked {target.triple}, but did not build it: that needs macOS", flush=True)
    sums.write(place.OUTPUT)
    print((place.OUTPUT / sums.NAME).read_text(), end="")


def write_bill() -> bytes:
    """Write the bill of materials; return the page of licences."""
    crates = packages.crates()
    contained = crates + libraries.all_of(crates)
    page = licences.page(contained)
    (place.OUTPUT / f"taotie-{place.version()}.cdx.json").write_bytes(bill.written(contained))
    return page


def pack(programs: dict[Target, Path], third_party: bytes) -> None:
    """Write the archives, after a trial of the program that runs here."""
    here = next((target for target in programs if target.runs_here), None)
    runnable = programs[here] if here else program.build(targets.chosen([])[0])
    if here and here.is_static:
        smoke.check(runnable.read_bytes())
    files = layout.shared(third_party, runnable)
    for target, path in programs.items():
        layout.write(place.OUTPUT, target, path, files)


if __name__ == "__main__":
    main()
