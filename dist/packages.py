"""What the programs and wheels contain that others wrote: crates, and libraries within them."""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import place
import targets
import toolchain

SHIPPED = ("taotie-cli", "taotie-py")


@dataclass
class Package:
    """A crate or library, with the folder that has its licence files."""

    name: str
    version: str
    licence: str
    # Its package URL: https://github.com/package-url/purl-spec.
    url: str
    folder: Path | None = None
    authors: list[str] = field(default_factory=list)
    checksum: str = ""
    # Where its source is: some licences ask to say so.
    source: str = ""
    texts: list[str] = field(default_factory=list)
    needs: list[str] = field(default_factory=list)


def crates() -> list[Package]:
    """Return the crates of others that are linked into a release, on any target."""
    metadata = json.loads(toolchain.output(["cargo", "metadata", "--locked", "--format-version", "1"]))
    locked = tomllib.loads((place.ROOT / "Cargo.lock").read_text())["package"]
    checksums = {(entry["name"], entry["version"]): entry.get("checksum", "") for entry in locked}
    linked = {(entry["name"], entry["version"]): entry for entry in metadata["packages"]}
    shipped = {key: linked[key] for key in names() if linked[key]["source"]}
    urls = {entry["id"]: url_of(entry) for entry in shipped.values()}
    needs = {node["id"]: sorted(urls[each] for each in node["dependencies"] if each in urls) for node in metadata["resolve"]["nodes"]}
    return [
        Package(
            entry["name"], entry["version"], licence_of(entry), url_of(entry), Path(entry["manifest_path"]).parent,
            entry["authors"], checksums[key], entry["repository"] or "", needs=needs[entry["id"]],
        )
        for key, entry in sorted(shipped.items())
    ]


def url_of(entry: dict) -> str:
    return f"pkg:cargo/{entry['name']}@{entry['version']}"


def licence_of(entry: dict) -> str:
    """Return the licence as an SPDX expression: old crates have a slash for `OR`."""
    return re.sub(r"\s*/\s*", " OR ", entry["license"] or "")


def names() -> set[tuple[str, str]]:
    """Return names and versions of the crates that are linked, not those that only run while others are compiled."""
    found = set()
    for triple in sorted(targets.triples(targets.ALL) | {targets.WASM}):
        options = [part for name in SHIPPED for part in ("--package", name)]
        edges = ["--edges", "normal,no-proc-macro", "--prefix", "none", "--format", "{p}"]
        tree = toolchain.output(["cargo", "tree", "--locked", "--target", triple, *options, *toolchain.FEATURES, *edges])
        found |= {(line.split()[0], line.split()[1].removeprefix("v")) for line in tree.splitlines() if line.strip()}
    return found
