"""Compares Taotie's maps of a generated pair with Blender's and with rays by Embree: `make bench-maps`."""

import json
import os
import sys

import numpy as np
from PIL import Image

import command
import map_section
import measure
import page
import pair
import png
import true_maps
from accuracy import angles
from command import say
from frames import unit
from map_rows import Comparison, Result, Row, apart, differ, lengths, most_apart, uniform

TARGET = "bench-maps"
HERE = os.path.dirname(os.path.abspath(__file__))
# Length of projection rays, distance within which surfaces occlude, and radius of rounded edges; model units.
EXTRUSION, AO_DISTANCE, BEVEL_RADIUS = 0.4, 0.5, 0.05
# Rays per texel; and the texels at which Embree casts rays, and at which edges are rounded without rays.
RAYS, TRUE_TEXELS, BEVEL_TEXELS = 512, 10_000, 500
MAPS = (
    "normal,ao,bent,height,curvature,metallic-roughness,albedo,position,world-normal,thickness,vertex-color,"
    "material-id,object-id,wireframe,bevel,vector-displacement"
)
# Texels closer to the border of an island are not compared.
BORDER = 2
# Texels within a bevel's radius, at least.
ALONE = 10
# Taotie shows another point than the outermost one if it is below it by more than this, model units.
HIDDEN = 2e-5
SEED = 3


def arguments():
    parser = command.parser(__doc__, TARGET)
    parser.set_defaults(page=os.path.join(command.ROOT, "docs/benchmarks.md"))
    taotie = os.path.join(command.PROGRAMS, "taotie")
    parser.add_argument("--taotie", default=taotie, help="the program that bakes")
    parser.add_argument("--size", type=int, default=512, help="width and height of the maps [default: 512]")
    parser.add_argument("--images", action="store_true", help="write an image of each difference into the folder")
    parser.add_argument("--quick", action="store_true", help="64 rays; prints without writing the page")
    args = parser.parse_args()
    command.check_program(parser, args.taotie)
    return args


def taotie(program, folder, output, size, rays, distance, more=()):
    """Bakes `output`, maps and their file, with Taotie and returns its report."""
    maps, file = output
    # One sample, at the centre of the texel, as in Blender. Rays follow the vertex normals there, so also here.
    options = ["--samples", "1", "--skew", "keep", "--ray-distance", EXTRUSION, "--bits", 16, "--dilation", 0]
    options += ["--ao-rays", rays, "--ao-distance", distance, "--size", size, "--no-verify", "--json"]
    bake = [program, "bake", f"{folder}/high.glb", "--low", f"{folder}/low.glb"]
    bake += ["-o", f"{folder}/{file}", "--maps", maps]
    return json.loads(measure.run([str(word) for word in (*bake, *options, *more)]).output)


def blender(folder, size, rays, colors):
    """Bakes all of Blender's maps, and returns them by name."""
    path = f"{folder}/colors.json"
    with open(path, "w", encoding="utf-8") as file:
        json.dump(colors, file)
    options = {"size": size, "samples": rays, "extrusion": EXTRUSION}
    options |= {"ao-distance": AO_DISTANCE, "bevel-radius": BEVEL_RADIUS}
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    script = os.path.join(HERE, "blender_maps.py")
    measure.run([sys.executable, script, f"{folder}/pair.npz", f"{folder}/blender.npz", path, *words])
    return dict(np.load(f"{folder}/blender.npz"))


def read(folder, report):
    """Taotie's maps by name, in the units of the report."""
    maps = {}
    for entry in report["maps"]:
        texels = png.read(os.path.join(folder, entry["file"]))
        if entry["black"] is not None:
            texels = entry["black"] + texels * (entry["white"] - entry["black"])
        maps[entry["map"]] = texels + np.array(entry.get("origin") or 0)
    return maps


def srgb_codes(linear):
    linear = np.clip(linear, 0, 1)
    return 255 * np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


def legend(report, name):
    """RGB in [0, 1] of each thing."""
    colors = next(entry["legend"] for entry in report["maps"] if entry["map"] == name)
    return {thing: [int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)] for thing, color in colors.items()}


def vectors(codes):
    return unit(codes * 2 - 1)


