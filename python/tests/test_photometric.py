"""Normals from photographs, and relightable images read by an independent implementation."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image as Pillow

import taotie as tt

from conftest import relief

Array = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def photographs() -> tuple[list[np.ndarray], np.ndarray, np.ndarray]:
    """Photographs, lights and true normals."""
    return relief()


@pytest.fixture(scope="module")
def folder(photographs: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same photographs in colour, with 8 bits, as files."""
    folder = tmp_path_factory.mktemp("photographs")
    images, lights, _ = photographs
    lines = [str(len(images))]
    for k, (image, light) in enumerate(zip(images, lights)):
        linear = image[..., None] / 65535 * [1.0, 0.7, 0.4]
        Pillow.fromarray(np.round(encoded(linear) * 255).astype(np.uint8)).save(folder / f"{k}.png")
        lines.append(f"{k}.png {light[0]} {light[1]} {light[2]}")
    (folder / "dome.lp").write_text("\n".join(lines) + "\n")
    return folder


def encoded(linear: Array) -> Array:
    """Encode linear light by the sRGB curve."""
    powers = 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    return np.asarray(np.where(linear <= 0.0031308, 12.92 * linear, powers))


def angles(a: Array, b: Array) -> Array:
    """Return the angles between unit vectors in degrees."""
    return np.asarray(np.degrees(np.arccos(np.clip((a * b).sum(axis=-1), -1, 1))))


def test_normals_of_arrays_are_those_of_the_relief(photographs: Any) -> None:
    images, lights, truth = photographs
    found = tt.photometric(images, lights=lights)
    assert found.normals.dtype == np.float32 and found.normals.shape == (48, 48, 3) and found.mask.all()
    assert angles(found.normals, truth).mean() < 0.5
    assert np.allclose(found.albedo, 0.8, atol=0.02) and found.residuals.max() < 0.01
    assert found.light_residuals.shape == (12,) and found.mean_sigma_deg < 1.5
    slope = np.diff(found.depth, axis=1).mean(axis=0)
    expected = -(truth[..., 0] / truth[..., 2]).mean(axis=0)
    assert np.corrcoef(slope, (expected[1:] + expected[:-1]) / 2)[0, 1] > 0.99
    assert repr(found).startswith("<taotie.PhotometricNormals 48x48: 2,304 normals, mean sigma ")


def test_all_kinds_of_arrays_are_taken(photographs: Any) -> None:
    images, lights, truth = photographs
    linear = [image / 65535 for image in images]
    codes = [np.round(encoded(image) * 255).astype(np.uint8) for image in linear]
    mask = np.zeros((48, 48), bool)
    mask[8:40, 8:40] = True
    for given in (
        linear,
        [np.repeat(image[..., None], 3, axis=2).astype(np.float32) for image in linear],
        codes,
        [Pillow.fromarray(code) for code in codes],
    ):
        found = tt.photometric(given, lights=3 * lights, mask=mask, threads=1)
        assert (found.mask == mask).all() and np.isnan(found.normals[~mask]).all()
        assert angles(found.normals[mask], truth[mask]).mean() < 1.0


def test_files_are_those_of_the_command(folder: Path, tmp_path: Path, run: Callable[..., Any]) -> None:
    run("photometric", folder, "-o", tmp_path / "command")
    found = tt.photometric(folder)
    found.save(tmp_path / "package")
    written = {path.name for path in (tmp_path / "command").iterdir()}
    assert {path.name for path in (tmp_path / "package").iterdir()} == written - {"report.json", "report.html"}
    for path in (tmp_path / "package").iterdir():
        assert path.read_bytes() == (tmp_path / "command" / path.name).read_bytes(), path.name
    assert tt.load(tmp_path / "package" / "relief.glb").triangles > 4000


def test_colours_and_units_are_those_of_the_photographs(folder: Path, tmp_path: Path) -> None:
    found = tt.photometric(folder, pixel_size=0.5, unit="mm")
    assert found.color.shape == (48, 48, 3) and np.allclose(found.color.mean(axis=2), found.albedo, rtol=1e-4)
    assert np.allclose(found.color / found.albedo[..., None], np.array([1.0, 0.7, 0.4]) / 0.7, atol=0.02)
    found.save(tmp_path / "out")
    for name, width in (("relief", 47), ("plane", 48)):
        bounds = tt.load(tmp_path / "out" / f"{name}.glb").bounds
        assert np.isclose(bounds[1, 0] - bounds[0, 0], width * 0.5e-3, rtol=1e-4), name
    with Pillow.open(tmp_path / "out" / "base_color.png") as image:
        assert image.mode == "RGB"


