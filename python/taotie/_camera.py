"""Cameras: on an orbit, from the file, or placed by a pose."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from ._arrays import affine, matrix
from ._error import invalid, invalid_type, number
from ._repr import Value

Floats64 = npt.NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class Orbit(Value):
    """The position of a camera that orbits the object's centre.

    Parameters
    ----------
    azimuth_deg : float
        Degrees to the right of the front, which is +z.
    elevation_deg : float
        Degrees above the horizon.
    distance : float, optional
        Distance from the target, in model units, above 0; by default the object fills the image.

    Examples
    --------
    >>> image = tt.render(scan, camera=tt.Orbit(14, 10), size=32)
    """

    azimuth_deg: float
    elevation_deg: float
    distance: float | None = None


@dataclass(frozen=True, repr=False, eq=False)
class Camera(Value):
    """A camera of the file, one that orbits a target, or one placed by a pose. A separate option overrides its field.

    The cameras of images (`Image.camera`) have ``pose``, ``K``, ``projection`` and planes, and can be passed again.

    Parameters
    ----------
    name : str, optional
        A camera of the file by name, or one without a name by its index from 0; the orbit is then ignored.
    azimuth_deg, elevation_deg : float, optional
        As for `Orbit`; by default 25 and 15.
    distance : float, optional
        As for `Orbit`.
    target : (x, y, z), optional
        Point to look at; defaults to the object's centre. A turntable turns about it.
    fov_deg : float, default 30
        Vertical field of view, degrees.
    pose : array_like, optional
        ``(4, 4)``: the rigid transform from the camera to the world, for column vectors. The camera looks along its -z
        axis, with +y up, as in glTF, OpenGL and pyrender; for x right, y down, z forward, as in OpenCV and COLMAP, pass
        ``pose @ np.diag([1, -1, -1, 1])``. It replaces the orbit.
    K : array_like, optional
        ``(3, 3)``: intrinsics for an image of the rendered size, in pixels, origin at the corner of the top left pixel,
        x right, y down; the principal point may be anywhere. It needs ``pose`` and replaces ``fov_deg`` and ``height``.
        For an orthographic projection, pixels per model unit.
    projection : {"perspective", "orthographic"}
        Central or parallel projection.
    height : float, optional
        The height seen by an orthographic camera, model units; by default the object fills the image.
    near, far : float, optional
        Distances of the clipping planes, model units; by default the whole object is kept.

    Examples
    --------
    >>> pose = np.eye(4)
    >>> pose[:3, 3] = (0, 0, 5)
    >>> image = tt.render(scan, camera=tt.Camera(pose=pose, fov_deg=40), size=(64, 48))
    >>> image.camera.K.round(1)
    array([[65.9,  0. , 32. ],
           [ 0. , 65.9, 24. ],
           [ 0. ,  0. ,  1. ]])
    >>> plan = tt.Camera(azimuth_deg=0, elevation_deg=90, projection="orthographic")
    >>> image = tt.render(scan, camera=plan, size=32)
    """

    name: str | None = None
    _: KW_ONLY
    azimuth_deg: float | None = None
    elevation_deg: float | None = None
    distance: float | None = None
    target: Sequence[float] | None = None
    fov_deg: float | None = None
    pose: npt.ArrayLike | None = None
    K: npt.ArrayLike | None = None
    projection: Literal["perspective", "orthographic"] = "perspective"
    height: float | None = None
    near: float | None = None
    far: float | None = None

    def project(self, points: npt.ArrayLike) -> Floats64:
        """Return the pixels at which points appear, and their distances along the viewing axis.

        Parameters
        ----------
        points : array_like
            ``(..., 3)``, world space.

        Returns
        -------
        ndarray
            ``(..., 3)`` float64: x to the right and y down from the corner of the top left pixel, and the distance.

        Raises
        ------
        Error
            If the camera lacks ``pose`` or ``K``; the camera of an image has both.

        Examples
        --------
        >>> image = tt.render(scan, camera=tt.Camera(target=(0, 0, 0)), size=(64, 48))
        >>> x, y, distance = image.camera.project((0, 0, 0))
        >>> print(x.round(6), y.round(6))
        32.0 24.0
        """
        if self.pose is None or self.K is None:
            raise invalid("camera", "it has no pose, or no K; use the camera of an image, or give both")
        pose, intrinsics = _pose(self.pose), _intrinsics(self.K)
        x, y, z = np.moveaxis((np.asarray(points, dtype=np.float64) - pose[:3, 3]) @ pose[:3, :3], -1, 0)
        depth = -z
        scale = np.ones_like(depth) if self.projection == "orthographic" else depth
        seen = np.stack([x, -y, scale], axis=-1) @ intrinsics.T
        return np.stack([seen[..., 0] / seen[..., 2], seen[..., 1] / seen[..., 2], depth], axis=-1)


def camera_request(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the camera for the native module."""
    given = _given(options.get("camera"))
    fov_deg, target = options.get("fov_deg", given.fov_deg), options.get("target")
    if fov_deg is not None and not 0.0 < fov_deg < 180.0:
        raise invalid(f"fov_deg {fov_deg}", "use an angle between 0 and 180 degrees")
    target = given.target if target is None else target
    angles = {"azimuth": given.azimuth_deg, "elevation": given.elevation_deg, "fov_y": fov_deg}
    request: dict[str, Any] = {
        "name": given.name,
        "distance": None if given.distance is None else number("distance", given.distance),
        "target": None if target is None else [number("target", x) for x in target],
        **{name: math.radians(angle) for name, angle in angles.items() if angle is not None},
    }
    return {"options": request, "placed": _placed(given, request, options)}


