"""Meshes of trimesh, PyVista and Open3D, as these packages make them."""

from __future__ import annotations

import importlib
import os
import platform
import sys
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image as Pillow

import taotie as tt

from conftest import sphere

CODES = np.array([[[250, 30, 20], [20, 240, 40]], [[30, 60, 250], [200, 200, 190]]], np.uint8)
UVS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def package(name: str) -> Any:
    """Return a package, or skip; in CI those that requirements.txt has for this system must exist."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return importlib.import_module(name)
        except OSError as error:
            pytest.skip(f"{name} lacks a library of the system: {error}")
        except ImportError:
            is_listed = sys.version_info >= (3, 11) and (name != "open3d" or _has_open3d())
            is_required = os.environ.get("CI") == "true" and is_listed
            assert not is_required, f"{name} is required: make tools"
            pytest.skip(f"pip install {name}")


def _has_open3d() -> bool:
    return sys.platform == "linux" and platform.machine() == "x86_64" and sys.version_info < (3, 13)


@pytest.fixture
def quad(tmp_path: Path) -> Path:
    """A square with a texture of four colours, as OBJ."""
    Pillow.fromarray(CODES).save(tmp_path / "quad.png")
    (tmp_path / "quad.mtl").write_text("newmtl a\nKd 0.8 0.8 0.8\nmap_Kd quad.png\n")
    corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    path = tmp_path / "quad.obj"
    path.write_text(f"mtllib quad.mtl\n{corners}usemtl a\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")
    return path


def seen(model: Any) -> np.ndarray:
    """Return the base colours that a camera in front sees."""
    found: np.ndarray = tt.render(model, linear=True, aov=["albedo"], size=24, camera=tt.Orbit(0, 0))["albedo"]
    return found


def caught(make: Any) -> tuple[Any, list[str]]:
    """Return a result and the warnings of Taotie about it."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        result = make()
    return result, [str(one.message) for one in found if issubclass(one.category, tt.TaotieWarning)]


def test_textures_of_trimesh_are_as_in_the_file(quad: Path) -> None:
    mesh = package("trimesh").load(quad, force="mesh")
    assert np.array_equal(tt.render(mesh, size=24), tt.render(quad, size=24))
    again = tt.Mesh(*sphere(16, 8), uvs=np.random.default_rng(1).random((114, 2))).to_trimesh()
    assert np.allclose(seen(tt.load(quad).to_trimesh()), seen(quad), equal_nan=True) and again.visual.uv.shape == (114, 2)


def test_colors_of_trimesh_are_srgb_for_vertices_and_faces() -> None:
    trimesh = package("trimesh")
    mesh = trimesh.creation.box()
    plain = tt.render(mesh, size=24)
    mesh.visual.vertex_colors = np.array([[10 * i, 200, 250 - i, 255] for i in range(8)], np.uint8)
    expected = tt.Mesh(mesh.vertices, mesh.faces, colors=np.asarray(mesh.visual.vertex_colors))
    assert np.array_equal(seen(mesh), seen(expected), equal_nan=True) and not np.array_equal(tt.render(mesh, size=24), plain)
    back = expected.to_trimesh()
    assert np.array_equal(back.visual.vertex_colors, mesh.visual.vertex_colors) and len(back.faces) == 12
    faces = trimesh.creation.box()
    faces.visual.face_colors = np.repeat(np.array([[255, 0, 0, 255], [0, 0, 255, 255]], np.uint8), 6, axis=0)
    colors = tt.Mesh(np.eye(3), [[0, 1, 2]], colors=np.array([[255, 0, 0], [0, 0, 255], [0, 0, 0]], np.uint8))
    shown = seen(faces)
    assert {tuple(color) for color in shown[~np.isnan(shown[:, :, 0])]} <= {tuple(c[:3]) for c in colors.arrays()["colors"]}


