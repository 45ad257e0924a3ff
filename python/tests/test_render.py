"""Images: identical to the command's, to the bit; their shapes; threads, signals and progress."""

from __future__ import annotations

import inspect
import re
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image as Pillow

import taotie as tt

CASES = [
    ({}, []),
    ({"camera": tt.Orbit(14, 10)}, ["--orbit", "14,10"]),
    ({"shading": "cook-torrance", "material": "bronze", "shadows": True}, "--shading cook-torrance --material bronze --shadows".split()),
    ({"env": "studio", "show_env": True, "env_rotate_deg": 33.3}, "--env studio --show-env --env-rotate-deg 33.3".split()),
    ({"light": "directional from=-75,10 strength=4", "tone": "aces", "exposure": 0.7}, ["--light", "directional from=-75,10 strength=4", "--tone", "aces", "--exposure", "0.7"]),
    ({"light": [tt.Light("directional", from_deg=(-75, 10), strength=4), tt.Light("spot", at=(0.1, 2, 3), toward=(0, 0.2, 0), angle_deg=20, color="#ffe0b0", falloff="none"), "point at=-2,1,2"]}, ["--light", "directional from=-75,10 strength=4", "--light", "spot at=0.1,2,3 toward=0,0.2,0 angle=20 color=#ffe0b0 falloff=none", "--light", "point at=-2,1,2"]),
    ({"env": tt.Environment("studio", rotation_deg=33.3, intensity=0.7, visible=True)}, "--env studio --show-env --env-rotate-deg 33.3 --env-intensity 0.7".split()),
    ({"camera": tt.Camera(azimuth_deg=14, elevation_deg=10, target=(0, 0.1, 0), fov_deg=41.7)}, "--orbit 14,10 --target 0,0.1,0 --fov-deg 41.7".split()),
    ({"background": "transparent", "samples": 16, "fov_deg": 41.7}, "--background transparent --samples 16 --fov-deg 41.7".split()),
    ({"integrator": "reference", "spp": 2, "seed": 3}, "--integrator reference --spp 2 --seed 3".split()),
    ({"surface": "facet", "ground": True, "material": tt.Material(base_color="#c08040", roughness=0.31)}, "--surface facet --ground --base-color #c08040 --roughness 0.31".split()),
]


@pytest.mark.parametrize(("options", "arguments"), CASES)
def test_pixels_are_those_of_the_command(scan_file: Path, tmp_path: Path, run, options, arguments) -> None:  # type: ignore[no-untyped-def]
    out = tmp_path / "out.png"
    run("render", scan_file, "--size", "96x64", "-o", out, *arguments)
    image = tt.render(scan_file, size=(96, 64), **options)
    assert image.shape == (64, 96, 4) and image.dtype == np.uint8
    assert np.array_equal(image, np.asarray(Pillow.open(out).convert("RGBA")))


def test_turntables_are_those_of_the_command(scan_file: Path, tmp_path: Path, run) -> None:  # type: ignore[no-untyped-def]
    run("render", scan_file, "--size", "48", "-o", tmp_path / "turn.png", "--turntable", "7")
    frames = tt.Renderer(scan_file).turntable(7, size=48)
    for index, frame in enumerate(frames):
        file = np.asarray(Pillow.open(tmp_path / f"turn.{index:03}.png").convert("RGBA"))
        assert np.array_equal(frame, file), index


def test_separate_options_override_those_of_an_object(ball: tt.Mesh) -> None:
    dim, wide = tt.Environment("studio", intensity=0.5), tt.Camera(azimuth_deg=40, elevation_deg=20, fov_deg=60)
    options = {"env_intensity": 1.5, "fov_deg": 25.0, "size": 24}
    expected = tt.render(ball, env="studio", camera=tt.Orbit(40, 20), **options)
    assert np.array_equal(tt.render(ball, env=dim, camera=wide, **options), expected)
    assert not np.array_equal(tt.render(ball, env=dim, camera=wide, size=24), expected)
    with pytest.raises(tt.Error, match="a point light needs at="):
        tt.render(ball, light=tt.Light("point"))


TAKERS: dict[str, Callable[..., object]] = {
    "render": tt.render,
    "Renderer": tt.Renderer,
    "Renderer.render": lambda model, **options: tt.Renderer(model).render(**options),
    "Renderer.turntable": lambda model, **options: tt.Renderer(model).turntable(2, **options),
    "view": tt.view,
    "compare": tt.compare,
}


@pytest.mark.parametrize("name", TAKERS)
def test_unknown_options_are_refused(ball: tt.Mesh, name: str) -> None:
    elsewhere = "turn_deg" if name != "Renderer.render" else "env"
    for option in ("shadings", elsewhere):
        with pytest.raises(TypeError, match=f"unexpected keyword argument '{option}'"):
            TAKERS[name](ball, **{option: 1})


