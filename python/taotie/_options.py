"""Options shared by several functions: names and defaults are those of the command."""

from __future__ import annotations

import inspect
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, TypeAlias, TypedDict, TypeVar, Union

import numpy.typing as npt

from ._arrays import PathLike, sides
from ._camera import Camera, Orbit, camera_request
from ._error import invalid, invalid_type, number
from ._light import Environment, Light, is_named, radiance
from ._material import Color, Material, color_request
from ._run import Progress

Shading: TypeAlias = Literal[
    "lambert",
    "phong",
    "blinn-phong",
    "blinn-phong-classic",
    "cook-torrance",
    "ggx",
    "cook-torrance-printed",
    "blinn-phong-printed",
    "ggx-printed",
]
Surface: TypeAlias = Literal["facet", "smooth", "bump", "bump-printed", "object-normal", "tangent-normal"]
Tone: TypeAlias = Literal["neutral", "linear", "reinhard", "aces", "agx"]
Unit: TypeAlias = Literal["mm", "cm", "m", "in"]
Codecs: TypeAlias = Literal["portable", "web-latest"]
Aov: TypeAlias = Literal["normals", "depth", "albedo", "uv", "triangle", "position"]
Device: TypeAlias = Literal["cpu", "gpu", "auto"]
Map: TypeAlias = Literal[
    "normal",
    "ao",
    "albedo",
    "height",
    "bent",
    "curvature",
    "roughness",
    "metallic-roughness",
    "emission",
    "alpha",
    "occlusion",
    "position",
    "world-normal",
    "thickness",
    "vertex-color",
    "material-id",
    "object-id",
    "wireframe",
    "bevel",
    "vector-displacement",
    "convexity",
    "concavity",
    "gradient",
]
#: The default background of images.
BACKGROUND = "#2a2b2e"


class _SceneOptions(TypedDict, total=False):
    """Options of `Renderer`, `view` and `compare`, described in `RenderOptions`."""

    bump_scale: float | None
    tangents: Literal["face", "averaged", "mikktspace"] | None
    material: Material | PathLike | None
    env: Union[Environment, PathLike, npt.ArrayLike, None]
    env_rotate_deg: float
    env_intensity: float
    threads: int | None


class _PictureOptions(TypedDict, total=False):
    """Options of `Renderer.render`, `view` and `compare`, described in `RenderOptions`."""

    camera: Camera | Orbit | str | None
    target: Sequence[float] | None
    fov_deg: float
    light: Light | str | Sequence[Light | str] | None
    ambient: Color | None
    samples: Literal[1, 4, 16]
    tone: Tone
    exposure: float
    background: Color | None
    energy: Literal["compensated", "single"]
    specular_aa: bool
    grazing_normals: Literal["soften", "keep"]
    progress: Progress


class RendererOptions(_SceneOptions, total=False):
    """Options of `Renderer`, described in `RenderOptions`.

    Examples
    --------
    >>> options: tt.RendererOptions = {"surface": "facet", "env": "studio"}
    >>> renderer = tt.Renderer(scan, **options)
    """

    surface: Surface | None
    show_env: bool
    time: float | None
    animation: str | None
    device: Device


class TurntableOptions(_PictureOptions, total=False):
    """Options of `Renderer.turntable`, described in `RenderOptions`.

    Examples
    --------
    >>> options: tt.TurntableOptions = {"size": 32, "light": "directional from=-75,10"}
    >>> frames = tt.Renderer(scan).turntable(2, **options)
    """

    aov: Sequence[Aov]
    shading: Shading
    shadows: bool
    ground: bool
    size: int | tuple[int, int]
    integrator: Literal["raster", "reference"]
    spp: int
    bounces: int
    seed: int


class ImageOptions(TurntableOptions, total=False):
    """Options of `Renderer.render`; the others are described in `RenderOptions`.

    Parameters
    ----------
    turn_deg : float
        The rotation of the object, as on a turntable, in degrees; lights and environment stay.
    all_around : bool
        Frame the object so that it stays in the image from all directions.

    Examples
    --------
    >>> options: tt.ImageOptions = {"size": 32, "turn_deg": 30}
    >>> image = tt.Renderer(scan).render(**options)
    """

    turn_deg: float
    all_around: bool


