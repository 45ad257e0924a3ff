"""Taotie bakes high-poly scans to low-poly glTF with normal maps, renders them physically, and measures the error.

>>> import taotie as tt
>>> scan = tt.load("scan.ply")
>>> asset = tt.bake(scan, triangles=50_000, size=2048)
>>> proof = asset.verify(scan)
>>> proof.require(mean_angle=2)
>>> asset.save("scan.glb")
>>> image = tt.render(asset, size=(640, 480))

It needs neither a display nor a GPU, and the same input gives the same bits on every machine.
"""

from . import normals, shade
from ._bake import Asset, Written, bake
from ._camera import Camera, Orbit
from ._compare import Comparison, View, compare
from ._diff import Difference, diff
from ._error import Cancelled, Error, FileError, InvalidType, InvalidValue, MissingFile, NotMet, TaotieWarning
from ._image import Buffers, Image
from ._inspect import Audit, Inspection, inspect
from ._light import Environment, Light
from ._material import Material
from ._model import Mesh, Model, load
from ._options import CompareOptions, ImageOptions, RendererOptions, RenderOptions, TurntableOptions, ViewOptions
from ._photometric import PhotometricNormals, photometric
from ._proof import Met, Proof, VerifyOptions, verify
from ._render import Renderer, render
from ._scene import Scene
from ._taotie import __version__
from ._view import Viewer, view

__all__ = [
    "Asset",
    "Audit",
    "Buffers",
    "Camera",
    "Cancelled",
    "CompareOptions",
    "Comparison",
    "Difference",
    "Environment",
    "Error",
    "FileError",
    "Image",
    "ImageOptions",
    "Inspection",
    "InvalidType",
    "InvalidValue",
    "Light",
    "Material",
    "Mesh",
    "Met",
    "MissingFile",
    "Model",
    "NotMet",
    "Orbit",
    "PhotometricNormals",
    "Proof",
    "RenderOptions",
    "Renderer",
    "RendererOptions",
    "Scene",
    "TaotieWarning",
    "TurntableOptions",
    "VerifyOptions",
    "View",
    "ViewOptions",
    "Viewer",
    "Written",
    "__version__",
    "bake",
    "compare",
    "diff",
    "inspect",
    "load",
    "normals",
    "photometric",
    "render",
    "shade",
    "verify",
    "view",
]
