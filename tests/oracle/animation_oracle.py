"""A small rig at several times in double precision, from the glTF 2.0 specification.

Writes animation_oracle.json next to itself: `python3 tests/oracle/animation_oracle.py` (needs NumPy).

Each step differs from the Rust code: rotations are interpolated via the logarithm of matrices, splines via their
Bézier points, and normals are transformed by the inverse transpose of each vertex's matrix.

Schema: `nodes` (parent, translation, rotation as quaternion x y z w, scale, weights), `skin` (joints, inverse bind
matrices by rows), `mesh` (positions, normals, tangents, two targets, joints, joint weights), `animation` (channels with
path, interpolation, times, values) and `poses` (time, world matrices by rows, positions, normals, tangents).
"""

import json
from pathlib import Path

import numpy as np

random = np.random.default_rng(3)


def stored(values):
    """Values as stored in a file: 32 bits."""
    return np.asarray(values, np.float32).astype(float)


def numbers(shape, scale=1.0):
    return stored(random.uniform(-scale, scale, shape))


def unit_rows(shape):
    rows = random.normal(size=shape)
    return stored(rows / np.linalg.norm(rows, axis=-1, keepdims=True))


def rotation_matrix(q):
    """The matrix of the quaternion x y z w, normalised: v + 2 w (u × v) + 2 u × (u × v)."""
    q = q / np.linalg.norm(q)
    u, w = q[:3], q[3]
    cross = np.array([[0, -u[2], u[1]], [u[2], 0, -u[0]], [-u[1], u[0], 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def between(a, b, t):
    """The rotation matrix at fraction t of the way from a to b, about the axis of aᵀ b."""
    turn = a.T @ b
    angle = np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))
    if angle < 1e-12:
        return a
    skew = (turn - turn.T) / (2 * np.sin(angle))
    return a @ (np.eye(3) + np.sin(t * angle) * skew + (1 - np.cos(t * angle)) * skew @ skew)


def bezier(p0, m0, p1, m1, t):
    """The Hermite cubic by de Casteljau."""
    points = [p0, p0 + m0 / 3, p1 - m1 / 3, p1]
    while len(points) > 1:
        points = [(1 - t) * a + t * b for a, b in zip(points, points[1:])]
    return points[0]


def sample(channel, time):
    """The value at a time; rotations as matrices."""
    times, values = channel["times"], channel["values"]
    rotation = channel["path"] == "rotation"
    cubic = channel["interpolation"] == "CUBICSPLINE"
    whole = (lambda v: rotation_matrix(v)) if rotation else (lambda v: v)
    value = (lambda k: values[k][1]) if cubic else (lambda k: values[k])
    if time <= times[0]:
        return whole(value(0))
    if time >= times[-1]:
        return whole(value(-1))
    k = max(i for i in range(len(times)) if times[i] <= time)
    length = times[k + 1] - times[k]
    t = (time - times[k]) / length
    if channel["interpolation"] == "STEP":
        return whole(value(k))
    if cubic:
        return whole(bezier(value(k), length * values[k][2], value(k + 1), length * values[k + 1][0], t))
    if rotation:
        return between(rotation_matrix(value(k)), rotation_matrix(value(k + 1)), t)
    return (1 - t) * value(k) + t * value(k + 1)


def world_matrices(nodes, moved):
    world = []
    for i, node in enumerate(nodes):
        m = np.eye(4)
        rotation = moved.get((i, "rotation"), rotation_matrix(node["rotation"]))
        m[:3, :3] = rotation @ np.diag(moved.get((i, "scale"), node["scale"]))
        m[:3, 3] = moved.get((i, "translation"), node["translation"])
        world.append(m if node["parent"] is None else world[node["parent"]] @ m)
    return world


def deform(mesh, skin, world, weights):
    positions, normals, tangents = [], [], []
    joints = [world[j] @ bind for j, bind in zip(skin["joints"], skin["inverse_bind_matrices"])]
    for v in range(len(mesh["positions"])):
        p, n, t = mesh["positions"][v], mesh["normals"][v], mesh["tangents"][v]
        for weight, target in zip(weights, mesh["targets"]):
            p = p + weight * target["positions"][v]
            n = n + weight * target["normals"][v]
            t = t + weight * np.append(target["tangents"][v], 0)
        m = sum(w * joints[j] for j, w in zip(mesh["joints"][v], mesh["joint_weights"][v]))
        positions.append((m @ np.append(p, 1))[:3])
        n = np.linalg.inv(m[:3, :3]).T @ n
        normals.append(n / np.linalg.norm(n))
        t = np.append(m[:3, :3] @ t[:3], t[3])
        t[:3] /= np.linalg.norm(t[:3])
        tangents.append(t)
    return positions, normals, tangents


def node(parent, weights=()):
    return {
        "parent": parent,
        "translation": numbers(3, 2),
        "rotation": unit_rows(4),
        "scale": stored(random.uniform(0.7, 1.4, 3)),
        "weights": list(weights),
    }


def channel(node, path, interpolation, width, value=numbers):
    times = stored([0.25, 0.5, 1.25, 2.0])
    shape = (4, 3, width) if interpolation == "CUBICSPLINE" else (4, width)
    return {"node": node, "path": path, "interpolation": interpolation, "times": times, "values": value(shape)}


def upright(values):
    """Joints must not mirror here: scales stay positive."""
    return stored(np.abs(values) + 0.5)


def rig():
    count = 7
    nodes = [node(None), node(0), node(1), node(0, [0.25, -0.5])]
    joint_weights = random.uniform(0, 1, (count, 2))
    joint_weights = stored(joint_weights / joint_weights.sum(axis=1, keepdims=True))
    offsets = lambda: {k: numbers((count, 3), 0.3) for k in ("positions", "normals", "tangents")}
    mesh = {
        "positions": numbers((count, 3)),
        "normals": unit_rows((count, 3)),
        "tangents": np.hstack([unit_rows((count, 3)), np.where(np.arange(count) % 2, 1.0, -1.0)[:, None]]),
        "targets": [offsets(), offsets()],
        "joints": [[v % 2, 1 - v % 2] for v in range(count)],
        "joint_weights": joint_weights,
    }
    binds = [np.vstack([np.hstack([np.eye(3) + numbers((3, 3), 0.1), numbers((3, 1))]), [0, 0, 0, 1]]) for _ in "ab"]
    skin = {"joints": [1, 2], "inverse_bind_matrices": binds}
    # Rotation keyframes on either side of the sphere: q and −q are one rotation, and the shorter path is expected.
    either_side = lambda shape: unit_rows(shape) * np.array([1, -1, 1, -1])[:, None]
    channels = [
        channel(0, "translation", "LINEAR", 3),
        channel(0, "rotation", "STEP", 4, unit_rows),
        channel(1, "rotation", "LINEAR", 4, either_side),
        channel(1, "scale", "LINEAR", 3, lambda shape: upright(numbers(shape))),
        channel(2, "rotation", "CUBICSPLINE", 4),
        channel(2, "translation", "CUBICSPLINE", 3),
        channel(3, "weights", "CUBICSPLINE", 2),
    ]
    return nodes, skin, mesh, channels


def main():
    nodes, skin, mesh, channels = rig()
    poses = []
    for time in [0.0, 0.25, 0.3, 0.5, 0.875, 1.2, 1.25, 1.9, 2.0, 7.0]:
        moved = {(c["node"], c["path"]): sample(c, time) for c in channels}
        world = world_matrices(nodes, moved)
        positions, normals, tangents = deform(mesh, skin, world, moved[(3, "weights")])
        poses.append(
            {"time": time, "world": world, "positions": positions, "normals": normals, "tangents": tangents}
        )
    document = {"nodes": nodes, "skin": skin, "mesh": mesh, "animation": channels, "poses": poses}
    path = Path(__file__).with_suffix(".json")
    path.write_text(json.dumps(document, default=lambda a: a.tolist()) + "\n")


main()
