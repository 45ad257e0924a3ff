"""The package as a whole: every public name, its documentation, the command."""

from __future__ import annotations

import inspect
import subprocess
import sys
from importlib import metadata

import numpy as np
import pytest

import taotie as tt

# `make test-slow` runs these tests without an installation.
INSTALLED = any(d.metadata["Name"] == "taotie" for d in metadata.distributions())
needs_installation = pytest.mark.skipif(not INSTALLED, reason="the package is not installed: make python")


def test_every_public_name_exists_and_is_documented() -> None:
    for module in (tt, tt.shade, tt.normals):
        for name in module.__all__:
            thing = getattr(module, name)
            if not isinstance(thing, (str, tuple)) and not inspect.ismodule(thing):
                assert inspect.getdoc(thing), name


@needs_installation
def test_the_installation_reports_its_version() -> None:
    assert tt.__version__ == metadata.version("taotie")
    assert [line.split(">")[0] for line in metadata.requires("taotie") or []] == ["numpy"]
    points = [e for e in metadata.entry_points(group="console_scripts") if e.name == "taotie"]
    assert points and points[0].value == "taotie._command:main"


def test_it_imports_no_other_package() -> None:
    code = "import sys, taotie; print(*sorted({m.split('.')[0] for m in sys.modules} & {'tqdm', 'PIL', 'trimesh'}))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert loaded.stdout.strip() == ""


def test_the_command_is_the_same_program() -> None:
    shown = subprocess.run([sys.executable, "-m", "taotie", "--version"], capture_output=True, text=True, check=True)
    assert shown.stdout.split() == ["taotie", tt.__version__]
    wrong = subprocess.run([sys.executable, "-m", "taotie", "render", "nowhere.glb", "-o", "x.png"], capture_output=True)
    assert wrong.returncode == 2 and b"nowhere.glb" in wrong.stderr


def test_errors_carry_file_place_and_remedy(tmp_path: object) -> None:
    with pytest.raises(tt.Error) as raised:
        tt.load("nowhere.glb")
    assert raised.value.kind == "io" and raised.value.path == "nowhere.glb"
    with pytest.raises(tt.Error, match="triangles") as raised:
        tt.bake(tt.Mesh(np.eye(3), [[0, 1, 2]]), triangles=3)
    assert raised.value.kind == "invalid" and raised.value.where == "3 triangles" and raised.value.remedy
