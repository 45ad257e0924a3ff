"""Workflows, action, templates and scripts: by their schemas and linters, and what no linter knows."""

from __future__ import annotations

import hashlib
import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import targets
from conftest import ROOT
from release import FILES

GITHUB = ROOT / ".github"
SCHEMAS = {
    "github-workflows": sorted(GITHUB.glob("workflows/*.yml")),
    "github-actions": [ROOT / "action.yml"],
    "github-issue-forms": sorted(set(GITHUB.glob("ISSUE_TEMPLATE/*.yml")) - {GITHUB / "ISSUE_TEMPLATE/config.yml"}),
    "github-issue-config": [GITHUB / "ISSUE_TEMPLATE/config.yml"],
    "dependabot": [GITHUB / "dependabot.yml"],
}
SCRIPTS = [*sorted((ROOT / "dist").glob("*.sh")), ROOT / ".ci/run"]


def run_module(module: str, *arguments: object) -> None:
    if not importlib.util.find_spec(module):
        pytest.skip(f"{module} is not installed")
    done = subprocess.run([sys.executable, "-m", module, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def program(name: str) -> str:
    found = shutil.which(name, path=str(Path(sys.executable).parent)) or shutil.which(name)
    if not found:
        pytest.skip(f"{name} is not installed")
    return found


@pytest.mark.parametrize("schema", SCHEMAS)
def test_files_match_their_schema(schema: str) -> None:
    assert SCHEMAS[schema]
    run_module("check_jsonschema", "--builtin-schema", f"vendor.{schema}", *SCHEMAS[schema])


def test_every_job_has_a_time_limit() -> None:
    run_module("check_jsonschema", "--builtin-schema", "custom.github-workflows-require-timeout", *SCHEMAS["github-workflows"])


def test_workflows_are_safe() -> None:
    done = subprocess.run([program("zizmor"), "--offline", "--quiet", "."], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_shell_scripts() -> None:
    done = subprocess.run([program("shellcheck"), *SCRIPTS], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_shell_of_workflows(tmp_path: Path) -> None:
    yaml = pytest.importorskip("yaml")
    steps = [step for path in SCHEMAS["github-workflows"] for job in yaml.safe_load(path.read_text())["jobs"].values() for step in job["steps"]]
    steps += yaml.safe_load((ROOT / "action.yml").read_text())["runs"]["steps"]
    scripts = [step["run"] for step in steps if "run" in step]
    assert len(scripts) > 12
    for number, script in enumerate(scripts):
        assert "${{" not in script, "values reach scripts through variables only"
        (tmp_path / f"{number}.sh").write_text(f"#!/bin/bash\nset -e\n{script}\n")
    subprocess.run([program("shellcheck"), *tmp_path.iterdir()], check=True)


def test_powershell_parses() -> None:
    tree_sitter, grammar = pytest.importorskip("tree_sitter"), pytest.importorskip("tree_sitter_powershell")
    parser = tree_sitter.Parser(tree_sitter.Language(grammar.language()))
    assert not parser.parse((ROOT / "dist/install.ps1").read_bytes()).root_node.has_error
    assert parser.parse(b"if (").root_node.has_error


def test_the_release_has_the_targets_that_others_expect() -> None:
    """The targets that the release builds are those of recipes, installers and images."""
    triple = re.compile(r"\b(?:x86_64|aarch64)-[a-z]+-[a-z]+(?:-[a-z]+)?\b")
    built = set(triple.findall((GITHUB / "workflows/release.yml").read_text()))
    for name in ("recipes/taotie.rb", "recipes/winget/Taotie.Taotie.installer.yaml"):
        assert set(triple.findall((ROOT / "dist" / name).read_text())) <= built
    assert built == {target.triple for target in targets.ALL}
    assert f"'{next(target for target in built if 'windows' in target)}'" in (ROOT / "dist/install.ps1").read_text()
    for pattern in ("-unknown-linux-musl", "-apple-darwin"):
        assert {target for target in built if target.endswith(pattern)} == {f"{processor}{pattern}" for processor in ("x86_64", "aarch64")}
        assert pattern in (ROOT / "dist/install.sh").read_text()


def test_the_image_copies_files_of_the_archive() -> None:
    copied = re.findall(r"/taotie-\*/(\S+)", (ROOT / "dist/Containerfile").read_text())
    assert set(copied) == {name for name in FILES if "/" not in name}


def test_built_files_are_merged(tmp_path: Path) -> None:
    def build(machine: str, files: dict[str, bytes]) -> None:
        folder = tmp_path / "built" / machine
        folder.mkdir(parents=True)
        for name, content in files.items():
            (folder / name).write_bytes(content)
        (folder / "SHA256SUMS").write_text("".join(f"{hashlib.sha256(content).hexdigest()}  {name}\n" for name, content in files.items()))
        (folder / "scratch").write_text("not part of the release")

    def merge() -> subprocess.CompletedProcess[str]:
        release = tmp_path / "release"
        shutil.rmtree(release, ignore_errors=True)
        return subprocess.run(["sh", ROOT / "dist/merge.sh", tmp_path / "built", release], capture_output=True, text=True, check=False)

    build("one", {"a.zip": b"a", "both.tgz": b"b"})
    build("two", {"both.tgz": b"b", "c.zip": b"c"})
    assert merge().returncode == 0
    assert {path.name for path in (tmp_path / "release").iterdir()} == {"a.zip", "both.tgz", "c.zip", "SHA256SUMS"}
    assert len((tmp_path / "release/SHA256SUMS").read_text().splitlines()) == 3
    build("three", {"both.tgz": b"other"})
    assert "built twice, with different bytes: both.tgz" in merge().stderr
    (tmp_path / "built/three/both.tgz").write_bytes(b"damaged")
    assert merge().returncode != 0
