"""Renders a scan, its asset and the error on its surface, side by side, for docs/blender.md: PROGRAM ZIP OUT.png."""

import argparse
import math
import os
import tempfile
from pathlib import Path

USER = tempfile.TemporaryDirectory(prefix="taotie-user-")
os.environ["BLENDER_USER_RESOURCES"] = USER.name

import bpy  # noqa: E402
import numpy as np  # noqa: E402
import scenes  # noqa: E402

SIDE, SAMPLES = 420, 32


def arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="taotie")
    parser.add_argument("package", help="taotie-blender.zip")
    parser.add_argument("output", help="PNG to write")
    return parser.parse_args()


def bake():
    form = bpy.context.scene.taotie
    high = scenes.sphere("scan", 512, scenes.colored("clay", (0.8, 0.45, 0.3)))
    scenes.displace(high, strength=0.2, scale=0.35)
    form.high, form.triangles, form.size = high, "1500", "256"
    bpy.ops.taotie.bake()


def set_up():
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", SAMPLES, "CPU"
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    scene.view_settings.view_transform = "Standard"
    world = scene.world = bpy.data.worlds.new("grey")
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.1, 0.1, 0.1, 1)
    bpy.ops.object.light_add(type="SUN", rotation=(math.radians(60), 0, math.radians(-60)))
    bpy.context.object.data.energy = 3
    bpy.ops.object.camera_add(location=(0, -4.4, 0), rotation=(math.radians(90), 0, 0))
    scene.camera = bpy.context.object


def rendered(show, folder):
    scene = bpy.context.scene
    scene.taotie.show = show
    scene.render.filepath = str(Path(folder) / f"{show}.png")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.array(image.pixels[:], np.float32)
    return pixels.reshape(SIDE, SIDE, 4)


def add_legend(picture):
    """Draws the colours of the legend at the lower edge."""
    stops = np.array([stop.color[:] for stop in bpy.context.scene.taotie.stops])
    left, right = SIDE // 8, SIDE - SIDE // 8
    at = np.linspace(0, len(stops) - 1, right - left)
    bar = np.stack([np.interp(at, np.arange(len(stops)), stops[:, i]) for i in range(3)], axis=1)
    picture[12:24, left:right, :3] = bar


def main():
    args = arguments()
    bpy.ops.extensions.package_install_files(filepath=os.path.abspath(args.package), repo="user_default")
    scenes.clear()
    bpy.context.preferences.addons["bl_ext.user_default.taotie"].preferences.program = os.path.abspath(args.program)
    bake()
    set_up()
    with tempfile.TemporaryDirectory() as folder:
        pictures = [rendered(show, folder) for show in ("ORIGINALS", "ASSET", "ERROR")]
    add_legend(pictures[-1])
    row = np.concatenate(pictures, axis=1)
    image = bpy.data.images.new("row", 3 * SIDE, SIDE)
    image.pixels.foreach_set(np.ascontiguousarray(row).ravel())
    image.filepath_raw, image.file_format = os.path.abspath(args.output), "PNG"
    image.save()
    print(bpy.context.scene.taotie.result)


if __name__ == "__main__":
    main()
