"""Typical user code, only for the type checkers: it is not run."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

import taotie as tt


def bake_and_prove(path: str) -> float:
    scan = tt.load(path, progress=True)
    asset = tt.bake(scan, triangles=50_000, size=2048, maps=["normal", "ao"])
    proof = asset.verify(scan)
    met: list[tt.Met] = proof.require(mean_angle=0.5)
    files: list[str] = asset.save("scan.glb", images="ktx2").files
    return proof.mean_deg if met and files else 0.0


def look(asset: tt.Asset) -> tuple[tt.Image, npt.NDArray[np.float32]]:
    image: tt.Image = tt.render(asset, shading="ggx", camera=tt.Orbit(14, 10), size=(640, 480))
    light: dict[str, npt.NDArray[np.float32]] = tt.render(asset, linear=True, aov=["normals", "depth"])
    frames: list[tt.Image] = tt.Renderer(asset, env="studio").turntable(36)
    return frames[0] if frames else image, light["depth"]


def light(asset: tt.Asset, camera: tt.Camera) -> list[tt.Buffers]:
    lights = [tt.Light("directional", from_deg=(-75, 10), strength=4), tt.Light("point", at=(1, 2, 3))]
    options: tt.RenderOptions = {"env": tt.Environment("studio", rotation_deg=30), "light": lights, "size": 256}
    image: tt.Image = tt.render(asset, **options)
    image.save("image.png")
    tt.view(asset, light=["point at=1,2,3", *lights], camera=tt.Camera("front"), fov_deg=20)
    return tt.Renderer(asset, surface="facet").turntable(36, linear=True, aov=["depth"], camera=camera)


def turn(asset: tt.Asset, scan: tt.Model) -> str:
    page: tt.Viewer = tt.view(asset, scan=scan, camera=tt.Orbit(14, 10), env="studio")
    page.save("proof.html")
    return page.html()


def measure(low: str, high: str) -> dict[str, Any]:
    found = tt.compare(low, high, methods=["smooth", "tangent-normal"])
    error: float | None = tt.diff("a.png", "b.png").flip
    report: tt.Inspection = tt.inspect(low)
    audit: tt.Audit = tt.inspect(low, audit="schema.json")
    assert audit.passed
    heights: npt.NDArray[np.float32] = tt.normals.from_height(np.zeros((4, 4)), scale=2)
    value, by = tt.shade.gradient("d_ggx", "alpha", n_dot_h=0.9, alpha=heights)
    assert error is None or by["alpha"].shape == value.shape
    return {**found.to_dict(), **report.to_dict()}


def photograph(images: list[npt.NDArray[np.uint16]], lights: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    found: tt.PhotometricNormals = tt.photometric(images, lights=lights, encoding="linear", progress=True)
    found.save("relief")
    inside: npt.NDArray[np.bool_] = tt.photometric("coin/dome.lp", pixel_size=0.05).mask
    return found.normals if inside.any() else found.sigma


def see(asset: tt.Asset, pose: npt.NDArray[np.float64], sky: npt.NDArray[np.float32]) -> npt.NDArray[np.uint32]:
    paint = tt.Material(base_color_map=np.zeros((8, 8, 3), np.uint8), emissive_map="glow.png", emissive=0.5)
    scene = tt.Scene([asset, (tt.load("plate.glb", material=paint), pose)])
    scene.save("scene.glb")
    image: tt.Image = tt.render(scene, camera=tt.Camera(pose=pose, K=np.eye(3)), env=sky, device="auto")
    seen: tt.Buffers = tt.render(scene, camera=image.camera, linear=True, aov=["position", "triangle"])
    return seen["triangle"]


def misspell(asset: tt.Asset, scan: tt.Model) -> None:
    tt.verify("asset.glb", scan, point=1000)  # type: ignore[call-arg]
    asset.verify(scan, points="many")  # type: ignore[arg-type]
    asset.verify(scan, veiw=64)  # type: ignore[call-arg]
    asset.save("asset.glb").verify(scan, maps=64)  # type: ignore[call-arg]
    tt.Renderer(asset).turntable(36, sizes=64)  # type: ignore[call-overload]
    tt.render(asset, device="tpu")  # type: ignore[call-overload]
