"""Reflectance values for `crates/taotie-engine/tests/oracle/shade.rs`, in double precision.

Written from the papers named at each function, with textbook forms, angles and complex numbers where the renderer
uses rearranged forms. Writes `shade_oracle.json` next to this file:

    cases   list of {n, v, l, base_color, metallic, roughness, f0, f82, f82_drop, diffuse, specular, shininess,
            slope} and the results: angles {n_dot_l, ...}, blocks {d_ggx, ...}, models {name: [r, g, b]}
    fresnel list of {cos, eta, k, dielectric, conductor}
    lights  list of {distance_squared, range, cos_angle, cos_inner, cos_outer, inverse_square, window, cone}
    powers  list of {x, y, exp_x, ln_y, pow}: e^x, ln y, and y^|x|
"""

import json
from pathlib import Path

import numpy as np

SEED = 20250615
MIN_ALPHA = 1e-3  # a documented limit of the models
MIN_N_DOT_V = 1e-4  # likewise


def unit(x):
    return x / np.linalg.norm(x)


# Fresnel


def schlick(f0, f90, cos):
    """Schlick 1994, eq. 15."""
    return f0 * (1 - (1 - cos) ** 5) + f90 * (1 - cos) ** 5


def lazanyi_coefficient(f0, f82):
    """Kutz, Hasan and Edmondson 2021: the coefficient that makes the curve pass through f82 at cos = 1/7."""
    mu = 1 / 7
    return (schlick(f0, 1.0, mu) - f82) / (mu * (1 - mu) ** 6)


def fresnel_f82(f0, f82, cos):
    value = schlick(f0, 1.0, cos) - lazanyi_coefficient(f0, f82) * cos * (1 - cos) ** 6
    return np.clip(value, 0, 1)


def fresnel_exact(cos, index):
    """Unpolarised reflectance from the amplitudes of Born and Wolf 1.5.2 with a complex index."""
    sin_t = np.sqrt(1 - cos**2) / index
    cos_t = np.sqrt(1 - sin_t**2 + 0j)
    r_s = (cos - index * cos_t) / (cos + index * cos_t)
    r_p = (index * cos - cos_t) / (index * cos + cos_t)
    return float((abs(r_s) ** 2 + abs(r_p) ** 2) / 2)


# Distributions of the angle between n and h


def beckmann(theta, m):
    """Walter et al. 2007, eq. 25."""
    with np.errstate(under="ignore"):
        return np.exp(-np.tan(theta) ** 2 / m**2) / (np.pi * m**2 * np.cos(theta) ** 4)


def ggx(theta, alpha):
    """Walter et al. 2007, eq. 33, first form."""
    return alpha**2 / (np.pi * np.cos(theta) ** 4 * (alpha**2 + np.tan(theta) ** 2) ** 2)


def blinn(theta, s):
    """Walter et al. 2007, eq. 30 with Blinn's exponent."""
    return (s + 2) / (2 * np.pi) * np.cos(theta) ** s


# Masking


def v_cavity(nl, nv, nh, vh):
    """Cook and Torrance 1982, section 4."""
    return min(1.0, 2 * nh * nv / vh, 2 * nh * nl / vh)


def smith_lambda(cos, alpha):
    """Heitz 2014, eq. 72 with a = 1/(alpha tan)."""
    tan2 = (1 - cos**2) / cos**2
    return (np.sqrt(1 + alpha**2 * tan2) - 1) / 2


def smith_visibility(nl, nv, alpha):
    """Heitz 2014, eq. 99, over 4 n.l n.v."""
    return 1 / (1 + smith_lambda(nl, alpha) + smith_lambda(nv, alpha)) / (4 * nl * nv)


def schlick_g(x, k):
    return x / (k + (1 - k) * x)


def schlick_visibility(nl, nv, k):
    return schlick_g(nl, k) * schlick_g(nv, k) / (4 * nl * nv)


# Models: radiance per unit irradiance on a plane facing the light


def angles(n, v, l):
    h = unit(l + v)
    r = 2 * np.dot(n, l) * n - l
    theta = np.arctan2(np.linalg.norm(np.cross(n, h)), np.dot(n, h))
    return {
        "n_dot_l": float(np.dot(n, l)),
        "n_dot_v": float(max(np.dot(n, v), MIN_N_DOT_V)),
        "n_dot_h": float(max(np.dot(n, h), 0)),
        "v_dot_h": float(np.dot(v, h)),
        "r_dot_v": float(np.dot(r, v)),
        "theta_h": float(min(theta, np.pi / 2)),
    }


