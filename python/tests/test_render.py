"""Images: identical to the command's, to the bit; their shapes; threads, signals and progress."""

from __future__ import annotations

import inspect
import pickle
import re
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Pillow

import taotie as tt

from conftest import sphere

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


def test_light_and_output_variables_are_arrays(scan: tt.Model) -> None:
    aov = ["normals", "depth", "uv", "triangle", "albedo", "position"]
    found = tt.render(scan, linear=True, aov=aov, size=(40, 30))  # type: ignore[arg-type]
    shapes = {"color": (30, 40, 4), "normals": (30, 40, 3), "depth": (30, 40), "uv": (30, 40, 2)}
    shapes |= {"triangle": (30, 40), "albedo": (30, 40, 3), "position": (30, 40, 3)}
    assert {name: array.shape for name, array in found.items()} == shapes
    kinds = {name: np.uint32 if name == "triangle" else np.float32 for name in found}
    assert all(array.dtype == kinds[name] and array.flags.c_contiguous for name, array in found.items())
    seen = ~np.isnan(found["depth"])
    assert ((found["triangle"] == np.iinfo(np.uint32).max) == ~seen).all()
    corners = scan.arrays()["vertices"][scan.arrays()["faces"][found["triangle"][seen]]]
    points = found["position"][seen]
    assert (points >= corners.min(1) - 1e-5).all() and (points <= corners.max(1) + 1e-5).all()
    pixels = found.camera.project(points)
    assert np.abs(pixels[:, :2] - np.argwhere(seen)[:, ::-1] - 0.5).max() <= 0.5
    assert np.allclose(pixels[:, 2], found["depth"][seen], rtol=1e-5)
    assert pickle.loads(pickle.dumps(found)).camera.K.tolist() == found.camera.K.tolist()
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


def test_images_are_saved_by_their_names_or_refused(ball: tt.Mesh, tmp_path: Path) -> None:
    image = tt.render(ball, size=24)
    for name, kind, error in (("a.jpg", "JPEG", 12), ("a.JPEG", "JPEG", 12), ("a.webp", "WEBP", 0)):
        image.save(tmp_path / name, quality=95)
        read = Pillow.open(tmp_path / name)
        assert read.format == kind
        assert np.abs(np.asarray(read.convert("RGB"), float) - np.asarray(image)[:, :, :3]).mean() <= error
    with pytest.raises(tt.Error, match="no transparent pixels"):
        tt.render(ball, size=24, background="transparent").save(tmp_path / "b.jpg")
    with pytest.raises(tt.Error, match=r"\.png, \.jpg"):
        image.save(tmp_path / "a.bmp")
    assert not (tmp_path / "b.jpg").exists() and not (tmp_path / "a.bmp").exists()


def test_reductions_of_images_are_scalars(ball: tt.Mesh) -> None:
    image = tt.render(ball, size=24)
    for value in (image.mean(), image.sum(axis=None), image.max(), np.std(image), image[0, 0, 0], np.median(image)):
        assert isinstance(value, np.generic) and float(value) >= 0
    assert type(image + 1) is np.ndarray and type(image.mean(axis=2)) is np.ndarray
    again = pickle.loads(pickle.dumps(image))
    assert np.array_equal(again, image) and np.array_equal(again.camera.pose, image.camera.pose)
    assert image[:8].camera is None and np.array_equal(image.copy().camera.K, image.camera.K)
    shared = np.from_dlpack(image)
    assert np.shares_memory(shared, image) and np.array_equal(shared, image)


def test_other_packages_share_the_memory_of_results(ball: tt.Mesh) -> None:
    torch = pytest.importorskip("torch")
    image = tt.render(ball, size=24)
    assert torch.from_dlpack(image).shape == image.shape
    depth = tt.render(ball, size=24, linear=True, aov=["depth"])["depth"]
    assert np.shares_memory(torch.from_dlpack(depth).numpy(), depth)


def test_the_camera_of_an_image_takes_it_again(ball: tt.Mesh) -> None:
    for camera in (tt.Orbit(40, 20), tt.Camera(projection="orthographic"), tt.Camera(target=(0.2, 0, 0), fov_deg=50)):
        image = tt.render(ball, camera=camera, size=(48, 32))
        seen = image.camera
        assert seen.pose.shape == (4, 4) and np.allclose(seen.K[:2, 2], (24, 16)) and seen.near < 10
        again = tt.render(ball, camera=seen, size=(48, 32))
        assert np.abs(again.astype(int) - image).max() <= 1
    looking_down = tt.Camera(azimuth_deg=0, elevation_deg=90, projection="orthographic", height=4)
    found = tt.render(ball, camera=looking_down, linear=True, aov=["position"], size=(40, 40))
    assert found.camera.projection == "orthographic" and found.camera.K[0, 0] == 10
    x = found["position"][:, :, 0]
    across = (np.arange(40) + 0.5 - 20) / 10
    assert np.nanmax(np.abs(x - across)) <= 0.05


