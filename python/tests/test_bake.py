"""Bakes and proofs: identical to the command's, to the bit."""

from __future__ import annotations

import json
import logging
import pickle
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image as Pillow

import taotie as tt

from conftest import sphere


def test_files_and_figures_are_those_of_the_command(scan_file: Path, tmp_path: Path, run) -> None:  # type: ignore[no-untyped-def]
    out, own = tmp_path / "a" / "asset.glb", tmp_path / "b" / "asset.glb"
    for path in (out, own):
        path.parent.mkdir()
    options = "--triangles 500 --lods 200,64px --size 128 --maps normal,ao --ao-rays 16"
    arguments = f"{options} --images webp --meshopt".split()
    run("bake", scan_file, "-o", out, *arguments, "--proof-points", 20_000, "--proof-view", 96)
    asset = tt.bake(scan_file, triangles=500, lods=[200, "64px"], size=128, maps=["normal", "ao"], ao_rays=16)
    written = asset.save(own, images="webp", meshopt=True)
    assert own.read_bytes() == out.read_bytes()
    report = json.loads(out.with_suffix(".report.json").read_text())
    proof = written.verify(scan_file, points=20_000, view=96)
    assert proof.to_dict() == report["proof"]
    made = written.report(proof)
    same = ("kind", "schema", "certificate", "high_sha256", "triangles", "parameters", "origin", "proof")
    same += ("carried", "left")
    assert {key: made[key] for key in same} == {key: report[key] for key in same}


def test_a_list_of_models_is_one_scan_as_for_the_command(scan_file: Path, tmp_path: Path, run) -> None:  # type: ignore[no-untyped-def]
    vertices, faces = sphere(24, 12)
    other = tmp_path / "lid_high.obj"
    lines = ["v {} {} {}".format(*vertex) for vertex in 0.5 * vertices + (0, 1, 0)]
    other.write_text("\n".join([*lines, *("f {} {} {}".format(*(face + 1)) for face in faces)]) + "\n")
    out, own = tmp_path / "a" / "asset.glb", tmp_path / "b" / "asset.glb"
    for path in (out, own):
        path.parent.mkdir()
    proof = ("--proof-points", 20_000, "--proof-view", 96)
    run("bake", scan_file, other, "-o", out, "--triangles", 500, "--size", 64, "--unit", "mm", *proof)
    parts = [scan_file, tt.load(other)]
    asset = tt.bake(parts, triangles=500, size=64, unit="mm")
    written = asset.save(own)
    assert own.read_bytes() == out.read_bytes()
    report = json.loads(out.with_suffix(".report.json").read_text())
    assert [file["name"] for file in report["certificate"]["scan"]] == [scan_file.name, other.name]
    assert tt.verify(own, parts, points=20_000, view=96).to_dict() == report["proof"]
    in_mm = [tt.load(scan_file, unit="mm"), tt.load(other, unit="mm")]
    proved = written.verify(in_mm, points=20_000, view=96)
    assert written.report(proved)["certificate"] == report["certificate"]
    with pytest.raises(tt.Error, match="different options"):
        tt.bake([scan_file, in_mm[1]], triangles=500, size=64)
    with pytest.raises(tt.Error, match="the same file as"):
        tt.bake([scan_file, scan_file], triangles=500, size=64)
    with pytest.raises(tt.Error, match="has no files"):
        tt.bake([], triangles=500, size=64)
    # A part in memory: there is no file to name.
    mesh = tt.Mesh(0.5 * vertices + (0, 1, 0), faces)
    assert tt.bake([scan_file, mesh], triangles=500, size=64).save(own).report()["high"] == ""


def test_a_packed_scan_has_the_materials_that_it_was_given(tmp_path: Path) -> None:
    vertices, faces = sphere(48, 24)
    x, y = np.mgrid[:128, :128]
    waves = np.dstack([100 + 80 * np.sin(0.2 * x), 100 + 80 * np.sin(0.2 * y), np.full((128, 128), 90)])
    paint = tt.Material(base_color_map=waves.astype(np.uint8), roughness=0.7)
    uvs = np.column_stack([np.arctan2(vertices[:, 0], vertices[:, 2]) / 7 + 0.5, vertices[:, 1] / 3 + 0.5])
    path = tmp_path / "scan.glb"
    tt.Mesh(vertices, faces, uvs=uvs, material=paint).save(path)

    def baked_roughness(**options: Any) -> float:
        asset = tt.bake(tt.load(path, **options), error=1.0)
        assert asset.save(tmp_path / "out.glb").report()["origin"]["is_scan"]
        glb = asset.glb()
        document = json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])
        roughness: float = document["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"]
        return roughness

    assert baked_roughness() == pytest.approx(0.7)
    assert baked_roughness(material=tt.Material(roughness=0.2)) == pytest.approx(0.2)


