"""Compares the Hausdorff distance bounds reported by `taotie verify` with two million points measured by Embree.

For each of the scans with the most triangles in the shared data, an asset with a tenth of the triangles is baked.
Open3D samples both surfaces uniformly and measures the distance of each point from the other surface, including hidden
parts. The largest must not exceed the upper bound if nothing is hidden, and the lower bound must not exceed it by more
than the gap between the points.
"""

import argparse
import json
import math
import os
import subprocess
import sys

import numpy as np
import open3d as o3d
import trimesh

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
POINTS = 2_000_000
SINGLE = 1e-6


def surface(path):
    """The triangles of a file in world space."""
    return trimesh.load(path, force="mesh", process=False, skip_materials=True)


def farthest(points, mesh):
    """The largest distance of points from a mesh, by Embree."""
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))
    return max(float(scene.compute_distance(part).numpy().max()) for part in np.array_split(points, 16))


def sampled(mesh):
    """Points distributed over a mesh by area, the same each time, and the gap between them."""
    points, _ = trimesh.sample.sample_surface(mesh, POINTS, seed=1)
    # A disc without a point is seldom wider than a few times the mean spacing.
    return points.astype(np.float32), 4.0 * math.sqrt(mesh.area / POINTS)


def compare(taotie, scan, folder):
    """One row: the name, the two bounds, what Embree found, and whether it agrees."""
    name = os.path.splitext(os.path.basename(scan))[0]
    asset = os.path.join(folder, name + ".glb")
    high = surface(scan)
    triangles = str(max(len(high.faces) // 10, 500))
    bake = [taotie, "bake", scan, "-o", asset, "--triangles", triangles, "--size", "256", "--no-verify", "-q"]
    subprocess.run(bake, check=True, capture_output=True)
    verify = [taotie, "verify", asset, "--scan", scan, "--json", "-q"]
    level = json.loads(subprocess.run(verify, check=True, capture_output=True).stdout)["proof"]["levels"][0]
    low = surface(asset)
    (from_scan, gap), (from_asset, other) = sampled(high), sampled(low)
    found = max(farthest(from_scan, low), farthest(from_asset, high))
    bounds, hidden = level["hausdorff"], level["coverage"]["hidden_of_scan"]
    slack = SINGLE * float(np.abs(high.vertices).max())
    is_below = found <= bounds["upper"] + slack
    is_above = found >= bounds["lower"] - max(gap, other)
    return name, bounds["lower"], bounds["upper"], found, hidden, is_below, is_above


def main():
    made = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    made.add_argument("--taotie", default=os.path.join(ROOT, "target/release/taotie"))
    made.add_argument("--folder", default=os.path.join(ROOT, "target/bench-distances"))
    made.add_argument("scans", nargs="+", help="self-contained scan files")
    options = made.parse_args()
    os.makedirs(options.folder, exist_ok=True)
    failed = False
    print(f"{'scan':24} {'lower':>12} {'Embree':>12} {'upper':>12} {'hidden':>8}")
    for scan in options.scans:
        name, lower, upper, found, hidden, is_below, is_above = compare(options.taotie, scan, options.folder)
        verdict = "" if is_below and is_above else "OUTSIDE" if hidden < 1e-3 else "outside, parts are hidden"
        failed |= verdict == "OUTSIDE"
        print(f"{name:24} {lower:12.6g} {found:12.6g} {upper:12.6g} {hidden:8.2%} {verdict}", flush=True)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
