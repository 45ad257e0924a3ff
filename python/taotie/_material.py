"""Materials: a preset or a file, factors, and maps from files or arrays."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, Literal, TypeAlias, Union

import numpy as np
import numpy.typing as npt

from ._arrays import Array, PathLike, image
from ._error import invalid, invalid_type, number
from ._repr import Value

#: A colour in CSS syntax, a linear grey value, or linear RGB.
Color: TypeAlias = Union[str, float, Sequence[float]]
#: A texture: a file, or texels ``(height, width)`` or ``(height, width, 1 to 4)``.
Texture: TypeAlias = Union[PathLike, npt.ArrayLike]


@dataclass(frozen=True, repr=False, eq=False)
class Material(Value):
    """Material properties; each given value applies to every material of the model.

    Maps are files, PIL images, or arrays ``(height, width, channels)`` with the first row at the top: uint8, uint16, or
    floats. In colours, integers are sRGB codes and floats linear.

    Parameters
    ----------
    material : str or path, optional
        A preset listed by ``taotie materials``, or a TOML file; the model keeps its maps.
    variant : str, optional
        Material variant of the file (KHR_materials_variants).
    base_color : color, optional
        Base colour; textures are multiplied by it. Defaults to the model's; for a `Mesh` to white under a map, grey
        without one.
    metallic, roughness : float, optional
        In [0, 1]; textures are multiplied by them. They default to the model's, or to 1 with ``metallic_roughness_map``.
    emissive : color, optional
        Emitted radiance; the map is multiplied by it. Defaults to the model's, or to 1 with ``emissive_map``.
    slope : float, optional
        Root mean square slope, above 0, for cook-torrance.
    shininess : float, optional
        Exponent, 0 or more, for phong and blinn-phong.
    base_color_map : path or array_like, optional
        Colour.
    metallic_roughness_map : path or array_like, optional
        Roughness in green, metallic in blue, linear, as in glTF.
    normal_map : path or array_like, optional
        Normals; vectors of floats are in [-1, 1] or, as in files, in [0, 1].
    occlusion_map : path or array_like, optional
        Occlusion in red, linear.
    emissive_map : path or array_like, optional
        Colour of the emitted light.
    height_map : path or array_like, optional
        Heights in red, [0, 1], for ``surface="bump"``; ``bump_scale`` is the height of 1.
    normal_scale : float
        Factor of x and y of the normal map.
    normal_space : {"tangent", "object"}
        Space of ``normal_map``.
    green : {"up", "down"}
        Direction of green in normal maps: up (OpenGL, glTF) or down (DirectX).

    Examples
    --------
    >>> checks = np.kron([[0, 1], [1, 0]], np.full((8, 8), 255, np.uint8)).astype(np.uint8)
    >>> painted = tt.Material(base_color_map=checks, roughness=0.3)
    >>> painted
    Material(roughness=0.3, base_color_map=<uint8 (16, 16)>)
    >>> image = tt.render(asset, material=painted, size=32)
    """

    material: PathLike | None = None
    variant: str | None = None
    base_color: Color | None = None
    metallic: float | None = None
    roughness: float | None = None
    slope: float | None = None
    shininess: float | None = None
    base_color_map: Texture | None = None
    normal_map: Texture | None = None
    normal_space: Literal["tangent", "object"] = "tangent"
    green: Literal["up", "down"] = "up"
    height_map: Texture | None = None
    occlusion_map: Texture | None = None
    _: KW_ONLY
    metallic_roughness_map: Texture | None = None
    emissive_map: Texture | None = None
    emissive: Color | None = None
    normal_scale: float = 1.0

    def _request(self, bump_scale: float | None = None) -> dict[str, Any]:
        """Return the options for the native module, and the arrays that they name."""
        arrays: dict[str, Array] = {}
        maps: dict[str, Any] = {}
        for role in ("base_color", "metallic_roughness", "normal", "height", "occlusion", "emissive"):
            name = f"{role}_map"
            texture = _texture(name, getattr(self, name))
            maps[role] = texture
            if isinstance(texture, np.ndarray):
                maps[role] = f"<{name}>"
                arrays[f"<{name}>"] = texture
        has_glow, has_mr = self.emissive_map is not None, self.metallic_roughness_map is not None
        emissive = 1.0 if self.emissive is None and has_glow else self.emissive
        factors = {
            "base_color": None if self.base_color is None else _reflectance(self.base_color),
            "metallic": 1.0 if self.metallic is None and has_mr else self.metallic,
            "roughness": 1.0 if self.roughness is None and has_mr else self.roughness,
            "slope": self.slope,
            "shininess": self.shininess,
            "emissive": None if emissive is None else rgb(emissive),
        }
        maps |= {
            "normal_scale": number("normal_scale", self.normal_scale),
            "normal_space": self.normal_space,
            "green": self.green,
            "height_scale": bump_scale,
        }
        options = {
            "variant": self.variant,
            "material": None if self.material is None else os.fspath(self.material),
            "factors": factors,
            "maps": maps,
            "green": self.green,
        }
        return {"options": options, "arrays": arrays}


def material(value: Material | PathLike | None) -> Material:
    """Return the material for a preset name, a file or None."""
    if value is None:
        return Material()
    if isinstance(value, Material):
        return value
    if not isinstance(value, (str, os.PathLike)):
        raise invalid_type("material", value, "a Material, the name of a preset, or a TOML file")
    return Material(value)


# How far floats of maps may be outside [0, 1].
_OVERSHOT = 0.1


def _texture(name: str, values: Any) -> str | Array | None:
    """Return a map as a path or as an array that is encoded as in a file."""
    if values is None:
        return None
    found: str | Array = image(name, values)
    if isinstance(found, str) or found.dtype != np.float32:
        return found
    if not np.isfinite(found).all():
        raise invalid(name, "an infinite number or NaN; expected finite numbers")
    least, most = float(found.min()), float(found.max())
    # Emission may exceed 1, and so may heights; resampling overshoots a little.
    if name not in ("normal_map", "height_map", "emissive_map") and not -_OVERSHOT <= least <= most <= 1 + _OVERSHOT:
        raise invalid(name, f"values from {least:g} to {most:g}; floats are linear, 0 to 1; pass codes of 0 to 255 as uint8")
    return found


def _reflectance(color: Color) -> list[float]:
    """Return a base colour as linear RGB in [0, 1]."""
    found = rgb(color)
    if min(found) < 0 or max(found) > 1:
        raise invalid("base_color", f"{color!r}; expected linear RGB from 0 to 1, or text such as '#c86432'")
    return found


def rgb(color: Color) -> list[float]:
    """Return linear RGB, rounded to float32."""
    from . import _taotie

    return list(_taotie.color(color_request(color)))


def color_request(color: Color) -> str | list[float]:
    """Return a colour in the form that the native module reads."""
    if isinstance(color, str):
        return color
    if np.ndim(color) == 0:
        return repr(float(color))  # type: ignore[arg-type]
    numbers = [float(channel) for channel in color]  # type: ignore[union-attr]
    if len(numbers) != 3:
        raise invalid("a colour", f"{len(numbers)} numbers; expected three, linear RGB, or text such as '#2a2b2e'")
    return numbers
