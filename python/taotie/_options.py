"""Options shared by several functions: names and defaults are those of the command."""

from __future__ import annotations

import inspect
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, fields
from typing import Any, Literal, TypeAlias, TypedDict, TypeVar, Union

import numpy as np

from ._arrays import PathLike
from ._error import invalid
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
Aov: TypeAlias = Literal["normals", "depth", "albedo", "uv", "triangle"]
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
]
#: A colour in CSS syntax, a linear grey value, or linear RGB.
Color: TypeAlias = Union[str, float, Sequence[float]]

#: The default background of images.
BACKGROUND = "#2a2b2e"


@dataclass(frozen=True)
class Orbit:
    """The position of a camera that orbits the object's centre.

    Parameters
    ----------
    azimuth_deg : float
        Degrees to the right of the front, which is +z.
    elevation_deg : float
        Degrees above the horizon.
    distance : float, optional
        Distance from the target, in model units, above 0; by default the object fills the image.
    """

    azimuth_deg: float
    elevation_deg: float
    distance: float | None = None


@dataclass(frozen=True)
class Camera:
    """A camera of the file, or one that orbits a target. An option given separately overrides its field.

    Parameters
    ----------
    name : str, optional
        A camera of the file by name, or one without a name by its index from 0; the orbit is then ignored.
    azimuth_deg, elevation_deg : float, optional
        As for `Orbit`; by default 25 and 15.
    distance : float, optional
        As for `Orbit`.
    target : (x, y, z), optional
        Point to look at; defaults to the object's centre.
    fov_deg : float, default 30
        Vertical field of view, degrees.
    """

    name: str | None = None
    _: KW_ONLY
    azimuth_deg: float | None = None
    elevation_deg: float | None = None
    distance: float | None = None
    target: Sequence[float] | None = None
    fov_deg: float | None = None


@dataclass(frozen=True)
class Environment:
    """Light from all directions. An option given separately overrides its field.

    Parameters
    ----------
    source : {"studio", "none"} or path
        The built-in studio, an equirectangular .hdr or .exr, or none.
    rotation_deg : float
        Rotation counterclockwise as seen from above, degrees.
    intensity : float
        Factor of its light.
    visible : bool
        Show it behind the model.
    """

    source: PathLike
    _: KW_ONLY
    rotation_deg: float = 0.0
    intensity: float = 1.0
    visible: bool = False


@dataclass(frozen=True)
class Light:
    """A light that keeps its position relative to the camera on a turntable. ``str`` returns its text.

    Parameters
    ----------
    kind : {"point", "spot", "directional"}
        Its form.
    at : (x, y, z), optional
        Position of a point or spot light.
    toward : (x, y, z), optional
        Point that a spot light is aimed at, or direction in which a directional light shines.
    from_deg : (azimuth, elevation), optional
        Direction that a directional light comes from, relative to the view, degrees.
    strength : float, default 3
        Intensity of a point or spot light, irradiance of a directional one.
    color : str or float, optional
        Colour in CSS syntax, or linear grey; the strength is multiplied by it.
    falloff : {"none", "inverse-square"}, optional
        Falloff of a point or spot light with distance.
    angle_deg : float, default 30
        Angle from the axis of a spot light beyond which it is dark, degrees.
    inner_deg : float, optional
        Angle from the axis up to which it has full strength, degrees; defaults to 0.8 of ``angle_deg``.
    """

    kind: Literal["point", "spot", "directional"]
    _: KW_ONLY
    at: Sequence[float] | None = None
    toward: Sequence[float] | None = None
    from_deg: Sequence[float] | None = None
    strength: float | None = None
    color: str | float | None = None
    falloff: Literal["none", "inverse-square"] | None = None
    angle_deg: float | None = None
    inner_deg: float | None = None

    def __str__(self) -> str:
        values = ((field.name.removesuffix("_deg"), getattr(self, field.name)) for field in fields(self)[1:])
        return " ".join([self.kind, *(f"{key}={_word(value)}" for key, value in values if value is not None)])


