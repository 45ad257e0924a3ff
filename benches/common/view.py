"""The view shown by every participant: camera, light and material. Lengths are model units."""

import numpy as np

# Vertical angle of view, degrees.
FOV = 30.0
EYE = (0.0, 0.55, 4.2)
TARGET = (0.0, -0.02, 0.0)
NEAR, FAR = 0.1, 20.0

# A point light; its irradiance is the intensity over the squared distance.
LIGHT = (2.2, 2.6, 3.4)
INTENSITY = 30.0

# For `cook-torrance`: Beckmann's rms slope, and the ambient radiance, which the albedo multiplies.
SLOPE = 0.30
AMBIENT = 0.04

# The rotation of the object between frames in radians, counter-clockwise as seen from above.
STEP = 0.01
# The background; sRGB codes.
BACKGROUND = (13, 13, 15)


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


def axes():
    """The camera's right, up and back, unit; it looks along its negative z axis."""
    back = unit(np.subtract(EYE, TARGET))
    right = unit(np.cross((0, 1, 0), back))
    return right, np.cross(back, right), back


def world_from_camera():
    """View matrix, 4×4, applied to columns."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack(axes(), -1)
    matrix[:3, 3] = EYE
    return matrix


def clip_from_world(width, height):
    """OpenGL's projection: depth in [-1, 1]."""
    scale = 1 / np.tan(np.radians(FOV) / 2)
    depth, shift = (FAR + NEAR) / (NEAR - FAR), 2 * FAR * NEAR / (NEAR - FAR)
    projection = np.array([[scale * height / width, 0, 0, 0], [0, scale, 0, 0], [0, 0, depth, shift], [0, 0, -1, 0]])
    return projection @ np.linalg.inv(world_from_camera())


def turned(angle):
    """4×4, applied to columns: a rotation of the object about y."""
    sin, cos = np.sin(angle), np.cos(angle)
    return np.array([[cos, 0, sin, 0], [0, 1, 0, 0], [-sin, 0, cos, 0], [0, 0, 0, 1.0]])


def linear(code):
    """The linear value of an sRGB code, 0 to 255."""
    c = code / 255
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4
