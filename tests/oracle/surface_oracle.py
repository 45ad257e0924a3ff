"""Frames, normals and bumps in double precision, computed differently from the library.

Writes surface_oracle.json next to itself: `python3 tests/oracle/surface_oracle.py` (needs NumPy).
"""

import json
from pathlib import Path

import numpy as np


def unit(v):
    return v / np.linalg.norm(v)


def derivatives(corners, uvs):
    """dp/du and dp/dv by least squares over the three corners of the affine map uv -> p."""
    a = np.column_stack([uvs, np.ones(3)])
    return np.linalg.lstsq(a, corners, rcond=None)[0][:2]


def bumped(n, pu, pv, hu, hv):
    """The normal of the surface p + h n, if flat, as the cross product of its derivatives."""
    raised = np.cross(pu + hu * n, pv + hv * n)
    return unit(raised * np.sign(np.dot(np.cross(pu, pv), n)))


def corner_weighted(corners_around, center):
    """Facet normals about a centre, weighted by the arc cosine of their angle there."""
    total = np.zeros(3)
    for a, b in zip(corners_around, np.roll(corners_around, -1, axis=0)):
        e, f = unit(a - center), unit(b - center)
        total += np.arccos(np.dot(e, f)) * unit(np.cross(e, f))
    return unit(total)


def main():
    rng = np.random.default_rng(7)
    single = lambda *shape: rng.normal(size=shape).astype(np.float32).astype(np.float64)
    cases = []
    for _ in range(40):
        corners, uvs = single(3, 3), single(3, 2)
        pu, pv = derivatives(corners, uvs)
        n = unit(np.cross(corners[1] - corners[0], corners[2] - corners[0]))
        hu, hv = single(2)
        t, w, color = unit(single(3)), rng.choice([-1.0, 1.0]), rng.uniform(0.55, 1, 3)
        frame = np.column_stack([t, w * np.cross(n, t), n])
        cases.append({
            "corners": corners.tolist(),
            "uvs": uvs.tolist(),
            "dp_du": pu.tolist(),
            "dp_dv": pv.tolist(),
            "n": n.tolist(),
            "dh": [hu, hv],
            "bumped": bumped(n, pu, pv, hu, hv).tolist(),
            "t": t.tolist(),
            "w": w,
            "color": color.tolist(),
            "mapped": unit(frame @ (2 * color - 1)).tolist(),
        })
    fans = []
    for count in (3, 4, 5, 7):
        angle = np.sort(rng.uniform(0, 2 * np.pi, count))
        angle = (angle + 2 * np.pi * np.arange(count) / count) / 2
        rim = np.column_stack([np.cos(angle), np.sin(angle), rng.uniform(-0.6, 0.1, count)])
        rim = rim.astype(np.float32).astype(np.float64)
        center = np.array([0.0, 0.0, 0.25])
        fans.append({"center": center.tolist(), "rim": rim.tolist(), "normal": corner_weighted(rim, center).tolist()})
    Path(__file__).with_suffix(".json").write_text(json.dumps({"cases": cases, "fans": fans}) + "\n")


if __name__ == "__main__":
    main()