class RenderOptions(RendererOptions, TurntableOptions, total=False):
    """Options of `render`. Omitted ones have the defaults of ``taotie render``.

    Parameters
    ----------
    aov : sequence of str
        Additional output variables: normals, depth, albedo, uv, triangle, position; at the centre of each pixel.
        They need ``linear=True``.
    shading : str, default "ggx"
        Reflectance model: lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, or as printed.
    surface : str, optional
        Source of the shading normals: facet, smooth, bump, bump-printed, object-normal, tangent-normal; defaults to
        the best that the material provides.
    bump_scale : float, optional
        Height of white for ``bump``, model units.
    tangents : {"face", "averaged", "mikktspace"}, optional
        Defaults to those of the file, otherwise mikktspace.
    material : Material or str, optional
        The material to apply to the model: a `Material`, the name of a preset, or a TOML file.
    camera : Camera, Orbit or str, optional
        The camera, or the name of one in the file. By default the object fills the image.
    target : (x, y, z), optional
        Point to look at; defaults to the object's centre.
    fov_deg : float, default 30
        Vertical field of view, degrees.
    light : Light, str, or a sequence of these, optional
        A `Light`, or its text: ``point at=X,Y,Z``, ``spot at=X,Y,Z toward=X,Y,Z angle=DEG`` or ``directional
        from=AZIMUTH,ELEVATION``, each with ``strength=``, ``color=``, ``falloff=none|inverse-square``. Defaults to the
        file's lights, otherwise key, fill and rim.
    ambient : color, optional
        Ambient radiance from all directions.
    shadows : bool
        Lights cast shadows.
    ground : bool
        Add an invisible ground that receives the object's soft shadow.
    env : Environment, {"studio", "none"}, path or array_like, optional
        Environment light: the built-in studio, an equirectangular .hdr or .exr, or none; or an equirectangular image,
        ``(height, width, 3)`` floats, linear radiance.
    env_rotate_deg : float
        Rotates the environment counterclockwise as seen from above.
    env_intensity : float, default 1
        Factor for its light.
    show_env : bool
        Show it behind the model.
    time : float, optional
        The time in the animation, in seconds.
    animation : str, optional
        The animation by name, or by number from 0; defaults to the first.
    device : {"cpu", "gpu", "auto"}, default "cpu"
        Device to render on; auto is a GPU if there is one that is not a software renderer. Only images from the CPU are
        bit-identical everywhere. Output variables and the reference need the CPU, which auto uses for them.
    size : int or (width, height), default 1024
        Pixels; 640 by default in `compare`.
    samples : {1, 4, 16}, default 4
        Samples per pixel, each of which is shaded.
    tone : str, default "neutral"
        Tone curve: neutral, linear, reinhard, aces, agx.
    exposure : float
        Stops.
    background : color or "transparent", optional
        ``#2a2b2e`` by default; opaque in `compare`.
    energy : {"compensated", "single"}, default "compensated"
        Light between microfacets in ggx and cook-torrance: compensated (multiple scattering) or single (lost).
    specular_aa : bool, default True
        Relief finer than a pixel widens the highlight instead of sparkling.
    grazing_normals : {"soften", "keep"}, default "soften"
        Mapped normals that face away from the viewer: soften bends them until they are just visible.
    integrator : {"raster", "reference"}, default "raster"
        The reference traces light paths, and all lights cast shadows.
    spp : int, default 64
        Paths per pixel of the reference.
    bounces : int, default 4
        Largest number of reflections after the first; 0 is direct light.
    seed : int
        Seed of the reference's noise.
    threads : int, optional
        1 to 1024; defaults to all of the machine's. Pixels do not depend on it.
    progress : bool or callable, optional
        True for a progress bar; a callable receives stage and fraction, and stops the work by returning False.

    Examples
    --------
    >>> options: tt.RenderOptions = {"size": 32, "env": "studio", "shading": "cook-torrance"}
    >>> image = tt.render(scan, **options)
    """


class ViewOptions(_SceneOptions, _PictureOptions, total=False):
    """Options of `view`, described in `RenderOptions`: the initial appearance.

    Examples
    --------
    >>> options: tt.ViewOptions = {"env": "studio", "exposure": 0.5}
    >>> page = tt.view(scan, **options)
    """

    shading: Shading
    surface: Surface | None


class CompareOptions(_SceneOptions, _PictureOptions, total=False):
    """Options of `compare`, described in `RenderOptions`.

    Examples
    --------
    >>> options: tt.CompareOptions = {"size": 64, "shadows": True}
    >>> found = tt.compare(asset, scan, methods=["smooth"], **options)
    """

    shadows: bool
    show_env: bool
    size: int | tuple[int, int]