def test_all_options_are_listed_and_documented() -> None:
    options = set(tt.RenderOptions.__annotations__)
    assert set(inspect.signature(tt.render).parameters) == {"model", "linear"} | options
    assert set(inspect.signature(tt.Renderer).parameters) == {"model"} | set(tt.RendererOptions.__annotations__)
    assert set(re.findall(r"^(\w+) : ", inspect.getdoc(tt.RenderOptions) or "", re.M)) == options


def test_light_and_output_variables_are_float(scan: tt.Model) -> None:
    found = tt.render(scan, linear=True, aov=["normals", "depth", "uv", "triangle", "albedo"], size=(40, 30))
    shapes = {"color": (30, 40, 4), "normals": (30, 40, 3), "depth": (30, 40), "uv": (30, 40, 2)}
    shapes |= {"triangle": (30, 40), "albedo": (30, 40, 3)}
    assert {name: array.shape for name, array in found.items()} == shapes
    assert all(array.dtype == np.float32 and array.flags.c_contiguous for array in found.values())
    seen = ~np.isnan(found["depth"])
    assert 100 < seen.sum() < 1200 and np.allclose(np.linalg.norm(found["normals"][seen], axis=-1), 1, atol=1e-5)
    with pytest.raises(tt.Error, match="linear=True"):
        tt.render(scan, aov=["depth"])  # type: ignore[call-overload]


def test_images_show_themselves(ball: tt.Mesh, tmp_path: Path) -> None:
    image = tt.render(ball, size=24)
    data = image._repr_png_()
    assert data is not None and data.startswith(b"\x89PNG") and image[0]._repr_png_() is None
    image.save(str(tmp_path / "a.png"))
    assert np.array_equal(np.asarray(Pillow.open(tmp_path / "a.png")), image)
    shown = ball._repr_png_()
    assert shown is not None and shown.startswith(b"\x89PNG")


def test_a_renderer_gives_what_a_render_gives(ball: tt.Mesh) -> None:
    renderer = tt.Renderer(ball, env="studio")
    for camera in (tt.Orbit(0, 0), tt.Orbit(40, 20), tt.Orbit(0, 0)):
        assert np.array_equal(renderer.render(camera=camera, size=32), tt.render(ball, env="studio", camera=camera, size=32))


def test_threads_render_in_parallel_without_blocking_others(scan: tt.Model) -> None:
    ticks, done = [], threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    counter = threading.Thread(target=tick)
    counter.start()
    results: list[np.ndarray] = []
    many = {"integrator": "reference", "spp": 8, "size": 128}
    workers = [threading.Thread(target=lambda: results.append(tt.render(scan, **many))) for _ in range(2)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    done.set()
    counter.join()
    assert len(results) == 2 and np.array_equal(*results)
    assert max(np.diff(ticks)) < 0.25, "the interpreter's lock was held"


def test_pixels_do_not_depend_on_threads(scan: tt.Model) -> None:
    assert np.array_equal(tt.render(scan, size=48, threads=1), tt.render(scan, size=48, threads=3))
    with pytest.raises(tt.Error, match="0 threads"):
        tt.render(scan, threads=0)


def test_a_listener_hears_and_stops(scan: tt.Model) -> None:
    heard: list[tuple[str, float]] = []

    def stop(stage: str, fraction: float) -> bool:
        heard.append((stage, fraction))
        return False

    with pytest.raises(tt.Cancelled):
        tt.render(scan, integrator="reference", spp=4096, size=256, progress=stop)
    assert heard[0][0] in ("prepare", "render") and 0 <= heard[0][1] <= 1

    def fail(stage: str, fraction: float) -> None:
        raise KeyError(stage)

    with pytest.raises(KeyError):
        tt.render(scan, integrator="reference", spp=4096, size=256, progress=fail)


def test_ctrl_c_stops_within_a_fifth_of_a_second(scan_file: Path) -> None:
    code = f"""
        import os, signal, threading, time, taotie as tt
        signal.signal(signal.SIGINT, signal.default_int_handler)  # shells ignore it for background jobs
        scan = tt.load({str(scan_file)!r})
        sent = []
        def send():
            time.sleep(0.5)
            sent.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=send).start()
        try:
            tt.render(scan, integrator="reference", spp=65536, size=512)
        except KeyboardInterrupt:
            print(time.perf_counter() - sent[0])
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    """
    ran = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=60)
    assert ran.returncode == 0, ran.stderr
    assert float(ran.stdout) < 0.2


def test_a_thousand_images_take_no_more_memory_than_ten(ball: tt.Mesh) -> None:
    def resident() -> int:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * 4096

    renderer = tt.Renderer(ball)
    for _ in range(50):
        renderer.render(size=64)
    before = resident()
    for _ in range(1000):
        renderer.render(size=64)
    assert resident() - before < 8 << 20