def test_the_folder_of_the_photographs_is_not_written_to(folder: Path) -> None:
    found = tt.photometric(folder)
    before = sorted(folder.iterdir())
    with pytest.raises(tt.InvalidValue, match="folder of the photographs"):
        found.save(folder)
    assert sorted(folder.iterdir()) == before


def test_wrong_arguments_are_named(photographs: Any, folder: Path, tmp_path: Path) -> None:
    images, lights, _ = photographs
    for kind, words, call in [
        (tt.InvalidValue, "lights: missing", lambda: tt.photometric(images)),
        (tt.InvalidValue, r"lights.*shape \(11, 3\).*\(12, 3\)", lambda: tt.photometric(images, lights=lights[1:])),
        (tt.InvalidValue, "lights.*states them", lambda: tt.photometric(folder, lights=lights)),
        (tt.InvalidValue, "lights.*at least 4", lambda: tt.photometric(images[:3], lights=lights[:3])),
        (tt.InvalidValue, "lights row 2", lambda: tt.photometric(images, lights=lights * (np.arange(12) != 2)[:, None])),
        (tt.InvalidValue, "lights.*not finite", lambda: tt.photometric(images, lights=lights * np.nan)),
        (tt.InvalidValue, r"images\[1\].*24x48", lambda: tt.photometric([images[0], *(i[:, :24] for i in images[1:])], lights=lights)),
        (tt.InvalidValue, r"images\[0\].*shape \(48,\)", lambda: tt.photometric(images[0], lights=lights)),
        (tt.InvalidValue, "images: an empty", lambda: tt.photometric([], lights=lights)),
        (tt.InvalidValue, "mask.*48x24", lambda: tt.photometric(images, lights=lights, mask=np.ones((24, 48), bool))),
        (tt.InvalidValue, "empty mask", lambda: tt.photometric(images, lights=lights, mask=np.zeros((48, 48), bool))),
        (tt.InvalidValue, "mask.*path", lambda: tt.photometric(folder, mask=np.ones((48, 48), bool))),
        (tt.InvalidValue, "encoding 'gamma'", lambda: tt.photometric(images, lights=lights, encoding="gamma")),  # type: ignore[arg-type]
        (tt.InvalidValue, "unit 'mm'.*pixel_size", lambda: tt.photometric(images, lights=lights, unit="mm")),
        (tt.InvalidValue, "unit 'km'", lambda: tt.photometric(images, lights=lights, pixel_size=1, unit="km")),  # type: ignore[arg-type]
        (tt.InvalidValue, "pixel_size -1", lambda: tt.photometric(images, lights=lights, pixel_size=-1)),
        (tt.InvalidType, "images 3.*a path", lambda: tt.photometric(3, lights=lights)),  # type: ignore[arg-type]
        (tt.InvalidType, "lights", lambda: tt.photometric(images, lights=[["a"] * 3] * 12)),
        (tt.MissingFile, "nowhere.lp", lambda: tt.photometric("nowhere.lp")),
    ]:
        with pytest.raises(kind, match=words):
            call()


def test_work_is_cancelled(photographs: Any) -> None:
    images, lights, _ = photographs
    large = [np.tile(image, (12, 12)) for image in images]
    with pytest.raises(tt.Cancelled):
        tt.photometric(large, lights=lights, progress=lambda *_: False)


def of_ptm(path: Path) -> Callable[[Array], Array]:
    """Read a polynomial texture map, as its authors describe it."""
    _, form, width, height, scales, biases, rest = path.read_bytes().split(b"\n", 6)
    w, h, n = int(width), int(height), int(width) * int(height)
    scale, bias = (np.array(words.split(), float) for words in (scales, biases))
    codes = np.frombuffer(rest, np.uint8)

    def terms(light: Array) -> Array:
        x, y, _ = light
        return np.array([x * x, y * y, x * y, x, y, 1])

    if form == b"PTM_FORMAT_LRGB":
        grey = (codes[: 6 * n].reshape(h, w, 6)[::-1] - bias) * scale
        color = codes[6 * n :].reshape(h, w, 3)[::-1]
        return lambda light: (grey @ terms(light))[..., None] / 255 * color / 255
    channels = (codes.reshape(3, h, w, 6)[:, ::-1] - bias) * scale
    return lambda light: np.moveaxis(channels @ terms(light), 0, -1) / 255