def test_an_asset_describes_itself(asset: tt.Asset) -> None:
    assert len(asset.triangles) == 1 and 400 < asset.triangles[0] <= 600
    assert asset.size == (128, 128) and asset.counts["texels"] > 5000
    level = asset.levels()[0]
    assert level["faces"].shape == (asset.triangles[0], 3) and level["tangents"].shape[1] == 4
    normal = asset.maps()["normal"]
    assert normal.shape == (128, 128, 3) and normal.dtype == np.uint8
    with pytest.raises(tt.Error, match="material 'x'"):
        asset.maps("x")


def test_a_remesh_is_recorded(scan: tt.Model, tmp_path: Path) -> None:
    closed = tt.bake(scan, triangles=300, size=64, remesh=True)
    report = closed.save(tmp_path / "closed.glb").report()
    assert report["parameters"]["remesh"] is True
    remesh = report["origin"]["simplified"]["remesh"]
    assert (remesh["scan_shells"], remesh["open_borders"], remesh["shells"]) == (1, 0, 1)


def test_a_device_casts_the_rays_or_its_absence_is_explained(scan: tt.Model) -> None:
    def maps(device: Any) -> dict[str, np.ndarray]:
        asset = tt.bake(scan, triangles=300, size=64, maps=["normal", "ao"], ao_rays=16, device=device)
        return dict(asset.maps())

    with pytest.raises(tt.Error, match="tpu"):
        maps("tpu")
    try:
        by_gpu = maps("gpu")
    except tt.Error as error:
        assert "GPU" in str(error)
        return
    by_cpu = maps("cpu")
    assert by_gpu.keys() == by_cpu.keys() and len(by_cpu) > 1
    for name, expected in by_cpu.items():
        differences = np.abs(by_gpu[name].astype(int) - expected)
        assert differences.mean() < 0.01 and differences.max() <= 4, name


def test_a_proof_measures_and_requires(asset: tt.Asset, scan: tt.Model, tmp_path: Path) -> None:
    proof = asset.verify(scan, points=20_000, view=64)
    assert 0.1 < proof.mean_deg < proof.p95_deg <= proof.max_deg < 90
    assert proof.error_map.shape == (128, 128) and proof.error_map.dtype == np.float32
    assert np.isnan(proof.error_map).any() and abs(np.nanmean(proof.error_map) - proof.mean_deg) < 2
    assert proof.detail_map.shape == (128, 128) and np.nanmin(proof.detail_map) > 0
    within = proof.require("within-60deg=50%")[0]
    assert (within.figure, within.within) == ("within-angle", 60)
    met = proof.require("mean-angle@0=20", mean_angle=20, missed="5%", bytes="1MB")
    assert [one.figure for one in met] == ["mean-angle", "mean-angle", "missed", "bytes"] and all(m.met for m in met)
    with pytest.raises(tt.NotMet, match="mean-angle"):
        proof.require(mean_angle=0.001)
    with pytest.raises(tt.Error, match="angle"):
        proof.require("angle=1")
    folder = asset.save(str(tmp_path / "asset.glb"))
    single = tt.verify(folder.path, scan, points=20_000, view=64)
    assert single.figures == proof.figures | {"bytes_out": single.figures["bytes_out"]}
    again = pickle.loads(pickle.dumps(proof))
    assert again.figures == proof.figures and again.require(mean_angle=20)[0].met


def test_an_asset_renders_like_its_file(asset: tt.Asset, tmp_path: Path) -> None:
    path = asset.save(tmp_path / "asset.glb").path
    assert np.array_equal(tt.render(asset, size=48), tt.render(path, size=48))
    assert asset.glb() == Path(path).read_bytes() and asset.model.triangles == asset.triangles[0]


def test_a_low_poly_mesh_of_arrays_keeps_its_triangles(scan: tt.Model) -> None:
    low = tt.Mesh(*sphere(24, 12))
    asset = tt.bake(scan, low=low, size=64)
    assert asset.triangles == [low.triangles]


def test_a_low_poly_mesh_whose_file_has_changed_is_the_one_that_was_loaded(scan: tt.Model, tmp_path: Path) -> None:
    path = tmp_path / "low.glb"
    tt.Mesh(*sphere(24, 12)).save(path)
    low = tt.load(path)
    tt.Mesh(*sphere(30, 16)).save(path)
    with pytest.warns(tt.TaotieWarning, match="low.glb has changed"):
        asset = tt.bake(scan, low=low, size=64)
    assert asset.triangles == [low.triangles]


