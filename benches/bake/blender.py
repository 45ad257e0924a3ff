"""One bake by Blender in a process of its own; the last line it prints is JSON: seconds of each step, peak memory.

The scan is laid onto the low-poly mesh ("selected to active"), as `taotie bake --low` does.
"""

import argparse
import contextlib
import json
import os
import resource
import sys
import time


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scan", help="PLY")
    parser.add_argument("low", help="low.npz of scene.py")
    parser.add_argument("output", help="PNG to write")
    parser.add_argument("--map", choices=["normal", "ao"], default="normal")
    parser.add_argument("--size", type=int, default=2048, help="texels across and down")
    parser.add_argument("--samples", type=int, default=1, help="samples a texel; of ao, rays")
    parser.add_argument("--extrusion", type=float, required=True, help="where rays begin, model units")
    parser.add_argument("--margin", type=int, default=16, help="texels")
    return parser.parse_args()


class Clock:
    """Seconds by the name of the step."""

    def __init__(self):
        self.seconds = {}

    @contextlib.contextmanager
    def step(self, name):
        start = time.perf_counter()
        yield
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start


def set_up(args):
    """An empty scene, and Cycles without anything that would change the number of samples."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = args.samples
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    bake = scene.render.bake
    bake.use_selected_to_active = True
    bake.cage_extrusion = args.extrusion
    bake.max_ray_distance = 0.0
    bake.margin = args.margin
    bake.normal_space = "TANGENT"


def load_scan(path):
    # The file's axes as they are; the importer's own choice is Z upward, which turns nothing.
    bpy.ops.wm.ply_import(filepath=path, forward_axis="Y", up_axis="Z")
    scan = bpy.context.view_layer.objects.active
    scan.data.shade_smooth()
    return scan


def build_low(path):
    """The low-poly mesh with the very normals and uvs of the file; Blender makes the tangents of them."""
    low = np.load(path)
    corners = low["triangles"].ravel()
    mesh = bpy.data.meshes.new("low")
    mesh.vertices.add(len(low["positions"]))
    mesh.vertices.foreach_set("co", low["positions"].ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(len(corners) // 3)
    mesh.polygons.foreach_set("loop_start", np.arange(0, len(corners), 3, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.uv_layers.new(name="uv").data.foreach_set("uv", low["uvs"][corners].ravel())
    mesh.shade_smooth()
    mesh.normals_split_custom_set_from_vertices(low["normals"].tolist())
    thing = bpy.data.objects.new("low", mesh)
    bpy.context.collection.objects.link(thing)
    return thing


def add_image(low, size):
    """The picture to bake into: the active image of the low-poly mesh's material."""
    image = bpy.data.images.new("map", size, size, alpha=False, float_buffer=False)
    image.colorspace_settings.name = "Non-Color"
    material = bpy.data.materials.new("low")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    low.data.materials.append(material)
    return image


def bake(scan, low, kind):
    bpy.ops.object.select_all(action="DESELECT")
    scan.select_set(True)
    low.select_set(True)
    bpy.context.view_layer.objects.active = low
    bpy.ops.object.bake(type=kind.upper())


def save(image, path):
    image.filepath_raw = os.path.abspath(path)  # a bare name would mean the folder of a .blend file
    image.file_format = "PNG"
    image.save()


def main():
    args, clock = arguments(), Clock()
    global bpy, np
    with clock.step("import"):
        import bpy
        import numpy as np
    with clock.step("load"):
        set_up(args)
        scan, low = load_scan(args.scan), build_low(args.low)
        image = add_image(low, args.size)
    with clock.step("bake"):
        bake(scan, low, args.map)
    with clock.step("save"):
        save(image, args.output)
    seconds = {name: round(value, 3) for name, value in clock.seconds.items()}
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)
    total = round(sum(clock.seconds.values()), 3)
    print(json.dumps({"version": bpy.app.version_string, **seconds, "total": total, "peak_mib": round(peak)}))


if __name__ == "__main__":
    main()
