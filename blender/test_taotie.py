"""The add-on in Blender without a window: `make blender`. TAOTIE names the program."""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from types import SimpleNamespace

HERE = Path(__file__).parent
# Before Blender starts: it would install into the user's own folder.
USER = tempfile.TemporaryDirectory(prefix="taotie-user-")
os.environ["BLENDER_USER_RESOURCES"] = USER.name

import bpy  # noqa: E402
import numpy as np  # noqa: E402
import pytest  # noqa: E402
import scenes  # noqa: E402
from mathutils import Matrix  # noqa: E402
from mathutils.bvhtree import BVHTree  # noqa: E402

PACKAGE = "bl_ext.user_default.taotie"
MAPPED = 0.15
PROGRAM = os.environ.get("TAOTIE") or str(HERE.parent / "target/release/taotie")


@pytest.fixture(scope="session")
def installed(tmp_path_factory):
    """The add-on, installed from its zip file as a user does."""
    packed = tmp_path_factory.mktemp("zip") / "taotie-blender.zip"
    subprocess.run([sys.executable, HERE / "pack.py", packed], check=True)
    done = bpy.ops.extensions.package_install_files(filepath=str(packed), repo="user_default", enable_on_install=True)
    assert done == {"FINISHED"}
    return packed


@pytest.fixture
def form(installed):
    """The form in an empty scene."""
    scenes.clear()
    preferences().program = PROGRAM
    form = bpy.context.scene.taotie
    form.options = "--proof-points 2000 --proof-view 64"
    return form


def preferences():
    return bpy.context.preferences.addons[PACKAGE].preferences


def module(name):
    return sys.modules[f"{PACKAGE}.{name}"]


def left_behind():
    """The temporary folders of work."""
    return [path for path in Path(bpy.app.tempdir).iterdir() if not path.name.startswith("taotie-report-")]


def report(form):
    return json.loads(Path(json.loads(form.result)["page"]).with_suffix(".json").read_text(encoding="utf-8"))


def figure(form, name):
    return next(each["value"] for each in report(form)["certificate"]["figures"] if each["figure"] == name)


def attribute(mesh, name="taotie_error_deg"):
    values = np.empty(len(mesh.polygons), np.float32)
    mesh.attributes[name].data.foreach_get("value", values)
    return values


