"""The section on maps of docs/benchmarks.md."""

import datetime

import machine
import page


def described(args, rays, border, result):
    """What is compared, and how."""
    scan, low = result.triangles
    return (
        f"`make bench-maps` bakes all maps of a generated pair with Taotie and Blender {result.version} (`bpy`, "
        f"Cycles on the CPU, selected to active), and compares them texel by texel: {scan:,} triangles of three "
        f"objects with four materials onto {low:,} triangles with six UV islands, one of them mirrored; "
        f"{args.size}² texels, one sample at the centre of each, {rays} rays, `--skew keep`, `--bits 16`. Maps "
        "that Blender lacks are compared with rays by Embree, a formula, or sums over the scan's triangles "
        f"(`benches/bake/true_maps.py`). Only texels that both programs cover, at least {border} texels inside a "
        "UV island, are compared; those of IDs only if the 3 × 3 texels around them have one ID. Lengths are in "
        "model units; the scan is about 2 units across. Definitions that differ, and the causes of missed "
        "targets, are in [bake.md](bake.md#maps-compared-with-blenders). Measured on "
        f"{datetime.date.today():%-d %B %Y} with {machine.described(args.taotie)}."
    )


def faults(result):
    """Whether the comparison recognises wrong maps, and where Taotie shows hidden points."""
    rows = result.comparison.rows
    normals = next(row for row in rows if row.name == "tangent normals")
    occlusion = next(row for row in rows if row.name == "occlusion")
    are_seen = "misses every target" if not result.blind() else f"meets a target: {', '.join(result.blind())}"
    share = 100 * result.hidden.sum() / result.comparison.mask.sum()
    return (
        f"A deliberately wrong map {are_seen}: Taotie's shifted by one texel, or for occlusion, baked with a "
        "quarter of the distance. The largest differences are where objects intersect: at "
        f"{result.hidden.sum():,} texels, {share:.1f} %, Taotie shows a point just inside another object. Without "
        f"these texels, tangent normals differ by {normals.shown_without(result.hidden)} and occlusion by "
        f"{occlusion.shown_without(result.hidden)} on average."
    )


def section(args, rays, border, result):
    """The section's Markdown."""
    head = ["map", "compared with", "mean difference", "p95", "max", "texels", "target", "met", "a wrong map"]
    table = page.table(head, [row.cells() for row in result.comparison.rows])
    lines = ["## Maps", "", page.wrapped(described(args, rays, border, result))]
    lines += ["", *table, "", page.wrapped(faults(result)), ""]
    lines += ["The commands; they fail if a wrong map meets a target:", "", "```sh", *COMMANDS, "```"]
    return "\n".join(lines)


COMMANDS = (
    "make bench-maps                          # writes this section",
    "make bench-maps BENCH='--quick --images' # 64 rays; prints it, and writes an image of each difference",
)