def test_hard_edges_of_a_modelled_shape_are_kept_unless_asked_otherwise() -> None:
    corners = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    cube = tt.Mesh(corners, [[a, b, c] for a, *rest in quads for b, c in zip(rest, rest[1:])])

    def said(**options: float) -> str:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            tt.bake(cube, size=64, **options)  # type: ignore[arg-type]
        return "\n".join(str(warning.message) for warning in caught)

    assert "smoothed below 26°, 12 hard edges kept" in said()
    assert "hard edges" not in said(crease_angle=180.0) and "hard edges" not in said(crease_angle=0.0)
    with pytest.raises(tt.Error, match="crease angle 200"):
        tt.bake(cube, size=64, crease_angle=200.0)
    with pytest.raises(tt.Error, match="scan_green"):
        tt.bake(cube, size=64, scan_green="left")  # type: ignore[arg-type]


def test_noise_is_measured_and_removed_only_if_asked(scan: tt.Model, tmp_path: Path) -> None:
    def written(**options: object) -> dict[str, object]:
        asset = tt.bake(scan, triangles=300, size=64, **options)  # type: ignore[arg-type]
        return asset.save(tmp_path / "asset.glb").report()

    assert "noise" not in written()
    assert "removed" not in written(noise="keep")["noise"]  # type: ignore[operator]
    removed = written(noise="remove")["noise"]["removed"]  # type: ignore[index]
    assert removed["rms"] >= 0 and 0 <= removed["mean_deg"] <= removed["p95_deg"]


def test_the_unit_of_a_scan_makes_its_asset_metres(tmp_path: Path) -> None:
    scan = tt.Mesh(*sphere(64, 32))
    asset = tt.bake(scan, triangles=300, size=64, unit="cm")
    path = asset.save(tmp_path / "asset.glb").path
    assert np.allclose(np.ptp(tt.load(path).bounds, axis=0), 0.02, rtol=0.05)
    proof = tt.verify(path, scan, points=20_000, view=64)
    assert (proof.figures["unit"], proof.figures["metres_per_unit"]) == ("cm", 0.01)
    met = proof.require("texel=5mm", hausdorff="1mm")
    assert [one.is_length for one in met] == [True, True] and all(one.met for one in met)
    unknown = tt.bake(scan, triangles=300, size=64).verify(scan, points=20_000, view=64)
    assert unknown.figures["unit"] is None
    with pytest.raises(tt.Error, match="unit"):
        unknown.require(hausdorff="1mm")
    with pytest.raises(tt.Error, match="unit 'ft'"):
        tt.bake(scan, unit="ft")  # type: ignore[arg-type]


def test_standalone_maps_are_written_as_pictures(scan: tt.Model, asset: tt.Asset, tmp_path: Path) -> None:
    level = asset.levels()[0]
    low = tt.Mesh(level["vertices"], level["faces"], level["normals"], level["uvs"])
    maps = tt.bake(scan, low=low, size=64)
    path = maps.save(tmp_path / "normal.png").path
    assert np.array_equal(np.asarray(Pillow.open(path)), maps.maps()["normal"])


def test_standalone_maps_of_several_materials_are_a_set_for_each(
    scan: tt.Model, asset: tt.Asset, tmp_path: Path
) -> None:
    level = asset.levels()[0]
    lines = [f"v {x} {y} {z}" for x, y, z in level["vertices"]] + [f"vt {u} {v}" for u, v in level["uvs"]]
    faces = ["f " + " ".join(f"{i + 1}/{i + 1}" for i in face) for face in level["faces"]]
    middle = len(faces) // 2
    parts = ["usemtl wood", *faces[:middle], "usemtl iron", *faces[middle:]]
    (tmp_path / "low.mtl").write_text("newmtl wood\nnewmtl iron\n")
    (tmp_path / "low.obj").write_text("\n".join(["mtllib low.mtl", *lines, *parts]) + "\n")
    maps = tt.bake(scan, low=tmp_path / "low.obj", size=64)
    written = maps.save(tmp_path / "normal.png")
    assert [Path(file).name for file in written.files] == ["normal.wood.png", "normal.iron.png"]
    for file, material in zip(written.files, ["wood", "iron"], strict=True):
        assert np.array_equal(np.asarray(Pillow.open(file)), maps.maps(material)["normal"])
    assert [note["material"] for note in written.report()["maps"]] == ["wood", "iron"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"triangles": 3}, "3 triangles"),
        ({"samples": 5}, "square"),
        ({"low": "low.glb", "remesh": True}, "omit one"),
        ({"maps": "normal"}, "sequence"),
        ({"maps": ["norml"]}, "norml"),
        ({"size": 8}, "16 to 16384"),
        ({"size": (64, 32)}, "square"),
        ({"cage": "cage.glb", "ray_distance": 1.0}, "cage"),
        ({"memory_limit": "many"}, "many"),
        ({"noise": "smooth"}, "keep, remove"),
    ],
)
def test_invalid_options_are_refused(scan: tt.Model, options: dict[str, object], words: str) -> None:
    with pytest.raises((tt.Error, ValueError), match=words):
        tt.bake(scan, **options)  # type: ignore[arg-type]


