"""Comparisons, differences and normal maps."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Pillow

import taotie as tt


def test_a_comparison_is_that_of_the_command(scan_file: Path, asset: tt.Asset, tmp_path: Path, run) -> None:  # type: ignore[no-untyped-def]
    low = asset.save(tmp_path / "low.glb").path
    run("compare", low, "--reference", scan_file, "--method", "smooth,tangent-normal", "--size", "160", "-o", tmp_path / "c", "--exr")
    report = json.loads((tmp_path / "c" / "report.json").read_text())
    found = tt.compare(low, scan_file, methods=["smooth", "tangent-normal"], size=160)
    report_of = found.to_dict()
    same = ("subject", "against", "unmatched", "rules", "methods", "skipped", "points", "notes")
    assert {key: report_of[key] for key in same} == {key: report[key] for key in same}
    smooth, mapped = found.mean_deg("smooth"), found.mean_deg("tangent-normal")
    assert smooth is not None and mapped is not None and mapped < smooth
    view = found.views["tangent-normal"]
    assert view.normals.shape == (160, 160, 3) and view.angles is not None and view.angles.shape == (160, 160)
    assert view.images["ggx"].shape == (160, 160, 3) and found.views["reference"].angles is None
    with pytest.raises(tt.Error, match="bump"):
        found.mean_deg("bump")


def test_differences_are_those_of_the_command(ball: tt.Mesh, tmp_path: Path, run) -> None:  # type: ignore[no-untyped-def]
    a, b = tt.render(ball, size=48), tt.render(ball, size=48, material="brass")
    for name, image in (("a", a), ("b", b)):
        image.save(str(tmp_path / f"{name}.png"))
    printed = json.loads(run("diff", tmp_path / "a.png", tmp_path / "b.png", "--json").stdout)
    for pair in ((a, b), (tmp_path / "a.png", tmp_path / "b.png"), (Pillow.fromarray(a), Pillow.fromarray(b))):
        found = tt.diff(*pair)
        assert found.to_dict() == printed["metrics"]
    assert found.map.shape == (48, 48) and found.title == "FLIP" and found.mean_deg is None
    same = tt.diff(a, a)
    assert (same.flip, same.rmse, same.ssim, same.psnr) == (0.0, 0.0, 1.0, float("inf"))
    with pytest.raises(tt.Error, match="same size"):
        tt.diff(a, a[:40])
    with pytest.raises(tt.Error, match=r"\(3,\).*expected"):
        tt.diff(a, np.zeros(3))


def test_normals_have_the_angle_between_them() -> None:
    flat = np.full((16, 16, 3), (128, 128, 255), np.uint8)
    turned = np.full((16, 16, 3), (218, 128, 218), np.uint8)
    found = tt.diff(flat, turned, encoding="unit")
    assert found.mean_deg == pytest.approx(45, abs=0.5) and found.unit == "°"


def test_heights_become_normals(tmp_path: Path, run) -> None:  # type: ignore[no-untyped-def]
    x = np.arange(64)
    heights = (32768 + 20000 * np.sin(x * 2 * np.pi / 64)[None, :] * np.cos(x * 2 * np.pi / 32)[:, None]).astype(np.uint16)
    normals = tt.normals.from_height(heights, scale=8)
    assert normals.shape == (64, 64, 3) and normals.dtype == np.float32
    assert np.allclose(np.linalg.norm(normals, axis=-1), 1, atol=1e-6)
    slope = 8 * 20000 / 65535 * 2 * np.pi / 64
    assert normals[0, 0, 0] / normals[0, 0, 2] == pytest.approx(-slope, rel=1e-3)
    Pillow.fromarray(heights).save(tmp_path / "h.png")
    run("normals", tmp_path / "h.png", "--from", "height", "--height-scale", "8", "--bits", "8", "-o", tmp_path / "n.png")
    for source in ("auto", "tangent"):
        codes = tt.normals.convert(normals, source=source, bits=16).map
        decoded = codes[..., :3] / np.float32(65535) * 2 - 1
        assert np.abs(decoded - normals).max() < 1e-4, "vectors in [-1, 1] are taken as such"
    made = tt.normals.convert(heights, source="height", height_scale=8, bits=8)
    assert np.array_equal(made.map, np.asarray(Pillow.open(tmp_path / "n.png")))
    assert 0 < np.nanmean(made.error_deg) < 0.4
    with pytest.raises(tt.Error, match=r"heights: .*\(2,\)"):
        tt.normals.from_height(np.zeros(2), scale=1)


def test_green_is_turned() -> None:
    directx = np.full((4, 4, 3), (128, 90, 240), np.uint8)
    opengl = tt.normals.convert(directx, source="tangent", green_in="down").map
    assert np.array_equal(opengl, np.full((4, 4, 3), (128, 165, 240), np.uint8))