def test_intrinsics_place_the_image_in_a_larger_one(ball: tt.Mesh) -> None:
    pose = tt.render(ball, camera=tt.Orbit(30, 20), size=8).camera.pose
    whole = [[120, 0, 48], [0, 120, 32], [0, 0, 1]]
    part = [[120, 0, 40], [0, 120, 20], [0, 0, 1]]
    for integrator in ("raster", "reference"):
        options = {"linear": True, "integrator": integrator, "spp": 1, "samples": 1, "light": "point at=3,3,3"}
        larger = tt.render(ball, camera=tt.Camera(pose=pose, K=whole), size=(96, 64), **options)["color"]
        smaller = tt.render(ball, camera=tt.Camera(pose=pose, K=part), size=(64, 48), **options)["color"]
        cut = larger[12:60, 8:72]
        if integrator == "raster":
            assert np.allclose(smaller, cut, atol=1e-3)
        else:
            assert ((smaller[..., 3] > 0.5) == (cut[..., 3] > 0.5)).mean() > 0.97
    wide = tt.render(ball, camera=tt.Camera(pose=pose, K=[[60, 0, 32], [0, 120, 24], [0, 0, 1]]), size=(64, 48))
    assert np.allclose(wide.camera.K, [[60, 0, 32], [0, 120, 24], [0, 0, 1]])
    assert np.allclose(wide.camera.pose, pose)


@pytest.mark.parametrize(
    ("camera", "words"),
    [
        ({"pose": np.eye(3)}, r"pose: .*\(4, 4\)"),
        ({"pose": np.diag([2.0, 1, 1, 1])}, "rigid"),
        ({"pose": np.full((4, 4), np.nan)}, "finite"),
        ({"K": np.eye(3)}, "pose"),
        ({"pose": np.eye(4), "K": np.zeros((3, 3))}, "fx and fy"),
        ({"projection": "fisheye"}, "perspective or orthographic"),
        ({"name": "a", "pose": np.eye(4)}, "camera 'a'"),
        ({"height": 2}, "orthographic"),
    ],
)
def test_impossible_cameras_are_refused(ball: tt.Mesh, camera: dict[str, Any], words: str) -> None:
    with pytest.raises(tt.Error, match=words):
        tt.render(ball, camera=tt.Camera(**camera), size=8)


def test_environments_are_arrays_too(ball: tt.Mesh, tmp_path: Path) -> None:
    room = tmp_path / "room.hdr"
    room.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n" + bytes([128, 64, 128, 128]) * 32)
    array = np.tile(np.float32((0.5, 0.25, 0.5)), (4, 8, 1))
    for options in ({}, {"integrator": "reference", "spp": 2}):
        expected = tt.render(ball, env=room, size=24, **options)
        assert np.array_equal(tt.render(ball, env=array, size=24, **options), expected)
    dim = tt.Environment(array.astype(float), intensity=0.5, visible=True)
    assert "\n" not in repr(dim) and tt.render(ball, env=dim, size=24)[0, 0, 0] > 100
    assert tt.view(ball, env=array).html() and tt.compare(ball, env=array, methods=["smooth"], size=32)
    for wrong in (array.astype(np.uint8), array[0]):
        with pytest.raises(tt.Error, match="env: .*expected"):
            tt.render(ball, env=wrong, size=8)


def square(**options: Any) -> tt.Mesh:
    """Return a square that faces the viewer."""
    corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    return tt.Mesh(corners, [[0, 1, 2], [0, 2, 3]], uvs=[[0, 1], [1, 1], [1, 0], [0, 0]], **options)


