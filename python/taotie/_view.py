"""Pages and widgets that show a model in a browser."""

from __future__ import annotations

import html
import os
from typing import TYPE_CHECKING, Any

from . import _taotie
from ._arrays import PathLike
from ._error import invalid, warn
from ._model import model as a_model
from ._options import ViewOptions, check, environment, image_request, renderer_request, takes
from ._run import running

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._widget import Widget


class Viewer:
    """A page that shows a model in a browser. Created by `view`; notebooks display it, and it fetches nothing.

    Examples
    --------
    >>> page = tt.view(asset, scan=scan)
    >>> page
    <taotie.Viewer 'Model'>
    """

    def __init__(self, native: _taotie.Viewer, title: str) -> None:
        self._native, self._title = native, title

    def html(self) -> str:
        """Return the page as one HTML document, as ``taotie view -o`` writes it.

        Examples
        --------
        >>> tt.view(scan).html()[:15]
        '<!doctype html>'
        """
        return self._native.html()

    def files(self) -> dict[str, bytes]:
        """Return the page and its accompanying files by name, as ``taotie view --folder`` writes them.

        Examples
        --------
        >>> "asset.glb" in tt.view(scan).files()
        True
        """
        return self._native.files()

    def save(self, path: PathLike) -> None:
        """Write the page as one file.

        Parameters
        ----------
        path : str or path
            The file, ending with ``.html``.

        Examples
        --------
        >>> tt.view(asset, scan=scan).save("proof.html")
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

        Examples
        --------
        >>> seen = tt.view(asset).widget()  # doctest: +SKIP
        >>> seen.light = (-75, 10)  # doctest: +SKIP
        """
        from ._widget import Widget

        return Widget(files=self.files(), height=height)

    def _repr_html_(self) -> str:
        page = html.escape(self.html(), quote=True)
        return f'<iframe srcdoc="{page}" title="Taotie" style="width: 100%; height: 480px; border: 0"></iframe>'

    def __repr__(self) -> str:
        return f"<taotie.Viewer {self._title!r}>"


@takes(ViewOptions)
def view(
    model: Any,
    *,
    scan: Any = None,
    publish_scan: bool = False,
    title: str | None = None,
    **options: Unpack[ViewOptions],
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
    **options
        The initial appearance: see `RenderOptions`.

    Returns
    -------
    Viewer
        Notebooks display it; `Viewer.widget` gives a version that Python can control.

    Raises
    ------
    Error
        With ``path``, ``where`` and ``remedy``.

    Examples
    --------
    >>> tt.view(asset, scan=scan, light="directional from=-75,10 strength=4").save("proof.html")
    """
    check("view", options, ViewOptions)
    seen = a_model(model, options.get("material"), options.get("bump_scale"))
    title = title or os.path.basename(seen.path or "") or "Model"
    request = {
        "title": title,
        "setup": renderer_request(options),
        "environment": environment(options),
        "image": image_request(options),
        "scan": None if scan is None else a_model(scan)._native,
        "publish_scan": publish_scan,
    }
    with running(options.get("progress"), options.get("threads")) as run:
        native = _taotie.Viewer(seen._native, request, run)
    warn(native.warnings())
    return Viewer(native, title)