def test_materials_of_trimesh_survive_both_ways() -> None:
    trimesh = package("trimesh")
    pbr, image = trimesh.visual.material.PBRMaterial, Pillow.fromarray(CODES)
    material = pbr(
        name="clay", baseColorFactor=[51, 102, 255, 255], metallicFactor=0.25, roughnessFactor=0.5,
        emissiveFactor=[0.5, 0.25, 0.0], baseColorTexture=image, metallicRoughnessTexture=image,
        occlusionTexture=image, normalTexture=Pillow.fromarray(np.full((2, 2, 3), [128, 128, 255], np.uint8)),
        emissiveTexture=image, alphaMode="MASK", alphaCutoff=0.25, doubleSided=True,
    )  # fmt: skip
    vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    visual = trimesh.visual.TextureVisuals(uv=UVS, material=material)
    mesh = trimesh.Trimesh(vertices, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)
    model, warned = caught(lambda: _model(mesh))
    assert not warned
    back, warned = caught(model.to_trimesh)
    assert not warned and np.allclose(back.visual.uv, UVS) and back.faces.tolist() == mesh.faces.tolist()
    for name in ("name", "metallicFactor", "roughnessFactor", "alphaMode", "alphaCutoff", "doubleSided"):
        assert getattr(back.visual.material, name) == getattr(material, name), name
    assert np.array_equal(back.visual.material.baseColorFactor, material.baseColorFactor)
    assert np.allclose(back.visual.material.emissiveFactor, material.emissiveFactor)
    for name in ("baseColor", "metallicRoughness", "occlusion", "normal", "emissive"):
        assert np.array_equal(getattr(back.visual.material, f"{name}Texture"), getattr(material, f"{name}Texture")), name


def test_several_materials_of_trimesh_survive_both_ways() -> None:
    trimesh = package("trimesh")
    named = [trimesh.visual.material.PBRMaterial(name=name, baseColorFactor=c) for name, c in (("a", [255, 0, 0, 255]), ("b", [0, 0, 255, 255]))]
    several = trimesh.visual.material.MultiMaterial(named)
    box = trimesh.creation.box()
    kinds = np.arange(12) % 2
    box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=several, face_materials=kinds)
    model = _model(box)
    back = model.to_trimesh()
    assert model.triangles == 12 and [one.name for one in back.visual.material.materials] == ["a", "b"]
    assert np.bincount(back.visual.face_materials).tolist() == [6, 6]
    assert np.array_equal(seen(back), seen(box), equal_nan=True)


def test_scenes_of_trimesh_keep_their_transforms() -> None:
    trimesh = package("trimesh")
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box(), transform=trimesh.transformations.translation_matrix([1, 2, 3]))
    scene.add_geometry(trimesh.creation.icosphere(subdivisions=1))
    scene.add_geometry(trimesh.PointCloud(np.eye(3)))
    model, warned = caught(lambda: _model(scene))
    assert model.triangles == 12 + 80 and np.allclose(model.bounds, [[-1, -1, -1], [1.5, 2.5, 3.5]], atol=0.2)
    assert warned == ["left out a geometry without faces"]
    with pytest.raises(tt.InvalidType, match="PointCloud"):
        tt.render(trimesh.PointCloud(np.eye(3)))


def test_normals_of_trimesh_are_kept_if_it_has_some() -> None:
    trimesh = package("trimesh")
    mesh = trimesh.creation.box()
    tilted = np.tile([[0.0, 0.6, 0.8], [0.6, 0.0, 0.8]], (4, 1))
    mesh.vertex_normals = tilted
    assert np.allclose(_model(mesh).arrays()["normals"], tilted)


def test_a_texture_without_uvs_gives_a_warning() -> None:
    trimesh = package("trimesh")
    mesh = trimesh.creation.box()
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Pillow.fromarray(CODES))
    mesh.visual = trimesh.visual.TextureVisuals(material=material)
    with pytest.warns(tt.TaotieWarning, match="texture of a mesh without UVs"):
        tt.render(mesh, size=16)


