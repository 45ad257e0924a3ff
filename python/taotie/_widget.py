"""The notebook widget."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from . import _taotie


@cache
def _module() -> str:
    """Return the front-end module: the element, and its binding to the traits."""
    return _taotie.viewer_script() + Path(__file__).with_name("widget.js").read_text(encoding="utf-8")


class Widget(anywidget.AnyWidget):
    """A model in a notebook, whose camera and light can be moved by hand and from Python. Created by `Viewer.widget`.

    A trait that Python has not set has the default listed here until the model is shown; from then on it has the
    current value.

    Attributes
    ----------
    camera : tuple of float
        Azimuth and elevation, degrees, and distance, model units; initially empty.
    target : tuple of float
        The point that the camera looks at, model units; initially empty.
    light : tuple of float or None
        Azimuth and elevation of the raking light, degrees; None for the lights given to `view`.
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
        The content right of the wipe: ``none``, ``smooth``, ``scan``.
    split : float
        The position of the wipe as a fraction of the width, [0, 1].
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