def test_input_files_are_never_overwritten(scan_file: Path, asset: tt.Asset) -> None:
    with pytest.raises(tt.Error):
        asset.save(scan_file)
    with pytest.raises(ValueError, match="jpeg:90"):
        asset.save("a.glb", images="jpeg")


def test_progress_reports_the_stages(scan: tt.Model, capfd: pytest.CaptureFixture[str]) -> None:
    heard: list[str] = []
    tt.bake(scan, triangles=300, size=256, samples=16, progress=lambda stage, _: heard.append(stage))
    assert "bake" in heard
    tt.bake(scan, triangles=300, size=256, samples=16, progress=True)
    assert "bake" in capfd.readouterr().err


def test_one_bar_shows_all_stages(scan: tt.Model, monkeypatch: pytest.MonkeyPatch) -> None:
    class Bar:
        """A fake of tqdm's."""

        made: list[Bar] = []

        def __init__(self, total: int, **_: object) -> None:
            self.total, self.n, self.stages, self.steps = total, 0, [], []
            Bar.made.append(self)

        def set_description(self, stage: str, refresh: bool) -> None:
            self.stages.append(stage)

        def update(self, step: int) -> None:
            self.n += step
            self.steps.append(step)

        def close(self) -> None:
            assert self.n <= self.total and min(self.steps) >= 0

    monkeypatch.setitem(sys.modules, "tqdm", SimpleNamespace())
    monkeypatch.setitem(sys.modules, "tqdm.auto", SimpleNamespace(tqdm=Bar))
    asset = tt.bake(scan, triangles=300, size=256, samples=16, progress=True)
    asset.verify(scan, points=1000, view=64, progress=True)
    assert len(Bar.made) == 2 and all(len(set(bar.stages)) > 1 for bar in Bar.made)
    assert all(bar.n > 0.7 * bar.total for bar in Bar.made), [bar.n for bar in Bar.made]


def test_stages_and_results_are_logged(scan: tt.Model, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, logger="taotie"):
        asset = tt.bake(scan, triangles=300, size=256, samples=16)
        asset.save(tmp_path / "a.glb").verify(scan, points=1000, view=64)
    said = {record.levelno: [] for record in caplog.records}
    for record in caplog.records:
        said[record.levelno].append(record.getMessage())
    assert "bake" in said[logging.DEBUG]
    assert [text.split()[0] for text in said[logging.INFO]] == ["baked", "wrote", "proved"]


def test_a_proof_displays_in_notebooks(asset: tt.Asset, scan: tt.Model) -> None:
    proof = asset.verify(scan, points=1000, view=64)
    shown = proof._repr_html_()
    assert shown.startswith("<table>") and f"{proof.mean_deg:.3g}°" in shown and len(shown) < 200_000
    assert shown.count("data:image/png;base64,") == 1


def test_representations_have_one_line(asset: tt.Asset, scan: tt.Model, tmp_path: Path) -> None:
    proof = asset.verify(scan, points=1000, view=64)
    image = tt.render(asset, size=32, linear=True, aov=["depth"])
    compared = tt.compare(asset, scan, methods=["smooth"], size=64)
    things = [
        asset, scan, proof, proof.require(mean_angle=20)[0], asset.save(tmp_path / "a.glb"), image, image.camera,
        compared, compared.views["smooth"], tt.diff(np.zeros((32, 32), np.uint8), np.ones((32, 32), np.uint8)),
        tt.Renderer(asset), tt.view(asset), tt.inspect(scan), tt.Scene([scan]), tt.Light("point", at=(1, 2, 3)),
        tt.Material(base_color_map=np.zeros((99, 99))), tt.Environment(np.zeros((99, 99, 3))), tt.Orbit(1, 2),
        tt.normals.convert(np.zeros((8, 8), np.float32), source="height", height_scale=1),
    ]  # fmt: skip
    for thing in things:
        assert "\n" not in repr(thing) and len(repr(thing)) < 400, repr(thing)