def models(c, a):
    nl, nv, nh, vh = a["n_dot_l"], a["n_dot_v"], a["n_dot_h"], a["v_dot_h"]
    rv, theta = max(a["r_dot_v"], 0), a["theta_h"]
    rho, f0 = c["base_color"], c["f0"]
    kd, ks, s, m = c["diffuse"], c["specular"], c["shininess"], c["slope"]
    dark = np.zeros(3)
    out = {}
    # formulas.md, section 1
    f = fresnel_f82(f0, c["f82"], vh)
    alpha = max(c["roughness"] ** 2, MIN_ALPHA)
    if nl > 0:
        out["lambert"] = rho / np.pi * nl
        out["phong"] = kd * nl + ks * rv**s
        out["blinn-phong"] = (kd / np.pi + (s + 8) / (8 * np.pi) * ks * nh**s) * nl
        out["blinn-phong-classic"] = kd * nl + ks * nh**s
        ct = beckmann(theta, m) * v_cavity(nl, nv, nh, vh) / (4 * nl * nv)
        out["cook-torrance"] = (kd / np.pi + ks * f * ct) * nl
        dv = ggx(theta, alpha) * smith_visibility(nl, nv, alpha)
        out["ggx"] = ((1 - f) * (1 - c["metallic"]) * rho / np.pi + dv * f) * nl
        # The seed paper, eq. 1 to 8
        f_2 = f0 + (1 - f0) * (1 - vh) ** 2
        d = 1 / (m**2 * nh**4) * np.exp((nh**2 - 1) / (m**2 * nh**2)) if nh > 0 else 0.0
        g = v_cavity(nl, nv, nh, vh)
        out["cook-torrance-printed"] = kd * nl + ks * f_2 / np.pi * d / nl * g / nv
        # The article's shader Custom/BlinnPhong
        out["blinn-phong-printed"] = (kd / np.pi + (s + 8) / (8 * np.pi) * ks * nh**5) * nl
    else:
        names = "lambert phong blinn-phong blinn-phong-classic cook-torrance ggx cook-torrance-printed blinn-phong-printed"
        out.update({name: dark for name in names.split()})
    # The article's shader Custom/BRDF, line by line; a float3 stored in a scalar keeps its first channel
    ndotl = min(max(nl, 0), 1)
    rough = max(c["roughness"], MIN_ALPHA)
    d = rough**2 / (np.pi * (nh**2 * (rough**2 - 1) + 1) ** 2)
    big_f = (f0 + (1 - f0) * (1 - nh**5))[0]
    lambert_nl = ndotl * 0.5 + 0.5
    k = (c["roughness"] + 1) ** 2 / 8
    v = schlick_g(ndotl, k) * schlick_g(nv, k) / (4 * lambert_nl * nv)
    kdiff = f0[0]
    kspec = ((1 - f0) * (1 - c["metallic"]))[0]
    out["ggx-printed"] = kdiff * rho / np.pi + kspec * v * big_f * d
    return out


def blocks(c, a):
    nl, nv, nh, vh, theta = a["n_dot_l"], a["n_dot_v"], a["n_dot_h"], a["v_dot_h"], a["theta_h"]
    x = abs(nl)  # masking of a light on the front side
    alpha = max(c["roughness"] ** 2, MIN_ALPHA)
    return {
        "f_schlick": schlick(c["f0"], 1.0, vh),
        "f_schlick_f90": schlick(c["f0"], c["specular"], vh),
        "f_f82": fresnel_f82(c["f0"], c["f82"], vh),
        "d_beckmann": beckmann(theta, c["slope"]),
        "d_ggx": ggx(theta, alpha),
        "d_blinn": blinn(theta, c["shininess"]),
        "alpha_from_shininess": np.sqrt(2 / (c["shininess"] + 2)),
        "shininess_from_alpha": 2 / alpha**2 - 2,
        "g_v_cavity": v_cavity(x, nv, nh, vh),
        "v_smith_ggx": smith_visibility(x, nv, alpha),
        "v_schlick_lights": schlick_visibility(x, nv, (c["roughness"] + 1) ** 2 / 8),
        "v_schlick_environment": schlick_visibility(x, nv, max(c["roughness"], 0.05) ** 2 / 2),
    }


# Inputs


def direction(rng, lowest):
    """A unit vector around z with its z in (lowest, 1]."""
    z = lowest + (1 - lowest) * rng.random()
    phi = 2 * np.pi * rng.random()
    r = np.sqrt(1 - z * z)
    return np.array([r * np.cos(phi), r * np.sin(phi), z])


def rotation(rng):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q


