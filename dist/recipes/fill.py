#!/usr/bin/env python3
"""Fills the recipes for conda, Homebrew and winget with the version and checksums of a release.

    python dist/recipes/fill.py release/SHA256SUMS recipes
"""

from __future__ import annotations

import argparse
import re
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
RECIPES = ["recipe.yaml", "taotie.rb", "winget/Taotie.Taotie.yaml", "winget/Taotie.Taotie.installer.yaml",
           "winget/Taotie.Taotie.locale.en-US.yaml"]
# The longest description that Homebrew accepts.
SHORT = 80


class Release:
    """The facts that recipes state, each from the file that declares it."""

    def __init__(self, sums: Path) -> None:
        self.sums = sums
        self.package = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]
        self.python = tomllib.loads((ROOT / "pyproject.toml").read_text())
        pairs = (line.split(maxsplit=1) for line in sums.read_text().splitlines() if line)
        self.checksums = {name.lstrip("*"): checksum for checksum, name in pairs}

    def value(self, name: str) -> str:
        """Return the value of `@NAME@` or `@NAME TARGET@` in a recipe."""
        key, _, target = name.partition(" ")
        if target in ("", "SUMMARY", "REQUIREMENT"):
            return self.facts()[name]()
        archive = self.sdist() if target == "SDIST" else self.archive(target)
        return {"SHA256": self.checksums[archive], "ARCHIVE": archive, "FOLDER": re.sub(r"\.(zip|tar\.gz)$", "", archive)}[key]

    def facts(self) -> dict[str, Callable[[], str]]:
        version, repository = self.package["version"], self.package["repository"]
        project = self.python["project"]
        return {
            "VERSION": lambda: version,
            "REPOSITORY": lambda: repository,
            "DOWNLOADS": lambda: f"{repository}/releases/download/v{version}",
            "LICENSE": lambda: self.package["license"],
            "PUBLISHER": lambda: self.package["authors"][0],
            "SUMMARY": lambda: project["description"],
            "SHORT SUMMARY": lambda: shortened(project["description"]),
            "TAGS": lambda: "\n".join(f"  - {word.lower().replace(' ', '-')}" for word in project["keywords"]),
            "BUILD REQUIREMENT": lambda: conda(self.python["build-system"]["requires"][0]),
            "RUN REQUIREMENT": lambda: conda(project["dependencies"][0]),
            "SDIST": self.sdist,
        }

    def sdist(self) -> str:
        return self.listed(f"taotie-{self.package['version']}.tar.gz")

    def archive(self, target: str) -> str:
        kind = "zip" if "windows" in target else "tar.gz"
        return self.listed(f"taotie-{self.package['version']}-{target}.{kind}")

    def listed(self, name: str) -> str:
        if name not in self.checksums:
            raise SystemExit(f"{self.sums}: does not list {name}: merge the builds of all targets with dist/merge.sh")
        return name


def shortened(text: str) -> str:
    """Return a description in the style of Homebrew: its first words, without a full stop."""
    text = text.rstrip(".")
    while len(text) > SHORT:
        text = text[: text.rindex(",")]
    return text


def conda(requirement: str) -> str:
    """Return a Python requirement as conda writes it, with a space before its versions."""
    return re.sub(r"^([\w.-]+)", r"\1 ", requirement)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sums", type=Path, help="the list of checksums")
    parser.add_argument("output", type=Path, help="the folder to write")
    asked = parser.parse_args()
    release = Release(asked.sums)
    for name in RECIPES:
        filled = re.sub(r"@([A-Z0-9]+(?: [\w-]+)?)@", lambda found: release.value(found[1]), (HERE / name).read_text())
        path = asked.output / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(filled)


if __name__ == "__main__":
    sys.exit(main())