def test_textures_are_arrays_too(tmp_path: Path) -> None:
    random = np.random.default_rng(5)
    front: Any = {"camera": tt.Orbit(0, 0), "size": 32}
    color = random.integers(0, 255, (16, 16, 3), np.uint8)
    bumps = tt.normals.from_height(random.random((16, 16), np.float32), scale=1)
    codes = np.round(bumps * 127.5 + 127.5).astype(np.uint8)
    for name, texels in (("base_color_map", color), ("normal_map", codes), ("occlusion_map", color)):
        Pillow.fromarray(texels).save(tmp_path / "map.png")
        file, array = (square(material=tt.Material(**{name: value})) for value in (tmp_path / "map.png", texels))
        assert np.array_equal(tt.render(file, **front), tt.render(array, **front)), name
    plain = tt.render(square(), **front)
    exact = tt.render(square(material=tt.Material(normal_map=bumps)), **front)
    coded = tt.render(square(material=tt.Material(normal_map=codes)), **front)
    assert np.abs(exact.astype(int) - coded).max() <= 6 and not np.array_equal(exact, plain)
    rough = np.zeros((4, 4, 3), np.uint8)
    rough[..., 1] = 255
    smooth = tt.Material(metallic_roughness_map=rough // 4)
    assert not np.array_equal(*(tt.render(square(material=m), **front) for m in (smooth, tt.Material(metallic_roughness_map=rough))))
    light: Any = {"light": tt.Light("point", at=(0, 0, -9)), "background": "black", "linear": True, **front}
    glow = square(material=tt.Material(emissive_map=np.full((2, 2, 3), 0.5, np.float32), emissive=(1, 0.5, 0)))
    assert np.allclose(tt.render(glow, **light)["color"][16, 16, :3], (0.5, 0.25, 0), atol=1e-3)
    albedo = tt.render(square(material=tt.Material(base_color_map=np.full((2, 2), 0.5, np.float32))), **light, aov=["albedo"])
    assert np.allclose(albedo["albedo"][16, 16], 0.5)
    with pytest.raises(tt.Error, match="normal_map"):
        square(material=tt.Material(normal_map=np.full((2, 2, 3), np.nan, np.float32)))
    for wrong in (dict(base_color_map=np.full((2, 2, 3), 188.0)), dict(base_color=(200, 100, 50))):
        with pytest.raises(tt.InvalidValue, match="base_color.*0 to 1"):
            square(material=tt.Material(**wrong))  # type: ignore[arg-type]
    assert repr(tt.Material(base_color_map=color, metallic=1)) == "Material(metallic=1, base_color_map=<uint8 (16, 16, 3)>)"


def test_scenes_place_their_models_and_are_saved(ball: tt.Mesh, tmp_path: Path) -> None:
    aside, turned = np.eye(4), np.diag([-1.0, 1, -1, 1])
    aside[0, 3] = 3
    red = square(material=tt.Material(base_color_map=np.full((2, 2, 3), (255, 0, 0), np.uint8)))
    scene = tt.Scene([ball, (ball, aside), (red, turned @ aside)])
    assert scene.triangles == 2 * ball.triangles + 2 and repr(scene) == f"<taotie.Scene {scene.triangles} triangles>"
    assert np.allclose(scene.bounds[:, 0], (-4, 4), atol=0.05)
    assert len(scene.inspect().meshes) == 2
    for name in ("scene.glb", "scene.gltf"):
        scene.save(tmp_path / name)
        again = tt.load(tmp_path / name)
        assert again.triangles == scene.triangles
        assert np.abs(tt.render(again, size=48).astype(int) - tt.render(scene, size=48)).mean() < 1
        with pytest.raises(tt.Error, match=name):
            again.save(tmp_path / name)
    for wrong, words in ((ball, "objects"), ([(ball, np.eye(3))], "transform")):
        with pytest.raises(tt.Error, match=words):
            tt.Scene(wrong)  # type: ignore[arg-type]
    with pytest.raises(tt.Error, match="ply"):
        ball.save(tmp_path / "ball.ply")


def test_a_device_is_used_or_its_absence_explained(ball: tt.Mesh) -> None:
    assert tt.Renderer(ball).device == "cpu" and "cpu" in repr(tt.Renderer(ball))
    expected = tt.render(ball, size=24)
    auto = tt.Renderer(ball, device="auto")
    assert np.abs(auto.render(size=24).astype(int) - expected).max() <= (0 if auto.device == "cpu" else 8)
    try:
        gpu = tt.Renderer(ball, device="gpu")
    except tt.Error as error:
        assert "GPU" in str(error)
        return
    assert gpu.device != "cpu"
    assert np.abs(gpu.render(size=24).astype(int) - expected).max() <= 8
    with pytest.raises(tt.Error, match="device"):
        gpu.render(size=24, integrator="reference")


def test_a_turntable_reports_all_of_its_images(ball: tt.Mesh) -> None:
    heard: list[float] = []
    tt.Renderer(ball).turntable(3, size=400, samples=16, progress=lambda stage, done: heard.append(done))
    assert heard == sorted(heard) and all(0 <= done <= 1 for done in heard)


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
    with pytest.raises(tt.Error, match="threads 0"):
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


def test_a_parallel_camera_sees_all_of_an_object_that_turns() -> None:
    vertices, faces = sphere(12, 8)
    long = tt.Mesh(vertices * (0.3, 0.3, 3), faces)
    camera = tt.Camera(azimuth_deg=0, elevation_deg=0, projection="orthographic")
    for frame in tt.Renderer(long).turntable(4, size=48, camera=camera, background="transparent"):
        assert frame[24, 24, 3] > 0
        assert frame[:, [0, -1], 3].max() == 0
        assert frame[[0, -1], :, 3].max() == 0
