"""Objects of Blender as files of the program, and back."""

import contextlib

import bpy
import numpy as np
from mathutils import Matrix

from .glb import Glb
from .problem import Problem

KINDS = {"MESH", "CURVE", "SURFACE", "META", "FONT"}

# Corners keep their attributes if faces are reversed.
SAVED = "taotie_normal"


def parts_of(thing):
    """Returns an object and all below it, as far as they have a surface."""
    return [part for part in [thing, *thing.children_recursive] if part.type in KINDS]


def transform(mesh, matrix):
    """Moves a mesh with its normals, exactly, also if the matrix mirrors or stretches."""
    linear = np.array(matrix.to_3x3())
    keeps = mesh.has_custom_normals or not _is_similarity(linear)
    if keeps:
        _save_normals(mesh, np.linalg.pinv(linear))
    mesh.transform(matrix)
    if np.linalg.det(linear) < 0:
        mesh.flip_normals()
    if keeps:
        _restore_normals(mesh)


def _is_similarity(linear):
    squares = linear.T @ linear
    return np.allclose(squares, np.eye(3) * np.trace(squares) / 3, rtol=0, atol=1e-6 * np.trace(squares))


def _save_normals(mesh, inverse):
    normals = np.empty(3 * len(mesh.loops), np.float32)
    mesh.corner_normals.foreach_get("vector", normals)
    moved = normals.reshape(-1, 3) @ inverse
    moved /= np.maximum(np.linalg.norm(moved, axis=1, keepdims=True), 1e-30)
    saved = mesh.attributes.new(SAVED, "FLOAT_VECTOR", "CORNER")
    saved.data.foreach_set("vector", moved.astype(np.float32).ravel())


def _restore_normals(mesh):
    normals, saved = np.empty(3 * len(mesh.loops), np.float32), mesh.attributes[SAVED]
    saved.data.foreach_get("vector", normals)
    mesh.attributes.remove(saved)
    mesh.normals_split_custom_set(normals.reshape(-1, 3))


@contextlib.contextmanager
def staged(originals, scale):
    """A temporary scene with the evaluated meshes of objects, also hidden ones, in metres and world space.

    Also yields the names of the objects by those of the copies.
    """
    scene, made, names = bpy.data.scenes.new("Taotie"), [], {}
    try:
        copies = [_copy_into(scene, original) for original in originals]
        made += copies
        layer = scene.view_layers[0]
        layer.update()
        for original, copy in zip(originals, copies):
            evaluated = copy.evaluated_get(layer.depsgraph)
            mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=layer.depsgraph)
            plain = bpy.data.objects.new(original.name, mesh)
            made += [plain, mesh]
            names |= {plain.name: original.name, mesh.name: original.name}
            transform(mesh, Matrix.Scale(scale, 4) @ copy.matrix_world)
            scene.collection.objects.link(plain)
        for copy in copies:
            scene.collection.objects.unlink(copy)
        yield scene, names
    finally:
        bpy.data.batch_remove([*made, scene])


def _copy_into(scene, original):
    copy = original.copy()
    copy.parent = None
    copy.constraints.clear()
    copy.hide_viewport = False
    copy.matrix_world = original.matrix_world
    scene.collection.objects.link(copy)
    return copy


def export(context, thing, path):
    """Writes an object and all below it as binary glTF, in metres."""
    window, parts = context.window or context.window_manager.windows[0], parts_of(thing)
    before = window.scene
    with staged(parts, context.scene.unit_settings.scale_length) as (scene, names):
        if not any(len(part.data.polygons) for part in scene.objects):
            raise Problem(f"`{thing.name}` has no faces: pick an object with a surface")
        window.scene = scene
        try:
            bpy.ops.export_scene.gltf(
                filepath=str(path),
                export_format="GLB",
                use_active_scene=True,
                export_animations=False,
                export_skins=False,
                export_morph=False,
            )
        finally:
            window.scene = before
    glb = Glb(path)
    for named in (*glb.json["nodes"], *glb.json["meshes"]):
        named["name"] = names.get(named["name"], named["name"])
    glb.save(path)


def load(context, path, collection):
    """Imports a file into a collection, as meshes in world space; Blender's importer converts metres to the scene's unit."""
    known = set(bpy.data.objects)
    bpy.ops.import_scene.gltf(filepath=str(path), import_scene_as_collection=False, import_merge_material_slots=False)
    context.view_layer.update()
    fresh = [thing for thing in bpy.data.objects if thing not in known]
    worlds = {thing: thing.matrix_world.copy() for thing in fresh}
    meshes = [thing for thing in fresh if thing.type == "MESH"]
    for thing in meshes:
        thing.parent = None
        thing.data = thing.data.copy() if thing.data.users > 1 else thing.data
        transform(thing.data, worlds[thing])
        thing.matrix_world = Matrix()
        for old in thing.users_collection:
            old.objects.unlink(thing)
        collection.objects.link(thing)
        part = "" if len(meshes) == 1 else f" {thing.name}"
        thing.name = thing.data.name = f"{collection.name}{part}"
    bpy.data.batch_remove([thing for thing in fresh if thing.type != "MESH"])
    return meshes


@contextlib.contextmanager
def new_collection(context, name):
    """A collection in the scene, which is removed with its objects if the work on it fails."""
    known = set(bpy.data.objects)
    collection = bpy.data.collections.new(name)
    context.scene.collection.children.link(collection)
    try:
        yield collection
    except BaseException:
        bpy.data.batch_remove([*(thing for thing in bpy.data.objects if thing not in known), collection])
        raise
