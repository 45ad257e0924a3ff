"""Energy, layers and antialiasing for `crates/taotie-engine/tests/oracle/light.rs`, in double precision.

Written from the papers named at each function. Directional albedos are integrals over light directions on a grid of
polar angle and azimuth that is graded towards the mirror direction, or the mean over randomly drawn visible facets,
not the quadrature over half vectors used for the renderer's tables. Writes `light_oracle.json` next to this file:

    ggx, cook_torrance  list of {n_dot_v, roughness or slope, scale, bias, edge, diffuse_edge}
    sheen               list of {n_dot_v, roughness, albedo}
    compensation        list of {scale, bias, edge, f0, f90, drop, gain, transmitted}
    lobes               list of {n, v, l, t, b, roughness, strength, stretched, d_charlie, v_neubelt, coat}
    occlusion           list of {n_dot_v, occlusion, roughness, seen}
    divergence          list of {alpha, divergence}
    mips                list of {normals: [[r, g, b] codes of 65535], mean: [x, y, z], variance}
"""

import json
from pathlib import Path

import numpy as np

from shade_oracle import beckmann, direction, plain, rotation, rounded, schlick, smith_visibility, unit, v_cavity

SEED = 20260211
N = np.array([0.0, 0.0, 1.0])


# Directional albedos: integrals over the light's direction


def gauss(lo, hi, count):
    x, w = np.polynomial.legendre.leggauss(count)
    return lo + (x + 1) / 2 * (hi - lo), w / 2 * (hi - lo)


def composite(edges, count):
    """Gauss-Legendre nodes and weights in each of the intervals between rising `edges`."""
    parts = [gauss(a, b, count) for a, b in zip(edges[:-1], edges[1:]) if b > a]
    return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])


def graded(lo, hi, peak, width):
    """Edges between lo and hi that are dense around `peak`."""
    steps = width * np.concatenate([[0], 2.0 ** np.arange(-3, 12)])
    edges = np.unique(np.clip(np.concatenate([[lo, hi], peak - steps, peak + steps]), lo, hi))
    return edges


def over_lights(n_dot_v, width, lobe):
    """Integrals over the hemisphere of l of each value that `lobe(nl, nh, vh)` returns, times n.l."""
    theta_v = np.arccos(n_dot_v)
    theta, w_theta = composite(graded(0, np.pi / 2, theta_v, width), 24)
    phi, w_phi = composite(graded(0, np.pi, 0, max(width, 1e-3)), 24)  # from the mirror direction; both sides alike
    th, ph = np.meshgrid(theta, phi, indexing="ij")
    w = np.outer(w_theta * np.sin(theta) * np.cos(theta), w_phi) * 2
    l = np.stack([-np.sin(th) * np.cos(ph), np.sin(th) * np.sin(ph), np.cos(th)], -1)
    v = np.array([np.sin(theta_v), 0, n_dot_v])
    h = l + v
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    sin_h = np.linalg.norm(np.cross(N, h), axis=-1)
    values = lobe(l[..., 2], np.arctan2(sin_h, h[..., 2]), np.clip(h @ v, 0, 1))
    return [float(np.sum(w * value)) for value in values]


def parts(lobe, vh):
    """F0, F90 and Lazanyi's part of a reflection, and Schlick's rise over a diffuse one."""
    fifth = (1 - vh) ** 5
    return [lobe * (1 - fifth), lobe * fifth, lobe * vh * (1 - vh) ** 6, fifth / np.pi]


def ggx_d(theta, alpha):
    """Trowbridge and Reitz 1975 as in Walter et al. 2007, eq. 33, with the tangent expanded."""
    c2, s2 = np.cos(theta) ** 2, np.sin(theta) ** 2
    return alpha**2 / (np.pi * (alpha**2 * c2 + s2) ** 2)


def albedo_ggx(n_dot_v, roughness):
    alpha = roughness**2
    return over_lights(
        n_dot_v,
        alpha,
        lambda nl, theta, vh: parts(ggx_d(theta, alpha) * smith_visibility(nl, n_dot_v, alpha), vh),
    )


def albedo_cook_torrance(n_dot_v, slope):
    def lobe(nl, theta, vh):
        nh = np.cos(theta)
        g = np.minimum(1, np.minimum(2 * nh * n_dot_v / vh, 2 * nh * nl / vh))
        return parts(beckmann(theta, slope) * g / (4 * nl * n_dot_v), vh)

    return over_lights(n_dot_v, slope, lobe)


def charlie(theta, roughness):
    """Estevez and Kulla 2017, eq. 2, alpha = roughness squared as in KHR_materials_sheen."""
    inverse = 1 / roughness**2
    return (2 + inverse) * np.sin(theta) ** inverse / (2 * np.pi)


