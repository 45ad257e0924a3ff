"""The notebooks, the page docs/python.md and the examples of docstrings run."""

from __future__ import annotations

import doctest
import importlib.util
import inspect
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import taotie as tt

from conftest import relief, sphere

NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))
PAGE = Path(__file__).parents[2] / "docs" / "python.md"
TUTORIAL = PAGE.parent / "tutorials" / "python.md"
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE | doctest.IGNORE_EXCEPTION_DETAIL


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::UserWarning")
def test_it_runs(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    cells = [cell for cell in json.loads(path.read_text())["cells"] if cell["cell_type"] == "code"]
    names: dict[str, object] = {"__name__": "__main__"}
    for number, cell in enumerate(cells):
        exec(compile("".join(cell["source"]), f"{path.name}, cell {number}", "exec"), names)


def test_there_are_notebooks() -> None:
    assert len(NOTEBOOKS) == 5


def hdr(path: Path) -> None:
    """Write a small grey room as Radiance HDR."""
    path.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + bytes([128, 128, 128, 128]) * 32)


def test_the_page_runs_from_top_to_bottom(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scan = tt.Mesh(*sphere(64, 32, relief=0.02))
    low = tt.bake(scan, triangles=300, size=64)
    for name in ("scan", "vase", "high"):
        write_ply(Path(f"{name}.ply"), scan)
    low.save("low.glb")
    low.save("vase.glb")
    hdr(Path("room.hdr"))
    text = PAGE.read_text(encoding="utf-8")
    names: dict[str, Any] = {"__name__": "__main__"}
    run, left_out = 0, []
    for block in re.finditer(r"(?:<!-- needs (.+?) -->\n)?```python\n(.*?)```", text, re.S):
        needed, code = block.groups()
        if needed is not None and not all(present(package) for package in needed.split(" and ")):
            left_out.append(needed)
            continue
        line = text[: block.start(2)].count("\n")
        exec(compile("\n" * line + code, str(PAGE), "exec"), names)
        run += 1
    always = len(re.findall(r"(?<!-->\n)```python", text))
    assert run >= always and set(left_out) <= {"anywidget", "pyrender", "trimesh", "trimesh and pyglet", "mitsuba", "bpy"}
    assert Path("scene.glb").exists() and Path("scan.jpg").read_bytes()[:2] == b"\xff\xd8"


def test_the_tutorial_prints_what_it_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```pycon\n(.*?)```", TUTORIAL.read_text(encoding="utf-8"), re.S)
    found = doctest.DocTestParser().get_doctest("\n".join(blocks), {}, TUTORIAL.name, None, 0)
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS, verbose=False)
    out: list[str] = []
    runner.run(found, out=out.append)
    assert len(found.examples) > 15 and runner.summarize(verbose=False).failed == 0, "".join(out)
    assert Path("ring.glb").exists() and Path("ring.html").exists()


def present(package: str) -> bool:
    """Return true for a package whose code is run; programs of others are only shown."""
    return package in ("anywidget", "trimesh") and importlib.util.find_spec(package) is not None


def write_ply(path: Path, mesh: tt.Model) -> None:
    """Write a mesh as PLY."""
    arrays = mesh.arrays()
    lines = ["ply", "format ascii 1.0", f"element vertex {len(arrays['vertices'])}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"element face {len(arrays['faces'])}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(str, row)) for row in arrays["vertices"].tolist()]
    lines += [" ".join(map(str, [3, *row])) for row in arrays["faces"].tolist()]
    path.write_text("\n".join(lines) + "\n")


def public() -> dict[str, Any]:
    """Return every public class, function and method by its name."""
    found: dict[str, Any] = {}
    for module in (tt, tt.shade, tt.normals):
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isfunction(thing):
                found[f"{module.__name__}.{name}"] = thing
            elif inspect.isclass(thing) and not issubclass(thing, (BaseException, Warning)):
                found[f"{module.__name__}.{name}"] = thing
                for method, function in vars(thing).items():
                    if inspect.isfunction(function) and not method.startswith("_"):
                        found[f"{module.__name__}.{name}.{method}"] = function
    return found


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The names that examples use, and the files."""
    folder = tmp_path_factory.mktemp("examples")
    ball = tt.Mesh(*sphere(40, 20, relief=0.02))
    write_ply(folder / "scan.ply", ball)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        scan = tt.load("scan.ply")
        asset = tt.bake(scan, triangles=300, size=64)
        proof = asset.verify(scan, points=1000, view=64)
    photographs, directions, truth = relief()
    photographed = {"photographs": photographs, "directions": directions, "truth": truth}
    baked = {"scan": scan, "asset": asset, "proof": proof, "folder": folder}
    return {"tt": tt, "np": np, "json": json, **baked, **photographed}


@pytest.mark.parametrize("name", public())
def test_examples_of_docstrings_run(name: str, examples: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(examples["folder"])
    text = inspect.getdoc(public()[name]) or ""
    found = doctest.DocTestParser().get_doctest(text, dict(examples), name, None, 0)
    assert found.examples, f"{name} has no example"
    runner = doctest.DocTestRunner(optionflags=FLAGS, verbose=False)
    out: list[str] = []
    runner.run(found, out=out.append)
    assert runner.summarize(verbose=False).failed == 0, "".join(out)
