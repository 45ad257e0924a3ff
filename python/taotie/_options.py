"""Options shared by several functions: names and defaults are those of the command."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, Union

from ._arrays import PathLike
from ._error import invalid

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


def camera(
    camera: Orbit | str | None, target: Sequence[float] | None, fov_deg: float
) -> dict[str, Any]:
    """Return a camera's options."""
    if not 0.0 < fov_deg < 180.0:
        raise invalid(f"fov_deg {fov_deg}", "use an angle between 0 and 180 degrees")
    options: dict[str, Any] = {"fov_y": math.radians(fov_deg)}
    if target is not None:
        options["target"] = [float(x) for x in target]
    if isinstance(camera, str):
        options["name"] = camera
    elif camera is not None:
        options["azimuth"] = math.radians(camera.azimuth_deg)
        options["elevation"] = math.radians(camera.elevation_deg)
        options["distance"] = None if camera.distance is None else float(camera.distance)
    return options


def environment(env: PathLike | None, rotate_deg: float, intensity: float, show: bool) -> dict[str, Any]:
    """Return the options of the environment."""
    name = None if env is None else os.fspath(env)
    source: Any = None if name in (None, "none") else "studio" if name == "studio" else {"file": name}
    if source is None and (show or rotate_deg != 0.0 or intensity != 1.0):
        raise invalid("env", "no environment to show, rotate or scale; specify one, e.g. 'studio'")
    return {
        "source": source,
        "rotation": math.radians(rotate_deg),
        "intensity": float(intensity),
        "visible": show,
    }


def lights(light: str | Sequence[str] | None) -> list[str]:
    """Return light specifications as a list."""
    if light is None:
        return []
    return [light] if isinstance(light, str) else list(light)


def ambient_light(color: Color | None) -> Any:
    """Return the ambient radiance."""
    return None if color is None else _color(color)


def film(exposure: float, tone: str, background: Color | None) -> dict[str, Any]:
    """Return the options for developing an image."""
    is_clear = isinstance(background, str) and background == "transparent"
    shown = BACKGROUND if background is None else background
    return {"exposure": float(exposure), "tone": tone, "background": None if is_clear else _color(shown)}
