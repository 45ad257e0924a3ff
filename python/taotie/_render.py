"""Images of models."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias, Union, overload

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._arrays import PathLike
from ._error import invalid, warn
from ._image import Image, image
from ._native import native_model
from ._options import Aov, Color, Material, Orbit, Shading, Surface, Tone
from ._options import camera as a_camera
from ._options import ambient_light, environment, film, lights
from ._run import Progress, running

Floats: TypeAlias = npt.NDArray[np.float32]


class Renderer:
    """A model that is prepared once, for many images. Use a separate one per thread.

    Parameters
    ----------
    model : path, Model, Asset, or a mesh of another package
        The model to render.
    surface : str, optional
        Source of the shading normals: facet, smooth, bump, bump-printed, object-normal, tangent-normal; defaults to
        the best that the material provides.
    bump_scale : float, optional
        Height of white for ``bump``, model units.
    tangents : {"face", "averaged", "mikktspace"}, optional
        Defaults to those of the file, otherwise mikktspace.
    material : Material or str, optional
        The material to apply to the model.
    env : {"studio", "none"} or path, optional
        Environment light: the built-in studio, an equirectangular .hdr or .exr, or none.
    env_rotate_deg : float
        Rotates the environment counterclockwise as seen from above.
    env_intensity : float
        Factor for its light.
    show_env : bool
        Show it behind the model.
    time : float, optional
        The time in the animation, in seconds.
    animation : str, optional
        The animation by name, or by number from 0; defaults to the first.
    threads : int, optional
        1 to 1024; defaults to all of the machine's. Pixels do not depend on it.
    """

    def __init__(
        self,
        model: Any,
        *,
        surface: Surface | None = None,
        bump_scale: float | None = None,
        tangents: Literal["face", "averaged", "mikktspace"] | None = None,
        material: Material | PathLike | None = None,
        env: PathLike | None = None,
        env_rotate_deg: float = 0.0,
        env_intensity: float = 1.0,
        show_env: bool = False,
        time: float | None = None,
        animation: str | None = None,
        threads: int | None = None,
    ) -> None:
        self._model, self._threads = native_model(model, material, bump_scale), threads
        self._surface = {"method": surface, "tangents": tangents, "bump_scale": bump_scale}
        setup = {
            "surface": self._surface,
            "environment": environment(env, env_rotate_deg, env_intensity, show_env),
            "time": None if time is None else float(time),
            "animation": animation,
        }
        with running(None, threads) as run:
            self._native = _taotie.Renderer(self._model, setup, run)
        warn(self._native.warnings())

    @overload
    def render(
        self,
        *,
        linear: Literal[False] = False,
        aov: Sequence[Aov] = (),
        shading: Shading = "ggx",
        camera: Orbit | str | None = None,
        target: Sequence[float] | None = None,
        fov_deg: float = 30.0,
        turn_deg: float = 0.0,
        all_around: bool = False,
        light: str | Sequence[str] | None = None,
        ambient: Color | None = None,
        shadows: bool = False,
        ground: bool = False,
        size: int | tuple[int, int] = (1024, 1024),
        samples: Literal[1, 4, 16] = 4,
        tone: Tone = "neutral",
        exposure: float = 0.0,
        background: Color | None = None,
        energy: Literal["compensated", "single"] = "compensated",
        specular_aa: bool = True,
        grazing_normals: Literal["soften", "keep"] = "soften",
        integrator: Literal["raster", "reference"] = "raster",
        spp: int = 64,
        bounces: int = 4,
        seed: int = 0,
        progress: Progress = None,
    ) -> Image: ...

    @overload
    def render(
        self,
        *,
        linear: Literal[True],
        aov: Sequence[Aov] = (),
        shading: Shading = "ggx",
        camera: Orbit | str | None = None,
        target: Sequence[float] | None = None,
        fov_deg: float = 30.0,
        turn_deg: float = 0.0,
        all_around: bool = False,
        light: str | Sequence[str] | None = None,
        ambient: Color | None = None,
        shadows: bool = False,
        ground: bool = False,
        size: int | tuple[int, int] = (1024, 1024),
        samples: Literal[1, 4, 16] = 4,
        tone: Tone = "neutral",
        exposure: float = 0.0,
        background: Color | None = None,
        energy: Literal["compensated", "single"] = "compensated",
        specular_aa: bool = True,
        grazing_normals: Literal["soften", "keep"] = "soften",
        integrator: Literal["raster", "reference"] = "raster",
        spp: int = 64,
        bounces: int = 4,
        seed: int = 0,
        progress: Progress = None,
    ) -> dict[str, Floats]: ...

    def render(
        self,
        *,
        linear: bool = False,
        aov: Sequence[Aov] = (),
        shading: Shading = "ggx",
        camera: Orbit | str | None = None,
        target: Sequence[float] | None = None,
        fov_deg: float = 30.0,
        turn_deg: float = 0.0,
        all_around: bool = False,
        light: str | Sequence[str] | None = None,
        ambient: Color | None = None,
        shadows: bool = False,
        ground: bool = False,
        size: int | tuple[int, int] = (1024, 1024),
        samples: Literal[1, 4, 16] = 4,
        tone: Tone = "neutral",
        exposure: float = 0.0,
        background: Color | None = None,
        energy: Literal["compensated", "single"] = "compensated",
        specular_aa: bool = True,
        grazing_normals: Literal["soften", "keep"] = "soften",
        integrator: Literal["raster", "reference"] = "raster",
        spp: int = 64,
        bounces: int = 4,
        seed: int = 0,
        progress: Progress = None,
    ) -> Union[Image, dict[str, Floats]]:
        """Render an image; see `taotie.render` for the parameters not listed here.

        Parameters
        ----------
        turn_deg : float
            The rotation of the object, as on a turntable, in degrees; lights and environment stay.
        all_around : bool
            Frame the object so that it stays in the image from all directions.
        """
        if aov and not linear:
            raise invalid("aov", "output variables need linear light: add linear=True")
        unknown = [name for name in aov if name not in ("normals", "depth", "albedo", "uv", "triangle")]
        if unknown:
            raise invalid(f"aov {unknown[0]}", "unknown; expected one of: normals, depth, albedo, uv, triangle")
        width, height = (size, size) if isinstance(size, int) else size
        is_reference = integrator == "reference"
        settings = {
            "width": int(width),
            "height": int(height),
            "samples": samples,
            "shading": shading,
            "surface": self._surface,
            "energy": energy,
            "specular_aa": specular_aa,
            "grazing_normals": grazing_normals,
            "shadows": shadows or is_reference,
            "ground": ground,
            "aovs": bool(aov),
        }
        request = {
            "settings": settings,
            "camera": a_camera(camera, target, fov_deg),
            "all_around": all_around,
            "turn": turn_deg.radians if isinstance(turn_deg, _Turn) else math.radians(turn_deg),
            "lights": lights(light),
            "ambient": ambient_light(ambient),
            "film": film(exposure, tone, background),
            "reference": {"spp": spp, "bounces": bounces, "seed": seed} if is_reference else None,
            "linear": linear,
        }
        with running(progress, self._threads) as run:
            taken = self._native.shoot(request, run)
        if not linear:
            return image(taken["codes"])
        return {name: taken[name] for name in ("color", *aov)}

    def turntable(self, count: int, **options: Any) -> list[Image]:
        """Render images all around the object.

        Parameters
        ----------
        count : int
            The number of images.
        **options
            The parameters of `render`.

        Returns
        -------
        list of Image
            As ``taotie render --turntable`` writes them.
        """
        turns = [_Turn(math.tau * index / count) for index in range(count)]
        return [self.render(turn_deg=turn, all_around=True, **options) for turn in turns]


class _Turn(float):
    """Degrees that remember the radians they were computed from: those of the command, to the bit."""

    radians: float

    def __new__(cls, radians: float) -> _Turn:
        turn = super().__new__(cls, math.degrees(radians))
        turn.radians = radians
        return turn


@overload
def render(
    model: Any,
    *,
    linear: Literal[False] = False,
    aov: Sequence[Aov] = (),
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
    shadows: bool = False,
    ground: bool = False,
    env: PathLike | None = None,
    env_rotate_deg: float = 0.0,
    env_intensity: float = 1.0,
    show_env: bool = False,
    time: float | None = None,
    animation: str | None = None,
    size: int | tuple[int, int] = (1024, 1024),
    samples: Literal[1, 4, 16] = 4,
    tone: Tone = "neutral",
    exposure: float = 0.0,
    background: Color | None = None,
    energy: Literal["compensated", "single"] = "compensated",
    specular_aa: bool = True,
    grazing_normals: Literal["soften", "keep"] = "soften",
    integrator: Literal["raster", "reference"] = "raster",
    spp: int = 64,
    bounces: int = 4,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress = None,
) -> Image: ...


@overload
def render(
    model: Any,
    *,
    linear: Literal[True],
    aov: Sequence[Aov] = (),
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
    shadows: bool = False,
    ground: bool = False,
    env: PathLike | None = None,
    env_rotate_deg: float = 0.0,
    env_intensity: float = 1.0,
    show_env: bool = False,
    time: float | None = None,
    animation: str | None = None,
    size: int | tuple[int, int] = (1024, 1024),
    samples: Literal[1, 4, 16] = 4,
    tone: Tone = "neutral",
    exposure: float = 0.0,
    background: Color | None = None,
    energy: Literal["compensated", "single"] = "compensated",
    specular_aa: bool = True,
    grazing_normals: Literal["soften", "keep"] = "soften",
    integrator: Literal["raster", "reference"] = "raster",
    spp: int = 64,
    bounces: int = 4,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress = None,
) -> dict[str, Floats]: ...


def render(
    model: Any,
    *,
    linear: bool = False,
    aov: Sequence[Aov] = (),
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
    shadows: bool = False,
    ground: bool = False,
    env: PathLike | None = None,
    env_rotate_deg: float = 0.0,
    env_intensity: float = 1.0,
    show_env: bool = False,
    time: float | None = None,
    animation: str | None = None,
    size: int | tuple[int, int] = (1024, 1024),
    samples: Literal[1, 4, 16] = 4,
    tone: Tone = "neutral",
    exposure: float = 0.0,
    background: Color | None = None,
    energy: Literal["compensated", "single"] = "compensated",
    specular_aa: bool = True,
    grazing_normals: Literal["soften", "keep"] = "soften",
    integrator: Literal["raster", "reference"] = "raster",
    spp: int = 64,
    bounces: int = 4,
    seed: int = 0,
    threads: int | None = None,
    progress: Progress = None,
) -> Union[Image, dict[str, Floats]]:
    """Render a model. Names and defaults are those of ``taotie render``, and so are the pixels, to the bit.

    Parameters
    ----------
    model : path, Model, Asset, or a mesh of another package
        The model to render.
    linear : bool
        Return linear light instead of a developed image.
    aov : sequence of str
        Additional output variables: normals, depth, albedo, uv, triangle; at the first sample of each pixel.
    shading : str
        Reflectance model: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, or as printed.
    surface, bump_scale, tangents, material, env, env_rotate_deg, env_intensity, show_env, time, animation, threads
        See `Renderer`.
    camera : Orbit or str, optional
        The position of the camera, or the name of a camera in the file. By default the object fills the image.
    target : (x, y, z), optional
        Point to look at; defaults to the object's centre.
    fov_deg : float
        Vertical field of view, degrees.
    light : str or sequence of str, optional
        ``point at=X,Y,Z``, ``spot at=X,Y,Z toward=X,Y,Z angle=DEG`` or ``directional from=AZIMUTH,ELEVATION``, each
        with ``strength=``, ``color=``, ``falloff=none|inverse-square``. Defaults to the file's lights, otherwise key,
        fill and rim.
    ambient : color, optional
        Ambient radiance from all directions.
    shadows : bool
        Lights cast shadows.
    ground : bool
        Add an invisible ground that receives the object's soft shadow.
    size : int or (width, height)
        Pixels.
    samples : {1, 4, 16}
        Samples per pixel, each of which is shaded.
    tone : str
        Tone curve: neutral, linear, reinhard, aces, agx.
    exposure : float
        Stops.
    background : color or "transparent", optional
        ``#2a2b2e`` by default.
    energy, specular_aa, grazing_normals
        Details of the reflection, as on the command line.
    integrator : {"raster", "reference"}
        The reference traces ``spp`` light paths per pixel, each with at most ``bounces`` reflections.
    progress : bool or callable, optional
        True for a progress bar; a callable receives stage and fraction, and stops the work by returning False.

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
    renderer = Renderer(
        model,
        surface=surface,
        bump_scale=bump_scale,
        tangents=tangents,
        material=material,
        env=env,
        env_rotate_deg=env_rotate_deg,
        env_intensity=env_intensity,
        show_env=show_env,
        time=time,
        animation=animation,
        threads=threads,
    )
    seen: dict[str, Any] = {
        "linear": linear,
        "aov": aov,
        "shading": shading,
        "camera": camera,
        "target": target,
        "fov_deg": fov_deg,
        "light": light,
        "ambient": ambient,
        "shadows": shadows,
        "ground": ground,
        "size": size,
        "samples": samples,
        "tone": tone,
        "exposure": exposure,
        "background": background,
        "energy": energy,
        "specular_aa": specular_aa,
        "grazing_normals": grazing_normals,
        "integrator": integrator,
        "spp": spp,
        "bounces": bounces,
        "seed": seed,
        "progress": progress,
    }
    result: Union[Image, dict[str, Floats]] = renderer.render(**seen)
    return result