def neubelt(nl, nv):
    """Neubelt and Pettineo 2013."""
    return 1 / (4 * (nl + nv - nl * nv))


def albedo_sheen(n_dot_v, roughness):
    return over_lights(
        n_dot_v, 0.3, lambda nl, theta, vh: [charlie(theta, roughness) * np.minimum(neubelt(nl, n_dot_v), 1)]
    )[0]


def visible_facets(rng, n_dot_v, alpha, count):
    """Monte Carlo: the mean of G2/G1 and its Fresnel parts over GGX facets as the viewer sees them (Heitz 2018)."""
    v = np.array([np.sqrt(1 - n_dot_v**2), 0, n_dot_v])
    stretched = unit(v * [alpha, alpha, 1])
    t1 = unit(np.cross(N, stretched)) if stretched[2] < 0.99999 else np.array([1.0, 0, 0])
    t2 = np.cross(stretched, t1)
    r, phi = np.sqrt(rng.random(count)), 2 * np.pi * rng.random(count)
    a, b = r * np.cos(phi), r * np.sin(phi)
    s = (1 + stretched[2]) / 2
    b = (1 - s) * np.sqrt(1 - a**2) + s * b
    h = a[:, None] * t1 + b[:, None] * t2 + np.sqrt(np.maximum(1 - a**2 - b**2, 0))[:, None] * stretched
    h = h * [alpha, alpha, 1]
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    vh = np.clip(h @ v, 0, 1)
    nl = (2 * vh[:, None] * h - v)[:, 2]
    lit = nl > 0
    nl = np.where(lit, nl, 1)
    lam = lambda c: (np.sqrt(1 + alpha**2 * (1 - c**2) / c**2) - 1) / 2
    share = np.where(lit, (1 + lam(n_dot_v)) / (1 + lam(n_dot_v) + lam(nl)), 0)
    return [float(x.mean()) for x in parts(share, vh)[:3]]


def albedo_rows(rng):
    cosines, roughnesses = [0.03, 0.1, 0.25, 0.5, 0.8, 1.0], [0.1, 0.2, 0.35, 0.5, 0.75, 1.0]
    names = "scale", "bias", "edge", "diffuse_edge"
    ggx, cook = [], []
    for n_dot_v in cosines:
        for r in roughnesses:
            found = albedo_ggx(n_dot_v, r)
            drawn = visible_facets(rng, n_dot_v, r * r, 400_000)
            # Neither can be trusted unless both agree.
            assert np.allclose(found[:3], drawn, atol=3e-3), (n_dot_v, r, found, drawn)
            ggx.append({"n_dot_v": n_dot_v, "roughness": r} | dict(zip(names, found)))
            m = r * r
            cook.append({"n_dot_v": n_dot_v, "slope": m} | dict(zip(names, albedo_cook_torrance(n_dot_v, m))))
    sheen = [
        {"n_dot_v": c, "roughness": r, "albedo": albedo_sheen(c, r)} for c in cosines for r in roughnesses
    ]
    return ggx, cook, sheen


# Compensation


def compensation_row(rng, ggx):
    """Turquin 2019, eq. 16, for a lobe whose single scattering returns scale + bias of the light."""
    f0, f90 = rng.random(3), float(0.3 + 0.7 * rng.random())
    drop = rng.random(3) * 3
    e = ggx["scale"] + ggx["bias"]
    gain = 1 + f0 * (1 - e) / e
    single = np.clip(f0 * ggx["scale"] + f90 * ggx["bias"] - drop * ggx["edge"], 0, 1)
    kept = {k: ggx[k] for k in ("scale", "bias", "edge", "diffuse_edge")}
    transmitted = float(np.clip(1 - np.max(gain * single), 0, 1))
    return kept | {"f0": f0, "f90": f90, "drop": drop, "gain": gain, "transmitted": transmitted}


# Lobes at fixed directions


def anisotropic_ggx(h, v, l, at, ab):
    """D of Heitz 2014, eq. 85, from slopes; masking by Lambda of eq. 72 with the roughness along the azimuth, eq. 80."""
    slope = np.array([-h[0] / h[2], -h[1] / h[2]])
    p22 = 1 / (np.pi * at * ab * (1 + slope[0] ** 2 / at**2 + slope[1] ** 2 / ab**2) ** 2)
    d = p22 / h[2] ** 4

    def lam(w):
        tan2 = (w[0] ** 2 + w[1] ** 2) / w[2] ** 2
        flat = w[:2] / np.hypot(w[0], w[1])
        a2 = (flat[0] * at) ** 2 + (flat[1] * ab) ** 2
        return (np.sqrt(1 + a2 * tan2) - 1) / 2

    return d / (1 + lam(v) + lam(l)) / (4 * l[2] * v[2])


