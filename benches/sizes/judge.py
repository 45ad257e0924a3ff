"""How far an asset is from its model: one judge for the assets of all tools.

Taotie renders model and asset from eight sides by the same cameras, under the same light: the normals that are shaded,
maps and all, the base colours, and the image. Pixels whose surroundings both show are compared, so silhouettes are not.
The angles are computed here, CIEDE2000 by scikit-image.
"""

import dataclasses
import math
import os

import inspected
import measure
import numpy as np
import OpenEXR
from PIL import Image
from skimage.color import deltaE_ciede2000, rgb2lab

AZIMUTHS = range(0, 360, 45)
# Above and below the horizon by turns, degrees.
ELEVATIONS = (20, -12)
PIXELS = 512
FOV = 30
# As many pixels around one must be covered in both images.
MARGIN = 3


@dataclasses.dataclass(frozen=True)
class View:
    """What one camera sees; arrays of (PIXELS, PIXELS, 3), and which pixels the object covers."""

    normals: np.ndarray
    albedo: np.ndarray
    image: np.ndarray
    covered: np.ndarray


@dataclasses.dataclass(frozen=True)
class Verdict:
    """Means over all pixels of all views, and the 95 % quantile of the angles; degrees and CIEDE2000."""

    degrees: float
    p95: float
    albedo: float
    image: float


class Judge:
    """Looks at one model, then at its assets."""

    def __init__(self, program, folder, model):
        self.program, self.folder = program, folder
        about = inspected.of(program, model)
        low, high = (np.array(about["bounds"][end]) for end in ("min", "max"))
        radius = np.linalg.norm(high - low) / 2
        self.target = (low + high) / 2
        self.distance = radius / math.sin(math.radians(FOV / 2))
        self.triangles = about["counts"]["triangles_drawn"]
        self.model = self.views(model)

    def verdict(self, asset):
        """What is apart between the model and an asset."""
        pairs = [self.apart(*pair) for pair in zip(self.model, self.views(asset), strict=True)]
        angles, albedo, image = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
        if not len(angles):
            raise measure.Failed(f"{asset}: no pixel shows it where its model is")
        figures = (angles.mean(), np.percentile(angles, 95), albedo.mean(), image.mean())
        return Verdict(*map(float, figures))

    def apart(self, model, asset):
        """Angles and differences of colour at the pixels that count."""
        inner = shrunk(model.covered & asset.covered)
        colors = [deltaE_ciede2000(rgb2lab(a[inner]), rgb2lab(b[inner])) for a, b in self.colors(model, asset)]
        return [angles(model.normals[inner], asset.normals[inner]), *colors]

    @staticmethod
    def colors(model, asset):
        return (model.albedo, asset.albedo), (model.image, asset.image)

    def views(self, path):
        return [self.view(path, azimuth, ELEVATIONS[i % 2]) for i, azimuth in enumerate(AZIMUTHS)]

    def view(self, path, azimuth, elevation):
        out = os.path.join(self.folder, "view")
        camera = [f"--orbit={azimuth},{elevation},{self.distance:.9g}", f"--fov-deg={FOV}"]
        camera.append("--target=" + ",".join(f"{x:.9g}" for x in self.target))
        look = ["--size", str(PIXELS), "--env", "studio", "--tone", "linear", "--background", "transparent"]
        aovs = ["--aov", "normals,albedo", "--quiet"]
        measure.run([self.program, "render", path, "-o", f"{out}.png", *camera, *look, *aovs])
        image, albedo = (picture(f"{out}.{kind}") for kind in ("png", "albedo.png"))
        normals = OpenEXR.File(f"{out}.normals.exr").channels()["RGBA"].pixels[..., :3]
        covered = (image[..., 3] == 1) & (np.linalg.norm(normals, axis=-1) > 0.5)
        return View(normals.astype(np.float64), albedo[..., :3], image[..., :3], covered)


def picture(path):
    """RGBA in [0, 1], encoded as sRGB."""
    return np.asarray(Image.open(path).convert("RGBA")) / 255


def shrunk(mask):
    """Without the pixels that have another in their surroundings, or lie at the image's edge."""
    side = 2 * MARGIN + 1
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(mask, MARGIN), (side, side))
    return windows.all((-2, -1))


def angles(a, b):
    """Between unit vectors, degrees; exact for small angles too."""
    return np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1)))
