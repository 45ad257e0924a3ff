"""Models: files and arrays."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import taotie as tt

from conftest import sphere


def test_arrays_go_in_and_come_out_the_same() -> None:
    vertices, faces = sphere(16, 8)
    uvs = np.random.default_rng(1).random((len(vertices), 2), dtype=np.float32)
    colors = np.full((len(vertices), 3), 0.25)
    mesh = tt.Mesh(vertices.astype(np.float32), faces.astype(np.uint32), normals=vertices, uvs=uvs, colors=colors)
    arrays = mesh.arrays()
    assert np.array_equal(arrays["vertices"], vertices.astype(np.float32))
    assert np.array_equal(arrays["faces"], faces) and arrays["faces"].dtype == np.uint32
    assert np.array_equal(arrays["uvs"], uvs) and arrays["normals"].shape == vertices.shape
    assert mesh.triangles == len(faces) and mesh.path is None
    assert np.allclose(mesh.bounds, [vertices.min(0), vertices.max(0)])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_arrays_of_any_layout_are_taken(dtype: type) -> None:
    vertices, faces = sphere(16, 8)
    wanted = tt.Mesh(vertices, faces).arrays()["vertices"]
    for layout in (np.asfortranarray(vertices.astype(dtype)), np.repeat(vertices.astype(dtype), 2, axis=0)[::2]):
        assert np.array_equal(tt.Mesh(layout, faces.astype(np.int64)).arrays()["vertices"], wanted)


VALUE, TYPE = tt.InvalidValue, tt.InvalidType


@pytest.mark.parametrize(
    ("change", "kind", "words"),
    [
        ({"vertices": np.zeros((4, 2))}, VALUE, r"vertices: .*\(4, 2\), dtype float64; expected \(n, 3\), float32 or float64"),
        ({"vertices": np.zeros((4, 3), np.complex64)}, TYPE, "vertices: .*complex64.*expected"),
        ({"vertices": [[0, 0, 0], [1]]}, TYPE, "vertices .*expected an array of numbers"),
        ({"vertices": "mesh"}, TYPE, "vertices .*expected an array of numbers"),
        ({"faces": np.zeros((1, 3))}, TYPE, r"faces: .*float64.*expected \(n, 3\), uint32"),
        ({"faces": [[0, 1, -1]]}, VALUE, "faces: row 0 has an index below 0, -1; accepted: 0 to 3"),
        ({"faces": [[0, 1, 2], [0, 1, 9]]}, VALUE, "faces: row 1 .*9; accepted: 0 to 3"),
        ({"uvs": np.zeros((4, 3))}, VALUE, r"uvs: .*expected \(n, 2\)"),
        ({"uvs": np.zeros((3, 2))}, VALUE, "uvs: 3 rows; expected 4"),
        ({"colors": np.zeros((4, 2))}, VALUE, r"colors: .*\(n, 3\) or \(n, 4\)"),
        ({"colors": np.full((4, 3), 255.0)}, VALUE, "colors: values from 255 to 255; floats are linear, 0 to 1; .*uint8"),
        ({"colors": np.full((4, 3), -0.1)}, VALUE, "colors: values from -0.1"),
        ({"colors": np.full((4, 3), np.nan)}, VALUE, "colors: row 0 is .nan.*finite"),
        ({"colors": np.full((4, 3), 255)}, TYPE, r"colors: .*int64.*uint8 \(sRGB\)"),
        ({"vertices": np.full((4, 3), np.nan)}, VALUE, "vertices: row 0 is .nan.*finite"),
        ({"vertices": np.full((4, 3), 1e300)}, VALUE, "vertices: row 0 is .inf.*finite"),
        ({"normals": [[0, 0, 1], [0, 0, 1], [0, np.inf, 1], [0, 0, 1]]}, VALUE, "normals: row 2 is .*inf.*finite"),
    ],
)
def test_wrong_arrays_are_refused_by_name_with_what_is_accepted(change: dict[str, object], kind: type, words: str) -> None:
    arrays: dict[str, object] = {"vertices": np.eye(4)[:, :3], "faces": [[0, 1, 2]]}
    with pytest.raises(kind, match=words):
        tt.Mesh(**{**arrays, **change})  # type: ignore[arg-type]


def test_codes_of_colors_are_srgb_and_floats_are_linear() -> None:
    vertices, faces = np.eye(3), [[0, 1, 2]]
    codes = np.array([[0, 10, 188], [255, 128, 1], [54, 200, 99]], np.uint8)
    colors = tt.Mesh(vertices, faces, colors=codes).arrays()["colors"]
    assert np.allclose(colors[0], [0, 10 / 255 / 12.92, 0.502886, 1], atol=1e-6)
    assert np.array_equal(tt.Mesh(vertices, faces, colors=colors).arrays()["colors"], colors)
    alpha = tt.Mesh(vertices, faces, colors=np.full((3, 4), 51, np.uint8)).arrays()["colors"][:, 3]
    assert np.allclose(alpha, 0.2)


def test_any_object_with_vertices_and_faces_is_a_mesh() -> None:
    vertices, faces = sphere(16, 8)
    other = SimpleNamespace(vertices=vertices, faces=faces, triangles=None, points=None)
    assert np.array_equal(tt.render(other, size=32), tt.render(tt.Mesh(vertices, faces), size=32))
    with pytest.raises(tt.InvalidType, match="model 7: of type int; expected a path, a Model"):
        tt.render(7)


def test_models_pickle(scan: tt.Model, ball: tt.Mesh) -> None:
    for model in (scan, ball):
        again = pickle.loads(pickle.dumps(model))
        assert again.triangles == model.triangles and again.path == model.path
        assert np.array_equal(tt.render(again, size=32), tt.render(model, size=32))


def test_units_and_options_of_reading_stay_with_a_model(scan_file: Path, scan: tt.Model, ball: tt.Mesh) -> None:
    def height(model: Any) -> float:
        bounds = tt.bake(model, triangles=200, size=64).model.bounds
        return float(bounds[1, 1] - bounds[0, 1])

    mm = tt.load(scan_file, unit="mm")
    expected = height(mm)
    assert 0.0019 < expected < 0.0021
    for model in (pickle.loads(pickle.dumps(mm)), copy.deepcopy(mm), tt.Scene([mm]), tt.Scene([mm, ball])):
        assert np.isclose(height(model), expected, rtol=0.05), "its unit is the same"
    twice = pickle.loads(pickle.dumps(pickle.loads(pickle.dumps(scan))))
    assert np.isclose(height(twice), height(scan), rtol=1e-3)
    mixed = tt.Scene([mm, tt.load(scan_file, unit="cm")])
    assert [what for what, _ in mixed.warnings if "different units" in what]


def test_arrays_of_either_byte_order_are_taken(ball: tt.Mesh) -> None:
    arrays = ball.arrays()
    vertices, faces = arrays["vertices"], arrays["faces"]
    swapped = tt.Mesh(vertices.astype(">f8"), faces.astype(">u4"))
    assert np.array_equal(tt.render(swapped, size=32), tt.render(tt.Mesh(vertices, faces), size=32))


def test_materials_are_given_by_name_or_in_full(ball: tt.Mesh) -> None:
    plain, bronze = (tt.render(model, size=32) for model in (ball, ball.with_material("bronze")))
    assert not np.array_equal(plain, bronze)
    assert np.array_equal(bronze, tt.render(ball, material=tt.Material("bronze"), size=32))
    rough = tt.render(ball, material=tt.Material("bronze", roughness=1.0), size=32)
    assert not np.array_equal(bronze, rough)
    with pytest.raises(tt.Error, match="bronce"):
        tt.render(ball, material="bronce")


def test_problems_of_a_file_give_warnings(tmp_path) -> None:  # type: ignore[no-untyped-def]
    obj = tmp_path / "a.obj"
    obj.write_text("mtllib nowhere.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.warns(tt.TaotieWarning, match="nowhere.mtl"):
        model = tt.load(obj)
    assert model.warnings and model.triangles == 1


def test_inspection_reports_what_the_command_reports(scan_file, run) -> None:  # type: ignore[no-untyped-def]
    import json

    printed = json.loads(run("inspect", scan_file, "--json").stdout)
    report = tt.inspect(scan_file)
    assert report.to_dict() == {key: printed[key] for key in report}
    assert report.format == "PLY" and "format" in dir(report)
    with pytest.raises(AttributeError):
        report.nothing


def test_an_audit_gives_the_answers_of_the_command(scan_file, tmp_path) -> None:  # type: ignore[no-untyped-def]
    import json
    import subprocess
    import sys

    schema, product = tmp_path / "s.json", tmp_path / "p.json"
    schema.write_text('{ "version": "1.0.4", "model": { "triangles": { "maximum": 100 } } }')
    product.write_text('{ "dimensions": { "height": 2 } }')
    line = ["inspect", scan_file, "--audit", schema, "--product-info", product, "--json"]
    done = subprocess.run([sys.executable, "-m", "taotie", *map(str, line)], capture_output=True, text=True)
    printed = json.loads(done.stdout)
    audit = tt.inspect(scan_file, audit=schema, product_info=product)
    assert done.returncode == 1 and not audit.passed and repr(audit).startswith("<taotie.Audit failed: triangle-count")
    assert audit.to_dict() == {key: printed[key] for key in audit}
    schema.write_text('{ "version": "1.0.4", "modle": {} }')
    with pytest.raises(tt.Error, match="unknown field `modle`"):
        tt.inspect(scan_file, audit=schema)
    with pytest.raises(TypeError, match="needs audit"):
        tt.inspect(scan_file, product_info=product)  # type: ignore[call-overload]