def with_blender(comparison, own, other, objects):
    """Maps that Blender has too."""
    pairs = (
        ("normal", "tangent normals", 0.3),
        ("world-normal", "world normals", 0.3),
        ("bevel", "rounded edges (bevel)", None),
    )
    for name, title, target in pairs:
        comparison.add(title, "Blender", vectors(own[name]), vectors(other[name]), angles, "°", target)
    clear = uniform(objects[..., None], ALONE)
    bevels = vectors(own["bevel"]), vectors(other["bevel"])
    comparison.add("bevel away from other objects", "Blender", *bevels, angles, "°", 1, clear)
    occlusion = own["ao"][..., 0], other["ao"][..., 0]
    comparison.add("occlusion", "Blender", *occlusion, apart, "", 0.02, wrong=own["wrong ao"][..., 0])
    diagonal = np.linalg.norm(np.ptp(other["position"][comparison.mask], axis=0))
    positions = own["position"] / diagonal, other["position"] / diagonal
    comparison.add("position", "Blender", *positions, lengths, "of the diagonal", 1e-4)
    orm = own["metallic-roughness"]
    for name, channel in (("roughness", 1), ("metalness", 2)):
        comparison.add(name, "Blender", orm[..., channel], other[name][..., 0], apart, "", 0.005)
    for name, title in (("albedo", "base colour, codes"), ("vertex-color", "vertex colours, codes")):
        codes = own[name] * 255, srgb_codes(other[name])
        comparison.add(title, "Blender", *codes, most_apart, "codes of 255", 1)
    for name, title in (("material-id", "material IDs"), ("object-id", "object IDs")):
        away = uniform(other[name])
        comparison.add(title, "Blender", own[name], other[name], differ, "of the texels", 0, away)
    body = objects == 0
    curvature, pointiness = own["curvature"][..., 0], other["pointiness"][..., 0]
    masked = np.where(body, pointiness, np.nan)
    comparison.correlate("ranks of the body's curvature", "Blender's pointiness", curvature, masked, None, by_rank=True)


def with_rays(comparison, own, texels, found, size):
    """Maps compared with rays by Embree, at all texels."""
    height = texels.image(found.heights, size)
    comparison.add("height", "Embree", own["height"][..., 0], height, apart, "units", 1e-4)
    way = found.points - texels.positions
    vector = texels.image(texels.in_tangent_space(way), size)
    comparison.add("vector displacement", "Embree", own["vector-displacement"], vector, lengths, "units", 1e-4)
    curvature = np.where(found.objects == 0, true_maps.mean_curvatures(found.points), np.nan)
    # Taotie clips the largest ones.
    clipped = np.clip(texels.image(curvature, size), own["curvature"].min(), own["curvature"].max())
    comparison.correlate("curvature of the body", "formula", own["curvature"][..., 0], clipped, 0.98)
    edges = texels.image((texels.edge <= 1).astype(float), size)
    clear = texels.image(np.abs(texels.edge - 1), size) > 0.01
    wires = own["wireframe"][..., 0]
    comparison.add("wireframe", "formula", wires, edges, apart, "of the texels", 0, clear)


def some(comparison, texels, count):
    """Random numbers of compared texels."""
    compared = np.flatnonzero(comparison.mask[texels.rows, texels.columns])
    return np.sort(np.random.default_rng(SEED).choice(compared, count, replace=False))


def with_hemispheres(comparison, own, texels, surface, size, rays):
    """Maps compared with hemispheres of rays by Embree, at some texels."""
    scan, found = surface
    chosen = some(comparison, texels, TRUE_TEXELS)
    say(f"casting {2 * TRUE_TEXELS * rays / 1e6:.0f} million rays by Embree")
    occlusion, bent = true_maps.sky(scan, found, chosen, rays, AO_DISTANCE)
    image = texels.image(occlusion, size, chosen)
    comparison.add("occlusion", "Embree", own["ao"][..., 0], image, apart, "", 0.02, wrong=own["wrong ao"][..., 0])
    image = texels.image(texels.in_tangent_space(bent, chosen), size, chosen)
    comparison.add("bent normals", "Embree", vectors(own["bent"]), image, angles, "°", 1)
    depth = true_maps.thickness(scan, found, chosen, rays)
    thickness = own["thickness"][..., 0] / depth.mean()
    image = texels.image(depth / depth.mean(), size, chosen)
    comparison.add("thickness", "Embree", thickness, image, apart, "of the mean", 0.02)


