"""Images of models."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, get_args, overload

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._error import invalid, warn
from ._image import Image, image
from ._native import native_model
from ._options import Aov, ImageOptions, RendererOptions, RenderOptions, TurntableOptions
from ._options import check, chosen, image_request, names, renderer_request, takes
from ._run import running

if TYPE_CHECKING:
    from typing_extensions import Unpack

Floats: TypeAlias = npt.NDArray[np.float32]


class Renderer:
    """A model that is prepared once, for many images. Use a separate one per thread.

    Parameters
    ----------
    model : path, Model, Asset, or a mesh of another package
        The model to render.
    **options
        See `RenderOptions`.
    """

    @takes(RendererOptions)
    def __init__(self, model: Any, **options: Unpack[RendererOptions]) -> None:
        check("Renderer.__init__", options, RendererOptions)
        native = native_model(model, options.get("material"), options.get("bump_scale"))
        self._options = options
        with running(None, options.get("threads")) as run:
            self._native = _taotie.Renderer(native, renderer_request(options), run)
        warn(self._native.warnings())

    @overload
    def render(self, *, linear: Literal[False] = False, **options: Unpack[ImageOptions]) -> Image: ...

    @overload
    def render(self, *, linear: Literal[True], **options: Unpack[ImageOptions]) -> dict[str, Floats]: ...

    @takes(ImageOptions)
    def render(self, *, linear: bool = False, **options: Unpack[ImageOptions]) -> Image | dict[str, Floats]:
        """Render an image, as `taotie.render` does.

        Parameters
        ----------
        linear : bool
            Return linear light instead of a developed image.
        turn_deg, all_around
            See `ImageOptions`.
        **options
            See `RenderOptions`.
        """
        check("Renderer.render", options, ImageOptions)
        turn = math.radians(options.get("turn_deg", 0.0))
        return self._image(linear, turn, options.get("all_around", False), options)

    @overload
    def turntable(
        self, count: int, *, linear: Literal[False] = False, **options: Unpack[TurntableOptions]
    ) -> list[Image]: ...

    @overload
    def turntable(
        self, count: int, *, linear: Literal[True], **options: Unpack[TurntableOptions]
    ) -> list[dict[str, Floats]]: ...

    @takes(TurntableOptions)
    def turntable(self, count: int, *, linear: bool = False, **options: Unpack[TurntableOptions]) -> list[Any]:
        """Render images all around the object.

        Parameters
        ----------
        count : int
            The number of images.
        linear : bool
            Return linear light instead of developed images.
        **options
            See `RenderOptions`.

        Returns
        -------
        list of Image
            As ``taotie render --turntable`` writes them; with ``linear`` a list of dicts.
        """
        check("Renderer.turntable", options, TurntableOptions)
        return [self._image(linear, math.tau * index / count, True, options) for index in range(count)]

    def _image(
        self, linear: bool, turn: float, all_around: bool, options: Mapping[str, Any]
    ) -> Image | dict[str, Floats]:
        """Render an image of the object, turned by an angle in radians."""
        aov = options.get("aov", ())
        if aov and not linear:
            raise invalid("aov", "output variables need linear light: add linear=True")
        unknown = [name for name in aov if name not in get_args(Aov)]
        if unknown:
            raise invalid(f"aov {unknown[0]}", f"unknown; expected one of: {', '.join(get_args(Aov))}")
        request: dict[str, Any] = {
            **image_request({**self._options, **options}),
            "all_around": all_around,
            "turn": turn,
            "linear": linear,
        }
        request["settings"]["aovs"] = bool(aov)
        if options.get("integrator") == "reference":
            request["settings"]["shadows"] = True
            request["reference"] = chosen(options, ["spp", "bounces", "seed"])
        with running(options.get("progress"), self._options.get("threads")) as run:
            taken = self._native.shoot(request, run)
        if not linear:
            return image(taken["codes"])
        return {name: taken[name] for name in ("color", *aov)}


@overload
def render(model: Any, *, linear: Literal[False] = False, **options: Unpack[RenderOptions]) -> Image: ...


@overload
def render(model: Any, *, linear: Literal[True], **options: Unpack[RenderOptions]) -> dict[str, Floats]: ...


@takes(RenderOptions)
def render(model: Any, *, linear: bool = False, **options: Unpack[RenderOptions]) -> Image | dict[str, Floats]:
    """Render a model. Names and defaults are those of ``taotie render``, and so are the pixels, to the bit.

    Parameters
    ----------
    model : path, Model, Asset, or a mesh of another package
        The model to render.
    linear : bool
        Return linear light instead of a developed image.
    **options
        See `RenderOptions`.

    Returns
    -------
    Image
        ``(height, width, 4)`` uint8, sRGB, straight alpha; its first row is the top.
    dict of float32 arrays
        With ``linear``: ``color`` ``(height, width, 4)``, radiance premultiplied by coverage, and the output variables:
        ``normals`` and ``albedo`` ``(height, width, 3)``, ``uv`` ``(height, width, 2)``, ``depth`` and ``triangle``
        ``(height, width)``; NaN where nothing is visible. Depth is along the viewing axis, in model units.

    Raises
    ------
    Error
        With ``path``, ``where`` and ``remedy``.
    """
    check("render", options, RenderOptions)
    renderer = Renderer(model, **chosen(options, names(RendererOptions)))
    return renderer._image(linear, 0.0, False, options)
