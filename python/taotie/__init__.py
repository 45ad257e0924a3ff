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
from ._bake import Asset, Met, Proof, Written, bake, verify
from ._compare import Comparison, View, compare
from ._diff import Difference, diff
from ._error import Cancelled, Error, NotMet, TaotieWarning
from ._image import Image
from ._inspect import Audit, Inspection, inspect
from ._model import Mesh, Model, load
from ._options import Camera, CompareOptions, Environment, ImageOptions, Light, Material, Orbit
from ._options import RendererOptions, RenderOptions, TurntableOptions, ViewOptions
from ._render import Renderer, render
from ._taotie import __version__
from ._view import Viewer, view

__all__ = [
    "Asset",
    "Audit",
    "Camera",
    "Cancelled",
    "CompareOptions",
    "Comparison",
    "Difference",
    "Environment",
    "Error",
    "Image",
    "ImageOptions",
    "Inspection",
    "Light",
    "Material",
    "Mesh",
    "Met",
    "Model",
    "NotMet",
    "Orbit",
    "Proof",
    "RenderOptions",
    "Renderer",
    "RendererOptions",
    "TaotieWarning",
    "TurntableOptions",
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
    "render",
    "shade",
    "verify",
    "view",
]