_Function = TypeVar("_Function", bound=Callable[..., Any])


def takes(kind: Any) -> Callable[[_Function], _Function]:
    """List the options of a TypedDict in the signature of a function that takes them, for help and completion."""

    def listed(function: _Function) -> _Function:
        signature, keyword = inspect.signature(function), inspect.Parameter.KEYWORD_ONLY
        *own, _ = signature.parameters.values()
        options = (inspect.Parameter(name, keyword, default=...) for name in kind.__annotations__)
        setattr(function, "__signature__", signature.replace(parameters=[*own, *options]))
        return function

    return listed


def names(kind: Any) -> frozenset[str]:
    """Return the names of the options of a TypedDict."""
    found: frozenset[str] = kind.__optional_keys__
    return found


#: The options that are numbers and are converted in Python.
_NUMBERS = ("bump_scale", "env_rotate_deg", "env_intensity", "exposure", "fov_deg", "time", "turn_deg")


def check(function: str, options: Mapping[str, Any], kind: Any) -> None:
    """Refuse an option that the TypedDict lacks, as Python refuses an unknown parameter."""
    unknown = [name for name in options if name not in names(kind)]
    if unknown:
        raise TypeError(f"{function}() got an unexpected keyword argument {unknown[0]!r}")
    for name in _NUMBERS:
        if options.get(name) is not None:
            number(name, options[name])
    if isinstance(options.get("aov"), str):
        raise invalid_type("aov", options["aov"], "a sequence of names, e.g. ['normals']")


def chosen(options: Mapping[str, Any], wanted: Iterable[str]) -> dict[str, Any]:
    """Return those of the wanted options that are given; the native module has the defaults of the others."""
    return {name: options[name] for name in wanted if name in options}


def renderer_request(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings shared by all images, for the native module."""
    time = options.get("time")
    return {
        "surface": _surface(options),
        "device": options.get("device", "cpu"),
        "time": None if time is None else float(time),
        "animation": options.get("animation"),
    }


def image_request(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of an image, for the native module."""
    shown = background(options)
    film = {
        "background": None if shown == "transparent" else shown,
        "exposure": float(options.get("exposure", 0.0)),
        **chosen(options, ["tone"]),
    }
    return {"settings": settings(options), **camera_and_light(options), "film": film}


def settings(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings of rendering, for the native module."""
    found = chosen(options, ["samples", "shading", "energy", "specular_aa", "grazing_normals", "shadows", "ground"])
    if "size" in options:
        width, height = sides("size", options["size"])
        found |= {"width": width, "height": height}
    return found | {"surface": _surface(options)}


def _surface(options: Mapping[str, Any]) -> dict[str, Any]:
    return {"method": options.get("surface"), **chosen(options, ["tangents", "bump_scale"])}


def camera_and_light(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return camera, lights and ambient light, for the native module."""
    light, ambient = options.get("light"), options.get("ambient")
    lights: Any = [] if light is None else [light] if isinstance(light, (str, Light)) else light
    if not isinstance(lights, Iterable) or not all(isinstance(one, (str, Light)) for one in lights):
        raise invalid_type("light", light, "a Light, its text, or a sequence of these")
    return {
        "camera": camera_request(options),
        "lights": [str(one) for one in lights],
        "ambient": None if ambient is None else color_request(ambient),
    }


def environment(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the environment, for the native module."""
    env = options.get("env")
    if not isinstance(env, Environment):
        env = Environment("none" if env is None else env)
    name = os.fspath(env.source) if is_named(env.source) else None  # type: ignore[arg-type]
    source: Any = None if name in (None, "none") else "studio" if name == "studio" else {"file": name}
    rotation_deg = options.get("env_rotate_deg", env.rotation_deg)
    intensity = options.get("env_intensity", env.intensity)
    visible = options.get("show_env", env.visible)
    if name == "none" and (visible or rotation_deg != 0.0 or intensity != 1.0):
        raise invalid("env", "no environment to show, rotate or scale; specify one, e.g. 'studio'")
    settings = {
        "source": source,
        "rotation": math.radians(rotation_deg),
        "intensity": float(intensity),
        "visible": visible,
    }
    return {"options": settings, "image": None if name is not None else radiance(env.source)}


def background(options: Mapping[str, Any]) -> str | list[float]:
    """Return the background in the form that the native module reads."""
    given = options.get("background")
    return color_request(BACKGROUND if given is None else given)