def areas(mesh):
    values = np.empty(len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("area", values)
    return values


def shown_mean(form):
    """The mean of the faces' errors by area, and the measured share of the area."""
    meshes = [thing.data for thing in form.mapped.objects]
    errors, weights = np.concatenate([attribute(m) for m in meshes]), np.concatenate([areas(m) for m in meshes])
    known = errors >= 0
    return float((errors * weights)[known].sum() / weights[known].sum()), float(weights[known].sum() / weights.sum())


def bounds(things):
    corners = np.array([thing.matrix_world @ vertex.co for thing in things for vertex in thing.data.vertices])
    return corners.min(0), corners.max(0)


def figures_agree(form, within=0.05):
    """Compares the faces with the report. Texels of the error map are at fixed places between those of a normal map, which
    makes a difference; without a map there is none."""
    mean, share = shown_mean(form)
    assert share > 0.98
    assert mean == pytest.approx(figure(form, "surface-mean-angle"), rel=within)


# --- The whole work


def test_package_is_valid_and_has_the_same_bytes_every_time(installed, tmp_path):
    again = tmp_path / "again.zip"
    subprocess.run([sys.executable, HERE / "pack.py", again], check=True)
    assert again.read_bytes() == installed.read_bytes()
    tool = Path(bpy.utils.resource_path("LOCAL")) / "scripts/addons_core/bl_pkg/cli/blender_ext.py"
    subprocess.run([sys.executable, tool, "validate", installed], check=True)


def test_bake_onto_a_low_object(form, tmp_path):
    form.high, form.low = scenes.pair()
    form.size, form.require, form.output = "512", "mean-angle=3,hausdorff=20%", str(tmp_path / "Ütput dir/asset.glb")
    assert bpy.ops.taotie.bake() == {"FINISHED"}

    (asset,) = form.made.objects
    assert asset.name == "low one asset"
    assert len(asset.data.polygons) == len(asset.data.loops) // 3 == 2 * 48 * 23
    low, high = bounds([asset]), bounds([form.low])
    assert np.allclose(low, high, atol=1e-5)

    nodes = asset.data.materials[0].node_tree.nodes
    (normal,) = [node for node in nodes if node.type == "NORMAL_MAP"]
    (link,) = normal.inputs["Color"].links
    assert link.from_node.image.colorspace_settings.name == "Non-Color" and link.from_node.image.packed_file
    assert tuple(link.from_node.image.size) == (512, 512)
    assert normal.outputs["Normal"].links[0].to_node.type == "BSDF_PRINCIPLED"
    (color,) = [node for node in nodes if node.type == "BSDF_PRINCIPLED"][0].inputs["Base Color"].links
    assert color.from_node.image.colorspace_settings.name == "sRGB"

    assert [path.name for path in sorted((tmp_path / "Ütput dir").iterdir())] == [
        "asset.glb",
        "asset.report.html",
        "asset.report.json",
    ]
    assert report(form)["certificate"]["verdict"] == json.loads(form.result)["verdict"] == "met"
    assert report(form)["high"] == "Über scan.glb"
    assert not left_behind()
    assert [scene.name for scene in bpy.data.scenes] == ["Scene"]
    figures_agree(form, MAPPED)


def test_maps_in_separate_files_are_kept(form, tmp_path):
    form.high, form.low = scenes.pair()
    form.size, form.output = "256", str(tmp_path / "plain.glb")
    form.options += " --maps normal,height"
    assert bpy.ops.taotie.bake() == {"FINISHED"}
    names = ["plain.glb", "plain.height.png", "plain.report.html", "plain.report.json"]
    assert sorted(path.name for path in tmp_path.iterdir()) == report(form)["files"] == names
    assert b'"plain.height.png"' in (tmp_path / "plain.glb").read_bytes(), "the asset states the map's file"
    assert not left_behind()


def test_verified_errors_agree_with_rays_of_blender(form):
    form.high, form.low = scenes.pair()
    assert bpy.ops.taotie.verify() == {"FINISHED"}
    figures_agree(form)
    (shown,) = form.mapped.objects
    form.show = "ORIGINALS"
    bpy.context.view_layer.update()
    angles = angles_by_rays(shown.data, form.high)
    known = np.isfinite(angles)
    assert known.mean() > 0.99
    weights = areas(shown.data)[known]
    mean = (angles[known] * weights).sum() / weights.sum()
    assert mean == pytest.approx(figure(form, "surface-mean-angle"), rel=0.05)
    # Errors of neighbours differ, so this fails if a map is mirrored or shifted.
    assert np.corrcoef(angles[known], attribute(shown.data)[known])[0, 1] > 0.9
    drawn, limit = drawn_degrees(form, shown.data), json.loads(form.result)["top"]
    centers = angles_by_rays(shown.data, form.high, POINTS[:1])
    assert np.abs(drawn - np.minimum(centers, limit))[known].mean() < 0.5


def drawn_degrees(form, mesh):
    """The errors at the centres of faces by the colours of the picture on it and of the legend."""
    image = next(node.image for node in mesh.materials[0].node_tree.nodes if node.type == "TEX_IMAGE")
    width, height = image.size
    pixels = np.array(image.pixels[:]).reshape(height, width, 4)[..., :3]
    stops = np.array([stop.color[:] for stop in form.stops])
    fine = np.stack([np.interp(np.linspace(0, 8, 201), np.arange(9), stops[:, i]) for i in range(3)], axis=1)
    found = []
    for face in mesh.polygons:
        u, v = np.mean([mesh.uv_layers["error"].data[i].uv for i in face.loop_indices], axis=0)
        color = pixels[int(v * height) % height, int(u * width) % width]
        found.append(np.argmin(((fine - color) ** 2).sum(1)) / 200 * json.loads(form.result)["top"])
    return np.array(found)


def angles_by_rays(mesh, high, points=None):
    """The angle between interpolated normals of both meshes, the mean of points of each triangle, degrees."""
    evaluated = high.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    evaluated.calc_loop_triangles()
    tree = BVHTree.FromPolygons([v.co for v in evaluated.vertices], [t.vertices for t in evaluated.loop_triangles])
    normals = [v.normal for v in evaluated.vertices]
    angles = []
    for face in mesh.polygons:
        corners, own = [mesh.vertices[i].co for i in face.vertices], [mesh.corner_normals[i].vector for i in face.loop_indices]
        found = [angle_at(tree, evaluated, normals, mixed(corners, at), mixed(own, at)) for at in points or POINTS]
        angles.append(np.mean(found))
    high.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh_clear()
    return np.array(angles)


POINTS = [(1 / 3, 1 / 3, 1 / 3), (2 / 3, 1 / 6, 1 / 6), (1 / 6, 2 / 3, 1 / 6), (1 / 6, 1 / 6, 2 / 3)]


def mixed(vectors, at):
    return sum((share * vector for share, vector in zip(at[1:], vectors[1:])), at[0] * vectors[0])


def angle_at(tree, mesh, normals, point, normal):
    normal = normal.normalized()
    place, _, number, _ = tree.ray_cast(point + 0.5 * normal, -normal, 1.0)
    if place is None:
        return np.nan
    corners = mesh.loop_triangles[number].vertices
    weights = barycentric([mesh.vertices[i].co for i in corners], place)
    return np.degrees(mixed([normals[i] for i in corners], weights).angle(normal))


def barycentric(corners, place):
    a, b, c = corners
    total = (b - a).cross(c - a)
    square = total.dot(total)
    u, v = (place - a).cross(c - a).dot(total) / square, (b - a).cross(place - a).dot(total) / square
    return 1 - u - v, u, v


def test_asset_of_a_search_is_unpacked_and_proved_again(form):
    form.high = scenes.sphere("scan", 96)
    scenes.displace(form.high)
    form.error = "2"
    assert bpy.ops.taotie.bake() == {"FINISHED"}
    seen, surface = figure(form, "mean-angle"), figure(form, "surface-mean-angle")
    figures_agree(form)
    assert seen < 2
    (form.low,) = form.made.objects
    assert bpy.ops.taotie.verify() == {"FINISHED"}
    assert figure(form, "mean-angle") == pytest.approx(seen, rel=0.05)
    assert figure(form, "surface-mean-angle") == pytest.approx(surface, rel=0.02)
    assert form.low.name in bpy.context.view_layer.objects
    figures_agree(form)


def test_lengths_follow_the_unit_of_the_scene_and_mirrored_children_stay_in_place(form):
    units = bpy.context.scene.unit_settings
    units.system, units.scale_length = "METRIC", 0.001
    high, low = scenes.pair()
    bpy.ops.object.empty_add(location=(30, -20, 10), rotation=(0.3, 0.2, 0.1))
    frame = bpy.context.object
    frame.scale = (-20, 30, 25)
    high.parent = low.parent = frame
    bpy.context.view_layer.update()
    form.high, form.low, form.size = high, low, "256"
    assert bpy.ops.taotie.bake() == {"FINISHED"}
    assert np.allclose(bounds(form.made.objects), bounds([low]), atol=1e-3)
    assert figure(form, "silhouette") < 15 and figure(form, "missed") < 0.001
    shape = dict(json.loads(form.result)["figures"])["shape error"]
    assert " mm " in shape
    assert not any("inside out" in warning or "turned" in warning for warning in json.loads(form.result)["warnings"])
    figures_agree(form, MAPPED)
    normals = form.made.objects[0].data.polygons
    middle = np.mean(bounds(form.made.objects), axis=0)
    outward = [np.dot(face.normal, np.array(face.center) - middle) > 0 for face in normals]
    assert all(outward)


def test_several_materials_and_objects(form):
    high, low = scenes.pair()
    low.data.materials.append(scenes.colored("upper", (0.2, 0.5, 0.8)))
    low.data.materials.append(bpy.data.materials.new("lower"))
    for face in low.data.polygons:
        face.material_index = int(face.center.z < 0)
    other = scenes.sphere("other", 24)
    other.location.x, other.parent = 2.5, low
    scan = scenes.sphere("other scan", 96)
    scan.location.x, scan.parent = 2.5, high
    scenes.displace(scan)
    bpy.context.view_layer.update()
    form.high, form.low, form.size = high, low, "256"
    assert bpy.ops.taotie.bake() == {"FINISHED"}
    assert len(form.made.objects) == 2
    figures_agree(form, MAPPED)
    materials = {m.name for thing in form.mapped.objects for m in thing.data.materials}
    assert len(materials) == 3


def test_hidden_objects_without_uvs(form):
    form.high, form.low = scenes.pair()
    form.low.data.uv_layers.remove(form.low.data.uv_layers[0])
    away = bpy.data.collections.new("away")
    bpy.context.scene.collection.children.link(away)
    for thing in (form.high, form.low):
        for old in thing.users_collection:
            old.objects.unlink(thing)
        away.objects.link(thing)
    form.high.hide_viewport = True
    bpy.context.view_layer.layer_collection.children["away"].exclude = True
    assert bpy.ops.taotie.verify() == {"FINISHED"}
    figures_agree(form)
    form.size = "256"
    assert bpy.ops.taotie.bake() == {"FINISHED"}
    figures_agree(form, MAPPED)
    assert figure(form, "surface-mean-angle") < 1


# --- The switch and the panel


def test_switch_shows_one_thing_at_a_time(form):
    form.high, form.low = scenes.pair()
    form.low.hide_render = True
    form.size = "256"
    assert bpy.ops.taotie.bake() == {"FINISHED"}

    def visible():
        return {thing.name for thing in bpy.context.view_layer.objects if not thing.hide_viewport}

    views = [area.spaces.active.shading for screen in bpy.data.screens for area in screen.areas if area.type == "VIEW_3D"]
    assert views
    before = [(view.light, view.color_type) for view in views]
    assert form.show == "ASSET" and visible() == {"low one asset"}
    form.show = "ERROR"
    assert visible() == {"low one error"}
    assert {(view.light, view.color_type) for view in views} == {("FLAT", "TEXTURE")}
    form.show = "ORIGINALS"
    assert [(view.light, view.color_type) for view in views] == before
    assert visible() == {"Über scan", "low one"}
    assert form.low.hide_render and not form.high.hide_render

    assert bpy.ops.taotie.bake() == {"FINISHED"}
    assert len([c for c in bpy.data.collections if c.name.startswith("low one error")]) == 1
    assert not [image for image in bpy.data.images if "error" in image.name and not image.users]


def test_panel_states_the_programs_own_figures(form):
    form.high, form.low = scenes.pair()
    form.size, form.require = "256", "mean-angle=0.01"
    assert bpy.ops.taotie.bake() == {"FINISHED"}
    form.show = "ERROR"
    drawn = []
    module("panel").TAOTIE_PT_panel.draw(SimpleNamespace(layout=Layout(drawn)), bpy.context)
    assert "Not met" in drawn and "normal error as seen" in drawn and "silhouette" in drawn
    assert any(text.startswith("requirement not met: mean-angle") for text in drawn)
    assert [text for text in drawn if text.endswith(" or more")] == ["10° or more"]
    assert len(form.stops) == 9 and drawn.count("color") == 9


class Layout:
    """Notes what a panel draws."""

    def __init__(self, drawn):
        self.drawn = drawn

    def label(self, text, icon="NONE"):
        self.drawn.append(text)

    def prop(self, _, name, **options):
        self.drawn.append(name)

    def operator(self, name, **options):
        return SimpleNamespace()

    def progress(self, factor, text):
        self.drawn.append(text)

    def row(self, **options):
        return self

    box = column = row


# --- Problems


def refused(message, operator):
    with pytest.raises(RuntimeError) as caught:
        operator()
    assert message in str(caught.value) and "Traceback" not in str(caught.value)
    assert not left_behind()
    assert [scene.name for scene in bpy.data.scenes] == ["Scene"]
    assert operator.poll()
    assert not [thing.name for thing in (*bpy.data.objects, *bpy.data.collections) if thing.name.endswith(("asset", "error"))]


def test_problems_are_messages(form):
    bake, verify = bpy.ops.taotie.bake, bpy.ops.taotie.verify
    refused("pick the high-poly object first", bake)
    form.high, low = scenes.pair()
    refused("pick the low-poly object to verify", verify)
    form.low = form.high
    refused("high and low are the same object, `Über scan`", bake)
    form.low = low
    form.size = "huge"
    refused("huge", bake)
    form.size, form.options = "256", "--maps 'normal"
    refused("invalid options `--maps 'normal`", bake)
    form.options, form.require = "", "beauty=1"
    refused("beauty", verify)
    form.require = ""
    full, low.data = low.data, bpy.data.meshes.new("empty")
    refused("`low one` has no faces", bake)
    low.data = full
    preferences().program = "/nowhere/taotie"
    refused("no program at `/nowhere/taotie`", bake)
    preferences().program = str(HERE / "pack.py")
    refused("cannot start", bake)


def test_a_missing_program_is_found_nowhere(form, monkeypatch):
    form.high, form.low = scenes.pair()
    preferences().program = ""
    monkeypatch.setenv("PATH", "")
    refused("taotie is not installed", bpy.ops.taotie.bake)


def test_meshes_far_apart_are_the_programs_error(form):
    form.high, form.low = scenes.pair()
    form.low.location.x = 50
    bpy.context.view_layer.update()
    form.size = "256"
    refused("do not overlap", bpy.ops.taotie.bake)


def test_a_finished_asset_is_kept_if_it_cannot_be_shown(form, tmp_path, monkeypatch):
    form.high, form.low = scenes.pair()
    form.size, form.output = "256", str(tmp_path / "asset.glb")

    def fail(*_):
        raise ValueError("the importer failed")

    monkeypatch.setattr(module("work"), "show_errors", fail)
    refused(f"the importer failed; the asset is complete: `{tmp_path}`", bpy.ops.taotie.bake)
    assert (tmp_path / "asset.glb").is_file() and (tmp_path / "asset.report.json").is_file()
    form.output = ""
    refused("the importer failed", bpy.ops.taotie.bake)


def test_packed_levels_of_detail_show_the_finest(form):
    form.high, _ = scenes.pair()
    form.triangles, form.size, form.options = "1000", "256", f"{form.options} --lods 300,100 --meshopt --images webp:80"
    assert bpy.ops.taotie.bake() == {"FINISHED"}
    assert [len(thing.data.polygons) for thing in (*form.made.objects, *form.mapped.objects)] == [1000, 1000]
    figures_agree(form, MAPPED)


def test_formats_unknown_to_blender_are_messages(form):
    form.high, _ = scenes.pair()
    form.triangles, form.size, fast = "1000", "256", form.options
    form.options = f"{fast} --images ktx2"
    refused("KHR_texture_basisu", bpy.ops.taotie.bake)
    form.options = f"{fast} --codecs web-latest --meshopt"
    refused("cannot import KHR_meshopt_compression into Blender", bpy.ops.taotie.bake)


# --- Cancelling


def test_escape_ends_the_program_and_leaves_no_files(form, tmp_path):
    form.high, form.low = scenes.pair()
    form.size, form.output = "2048", str(tmp_path / "asset.glb")
    panel = module("panel")
    said = []
    run = SimpleNamespace(report=lambda kind, text: said.append((kind, text)))
    for name in ("start", "step", "cancel", "leave", "modal", "say"):
        setattr(run, name, getattr(panel.Runs, name).__get__(run))
    run.work, run.fields, run.needs_low = panel.TAOTIE_OT_bake.work, panel.TAOTIE_OT_bake.fields, False
    assert run.start(bpy.context)
    assert not bpy.ops.taotie.bake.poll()
    own = ("", "starting", "exporting Über scan", "exporting low one")
    while panel.Runs.running[0] in own:
        assert run.step(bpy.context) is None
        time.sleep(0.02)
    assert 0 <= panel.Runs.running[1] <= 1
    assert children() and left_behind()
    assert run.modal(bpy.context, SimpleNamespace(type="ESC")) == {"CANCELLED"}
    assert said == [({"INFO"}, "cancelled")]
    assert not children() and not left_behind() and not list(tmp_path.iterdir())
    assert bpy.ops.taotie.bake.poll()


def children():
    return Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text().split()


# --- Transforms


def test_mirrored_and_stretched_normals_are_kept(form):
    thing = scenes.sphere("ball", 16)
    module("objects").transform(thing.data, Matrix.Diagonal((1, 1, -3, 1)))
    for vertex, normal in zip(thing.data.vertices, vertex_normals(thing.data)):
        x, y, z = vertex.co
        expected = np.array([x, y, z / 9])
        assert np.dot(normal, expected / np.linalg.norm(expected)) > 1 - 1e-3


def vertex_normals(mesh):
    normals = np.zeros((len(mesh.vertices), 3))
    for loop in mesh.loops:
        normals[loop.vertex_index] = mesh.corner_normals[loop.index].vector
    return normals