def _word(value: Any) -> str:
    """Return a value in the text of a light: one word, with numbers that are read back exactly."""
    if isinstance(value, str):
        return value.replace(" ", "")
    return ",".join(repr(float(number)) for number in np.ravel(value))


@dataclass(frozen=True)
class Material:
    """Material properties; each given value applies to every material of the model.

    Parameters
    ----------
    material : str or path, optional
        A preset listed by ``taotie materials``, or a TOML file; the model keeps its maps.
    variant : str, optional
        Material variant of the file (KHR_materials_variants).
    base_color : color, optional
        Base colour; textures are multiplied by it.
    metallic, roughness : float, optional
        In [0, 1]; textures are multiplied by them.
    slope : float, optional
        Root mean square slope, above 0, for cook-torrance.
    shininess : float, optional
        Exponent, 0 or more, for phong and blinn-phong.
    base_color_map, normal_map, height_map, occlusion_map : path, optional
        Textures for every material.
    normal_space : {"tangent", "object"}
        Space of ``normal_map``.
    green : {"up", "down"}
        Direction of green in normal maps: up (OpenGL, glTF) or down (DirectX).
    """

    material: PathLike | None = None
    variant: str | None = None
    base_color: Color | None = None
    metallic: float | None = None
    roughness: float | None = None
    slope: float | None = None
    shininess: float | None = None
    base_color_map: PathLike | None = None
    normal_map: PathLike | None = None
    normal_space: Literal["tangent", "object"] = "tangent"
    green: Literal["up", "down"] = "up"
    height_map: PathLike | None = None
    occlusion_map: PathLike | None = None

    def _options(self, bump_scale: float | None = None) -> dict[str, Any]:
        factors = {
            "base_color": None if self.base_color is None else _rgb(self.base_color),
            "metallic": self.metallic,
            "roughness": self.roughness,
            "slope": self.slope,
            "shininess": self.shininess,
        }
        maps = {
            "base_color": _path(self.base_color_map),
            "normal": _path(self.normal_map),
            "normal_space": self.normal_space,
            "green": self.green,
            "height": _path(self.height_map),
            "height_scale": bump_scale,
            "occlusion": _path(self.occlusion_map),
        }
        return {
            "variant": self.variant,
            "material": _path(self.material),
            "factors": factors,
            "maps": maps,
            "green": self.green,
        }


def material(value: Material | PathLike | None) -> Material:
    """Return the material for a preset name, a file or None."""
    if value is None:
        return Material()
    return value if isinstance(value, Material) else Material(value)


def _path(path: PathLike | None) -> str | None:
    return None if path is None else os.fspath(path)


def _rgb(color: Color) -> list[float]:
    """Return linear RGB, rounded to float32."""
    from . import _taotie

    return list(_taotie.color(_color(color)))


def _color(color: Color) -> str | list[float]:
    """Return a colour in the form that the native module reads."""
    if isinstance(color, str):
        return color
    if isinstance(color, (int, float)):
        return repr(float(color))
    numbers = [float(channel) for channel in color]
    if len(numbers) != 3:
        raise invalid("a colour", f"{len(numbers)} numbers; expected three, linear RGB, or text such as '#2a2b2e'")
    return numbers


class _SceneOptions(TypedDict, total=False):
    """Options of `Renderer`, `view` and `compare`, described in `RenderOptions`."""

    bump_scale: float | None
    tangents: Literal["face", "averaged", "mikktspace"] | None
    material: Material | PathLike | None
    env: Environment | PathLike | None
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
    """Options of `Renderer`, described in `RenderOptions`."""

    surface: Surface | None
    show_env: bool
    time: float | None
    animation: str | None


