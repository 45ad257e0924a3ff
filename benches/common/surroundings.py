"""The environment, a dim room with three lamps, and its prefiltered form for engines that use the split sum.

Its image is equirectangular: u = atan2(z, x)/(2π) + 1/2, v = acos(y)/π, both from the top left.
"""

import numpy as np

WIDTH, HEIGHT = 1024, 512
FLOOR, SKY = (0.10, 0.09, 0.08), (0.30, 0.36, 0.45)
# Direction, half widths across and up at distance 1, radiance.
LAMPS = (
    ((-1.0, 0.6, 0.7), (0.35, 0.8), (9.0, 8.4, 7.5)),
    ((1.0, 0.3, 0.5), (0.15, 0.9), (5.0, 5.5, 6.5)),
    ((0.1, 1.0, -0.3), (0.6, 0.4), (4.0, 4.0, 4.0)),
)

# Side length of the prefiltered cube's first level, in texels; level i has roughness i / (LEVELS - 1).
CUBE, LEVELS = 128, 8
TABLE = 128
SAMPLES = 256
# For each face of a cube, in OpenGL's order: its axis, and the directions of its columns and rows.
FACES = (
    ((1, 0, 0), (0, 0, -1), (0, -1, 0)), ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    ((0, 1, 0), (1, 0, 0), (0, 0, 1)), ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
    ((0, 0, 1), (1, 0, 0), (0, -1, 0)), ((0, 0, -1), (-1, 0, 0), (0, -1, 0)),
)  # fmt: skip


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def picture():
    """Radiance (HEIGHT, WIDTH, 3)."""
    theta = (np.arange(HEIGHT) + 0.5)[:, None] / HEIGHT * np.pi
    phi = ((np.arange(WIDTH) + 0.5) / WIDTH - 0.5) * 2 * np.pi
    d = np.stack(np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)), -1)
    height = d[..., 1:2] * 0.5 + 0.5
    radiance = np.array(FLOOR) * (1 - height) + np.array(SKY) * height
    for direction, half, color in LAMPS:
        axis = unit(np.array(direction))
        across = unit(np.cross((0, 1, 0), axis))
        ahead = d @ axis
        x, y = (np.abs(d @ a) / np.maximum(ahead, 1e-6) / h for a, h in zip((across, np.cross(axis, across)), half))
        edge = 1 / (1 + np.exp(np.minimum((np.maximum(x, y) - 1) * 30, 700)))
        radiance += (edge * (ahead > 0))[..., None] * np.array(color)
    return radiance.astype(np.float32)


def radiance_hdr(radiance):
    """A Radiance file without compression."""
    most = np.maximum(radiance.max(-1), 1e-30)
    exponent = np.floor(np.log2(most)) + 1
    texels = np.empty((*radiance.shape[:2], 4), np.uint8)
    texels[..., :3] = np.clip(radiance * (256 / 2**exponent)[..., None], 0, 255)
    texels[..., 3] = exponent + 128
    head = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {HEIGHT} +X {WIDTH}\n"
    return head.encode() + texels.tobytes()


def looked_up(radiance, d):
    """The texels in these directions."""
    rows, columns = radiance.shape[:2]
    u = np.arctan2(d[..., 2], d[..., 0]) / (2 * np.pi) + 0.5
    v = np.arccos(np.clip(d[..., 1], -1, 1)) / np.pi
    return radiance[np.minimum((v * rows).astype(int), rows - 1), (u * columns).astype(int) % columns]


def directions(size):
    """Unit directions of the texels of a cube's faces (6, size, size, 3)."""
    at = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = (a[..., None] for a in np.meshgrid(at, at))
    return np.stack([unit(np.array(axis) + x * np.array(across) + y * np.array(down)) for axis, across, down in FACES])


def sequence(count):
    """Hammersley's points in the unit square."""
    i = np.arange(count)
    reversed_bits = sum(((i >> bit) & 1) / 2 ** (bit + 1) for bit in range(count.bit_length()))
    return (i + 0.5) / count, reversed_bits


def half_vectors(alpha):
    """Half vectors sampled by GGX, around +z."""
    x, y = sequence(SAMPLES)
    cos = np.sqrt((1 - y) / (1 + (alpha * alpha - 1) * y))
    sin = np.sqrt(1 - cos * cos)
    return np.stack([sin * np.cos(2 * np.pi * x), sin * np.sin(2 * np.pi * x), cos], -1)


