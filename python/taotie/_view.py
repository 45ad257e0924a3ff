"""Pages and widgets that show a model in a browser."""

from __future__ import annotations

import html
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from . import _taotie
from ._arrays import PathLike
from ._error import invalid, warn
from ._model import model as a_model
from ._options import Color, Material, Orbit, Shading, Surface, Tone, ambient_light, environment, film, lights
from ._options import camera as a_camera
from ._run import Progress, running

if TYPE_CHECKING:
    from ._widget import Widget


class Viewer:
    """A page that shows a model in a browser. Created by `view`; notebooks display it, and it fetches nothing."""

    def __init__(self, native: _taotie.Viewer) -> None:
        self._native = native

    def html(self) -> str:
        """Return the page as one HTML document, as ``taotie view -o`` writes it."""
        return self._native.html()

    def files(self) -> dict[str, bytes]:
        """Return the page and its accompanying files by name, as ``taotie view --folder`` writes them."""
        return self._native.files()

    def save(self, path: PathLike) -> None:
        """Write the page as one file.

        Parameters
        ----------
        path : str or path
            The file, ending with ``.html``.
        """
        name = os.fspath(path)
        if not name.lower().endswith(".html"):
            raise invalid(name, "use a name ending in .html")
        with open(name, "w", encoding="utf-8", newline="") as file:
            file.write(self.html())

    def widget(self, height: int = 480) -> Widget:
        """Return a notebook widget whose camera, light and mode can be read and set from Python. Needs anywidget.

        Parameters
        ----------
        height : int
            Height of the image, in pixels.
        """
        from ._widget import Widget

        return Widget(files=self.files(), height=height)

    def _repr_html_(self) -> str:
        page = html.escape(self.html(), quote=True)
        return f'<iframe srcdoc="{page}" title="Taotie" style="width: 100%; height: 480px; border: 0"></iframe>'

    def __repr__(self) -> str:
        return "<taotie.Viewer>"


def view(
    model: Any,
    *,
    scan: Any = None,
    publish_scan: bool = False,
    title: str | None = None,
    shading: Shading = "ggx",
    surface: Surface | None = None,
    bump_scale: float | None = None,
    tangents: Literal["face", "averaged", "mikktspace"] | None = None,
    material: Material | PathLike | None = None,
    camera: Orbit | str | None = None,
    target: Sequence[float] | None = None,
    fov_deg: float = 30.0,
    light: str | Sequence[str] | None = None,
    ambient: Color | None = None,
    env: PathLike | None = None,
    env_rotate_deg: float = 0.0,
    env_intensity: float = 1.0,
    samples: Literal[1, 4, 16] = 4,
    tone: Tone = "neutral",
    exposure: float = 0.0,
    background: Color | None = None,
    energy: Literal["compensated", "single"] = "compensated",
    specular_aa: bool = True,
    grazing_normals: Literal["soften", "keep"] = "soften",
    threads: int | None = None,
    progress: Progress = None,
) -> Viewer:
    """Make a page that shows a model in a browser. Names and defaults are those of ``taotie view``.

    Parameters
    ----------
    model : path, Model, Asset, or a mesh of another package
        The model to show.
    scan : path, Model, or a mesh of another package, optional
        The scan that the model was baked from: the page shows the measured error on the model, but no part of the
        scan.
    publish_scan : bool
        Include the scan itself in the page, to be shown next to the model behind a wipe.
    title : str, optional
        The heading; defaults to the file's name.
    shading, camera, target, fov_deg, light, ambient, samples, tone, exposure, background, energy, specular_aa
        The initial appearance; see `render`.
    grazing_normals, surface, bump_scale, tangents, material, env, env_rotate_deg, env_intensity, threads
        See `render`.
    progress : bool or callable, optional
        True for a progress bar; a callable receives stage and fraction, and stops the work by returning False.

    Returns
    -------
    Viewer
        Notebooks display it; `Viewer.widget` gives a version that Python can control.

    Raises
    ------
    Error
        With ``path``, ``where`` and ``remedy``.
    """
    seen = a_model(model, material, bump_scale)
    of = {"method": surface, "tangents": tangents, "bump_scale": bump_scale}
    settings = {
        "samples": samples,
        "shading": shading,
        "surface": of,
        "energy": energy,
        "specular_aa": specular_aa,
        "grazing_normals": grazing_normals,
    }
    request = {
        "title": title or os.path.basename(seen.path or "") or "Model",
        "setup": {"surface": of, "environment": environment(env, env_rotate_deg, env_intensity, False)},
        "image": {
            "settings": settings,
            "camera": a_camera(camera, target, fov_deg),
            "lights": lights(light),
            "ambient": ambient_light(ambient),
            "film": film(exposure, tone, background),
        },
        "scan": None if scan is None else a_model(scan)._native,
        "publish_scan": publish_scan,
    }
    with running(progress, threads) as run:
        native = _taotie.Viewer(seen._native, request, run)
    warn(native.warnings())
    return Viewer(native)