class TurntableOptions(_PictureOptions, total=False):
    """Options of `Renderer.turntable`, described in `RenderOptions`."""

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
    """

    turn_deg: float
    all_around: bool


class RenderOptions(RendererOptions, TurntableOptions, total=False):
    """Options of `render`. Omitted ones have the defaults of ``taotie render``.

    Parameters
    ----------
    aov : sequence of str
        Additional output variables: normals, depth, albedo, uv, triangle; at the first sample of each pixel. They need
        ``linear=True``.
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
    env : Environment, {"studio", "none"} or path, optional
        Environment light: the built-in studio, an equirectangular .hdr or .exr, or none.
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
    """


class ViewOptions(_SceneOptions, _PictureOptions, total=False):
    """Options of `view`, described in `RenderOptions`: the initial appearance."""

    shading: Shading
    surface: Surface | None


class CompareOptions(_SceneOptions, _PictureOptions, total=False):
    """Options of `compare`, described in `RenderOptions`."""

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


def check(function: str, options: Mapping[str, Any], kind: Any) -> None:
    """Refuse an option that the TypedDict lacks, as Python refuses an unknown parameter."""
    unknown = [name for name in options if name not in names(kind)]
    if unknown:
        raise TypeError(f"{function}() got an unexpected keyword argument {unknown[0]!r}")


def chosen(options: Mapping[str, Any], wanted: Iterable[str]) -> dict[str, Any]:
    """Return those of the wanted options that are given; the native module has the defaults of the others."""
    return {name: options[name] for name in wanted if name in options}


def renderer_request(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings shared by all images, for the native module."""
    time = options.get("time")
    return {
        "surface": _surface(options),
        "environment": environment(options),
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
        size = options["size"]
        width, height = (size, size) if isinstance(size, int) else size
        found |= {"width": int(width), "height": int(height)}
    return found | {"surface": _surface(options)}


def _surface(options: Mapping[str, Any]) -> dict[str, Any]:
    return {"method": options.get("surface"), **chosen(options, ["tangents", "bump_scale"])}


def camera_and_light(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return camera, lights and ambient light, for the native module."""
    light, ambient = options.get("light"), options.get("ambient")
    lights: Sequence[Any] = [] if light is None else [light] if isinstance(light, (str, Light)) else light
    return {
        "camera": _camera(options),
        "lights": [str(one) if isinstance(one, Light) else one for one in lights],
        "ambient": None if ambient is None else _color(ambient),
    }


def _camera(options: Mapping[str, Any]) -> dict[str, Any]:
    given = options.get("camera")
    if given is None or isinstance(given, str):
        given = Camera(given)
    elif isinstance(given, Orbit):
        given = Camera(azimuth_deg=given.azimuth_deg, elevation_deg=given.elevation_deg, distance=given.distance)
    fov_deg, target = options.get("fov_deg", given.fov_deg), options.get("target")
    if fov_deg is not None and not 0.0 < fov_deg < 180.0:
        raise invalid(f"fov_deg {fov_deg}", "use an angle between 0 and 180 degrees")
    target = given.target if target is None else target
    angles = {"azimuth": given.azimuth_deg, "elevation": given.elevation_deg, "fov_y": fov_deg}
    return {
        "name": given.name,
        "distance": None if given.distance is None else float(given.distance),
        "target": None if target is None else [float(x) for x in target],
        **{name: math.radians(angle) for name, angle in angles.items() if angle is not None},
    }


def environment(options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the environment, for the native module."""
    env = options.get("env")
    if not isinstance(env, Environment):
        env = Environment("none" if env is None else env)
    name = os.fspath(env.source)
    source: Any = None if name == "none" else "studio" if name == "studio" else {"file": name}
    rotation_deg = options.get("env_rotate_deg", env.rotation_deg)
    intensity = options.get("env_intensity", env.intensity)
    visible = options.get("show_env", env.visible)
    if source is None and (visible or rotation_deg != 0.0 or intensity != 1.0):
        raise invalid("env", "no environment to show, rotate or scale; specify one, e.g. 'studio'")
    return {
        "source": source,
        "rotation": math.radians(rotation_deg),
        "intensity": float(intensity),
        "visible": visible,
    }


def background(options: Mapping[str, Any]) -> str | list[float]:
    """Return the background in the form that the native module reads."""
    given = options.get("background")
    return _color(BACKGROUND if given is None else given)
