"""The package as a whole: every public name, its documentation, the command."""

from __future__ import annotations

import errno
import inspect
import multiprocessing
import os
import pickle
import subprocess
import sys
import warnings
from collections.abc import Callable
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

import taotie as tt

from conftest import sphere

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


def test_errors_carry_file_place_and_remedy(tmp_path: Path) -> None:
    with pytest.raises(tt.Error) as raised:
        tt.load("nowhere.glb")
    assert raised.value.kind == "io" and raised.value.path == "nowhere.glb"
    with pytest.raises(tt.Error, match="triangles") as raised:
        tt.bake(tt.Mesh(np.eye(3), [[0, 1, 2]]), triangles=3)
    assert raised.value.kind == "invalid" and raised.value.where == "3 triangles" and raised.value.remedy
    (tmp_path / "broken.glb").write_bytes(b"glTF")
    with pytest.raises(tt.FileError) as raised:
        tt.load(tmp_path / "broken.glb")
    assert raised.value.kind == "parse" and not isinstance(raised.value, FileNotFoundError)


def test_errors_about_files_are_those_of_python() -> None:
    with pytest.raises(FileNotFoundError, match="nowhere.glb") as raised:
        tt.load("nowhere.glb")
    error = raised.value
    assert isinstance(error, tt.MissingFile) and error.errno == errno.ENOENT and error.filename == "nowhere.glb"
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) and again.errno == error.errno and again.path == error.path
    assert not str(error).startswith("[Errno")


BALL = tt.Mesh(*sphere(8, 4))


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda: tt.render(BALL, size=8, shading="gxx"), ValueError, "shading.*gxx.*expected one of.*lambert.*ggx"),
        (lambda: tt.render(BALL, size=8, tone="warm"), ValueError, "tone.*warm.*neutral"),
        (lambda: tt.render(BALL, size=8, samples="many"), TypeError, "samples.*many"),
        (lambda: tt.render(BALL, size=8, camera=(30, 15)), TypeError, r"camera \(30, 15\).*Orbit"),
        (lambda: tt.render(BALL, size="big"), TypeError, "size.*big"),
        (lambda: tt.render(BALL, size=-8), ValueError, "size.*-8"),
        (lambda: tt.render(BALL, size=8, fov_deg=float("nan")), ValueError, "fov_deg"),
        (lambda: tt.render(BALL, size=8, exposure=float("inf")), ValueError, "exposure"),
        (lambda: tt.render(BALL, size=8, light=3), TypeError, "light"),
        (lambda: tt.render(BALL, size=8, threads=0), ValueError, "threads 0: .*1"),
        (lambda: tt.render(BALL, size=8, threads=1.5), TypeError, "threads 1.5: of type float; expected an integer"),
        (lambda: tt.render(BALL, size=8, progress="yes"), TypeError, "progress 'yes': of type str"),
        (lambda: tt.bake(BALL, triangles=-5), ValueError, "triangles.*-5.*0 or more"),
        (lambda: tt.bake(BALL, triangles=100, size=64, space="tangents"), ValueError, "space.*tangents.*object"),
        (lambda: tt.load(5), TypeError, "path 5: of type int; expected str or a path"),
        (lambda: tt.load("x.glb", unit="km"), ValueError, "unit 'km'.*mm, cm, m, in"),
        (lambda: tt.normals.from_height(np.full((4, 4), np.nan), scale=1), ValueError, "heights.*finite"),
        (lambda: tt.normals.from_height(np.zeros((4, 4)), scale=1, border="wrap"), ValueError, "border 'wrap'.*repeat"),
        (lambda: tt.normals.convert(np.zeros((4, 4), bool)), TypeError, "map.*bool.*uint8"),
        (lambda: tt.shade.d_ggx("high", 0.5), TypeError, "n_dot_h 'high'.*float"),
    ],
)
def test_errors_name_the_argument_and_what_is_accepted(call: Callable[[], object], kind: type, words: str) -> None:
    with pytest.raises(kind, match=words) as raised:
        call()
    assert isinstance(raised.value, tt.Error)


def test_numbers_of_numpy_are_numbers() -> None:
    expected = tt.render(BALL, size=24, samples=4, fov_deg=30.0, exposure=0.5)
    numbers = {"samples": np.int64(4), "fov_deg": np.float32(30), "exposure": np.float64(0.5), "shadows": np.bool_(False)}
    for size in (np.int64(24), np.uint8(24), (np.int32(24), np.int16(24)), np.array([24, 24])):
        assert np.array_equal(tt.render(BALL, size=size, **numbers), expected)  # type: ignore[call-overload]


#: What forked children inherit.
SHARED: dict[str, tt.Asset] = {}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_it_works_in_a_forked_child(scan_file: Path) -> None:
    expected = tt.render(BALL, size=32)
    SHARED["asset"] = tt.bake(tt.load(scan_file), triangles=100, size=32)
    with warnings.catch_warnings():
        # Python warns of threads that the child lacks.
        warnings.simplefilter("ignore")
        with multiprocessing.get_context("fork").Pool(2) as pool:
            images = [pool.apply_async(_rendered, (size,)) for size in (32, 33, 32)]
            found = [image.get(timeout=60) for image in images]
    assert np.array_equal(found[0], expected) and np.array_equal(found[2], expected)
    assert np.array_equal(tt.render(BALL, size=32), expected)


def _rendered(size: int) -> np.ndarray:
    assert np.isfinite(BALL.bounds).all() and BALL.glb() and tt.shade.d_ggx(0.9, np.full(1000, 0.5)).shape == (1000,)
    assert SHARED["asset"].glb()
    return np.asarray(tt.render(BALL, size=size))
