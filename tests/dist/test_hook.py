"""The hook of pre-commit, run by pre-commit in a repository with assets."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

TRIANGLE = """{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
"materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]IMAGE}}], TEXTURES
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"buffers": [{"byteLength": 36, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"""
WHOLE = TRIANGLE.replace("IMAGE", "").replace("TEXTURES", "")
LACKS_A_FILE = TRIANGLE.replace("IMAGE", ', "baseColorTexture": {"index": 0}').replace(
    "TEXTURES", '"textures": [{"source": 0}], "images": [{"uri": "lost.png"}],')


class Checkout:
    """A repository with the hook, and a `PATH` with the program."""

    def __init__(self, folder: Path, program: Path | None) -> None:
        self.folder = folder / "repository"
        self.folder.mkdir()
        programs = folder / "programs"
        programs.mkdir()
        if program:
            (programs / "taotie").symlink_to(program)
        self.environment = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "PRE_COMMIT_HOME": str(folder / "cache"),
                            "GIT_AUTHOR_NAME": "T", "GIT_AUTHOR_EMAIL": "t@example.org", "GIT_COMMITTER_NAME": "T",
                            "GIT_COMMITTER_EMAIL": "t@example.org"}
        self.source = folder / "source"
        self.make_source()
        self.run("git", "init", "-q")

    def make_source(self) -> None:
        """Make the repository of the hook as it is now, committed or not."""
        for name in (".pre-commit-hooks.yaml", "dist/hook.py"):
            (self.source / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.source / name)
        for command in (["init", "-q"], ["add", "."], ["commit", "-qm", "Hook"], ["tag", "v1"]):
            subprocess.run(["git", *command], cwd=self.source, env=self.environment, check=True)

    def run(self, *command: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(command, cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False)

    def check(self, files: dict[str, str], *arguments: str) -> subprocess.CompletedProcess[str]:
        for name, content in files.items():
            (self.folder / name).write_text(content)
        listed = ", ".join(f'"{argument}"' for argument in arguments)
        (self.folder / ".pre-commit-config.yaml").write_text(
            f"repos:\n  - repo: file://{self.source}\n    rev: v1\n    hooks:\n      - {{ id: taotie-inspect, args: [{listed}] }}\n")
        self.run("git", "add", "--all")
        pre_commit = shutil.which("pre-commit", path=f"{Path(sys.executable).parent}:{os.environ['PATH']}")
        if not pre_commit:
            pytest.skip("pre-commit is not installed")
        return self.run(pre_commit, "run", "--verbose")


@pytest.fixture
def checkout(tmp_path: Path, program: Path) -> Checkout:
    return Checkout(tmp_path, program)


def test_whole_assets_pass(checkout: Checkout) -> None:
    done = checkout.check({"whole.gltf": WHOLE, "two words.gltf": WHOLE, "-o.gltf": WHOLE, "notes.txt": "not a model"})
    assert done.returncode == 0, done.stdout + done.stderr
    assert "no files to check" not in done.stdout
    assert "deprecat" not in done.stdout + done.stderr


def test_faults_are_named(checkout: Checkout) -> None:
    done = checkout.check({"broken.glb": "not a GLB", "lacking.gltf": LACKS_A_FILE, "whole.gltf": WHOLE})
    assert done.returncode == 1
    assert "lacking.gltf: 1× skipped image 0: the file 'lost.png' is missing" in done.stdout
    assert "broken.glb: " in done.stdout
    assert "whole.gltf" not in done.stdout


def test_an_audit_needs_its_schema_met(checkout: Checkout) -> None:
    schema = '{"version": "1.0.4", "model": {"triangles": {"maximum": LIMIT}}}'
    few = checkout.check({"whole.gltf": WHOLE, "schema.json": schema.replace("LIMIT", "0")}, "--audit", "schema.json")
    assert few.returncode == 1 and "whole.gltf: triangle-count: 1 (at most 0)" in few.stdout, few.stdout
    assert checkout.check({"schema.json": schema.replace("LIMIT", "1")}, "--audit", "schema.json").returncode == 0


def test_a_missing_program_is_named(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path, None)
    if shutil.which("taotie"):
        pytest.skip("the command is installed for everybody")
    done = checkout.check({"whole.gltf": WHOLE})
    assert done.returncode == 1 and "taotie was not found: install it and add its folder to PATH" in done.stdout