def with_sums(comparison, own, other, texels, surface, size):
    """Rounded edges compared with sums over the triangles of all objects, for Taotie, or of one, for Blender."""
    parts, scan, found = surface
    chosen = some(comparison, texels, BEVEL_TEXELS)
    normals = true_maps.rounded(scan, found, chosen, BEVEL_RADIUS)
    image = texels.image(texels.in_tangent_space(normals, chosen), size, chosen)
    comparison.add("rounded edges (bevel)", "sums, all objects", vectors(own["bevel"]), image, angles, "°", 1)
    for k, part in enumerate(parts):
        its = found.objects[chosen] == k
        normals[its] = true_maps.rounded(true_maps.Scan([part]), found, chosen[its], BEVEL_RADIUS)
    image = texels.image(texels.in_tangent_space(normals, chosen), size, chosen)
    comparison.add("Blender's rounded edges", "sums, one object", vectors(other["bevel"]), image, angles, "°", None)


def hidden(own, texels, found, size):
    """Texels at which Taotie shows a point below the outermost one."""
    return texels.image(found.heights, size) - own["height"][..., 0] > HIDDEN


def compared(args, rays):
    """Bakes and compares all maps."""
    folder, size = args.folder, args.size
    os.makedirs(folder, exist_ok=True)
    parts, low = pair.write(folder)
    say("baking with Taotie")
    bevel = ["--bevel-radius", BEVEL_RADIUS]
    report = taotie(args.taotie, folder, (MAPS, "taotie.png"), size, rays, AO_DISTANCE, bevel)
    own = read(folder, report)
    own["wrong ao"] = read(folder, taotie(args.taotie, folder, ("ao", "wrong.png"), size, rays, AO_DISTANCE / 4))["ao"]
    say("baking with Blender")
    other = blender(folder, size, rays, {name: legend(report, name) for name in ("material-id", "object-id")})
    version = str(other.pop("version"))
    texels, scan = true_maps.texels(low, size), true_maps.Scan(parts)
    found = true_maps.found(scan, texels, EXTRUSION)
    inside = texels.image(texels.inside, size) >= BORDER
    met = texels.image(found.met.astype(float), size) == 1
    comparison = Comparison(inside & met & (other["position"] != 0).any(-1))
    with_blender(comparison, own, other, texels.image(found.objects.astype(float), size))
    with_rays(comparison, own, texels, found, size)
    with_hemispheres(comparison, own, texels, (scan, found), size, rays)
    with_sums(comparison, own, other, texels, (parts, scan, found), size)
    triangles = len(scan.triangles), len(low.triangles)
    return Result(comparison, hidden(own, texels, found, size) & comparison.mask, triangles, version)


def write_images(folder, comparison):
    """An image for each difference: black is 0, white four times the 95th percentile; blue is not compared."""
    for row in comparison.rows:
        if isinstance(row, Row):
            values = row.difference / max(4 * np.percentile(row.values, 95), 1e-9)
            image = np.repeat(np.clip(np.nan_to_num(values) * 255, 0, 255).astype(np.uint8)[..., None], 3, -1)
            image[np.isnan(values)] = (40, 40, 90)
            name = f"{row.name} {row.other}".replace(" ", "-").lower()
            Image.fromarray(image).save(os.path.join(folder, f"difference-{name}.png"))


def main():
    args = arguments()
    rays = 64 if args.quick else RAYS
    if not args.quick:
        page.around(args.page, TARGET)  # fails now rather than after minutes
    result = compared(args, rays)
    if args.images:
        write_images(args.folder, result.comparison)
    text = map_section.section(args, rays, BORDER, result)
    print(text)
    if not args.quick:
        page.write(args.page, TARGET, text)
    if result.blind():
        sys.exit("deliberately wrong maps met a target")


if __name__ == "__main__":
    command.run(main)