def _given(camera: Any) -> Camera:
    if camera is None or isinstance(camera, str):
        return Camera(camera)
    if isinstance(camera, Orbit):
        return Camera(azimuth_deg=camera.azimuth_deg, elevation_deg=camera.elevation_deg, distance=camera.distance)
    if not isinstance(camera, Camera):
        raise invalid_type("camera", camera, "a Camera, an Orbit such as tt.Orbit(30, 15), or the name of one in the file")
    if camera.projection not in ("perspective", "orthographic"):
        raise invalid(f"projection {camera.projection!r}", "expected perspective or orthographic")
    is_parallel = camera.projection == "orthographic"
    if camera.height is not None and not (is_parallel and 0 < camera.height < math.inf):
        raise invalid(f"height {camera.height}", "expected a number above 0, for projection='orthographic'")
    if camera.K is not None and camera.pose is None:
        raise invalid("K", "it needs a pose; without one use fov_deg or height")
    if camera.name is not None and (is_parallel or camera.pose is not None):
        raise invalid(f"camera {camera.name!r}", "a camera of the file has a pose and a projection; omit yours, or the name")
    return camera


def _placed(camera: Camera, request: dict[str, Any], options: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return what the command's cameras lack: pose, projection and planes; puts the angle of view into `request`."""
    is_parallel = camera.projection == "orthographic"
    if camera.pose is None and not is_parallel and camera.near is None and camera.far is None:
        return None
    placed: dict[str, Any] = {
        "world_from_view": None,
        "is_parallel": is_parallel,
        "height": None if camera.height is None else number("height", camera.height),
        "near": None if camera.near is None else number("near", camera.near),
        "far": None if camera.far is None else number("far", camera.far),
    }
    if camera.pose is None:
        if not is_parallel:
            raise invalid("near, far", "they need a pose, or projection='orthographic'; an orbit keeps the whole object")
        return placed
    world_from_view = _pose(camera.pose)
    if camera.K is not None and "fov_deg" not in options:
        intrinsics = _intrinsics(camera.K)
        size = _size(options, intrinsics)
        height = size[1]
        if is_parallel:
            placed["height"] = height / intrinsics[1, 1]
        else:
            request["fov_y"] = 2 * math.atan(height / (2 * intrinsics[1, 1]))
        world_from_view = world_from_view @ np.linalg.inv(_shear(intrinsics, size, is_parallel))
    placed["world_from_view"] = world_from_view.T.tolist()
    return placed


def _shear(intrinsics: Floats64, size: tuple[float, float], is_parallel: bool) -> Floats64:
    """Return the transform of view space that moves the principal point to the centre and makes pixels square."""
    width, height = size
    focal = intrinsics[1, 1]
    shear = np.eye(4)
    shear[0, :2] = intrinsics[0, 0] / focal, -intrinsics[0, 1] / focal
    shift = (intrinsics[0, 2] - width / 2) / focal, (height / 2 - intrinsics[1, 2]) / focal
    if is_parallel:
        shear[:2, 3] = shift
    else:
        shear[:2, 2] = -shift[0], -shift[1]
    return shear


def _size(options: Mapping[str, Any], intrinsics: Floats64) -> tuple[float, float]:
    """Return the size of the image; without one, that which has the principal point in its centre."""
    size = options.get("size")
    if size is None:
        return 2 * float(intrinsics[0, 2]), 2 * float(intrinsics[1, 2])
    width, height = (size, size) if np.ndim(size) == 0 else size
    return float(width), float(height)


def _pose(values: npt.ArrayLike) -> Floats64:
    pose = affine("pose", values)
    turn = pose[:3, :3]
    if not np.allclose(turn.T @ turn, np.eye(3), atol=1e-3) or np.linalg.det(turn) < 0:
        raise invalid("pose", "its axes are not perpendicular unit vectors, right-handed; expected a rigid transform")
    return pose


def _intrinsics(values: npt.ArrayLike) -> Floats64:
    intrinsics = matrix("K", values, 3)
    if min(intrinsics[0, 0], intrinsics[1, 1]) <= 0 or not np.allclose(intrinsics[[1, 2, 2, 2], [0, 0, 1, 2]], (0, 0, 0, 1)):
        raise invalid("K", f"{intrinsics.tolist()}; expected [[fx, skew, cx], [0, fy, cy], [0, 0, 1]], fx and fy above 0")
    return intrinsics


def camera_of(seen: str, size: tuple[int, int]) -> Camera:
    """Return the camera of an image of this width and height, from the native module's JSON."""
    camera = json.loads(seen)
    world_from_view = np.array(camera["world_from_view"]).T
    ((projection, about),) = camera["projection"].items()
    width, height = size
    if projection == "perspective":
        half = math.tan(about["fov_y"] / 2) * max(1.0, (about["aspect"] or 0.0) * height / width)
    else:
        half = max(abs(about["half_height"]), abs(about["half_width"]) * height / width)
    axes, sheared = np.linalg.qr(world_from_view[:3, :3])
    signs = np.sign(np.diagonal(sheared))
    shear = np.linalg.inv(sheared * signs[:, None])
    pose = world_from_view.copy()
    pose[:3, :3] = axes * signs
    focal = height / (2 * half)
    (a, b, across), (_, c, down) = shear[0], shear[1]
    is_parallel = projection == "orthographic"
    intrinsics = np.array(
        [
            [focal * a, -focal * b, width / 2 - (0.0 if is_parallel else focal * across)],
            [0.0, focal * c, height / 2 + (0.0 if is_parallel else focal * down)],
            [0.0, 0.0, 1.0],
        ]
    )
    # Removes the rounding of cameras that are not sheared.
    intrinsics = np.where(np.abs(intrinsics - intrinsics.round(9)) < 1e-9, intrinsics.round(9) + 0.0, intrinsics)
    return Camera(pose=pose, K=intrinsics, projection=projection, near=about["near"], far=about["far"])
