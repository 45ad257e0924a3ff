"""The widget of notebooks."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from . import _taotie


@cache
def _module() -> str:
    """Return the module of the front end: the element, and what binds it to the traits."""
    return _taotie.viewer_script() + Path(__file__).with_name("widget.js").read_text(encoding="utf-8")


class Widget(anywidget.AnyWidget):
    """A model in a notebook, whose camera and light are moved by hand and from Python. Made by `Viewer.widget`.

    A trait that Python has not set has the default that is said here until the model is shown, and from then on what is
    shown.

    Attributes
    ----------
    camera : tuple of float
        Azimuth and elevation, degrees, and distance, model units; empty at first.
    target : tuple of float
        The point that is looked at, model units; empty at first.
    light : tuple of float or None
        Azimuth and elevation of the raking light, degrees; None for the lights that `view` was given.
    shadows : bool
        Whether the raking light casts shadows.
    mode : str
        ``shaded``, ``clay``, ``base-color``, ``normals``, ``tangent-normals``, ``roughness``, ``metallic``,
        ``occlusion``, ``uv``; with a scan ``error``.
    shading : str
        The reflectance model.
    surface : str
        The surface method, or ``best``.
    beside : str
        What stands right of the wipe: ``none``, ``smooth``, ``scan``.
    split : float
        Where the wipe is: a part of the width, [0, 1].
    """

    _files = traitlets.Dict().tag(sync=True)
    _said = traitlets.List(traitlets.Unicode()).tag(sync=True)
    height = traitlets.Int(480, min=1).tag(sync=True)
    camera = traitlets.Tuple().tag(sync=True)
    target = traitlets.Tuple().tag(sync=True)
    light = traitlets.Tuple(allow_none=True, default_value=None).tag(sync=True)
    shadows = traitlets.Bool(False).tag(sync=True)
    mode = traitlets.Unicode("shaded").tag(sync=True)
    shading = traitlets.Unicode("ggx").tag(sync=True)
    surface = traitlets.Unicode("best").tag(sync=True)
    beside = traitlets.Unicode("none").tag(sync=True)
    split = traitlets.Float(0.5, min=0.0, max=1.0).tag(sync=True)

    def __init__(self, files: dict[str, bytes], height: int) -> None:
        super().__init__(_esm=_module(), _files=files, height=height)
        self.observe(self._note, names=list(_SHOWN))

    def _note(self, change: Any) -> None:
        if change.name not in self._said:
            self._said = [*self._said, change.name]


_SHOWN = ("camera", "target", "light", "shadows", "mode", "shading", "surface", "beside", "split")
