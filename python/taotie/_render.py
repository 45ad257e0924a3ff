"""Images of models."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, get_args, overload

from . import _taotie
from ._camera import camera_of
from ._error import invalid, warn
from ._image import Buffers, Image, image
from ._native import native_model
from ._options import Aov, ImageOptions, RendererOptions, RenderOptions, TurntableOptions
from ._options import check, chosen, environment, image_request, names, renderer_request, takes
from ._run import running, shown

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Renderer:
    """A model that is prepared once, for many images. Use a separate one per thread.

    Parameters
    ----------
    model : path, Model, Asset, or a mesh of another package
        The model to render.
    **options
        See `RenderOptions`.

    Examples
    --------
    >>> renderer = tt.Renderer(scan, env="studio")
    >>> images = [renderer.render(camera=tt.Orbit(azimuth, 10), size=32) for azimuth in (0, 90, 180)]
    """

    @takes(RendererOptions)
    def __init__(self, model: Any, **options: Unpack[RendererOptions]) -> None:
        check("Renderer.__init__", options, RendererOptions)
        native = native_model(model, options.get("material"), options.get("bump_scale"))
        self._options = options
        with running(None, options.get("threads")) as run:
            request = {"setup": renderer_request(options), "environment": environment(options)}
            self._native = _taotie.Renderer(native, request, run)
        warn(self._native.warnings())

    @property
    def device(self) -> str:
        """The device that renders, ``cpu`` or the name of the GPU.

        Examples
        --------
        >>> tt.Renderer(scan).device
        'cpu'
        """
        return self._native.device()

    def __repr__(self) -> str:
        return f"<taotie.Renderer on {self.device}>"

    @overload
    def render(self, *, linear: Literal[False] = False, **options: Unpack[ImageOptions]) -> Image: ...

    @overload
    def render(self, *, linear: Literal[True], **options: Unpack[ImageOptions]) -> Buffers: ...

    @takes(ImageOptions)
    def render(self, *, linear: bool = False, **options: Unpack[ImageOptions]) -> Image | Buffers:
        """Render an image, as `taotie.render` does.

        Parameters
        ----------
        linear : bool
            Return linear light instead of a developed image.
        turn_deg, all_around
            See `ImageOptions`.
        **options
            See `RenderOptions`.

        Examples
        --------
        >>> image = tt.Renderer(scan).render(turn_deg=30, size=32)
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
    ) -> list[Buffers]: ...

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
            As ``taotie render --turntable`` writes them; with ``linear`` a list of `Buffers`.

        Examples
        --------
        >>> frames = tt.Renderer(scan).turntable(4, size=32)
        >>> np.stack(frames).shape
        (4, 32, 32, 4)
        """
        check("Renderer.turntable", options, TurntableOptions)
        with shown(options.get("progress"), {"render": 1.0}) as listened:

            def frame(index: int) -> Any:
                def report(stage: str, done: float) -> object:
                    return None if listened is None else listened(stage, (index + done) / count)

                progress = None if listened is None else report
                return self._image(linear, math.tau * index / count, True, {**options, "progress": progress})

            return [frame(index) for index in range(count)]

    def _image(self, linear: bool, turn: float, all_around: bool, options: Mapping[str, Any]) -> Image | Buffers:
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
        pixels = taken["color" if linear else "codes"]
        camera = camera_of(taken["camera"], (pixels.shape[1], pixels.shape[0]))
        if not linear:
            return image(pixels, camera)
        return Buffers({name: taken[name] for name in ("color", *aov)}, camera)


@overload
def render(model: Any, *, linear: Literal[False] = False, **options: Unpack[RenderOptions]) -> Image: ...


@overload
def render(model: Any, *, linear: Literal[True], **options: Unpack[RenderOptions]) -> Buffers: ...


@takes(RenderOptions)
def render(model: Any, *, linear: bool = False, **options: Unpack[RenderOptions]) -> Image | Buffers:
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
    Buffers
        With ``linear``: a dict of ``color`` ``(height, width, 4)``, radiance premultiplied by coverage, and the output
        variables: ``normals``, ``albedo`` and ``position`` ``(height, width, 3)``, ``uv`` ``(height, width, 2)``,
        ``depth`` and ``triangle`` ``(height, width)``. They are float32, NaN where nothing is visible; ``triangle`` is
        uint32, 4294967295 there. Depth is along the viewing axis, in model units; normals and positions are in world
        space.

    Raises
    ------
    Error
        With ``path``, ``where`` and ``remedy``.

    Examples
    --------
    >>> image = tt.render(asset, camera=tt.Orbit(14, 10), light="directional from=-75,10 strength=4", size=(64, 48))
    >>> found = tt.render(asset, linear=True, aov=["position"], size=(64, 48))
    >>> found["position"].shape
    (48, 64, 3)
    """
    check("render", options, RenderOptions)
    renderer = Renderer(model, **chosen(options, names(RendererOptions)))
    return renderer._image(linear, 0.0, False, options)
