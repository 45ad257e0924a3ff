"""Measures the deviation of an asset from its model: one judge for the assets of all tools.

Taotie renders model and asset from eight sides with the same cameras and lights: the shading normals, including maps,
the base colours, and the image. Pixels whose neighbourhood both show are compared, so silhouettes are not. The angles
are computed here, CIEDE2000 by scikit-image. Pixels that an asset lacks altogether are counted.
"""

import concurrent.futures
import dataclasses
import math
import os

import inspected
import machine
import measure
import numpy as np
import OpenEXR
from PIL import Image
from skimage.color import deltaE_ciede2000, rgb2lab

AZIMUTHS = range(0, 360, 45)
# Alternately above and below the horizon, degrees.
ELEVATIONS = (20, -12)
PIXELS = 512
FOV = 30
# This many pixels around one must be covered in both images.
MARGIN = 3


@dataclasses.dataclass(frozen=True)
class View:
    """The view of one camera; arrays of (PIXELS, PIXELS, 3), and the pixels covered by the object."""

    normals: np.ndarray
    albedo: np.ndarray
    image: np.ndarray
    covered: np.ndarray


@dataclasses.dataclass(frozen=True)
class Verdict:
    """Means and 95 % quantiles over all pixels of all views: degrees, and CIEDE2000 of base colour and image.

    `missed` is the fraction of the model's pixels, without its silhouette, at which the asset shows nothing.
    """

    degrees: float
    degrees_p95: float
    albedo: float
    albedo_p95: float
    image: float
    missed: float


class Judge:
    """Renders one model, then its assets."""

    def __init__(self, program, folder, model):
        self.program, self.folder = program, folder
        about = inspected.of(program, model)
        low, high = (np.array(about["bounds"][end]) for end in ("min", "max"))
        radius = np.linalg.norm(high - low) / 2
        self.target = (low + high) / 2
        self.distance = radius / math.sin(math.radians(FOV / 2))
        self.model = self.views(model)
        self.inner = [shrunk(view.covered) for view in self.model]

    def verdict(self, asset):
        """The difference between the model and an asset."""
        views = self.views(asset)
        pairs = at_once(self.apart, self.model, views)
        angles, albedo, image = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
        if not len(angles):
            raise measure.Failed(f"{asset}: no pixel shows both the asset and its model")
        figures = [angles.mean(), np.percentile(angles, 95), albedo.mean(), np.percentile(albedo, 95), image.mean()]
        return Verdict(*map(float, [*figures, self.missed(views)]))

    def missed(self, views):
        """The fraction of the model's inner pixels that the views of an asset do not cover."""
        lost = [inner & ~view.covered for inner, view in zip(self.inner, views, strict=True)]
        return np.sum(lost) / np.sum(self.inner)

    def apart(self, model, asset):
        """Angles and colour differences at the pixels that count."""
        inner = shrunk(model.covered & asset.covered)
        colors = [deltaE_ciede2000(rgb2lab(a[inner]), rgb2lab(b[inner])) for a, b in self.colors(model, asset)]
        return [angles(model.normals[inner], asset.normals[inner]), *colors]

    @staticmethod
    def colors(model, asset):
        return (model.albedo, asset.albedo), (model.image, asset.image)

    def views(self, path):
        elevations = [ELEVATIONS[i % 2] for i in range(len(AZIMUTHS))]
        return at_once(lambda *angles: self.view(path, *angles), AZIMUTHS, elevations)

    def view(self, path, azimuth, elevation):
        out = os.path.join(self.folder, f"view-{azimuth}")
        camera = [f"--orbit={azimuth},{elevation},{self.distance:.9g}", f"--fov-deg={FOV}"]
        camera.append("--target=" + ",".join(f"{x:.9g}" for x in self.target))
        look = ["--size", str(PIXELS), "--env", "studio", "--tone", "linear", "--background", "transparent"]
        aovs = ["--aov", "normals,albedo", "--quiet"]
        measure.run([self.program, "render", path, "-o", f"{out}.png", *camera, *look, *aovs])
        image, albedo = (picture(f"{out}.{kind}") for kind in ("png", "albedo.png"))
        normals = OpenEXR.File(f"{out}.normals.exr").channels()["RGBA"].pixels[..., :3]
        covered = (image[..., 3] == 1) & (np.linalg.norm(normals, axis=-1) > 0.5)
        return View(normals.astype(np.float64), albedo[..., :3], image[..., :3], covered)


def at_once(work, *arguments):
    """Calls `work` for each set of arguments, on all cores; returns a list in their order."""
    with concurrent.futures.ThreadPoolExecutor(machine.cores()) as pool:
        return list(pool.map(work, *arguments))


def picture(path):
    """RGBA in [0, 1], encoded as sRGB."""
    return np.asarray(Image.open(path).convert("RGBA")) / 255


def shrunk(mask):
    """Removes the pixels that have an uncovered one in their neighbourhood, or are at the image's edge."""
    side = 2 * MARGIN + 1
    padded = np.pad(mask, MARGIN)
    for axis in (0, 1):
        padded = np.lib.stride_tricks.sliding_window_view(padded, side, axis).all(-1)
    return padded


def angles(a, b):
    """Angles between unit vectors, in degrees; also accurate for small angles."""
    return np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)))
