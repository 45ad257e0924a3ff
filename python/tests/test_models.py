"""Models: files and arrays."""

from __future__ import annotations

import pickle
from types import SimpleNamespace

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


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"vertices": np.zeros((4, 2))}, r"vertices: .*\(4, 2\), dtype float64; expected \(n, 3\), float32 or float64"),
        ({"vertices": np.zeros((4, 3), np.complex64)}, "complex64"),
        ({"faces": np.zeros((1, 3))}, r"faces: .*float64; expected \(n, 3\), uint32"),
        ({"faces": [[0, 1, -1]]}, "an index below 0"),
        ({"faces": [[0, 1, 9]]}, "9"),
        ({"uvs": np.zeros((4, 3))}, r"uvs: .*expected \(n, 2\)"),
        ({"uvs": np.zeros((3, 2))}, "3"),
        ({"colors": np.zeros((4, 2))}, r"\(n, 3\) or \(n, 4\)"),
        ({"vertices": np.full((4, 3), np.nan)}, "finite|NaN|number"),
    ],
)
def test_wrong_arrays_are_refused_with_shape_and_dtype(change: dict[str, object], words: str) -> None:
    arrays: dict[str, object] = {"vertices": np.eye(4)[:, :3], "faces": [[0, 1, 2]]}
    with pytest.raises(tt.Error, match=words):
        tt.Mesh(**{**arrays, **change})  # type: ignore[arg-type]


def test_meshes_of_others_are_taken_by_their_attributes() -> None:
    vertices, faces = sphere(16, 8)
    shown = tt.render(tt.Mesh(vertices, faces), size=32)
    trimesh = SimpleNamespace(vertices=vertices, faces=faces)
    open3d = SimpleNamespace(vertices=vertices, triangles=faces.astype(np.int32))
    pyvista = SimpleNamespace(points=vertices, regular_faces=faces, is_all_triangles=True)
    for other in (trimesh, open3d, pyvista):
        assert np.array_equal(tt.render(other, size=32), shown)
    with pytest.raises(tt.Error, match="an object of type int"):
        tt.render(7)


def test_models_pickle(scan: tt.Model, ball: tt.Mesh) -> None:
    for model in (scan, ball):
        again = pickle.loads(pickle.dumps(model))
        assert again.triangles == model.triangles and again.path == model.path
        assert np.array_equal(tt.render(again, size=32), tt.render(model, size=32))


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