def test_pyvista_meshes_keep_polygons_colors_normals_and_uvs() -> None:
    pyvista = package("pyvista")
    plane = pyvista.Plane(i_resolution=3, j_resolution=2, direction=(0, 0, 1))
    assert not plane.is_all_triangles
    codes = np.random.default_rng(3).integers(0, 256, (12, 3), dtype=np.uint8)
    plane.point_data["colors"] = codes
    model, warned = caught(lambda: _model(plane))
    arrays = model.arrays()
    assert not warned and model.triangles == 12 and np.allclose(arrays["normals"], [0, 0, 1])
    assert np.allclose(arrays["uvs"], np.asarray(plane.active_texture_coordinates) * [1, -1] + [0, 1])
    back = model.to_pyvista()
    assert np.array_equal(back.active_scalars[:, :3], codes) and back.n_cells == 12
    assert np.allclose(back.active_texture_coordinates, plane.active_texture_coordinates)
    assert np.allclose(back.point_data.active_normals, plane.point_data.active_normals)
    cells = pyvista.Plane(i_resolution=2, j_resolution=1, direction=(0, 0, 1))
    cells.cell_data["colors"] = np.array([[255, 0, 0], [0, 0, 255]], np.uint8)
    shown = seen(cells)
    assert {tuple(color) for color in shown[~np.isnan(shown[:, :, 0])]} == {(1, 0, 0), (0, 0, 1)}
    assert _model(pyvista.ImageData(dimensions=(3, 3, 3))).triangles == 48
    assert _model(pyvista.MultiBlock([plane, None, cells])).triangles == 16


def test_pyvista_gets_no_textures_without_a_warning(quad: Path) -> None:
    package("pyvista")
    mesh, warned = caught(tt.load(quad).to_pyvista)
    assert mesh.n_cells == 2 and np.allclose(np.sort(mesh.active_texture_coordinates, axis=0), np.sort(UVS, axis=0))
    assert len(warned) == 1 and "texture" in warned[0]
    _, warned = caught(lambda: _model(package("pyvista").Sphere().merge(package("pyvista").Line())))
    assert warned == ["left out a line or point of a mesh"]


def test_open3d_meshes_keep_textures_colors_and_normals(quad: Path) -> None:
    open3d = package("open3d")
    legacy = open3d.io.read_triangle_mesh(str(quad), True)
    tensors = open3d.t.io.read_triangle_mesh(str(quad), True)
    # The older class has no factors.
    assert np.allclose(seen(legacy) * 0.8, seen(quad), atol=1e-6, equal_nan=True)
    assert np.allclose(seen(tensors), seen(quad), atol=1e-6, equal_nan=True)
    box = open3d.geometry.TriangleMesh.create_box()
    box.paint_uniform_color([0.5, 0.25, 1.0])
    box.compute_vertex_normals()
    arrays = _model(box).arrays()
    assert np.allclose(arrays["colors"], [0.214041, 0.050876, 1, 1], atol=1e-5)
    assert np.allclose(arrays["normals"], np.asarray(box.vertex_normals))
    corners = np.random.default_rng(5).random((36, 2))
    box.triangle_uvs = open3d.utility.Vector2dVector(corners)
    arrays = _model(box).arrays()
    assert np.allclose(arrays["uvs"][arrays["faces"].reshape(-1)], corners * [1, -1] + [0, 1])
    assert len(arrays["faces"]) == 12


def test_open3d_gets_what_it_can_hold(quad: Path) -> None:
    package("open3d")
    mesh, warned = caught(tt.load(quad).to_open3d)
    assert np.allclose(seen(mesh) * 0.8, seen(quad), atol=1e-6, equal_nan=True)
    assert len(mesh.triangles) == 2 and len(warned) == 1 and "factors" in warned[0]
    codes = np.array([[250, 30, 20], [20, 240, 40], [30, 60, 250]], np.uint8)
    mesh, warned = caught(tt.Mesh(np.eye(3), [[0, 1, 2]], colors=codes).to_open3d)
    assert not warned and np.array_equal(np.rint(np.asarray(mesh.vertex_colors) * 255), codes)


def _model(mesh: Any) -> tt.Model:
    from taotie._model import model

    return model(mesh)


def test_the_base_colour_of_one_material_is_kept() -> None:
    package("trimesh")
    red = tt.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], material=tt.Material(base_color="#ff0000"))
    mesh = red.to_trimesh()
    assert mesh.visual.vertex_colors[0].tolist() == [255, 0, 0, 255]
