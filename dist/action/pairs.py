"""Pairs of scan and asset in a git repository, and those that a pull request changes."""

from __future__ import annotations

import os
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

# The first line of a file whose content git-lfs has not fetched.
LFS = b"version https://git-lfs.github.com/spec/v1"
# Formats whose models name other files; those are in the model's folder or below it.
OF_SEVERAL_FILES = {".gltf", ".obj"}
# The base of the first push to a branch.
NO_COMMIT = re.compile("0+")


class Unusable(Exception):
    """An input or a repository that the action cannot work with."""


@dataclass(frozen=True)
class Pair:
    """A scan, and the asset made from it: paths from the root of the repository."""

    scan: str
    asset: str


def git(*arguments: str) -> str:
    """Return the output of a git command."""
    done = subprocess.run(["git", *arguments], capture_output=True, check=False)
    if done.returncode:
        raise Unusable(f"git {arguments[0]}: {done.stderr.decode(errors='replace').strip()}")
    return os.fsdecode(done.stdout)


def paths(*arguments: str) -> list[str]:
    """Return the paths that a git command prints with `-z`."""
    return [path for path in git(*arguments).split("\0") if path]


class Repository:
    """The scans of the checked-out repository, each with the place of its asset."""

    def __init__(self, patterns: list[str], template: str) -> None:
        if "{stem}" not in template:
            raise Unusable(f"asset: `{template}` gives all scans the same asset: include {{stem}}, such as {{dir}}/{{stem}}.glb")
        scans = paths("ls-files", "-z", "--", *(f":(glob){pattern}" for pattern in patterns))
        self.template = template
        # An asset may match the patterns too: only what is not the asset of another scan is a scan.
        assets = {asset_of(scan, template) for scan in scans if asset_of(scan, template) != scan}
        self.pairs = [Pair(scan, asset_of(scan, template)) for scan in scans if scan not in assets]
        for pair in self.pairs:
            if pair.asset == pair.scan:
                raise Unusable(f"asset: `{template}` is the scan itself for {pair.scan}")
        by_asset: dict[str, str] = {}
        for pair in self.pairs:
            other = by_asset.setdefault(pair.asset, pair.scan)
            if other != pair.scan:
                raise Unusable(f"asset: {other} and {pair.scan} have the same asset {pair.asset}: include {{dir}}")

    def of_changed_scans(self, changed: set[str] | None) -> list[Pair]:
        """Return the pairs whose scan changed; all if `changed` is `None`."""
        return [pair for pair in self.pairs if self.has_changed(pair.scan, changed)]

    def of_changed(self, changed: set[str] | None) -> list[Pair]:
        """Return the pairs of which either file changed."""
        return [pair for pair in self.pairs if any(self.has_changed(path, changed) for path in (pair.scan, pair.asset))]

    def has_changed(self, model: str, changed: set[str] | None) -> bool:
        """Return whether a model changed, or, if it may name other files, any other in its folder."""
        if changed is None or model in changed:
            return True
        if PurePosixPath(model).suffix.lower() not in OF_SEVERAL_FILES:
            return False
        folder = PurePosixPath(model).parent
        others = changed - {path for pair in self.pairs for path in (pair.scan, pair.asset)}
        return any(folder in PurePosixPath(path).parents for path in others)

    def without_scan(self, changed: set[str] | None) -> list[str]:
        """Return the changed files that are where assets are, but are the asset of no scan."""
        pattern = re.escape(self.template).replace(r"\{dir\}", ".*").replace(r"\{stem\}", "[^/]*")
        known = {path for pair in self.pairs for path in (pair.scan, pair.asset)}
        return sorted(path for path in (changed or set()) - known if re.fullmatch(pattern, path, re.DOTALL))


def asset_of(scan: str, template: str) -> str:
    """Return the path of a scan's asset."""
    path = PurePosixPath(scan)
    parts = {"{dir}": str(path.parent), "{stem}": path.stem}
    return str(PurePosixPath(re.sub(r"\{dir\}|\{stem\}", lambda found: parts[found[0]], template)))


def changed_files(base: str) -> set[str] | None:
    """Return the files that the checked-out commit changes since it left `base`; `None`, that is all, without a base."""
    if not base or NO_COMMIT.fullmatch(base):
        return None
    if not is_here(base):
        git("fetch", "--quiet", "--no-tags", "--depth=1", "origin", base)
    # A shallow repository does not have the commit they have in common; then the base's later changes count too.
    common = subprocess.run(["git", "merge-base", base, "HEAD"], capture_output=True, text=True, check=False)
    since = common.stdout.strip() if common.returncode == 0 else base
    return set(paths("diff", "--name-only", "-z", "--no-renames", "--diff-filter=d", since, "HEAD"))


def is_here(commit: str) -> bool:
    name = f"{commit}^{{commit}}"
    return subprocess.run(["git", "rev-parse", "--quiet", "--verify", name], capture_output=True, check=False).returncode == 0


def is_pointer(path: str) -> bool:
    """Return whether git-lfs has not fetched a file."""
    with Path(path).open("rb") as file:
        return file.read(len(LFS)) == LFS
