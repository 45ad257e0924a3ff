"""One bake with Blender in a separate process; the last line of output is JSON: seconds of each step, peak memory.

The scan is baked onto the low-poly mesh ("selected to active"), like `taotie bake --low`.
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
    parser.add_argument("--size", type=int, default=2048, help="width and height in texels")
    parser.add_argument("--samples", type=int, default=1, help="samples per texel; rays for ao")
    parser.add_argument("--extrusion", type=float, required=True, help="distance of the rays' origins, model units")
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


def load_scan(path):
    # Keep the file's axes; the importer's default is Z upward, which rotates nothing.
    bpy.ops.wm.ply_import(filepath=path, forward_axis="Y", up_axis="Z")
    scan = bpy.context.view_layer.objects.active
    scan.data.shade_smooth()
    return scan


def build_low(path):
    """The low-poly mesh with the exact normals and uvs of the file; Blender computes tangents from them."""
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
    """The image to bake into, in a new material of the low-poly mesh."""
    low.data.materials.append(bpy.data.materials.new("low"))
    return cycles_bake.add_image(low.data.materials[0], size).image


def save(image, path):
    image.filepath_raw = os.path.abspath(path)  # a bare name would refer to the folder of a .blend file
    image.file_format = "PNG"
    image.save()


def main():
    args, clock = arguments(), Clock()
    global bpy, cycles_bake, np
    with clock.step("import"):
        import bpy
        import cycles_bake
        import numpy as np
    with clock.step("load"):
        cycles_bake.set_up(args.samples, args.extrusion, args.margin)
        scan, low = load_scan(args.scan), build_low(args.low)
        image = add_image(low, args.size)
    with clock.step("bake"):
        cycles_bake.bake(scan, low, args.map)
    with clock.step("save"):
        save(image, args.output)
    seconds = {name: round(value, 3) for name, value in clock.seconds.items()}
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)
    total = round(sum(clock.seconds.values()), 3)
    print(json.dumps({"version": bpy.app.version_string, **seconds, "total": total, "peak_mib": round(peak)}))


if __name__ == "__main__":
    main()