def directions(rng, i):
    """n, v and l; every eighth pair near the mirror direction, some grazing, some turned away."""
    n = np.array([0.0, 0.0, 1.0])
    v = direction(rng, 0.02)
    l = direction(rng, -0.3 if i % 8 == 3 else 0.01)
    if i % 8 == 5:
        l = unit(np.array([-v[0], -v[1], v[2]]) + 0.02 * rng.normal(size=3))
    if i % 16 == 7:
        v = unit(np.array([v[0], v[1], 1e-3]))
    if i % 16 == 15:
        l = unit(np.array([l[0], l[1], 1e-3]))
    if i % 32 == 12:
        v = unit(np.array([v[0], v[1], -0.05]))
    q = rotation(rng)
    return unit(q @ n), unit(q @ v), unit(q @ l)


def case(rng, i):
    n, v, l = directions(rng, i)
    f0 = rng.random(3) * 0.96 + 0.02
    f82 = np.clip(f0 + (rng.random(3) - 0.4) * 0.4, 0.05, 0.98)
    c = {
        "n": n,
        "v": v,
        "l": l,
        "base_color": rng.random(3),
        "metallic": float([0, 1, rng.random()][i % 3]),
        "roughness": float([0.0, 0.05, 0.2, 0.5, 1.0, rng.random()][i % 6]),
        "f0": f0,
        "f82": f82,
        "f82_drop": lazanyi_coefficient(f0, f82),
        "diffuse": rng.random(3),
        "specular": rng.random(3),
        "shininess": float([0, 1, 5, 32, 250.5, 1000, 300 * rng.random()][i % 7]),
        "slope": float([0.02, 0.1, 0.5, 1.0, rng.random() + 0.05][i % 5]),
    }
    a = angles(n, v, l)
    return c | {"angles": a, "blocks": blocks(c, a), "models": models(c, a)}


def fresnel_case(rng, i):
    cos = float([1.0, 0.5, 1 / 7, 1e-3, rng.random()][i % 5])
    eta = float([1.5, 1.33, 0.2, 1 / 1.5, 0.5 + 2 * rng.random()][i % 5] if i < 25 else 0.1 + 3 * rng.random())
    k = float([3.6, 0.5, 8 * rng.random()][i % 3])
    result = {"dielectric": fresnel_exact(cos, complex(eta)), "conductor": fresnel_exact(cos, complex(eta, k))}
    return {"cos": cos, "eta": eta, "k": k} | result


def light_case(rng):
    d = 10 ** (rng.random() * 4 - 2)
    reach = 10 ** (rng.random() * 4 - 2)
    inner, outer = sorted(rng.random(2) * np.pi / 2)
    angle = rng.random() * np.pi / 2
    # KHR_lights_punctual
    scale = 1 / max(0.001, np.cos(inner) - np.cos(outer))
    cone = np.clip(np.cos(angle) * scale - np.cos(outer) * scale, 0, 1) ** 2
    return {
        "distance_squared": d * d,
        "range": reach,
        "cos_angle": np.cos(angle),
        "cos_inner": np.cos(inner),
        "cos_outer": np.cos(outer),
        "inverse_square": 1 / d**2,
        "window": max(min(1 - (d / reach) ** 4, 1), 0),
        "cone": cone,
    }


def power_case(rng, i):
    y = rng.random() ** (1 + i % 3)
    x = [-80 * rng.random(), -rng.random(), 80 * rng.random(), 1000 * rng.random()][i % 4]
    if x > 80:
        y = np.exp(-rng.random() * 80 / x)
    small = x if abs(x) < 85 else x / 12
    return {"x": small, "y": y, "p": abs(x), "exp_x": np.exp(small), "ln_y": np.log(y), "pow": y ** abs(x)}


def plain(value):
    """Converts NumPy values to JSON types."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(item) for item in value]
    return float(value)


def rounded(value):
    """Rounds results to 12 digits, a hundred thousand times finer than any test requires."""
    if isinstance(value, dict):
        return {key: rounded(item) for key, item in value.items()}
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return float(f"{value:.12g}")


def row(values):
    """A row as JSON: vectors in full so that they stay unit vectors, everything else rounded."""
    values = plain(values)
    return json.dumps({k: x if k in "nvl" else rounded(x) for k, x in values.items()}, allow_nan=False)


def main():
    rng = np.random.default_rng(SEED)
    tables = {
        "cases": [case(rng, i) for i in range(144)],
        "fresnel": [fresnel_case(rng, i) for i in range(60)],
        "lights": [light_case(rng) for _ in range(60)],
        "powers": [power_case(rng, i) for i in range(80)],
    }
    lines = []
    for name, rows in tables.items():
        body = ",\n".join(row(values) for values in rows)
        lines.append(f'"{name}": [\n{body}\n]')
    Path(__file__).with_suffix(".json").write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    main()