def harmonics(light: Array) -> Array:
    """Return the hemispherical harmonics up to degree 2: associated Legendre polynomials of 2 cos θ − 1."""
    angle, u = np.arctan2(light[1], light[0]), 2 * max(light[2], 0) - 1
    s = np.sqrt(1 - u * u)
    root = 1 / np.sqrt(2 * np.pi)
    first = np.sqrt(3) * root * np.array([s * np.cos(angle), u, s * np.sin(angle)])
    second = np.sqrt(15 / 4) * np.array(
        [
            -s * s * np.cos(2 * angle),
            2 * u * s * np.cos(angle),
            (3 * u * u - 1) / np.sqrt(3),
            2 * u * s * np.sin(angle),
            -s * s * np.sin(2 * angle),
        ]
    )
    return np.array([root, *first, *(root * second)])


def of_rti(path: Path) -> Callable[[Array], Array]:
    """Read hemispherical harmonics."""
    _, kind, size, form, rest = path.read_bytes().split(b"\n", 4)
    width, height, channels = map(int, size.split())
    terms = int(form.split()[0])
    assert kind == b"3" and channels == 3
    scale, bias = np.frombuffer(rest[: 8 * terms], "<f4").reshape(2, terms)
    codes = np.frombuffer(rest[8 * terms :], np.uint8).reshape(height, width, 3, terms)
    return lambda light: (codes / 255 * scale + bias) @ harmonics(light)[:terms]


def of_web(folder: Path) -> Callable[[Array], Array]:
    """Read the images of a web viewer."""
    info = json.loads((folder / "info.json").read_text())
    assert (info["type"], info["colorspace"]) == ("hsh", "rgb")
    scale, bias = (np.array(info["materials"][0][name]).reshape(-1, 1, 1, 3) for name in ("scale", "bias"))
    images = [np.asarray(Pillow.open(folder / f"plane_{k}.jpg").convert("RGB")) for k in range(len(scale))]
    planes = (np.array(images) / 255 - bias) * scale
    return lambda light: np.tensordot(harmonics(light)[: len(planes)], planes, 1)


def test_relightable_files_are_what_others_read(folder: Path, tmp_path: Path, run: Callable[..., Any]) -> None:
    run("photometric", folder, "-o", tmp_path / "o", "--relight", "ptm,ptm-rgb,rti,openlime", "--encoding", "srgb")
    report = json.loads((tmp_path / "o" / "report.json").read_text())
    for relight, read in zip(report["relight"], (of_ptm, of_ptm, of_rti, of_web)):
        path = tmp_path / "o" / relight["file"]
        relit = read(path.parent if path.name == "info.json" else path)
        squares = []
        for photograph in report["photographs"]:
            actual = np.asarray(Pillow.open(folder / photograph["name"])) / 255
            found = np.clip(relit(np.array(photograph["direction"])), 0, 1)
            squares.append(np.mean((found - actual) ** 2))
        psnr = -10 * np.log10(np.mean(squares))
        # Decoders of JPEG differ by a code.
        assert abs(psnr - relight["psnr"]) < (0.3 if path.name == "info.json" else 0.02), (relight, psnr)
        assert psnr > 30, relight
    # A polynomial cannot be fitted better than by NumPy.
    lights = np.array([photograph["direction"] for photograph in report["photographs"]])
    x, y = lights[:, 0], lights[:, 1]
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    images = [np.asarray(Pillow.open(folder / photograph["name"])) / 255 for photograph in report["photographs"]]
    samples = np.array(images).reshape(len(lights), -1)
    best = terms @ np.linalg.lstsq(terms, samples, rcond=None)[0]
    least = -10 * np.log10(np.mean((best - samples) ** 2))
    assert least - 1 < report["relight"][1]["psnr"] <= least + 0.01