def lobe_row(rng, i):
    v, l = direction(rng, 0.05), direction(rng, 0.05)
    if i % 4 == 1:
        l = unit(np.array([-v[0], -v[1], v[2]]) + 0.05 * rng.normal(size=3))
        l[2] = abs(l[2])
    roughness = float([0.1, 0.25, 0.5, 0.8, 1.0][i % 5])
    strength = float([0.0, 0.3, 0.7, 1.0][i % 4])
    h = unit(v + l)
    across = roughness**2
    along = across + (1 - across) * strength**2  # KHR_materials_anisotropy
    nl, nv = l[2], v[2]
    theta = np.arctan2(np.hypot(h[0], h[1]), h[2])
    f = schlick(0.04, 1.0, np.dot(v, h))
    q = rotation(rng)
    q = q * np.sign(np.linalg.det(q))
    return {
        "n": unit(q @ N),
        "v": unit(q @ v),
        "l": unit(q @ l),
        "t": unit(q @ np.array([1.0, 0, 0])),
        "b": unit(q @ np.array([0, 1.0, 0])),
        "roughness": roughness,
        "strength": strength,
        "stretched": anisotropic_ggx(h, v, l, along, across),
        "d_charlie": charlie(theta, roughness),
        "v_neubelt": neubelt(nl, nv),
        "coat": ggx_d(theta, across) * smith_visibility(nl, nv, across) * f * nl,
    }


# Occlusion, antialiasing


def occlusion_row(rng, i):
    """Lagarde and de Rousiers 2014, listing 26: saturate(pow(NdotV + ao, exp2(-16 roughness - 1)) - 1 + ao)."""
    o, c, r = float([0, 1, rng.random()][i % 3]), float(rng.random()), float([0, 0.1, 0.5, 1][i % 4])
    return {"n_dot_v": c, "occlusion": o, "roughness": r, "seen": np.clip((c + o) ** np.exp2(-16 * r - 1) - 1 + o, 0, 1)}


def divergence_row(alpha):
    """1 minus the mean of n.m over GGX facets, which are distributed as D n.m (Walter et al. 2007, eq. 33)."""
    # Facets by their quantile: tan^2 = alpha^2 u / (1 - u) (Walter et al. 2007, eq. 35); u = sin^2 x smooths the end.
    x, w = composite(np.linspace(0, np.pi / 2, 9), 40)
    u = np.sin(x) ** 2
    sine, cosine = alpha * np.sin(x), np.cos(x)
    # 1 - cos of the facet, without cancellation
    lost = sine**2 / (cosine**2 + sine**2 + cosine * np.hypot(cosine, sine))
    return {"alpha": alpha, "divergence": float(np.sum(w * lost * 2 * np.sqrt(u) * cosine))}


def mip_row(rng, i):
    """Mean of four unit vectors and the mean square distance from it, sum |n - mean|^2 / 4."""
    spread = [0.02, 0.1, 0.3, 0.8][i % 4]
    vectors = np.array([unit(np.array([0, 0, 1]) + spread * rng.normal(size=3)) for _ in range(4)])
    codes = np.round((vectors + 1) / 2 * 65535)
    stored = 2 * codes / 65535 - 1
    stored /= np.linalg.norm(stored, axis=1, keepdims=True)
    mean = stored.mean(axis=0)
    return {"normals": codes, "mean": mean, "variance": np.sum((stored - mean) ** 2) / 4}


def main():
    rng = np.random.default_rng(SEED)
    ggx, cook, sheen = albedo_rows(rng)
    tables = {
        "ggx": ggx,
        "cook_torrance": cook,
        "sheen": sheen,
        "compensation": [compensation_row(rng, row) for row in ggx],
        "lobes": [lobe_row(rng, i) for i in range(60)],
        "occlusion": [occlusion_row(rng, i) for i in range(36)],
        "divergence": [divergence_row(a) for a in (0.002, 0.01, 0.04, 0.1, 0.3, 0.5, 0.8, 0.95, 0.98, 1.0)],
        "mips": [mip_row(rng, i) for i in range(16)],
    }
    vectors = "n", "v", "l", "t", "b", "normals"
    row = lambda values: json.dumps({k: x if k in vectors else rounded(x) for k, x in plain(values).items()})
    lines = []
    for name, rows in tables.items():
        body = ",\n".join(row(values) for values in rows)
        lines.append(f'"{name}": [\n{body}\n]')
    Path(__file__).with_suffix(".json").write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    main()