def prefiltered(radiance, level):
    """The light gathered by a mirror of the level's roughness, seen along its normal: (6, size, size, 3)."""
    size, roughness = CUBE >> level, level / (LEVELS - 1)
    if level == 0:
        return looked_up(blurred(radiance, 2), directions(size)).astype(np.float32)
    source = blurred(radiance, 8 if roughness > 0.2 else 4)
    d = directions(size).reshape(-1, 3)
    h = half_vectors(roughness**2)
    light = 2 * h[:, 2:] * h - np.array([0, 0, 1])
    light = light[light[:, 2] > 1e-3]
    up = np.where(np.abs(d[:, 1:2]) < 0.99, [[0.0, 1, 0]], [[1.0, 0, 0]])
    across = unit(np.cross(up, d))
    other = np.cross(d, across)
    total = sum(z * looked_up(source, across * x + other * y + d * z) for x, y, z in light)
    return (total / light[:, 2].sum()).reshape(6, size, size, 3).astype(np.float32)


def blurred(radiance, by):
    rows, columns = radiance.shape[:2]
    return radiance.reshape(rows // by, by, columns // by, by, 3).mean((1, 3))


def albedo_table():
    """Scale and bias of F0 (roughness downward, n·v to the right, 2), for correlated Smith masking."""
    at = (np.arange(TABLE) + 0.5) / TABLE
    n_dot_v, roughness = np.meshgrid(at, at)
    a2 = roughness**4
    v = np.stack([np.sqrt(1 - n_dot_v**2), np.zeros_like(n_dot_v), n_dot_v], -1)
    sums = np.zeros((TABLE, TABLE, 2))
    for x, y in zip(*sequence(SAMPLES)):
        cos = np.sqrt((1 - y) / (1 + (a2 - 1) * y))
        sin = np.sqrt(1 - cos * cos)
        h = np.stack([sin * np.cos(2 * np.pi * x), sin * np.sin(2 * np.pi * x), cos], -1)
        v_dot_h = np.maximum((v * h).sum(-1), 1e-5)
        n_dot_l = np.maximum(2 * v_dot_h * cos - n_dot_v, 0)
        width = n_dot_l * np.sqrt(n_dot_v**2 * (1 - a2) + a2) + n_dot_v * np.sqrt(n_dot_l**2 * (1 - a2) + a2)
        seen = 2 * n_dot_l * v_dot_h / (width * cos)
        grazing = (1 - v_dot_h) ** 5
        sums += np.stack([seen * (1 - grazing), seen * grazing], -1)
    return (sums / SAMPLES).astype(np.float32)


def harmonics(d):
    """Real spherical harmonics up to the second degree (..., 9)."""
    x, y, z = np.moveaxis(d, -1, 0)
    return np.stack(
        [
            np.full_like(x, 0.282095), 0.488603 * y, 0.488603 * z, 0.488603 * x, 1.092548 * x * y,
            1.092548 * y * z, 0.315392 * (3 * z * z - 1), 1.092548 * x * z, 0.546274 * (x * x - y * y),
        ],
        -1,
    )  # fmt: skip


def irradiance(radiance):
    """Coefficients (9, 3) of the irradiance on a plane, for the harmonics of its normal."""
    size = 64
    d = directions(size)
    at = (np.arange(size) + 0.5) / size * 2 - 1
    x, y = np.meshgrid(at, at)
    angle = (4 / size**2) / (1 + x * x + y * y) ** 1.5
    cosine = np.repeat([np.pi, 2 * np.pi / 3, np.pi / 4], [1, 3, 5])
    light = looked_up(blurred(radiance, 4), d)
    return (np.einsum("fijc,fijk,ij->kc", light, harmonics(d), angle) * cosine[:, None]).astype(np.float32)


def split_sum(radiance):
    """Arrays: level0 to level7 of the cube, table, irradiance."""
    levels = {f"level{i}": prefiltered(radiance, i) for i in range(LEVELS)}
    return levels | {"table": albedo_table(), "irradiance": irradiance(radiance)}
