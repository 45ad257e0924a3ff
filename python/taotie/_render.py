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
from ._model import model as a_model
from ._options import Aov, Color, Material, Orbit, Shading, Surface, Tone
from ._options import camera as a_camera
from ._options import ambient_light, environment, film, lights
from ._run import Progress, running

Floats: TypeAlias = npt.NDArray[np.float32]


class Renderer:
    """A model that is prepared once, for many images. Two threads may have one each.

    Parameters
    ----------
    model : path, Model, Asset, or a mesh of another package
        What is seen.
    surface : str, optional
        Source of the shading normals: facet, smooth, bump, bump-printed, object-normal, tangent-normal; the best that
        the material provides if not given.
    bump_scale : float, optional
        Height of white for ``bump``, model units.
    tangents : {"face", "averaged", "mikktspace"}, optional
        Those of the file, else mikktspace, if not given.
    material : Material or str, optional
        What its materials are made of.
    env : {"studio", "none"} or path, optional
        Light from all around: the studio that is built in, an equirectangular .hdr or .exr, or none.
    env_rotate_deg : float
        Turns the environment counterclockwise as seen from above.
    env_intensity : float
        Factor of its light.
    show_env : bool
        Show it behind the model.
    time : float, optional
        The moment of an animation to show, seconds.
    animation : str, optional
        The animation by name, or by number from 0; the first if not given.
    threads : int, optional
        1 to 1024; all of the machine's if not given. Pixels do not depend on it.
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
        self._model, self._threads = a_model(model, material, bump_scale), threads
        self._surface = {"method": surface, "tangents": tangents, "bump_scale": bump_scale}
        setup = {
            "surface": self._surface,
            "environment": environment(env, env_rotate_deg, env_intensity, show_env),
            "time": None if time is None else float(time),
            "animation": animation,
        }
        with running(None, threads) as run:
            self._native = _taotie.Renderer(self._model._native, setup, run)
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
        """Take an image; see `taotie.render` for what is not said here.

        Parameters
        ----------
        turn_deg : float
            The object has turned by so many degrees, as if it stood on a turntable; lights and environment stay.
        all_around : bool
            Frame the object so that it stays in the picture all around.
        """
        if aov and not linear:
            raise invalid("aov", "output variables come with light as it is: add linear=True")
        unknown = [name for name in aov if name not in ("normals", "depth", "albedo", "uv", "triangle")]
        if unknown:
            raise invalid(f"aov {unknown[0]}", "there is none of this name; choose from: normals, depth, albedo, uv, triangle")
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
        """Take images all around the object.

        Parameters
        ----------
        count : int
            The number of images.
        **options
            As those of `render`.

        Returns
        -------
        list of Image
            As ``taotie render --turntable`` writes them.
        """
        turns = [_Turn(math.tau * index / count) for index in range(count)]
        return [self.render(turn_deg=turn, all_around=True, **options) for turn in turns]


class _Turn(float):
    """Degrees that know the radians they were made of: those of the command, to the bit."""

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
        What is seen.
    linear : bool
        Return light as it is, and not developed.
    aov : sequence of str
        Output variables beside it: normals, depth, albedo, uv, triangle; at the first sample of each pixel.
    shading : str
        Reflectance model: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, or as printed.
    surface, bump_scale, tangents, material, env, env_rotate_deg, env_intensity, show_env, time, animation, threads
        See `Renderer`.
    camera : Orbit or str, optional
        Where it stands, or a camera of the file by name. Without one the object fills the picture.
    target : (x, y, z), optional
        Point to look at; the object's middle if not given.
    fov_deg : float
        Vertical field of view, degrees.
    light : str or sequence of str, optional
        ``point at=X,Y,Z``, ``spot at=X,Y,Z toward=X,Y,Z angle=DEG`` or ``directional from=AZIMUTH,ELEVATION``, each
        with ``strength=``, ``color=``, ``falloff=none|inverse-square``. Without any: the file's lights, else key, fill
        and rim.
    ambient : color, optional
        Radiance from all around.
    shadows : bool
        Lights cast shadows.
    ground : bool
        Add an invisible ground that catches the object's soft shadow.
    size : int or (width, height)
        Pixels.
    samples : {1, 4, 16}
        Samples a pixel, each of which is shaded.
    tone : str
        Tone curve: neutral, linear, reinhard, aces, agx.
    exposure : float
        Stops.
    background : color or "transparent", optional
        ``#2a2b2e`` if not given.
    energy, specular_aa, grazing_normals
        Details of reflection, as on the command line.
    integrator : {"raster", "reference"}
        The reference follows ``spp`` paths of light a pixel, each over at most ``bounces`` reflections.
    progress : bool or callable, optional
        True for a bar; a callable gets stage and fraction, and stops the work by returning False.

    Returns
    -------
    Image
        ``(height, width, 4)`` uint8, sRGB, straight alpha; its first row is the top.
    dict of float32 arrays
        With ``linear``: ``color`` ``(height, width, 4)``, radiance premultiplied by coverage, and the output variables:
        ``normals`` and ``albedo`` ``(height, width, 3)``, ``uv`` ``(height, width, 2)``, ``depth`` and ``triangle``
        ``(height, width)``; NaN where nothing is seen. Depth is along the axis of sight, model units.

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
