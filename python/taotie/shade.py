"""The reflectance formulas, over arrays, with their derivatives.

Each broadcasts its arguments, computes in float32 if all of them are float32 (or plain numbers next to such arrays),
otherwise in float64, and is the same function that the renderer uses. Directions are unit vectors, with a last axis
of 3; colours are linear RGB, with a last axis of 3. `gradient` evaluates any of them with its derivatives.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _taotie
from ._error import invalid, invalid_type

Numbers: TypeAlias = npt.NDArray[Any]
Like: TypeAlias = npt.ArrayLike

#: The arguments of each formula with their sizes: 1, or 3 for directions and colours.
_ARGUMENTS: dict[str, dict[str, int]] = {
    "alpha_from_roughness": {"roughness": 1},
    "alpha_from_shininess": {"shininess": 1},
    "shininess_from_alpha": {"alpha": 1},
    "d_beckmann": {"n_dot_h": 1, "sin2_h": 1, "slope": 1},
    "d_ggx": {"n_dot_h": 1, "sin2_h": 1, "alpha": 1},
    "d_blinn": {"n_dot_h": 1, "shininess": 1},
    "d_charlie": {"sin2_h": 1, "roughness": 1},
    "g_v_cavity": {"n_dot_l": 1, "n_dot_v": 1, "n_dot_h": 1, "v_dot_h": 1},
    "v_smith_ggx": {"n_dot_l": 1, "n_dot_v": 1, "alpha": 1},
    "g1_schlick_ggx": {"cosine": 1, "k": 1},
    "v_schlick_ggx": {"n_dot_l": 1, "n_dot_v": 1, "k": 1},
    "k_for_lights": {"roughness": 1},
    "k_for_environment": {"roughness": 1},
    "v_neubelt": {"n_dot_l": 1, "n_dot_v": 1},
    "f_schlick": {"f0": 3, "v_dot_h": 1},
    "f_schlick_f90": {"f0": 3, "f90": 3, "v_dot_h": 1},
    "f82_drop": {"f0": 3, "f82": 3},
    "f_f82": {"f0": 3, "f90": 1, "drop": 3, "v_dot_h": 1},
    "f_dielectric": {"cos_theta": 1, "eta": 1},
    "f_conductor": {"cos_theta": 1, "eta": 1, "k": 1},
    "coat_fresnel": {"cosine": 1},
    "specular_occlusion": {"n_dot_v": 1, "occlusion": 1, "roughness": 1},
    "inverse_square": {"distance_squared": 1},
    "range_window": {"distance_squared": 1, "range": 1},
    "spot_cone": {"cos_angle": 1, "cos_inner": 1, "cos_outer": 1},
}

#: The fixed arguments of `reflect`, in order.
_REFLECT = {"n": 3, "v": 3, "l": 3, "base_color": 3, "metallic": 1, "roughness": 1, "ior": 1}

#: The optional arguments of `reflect`.
_REFLECT_EXTRA = {"f0": 3, "f82": 3, "slope": 1, "shininess": 1}

#: Formulas with a colour as result.
_COLORS = ("f_schlick", "f_schlick_f90", "f82_drop", "f_f82")

#: The names of all formulas except `reflect`.
NAMES: tuple[str, ...] = tuple(_ARGUMENTS)


def gradient(
    formula: str, wrt: str | Sequence[str], **arguments: Any
) -> tuple[Numbers, dict[str, Numbers]]:
    """Evaluate a formula and its derivatives, by running it on dual numbers: exact up to rounding.

    Parameters
    ----------
    formula : str
        The name of a function of this module, such as ``"d_ggx"``, or ``"reflect"`` with ``model=``.
    wrt : str or sequence of str
        The arguments to differentiate by.
    **arguments
        The arguments of the function.

    Returns
    -------
    value : ndarray
        The value of the function.
    derivatives : dict of ndarray
        By each argument of ``wrt``: with the shape of the value, plus an axis of 3 if the argument is a vector.
        At a kink of a formula they are those of the branch taken.

    Examples
    --------
    >>> value, by = tt.shade.gradient("d_ggx", "alpha", n_dot_h=0.9, alpha=[0.25, 0.5])
    >>> by["alpha"].round(4)
    array([ 1.5921, -0.0658])
    """
    names = (wrt,) if isinstance(wrt, str) else tuple(wrt)
    if formula == "reflect":
        model, (sizes, given) = arguments.pop("model", "ggx"), _reflect_arguments(arguments)
        native, is_color = _reflect_name(model, sizes), True
    else:
        if formula not in _ARGUMENTS:
            raise invalid(f"formula {formula!r}", f"unknown; expected one of: {', '.join(('reflect', *NAMES))}")
        sizes, given = _ARGUMENTS[formula], _with_sine(formula, arguments)
        native, is_color = formula, formula in _COLORS
    for name in names:
        if name not in sizes:
            raise invalid(f"wrt {name!r}", f"not an argument of the formula; expected one of: {', '.join(sizes)}")
    starts = dict(zip(sizes, np.cumsum([0, *sizes.values()]).tolist()))
    by = [starts[name] + i for name in names for i in range(sizes[name])]
    values, partials, shape = _computed(native, (sizes, given), by)
    value = _shaped(values, shape, is_color)
    derivatives, at = {}, 0
    for name in names:
        size = sizes[name]
        part = partials[:, :, at : at + size]
        at += size
        outputs = (3,) if is_color else ()
        derivatives[name] = part.reshape(shape + outputs + ((size,) if size > 1 else ()))
    return value, derivatives


def _with_sine(formula: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments, adding sin² if the formula needs it and it is missing."""
    given = dict(arguments)
    if "sin2_h" in _ARGUMENTS[formula] and given.get("sin2_h") is None and "n_dot_h" in given:
        cosine = _numbers("n_dot_h", given["n_dot_h"])
        given["sin2_h"] = (1 - cosine) * (1 + cosine)
    return given


def _compute(formula: str, **arguments: Any) -> Numbers:
    sizes, given = _ARGUMENTS[formula], _with_sine(formula, arguments)
    values, _, shape = _computed(formula, (sizes, given), [])
    return _shaped(values, shape, formula in _COLORS)


def _shaped(values: Numbers, shape: tuple[int, ...], is_color: bool) -> Numbers:
    return values.reshape(shape + ((3,) if is_color else ()))


def _computed(
    native: str, table: tuple[Mapping[str, int], Mapping[str, Any]], by: list[int]
) -> tuple[Numbers, Numbers, tuple[int, ...]]:
    """Evaluate a formula for each row; return values, derivatives and the shape that the arguments broadcast to."""
    sizes, given = table
    missing = [name for name in sizes if given.get(name) is None]
    unknown = [name for name in given if name not in sizes]
    if missing or unknown:
        raise invalid(f"argument {(missing or unknown)[0]!r}", f"the formula takes {', '.join(sizes)}")
    arrays = {name: _numbers(name, given[name]) for name in sizes}
    for name, size in sizes.items():
        array = arrays[name]
        if size == 3 and (array.ndim == 0 or array.shape[-1] != 3):
            raise invalid(name, f"an array of shape {array.shape}; expected (..., 3)")
    dtype = _precision([given[name] for name in sizes], list(arrays.values()))
    shapes = [array.shape[:-1] if sizes[name] == 3 else array.shape for name, array in arrays.items()]
    try:
        shape = np.broadcast_shapes(*shapes)
    except ValueError:
        listed = ", ".join(f"{name} {shape}" for name, shape in zip(sizes, shapes))
        raise invalid("arguments", f"their shapes do not broadcast: {listed}") from None
    rows = np.empty((*shape, sum(sizes.values())), dtype)
    at = 0
    for name, size in sizes.items():
        rows[..., at : at + size] = arrays[name] if size == 3 else arrays[name][..., None]
        at += size
    values, partials = _taotie.shade(native, rows.reshape(-1, rows.shape[-1]), by)
    return values, partials, shape


def _numbers(name: str, given: Any) -> Numbers:
    array = np.asarray(given)
    if array.dtype.kind not in "fiu":
        raise invalid_type(name, given, f"float32 or float64, not {array.dtype}")
    return array


def _precision(given: list[Any], arrays: list[Numbers]) -> Any:
    """Return float32 if all arrays are float32, ignoring plain numbers; otherwise float64."""
    kinds = [array.dtype for one, array in zip(given, arrays) if not isinstance(one, (int, float))]
    is_single = bool(kinds) and all(kind == np.float32 for kind in kinds)
    return np.float32 if is_single else np.float64


def _reflect_arguments(arguments: Mapping[str, Any]) -> tuple[dict[str, int], dict[str, Any]]:
    defaults: dict[str, Any] = {"base_color": (1.0, 1.0, 1.0), "metallic": 0.0, "roughness": 1.0, "ior": 1.5}
    given = {**defaults, **{name: value for name, value in arguments.items() if value is not None}}
    extra = {name: size for name, size in _REFLECT_EXTRA.items() if name in given}
    return {**_REFLECT, **extra}, given


def _reflect_name(model: str, sizes: Mapping[str, int]) -> str:
    return " ".join(["reflect", model, *(name for name in _REFLECT_EXTRA if name in sizes)])


def reflect(
    model: str,
    *,
    n: Like,
    v: Like,
    l: Like,  # noqa: E741
    base_color: Like = (1.0, 1.0, 1.0),
    metallic: Like = 0.0,
    roughness: Like = 1.0,
    ior: Like = 1.5,
    f0: Like | None = None,
    f82: Like | None = None,
    slope: Like | None = None,
    shininess: Like | None = None,
) -> Numbers:
    """Return outgoing radiance per unit of irradiance on a plane that faces the light: f (n·l)⁺.

    Parameters
    ----------
    model : str
        lambert, phong, blinn-phong, blinn-phong-classic, cook-torrance, ggx, or one as printed.
    n, v, l : array_like
        ``(..., 3)``: the unit normal, and unit vectors to the viewer and to the light.
    base_color : array_like
        ``(..., 3)`` linear RGB in [0, 1].
    metallic, roughness : array_like
        In [0, 1].
    ior : array_like
        Index of refraction of the dielectric part.
    f0, f82 : array_like, optional
        ``(..., 3)`` measured reflectance along the normal and at 82 degrees.
    slope : array_like, optional
        Beckmann's rms slope, above 0, for cook-torrance; defaults to the square of the roughness.
    shininess : array_like, optional
        Exponent of the Phong family; by default derived from the roughness.

    Returns
    -------
    ndarray
        ``(..., 3)`` linear RGB, with single scattering only, as with ``energy="single"``.

    Examples
    --------
    >>> seen = {"n": [0, 0, 1], "v": [0.6, 0, 0.8], "l": [-0.6, 0, 0.8]}
    >>> tt.shade.reflect("ggx", **seen, base_color=(1, 0.8, 0.3), metallic=1, roughness=0.4).round(3)
    array([3.858, 3.087, 1.158])
    """
    arguments = dict(n=n, v=v, l=l, base_color=base_color, metallic=metallic, roughness=roughness, ior=ior)
    sizes, given = _reflect_arguments({**arguments, "f0": f0, "f82": f82, "slope": slope, "shininess": shininess})
    values, _, shape = _computed(_reflect_name(model, sizes), (sizes, given), [])
    return _shaped(values, shape, True)


def alpha_from_roughness(roughness: Like) -> Numbers:
    """Return α = roughness², at least 1e-3. Burley 2012, §5.4; glTF 2.0, appendix B.

    Examples
    --------
    >>> float(tt.shade.alpha_from_roughness(0.5).round(4))
    0.25
    """
    return _compute("alpha_from_roughness", roughness=roughness)


def alpha_from_shininess(shininess: Like) -> Numbers:
    """Return α with α² = 2/(s + 2). Walter et al. 2007, §5.2.

    Examples
    --------
    >>> float(tt.shade.alpha_from_shininess(30).round(4))
    0.25
    """
    return _compute("alpha_from_shininess", shininess=shininess)


def shininess_from_alpha(alpha: Like) -> Numbers:
    """Return the Blinn exponent s = 2/α² − 2. Walter et al. 2007, §5.2.

    Examples
    --------
    >>> float(tt.shade.shininess_from_alpha(0.25).round(4))
    30.0
    """
    return _compute("shininess_from_alpha", alpha=alpha)


def d_beckmann(n_dot_h: Like, slope: Like, *, sin2_h: Like | None = None) -> Numbers:
    """Return Beckmann's normal distribution, sr⁻¹. Cook and Torrance 1982, eq. 5 with 1/π; Walter et al. 2007, eq. 25.

    ``sin2_h`` is 1 − (n·h)², by default computed from n·h; near a highlight it has digits that n·h lacks.

    Examples
    --------
    >>> float(tt.shade.d_beckmann(0.9, slope=0.5).round(4))
    0.7594
    """
    return _compute("d_beckmann", n_dot_h=n_dot_h, sin2_h=sin2_h, slope=slope)


def d_ggx(n_dot_h: Like, alpha: Like, *, sin2_h: Like | None = None) -> Numbers:
    """Return the Trowbridge-Reitz (GGX) normal distribution, sr⁻¹. Walter et al. 2007, eq. 33.

    Parameters
    ----------
    n_dot_h : array_like
        Cosine between normal and half vector, [0, 1].
    alpha : array_like
        In [1e-3, 1].
    sin2_h : array_like, optional
        1 − (n·h)²; near a highlight it has digits that n·h lacks.

    Examples
    --------
    >>> tt.shade.d_ggx([0.8, 0.9, 1.0], alpha=0.5).round(4)
    array([0.2943, 0.5165, 1.2732])
    """
    return _compute("d_ggx", n_dot_h=n_dot_h, sin2_h=sin2_h, alpha=alpha)


def d_blinn(n_dot_h: Like, shininess: Like) -> Numbers:
    """Return Blinn's normal distribution, sr⁻¹. Blinn 1977; Walter et al. 2007, eq. 30.

    Examples
    --------
    >>> float(tt.shade.d_blinn(0.9, shininess=30).round(4))
    0.2159
    """
    return _compute("d_blinn", n_dot_h=n_dot_h, shininess=shininess)


def d_charlie(sin2_h: Like, roughness: Like) -> Numbers:
    """Return the "Charlie" distribution of fibres, sr⁻¹. Estevez and Kulla 2017, eq. 2.

    Examples
    --------
    >>> float(tt.shade.d_charlie(0.5, roughness=0.5).round(4))
    0.2387
    """
    return _compute("d_charlie", sin2_h=sin2_h, roughness=roughness)


def g_v_cavity(n_dot_l: Like, n_dot_v: Like, n_dot_h: Like, v_dot_h: Like) -> Numbers:
    """Return the masking of V-shaped grooves, [0, 1]. Cook and Torrance 1982, §4.

    Examples
    --------
    >>> float(tt.shade.g_v_cavity(0.8, 0.6, 0.9, 0.7).round(4))
    1.0
    """
    return _compute("g_v_cavity", n_dot_l=n_dot_l, n_dot_v=n_dot_v, n_dot_h=n_dot_h, v_dot_h=v_dot_h)


def v_smith_ggx(n_dot_l: Like, n_dot_v: Like, alpha: Like) -> Numbers:
    """Return the height-correlated visibility of GGX, G/(4 n·l n·v). Heitz 2014.

    Examples
    --------
    >>> float(tt.shade.v_smith_ggx(0.8, 0.6, alpha=0.25).round(4))
    0.5029
    """
    return _compute("v_smith_ggx", n_dot_l=n_dot_l, n_dot_v=n_dot_v, alpha=alpha)


def g1_schlick_ggx(cosine: Like, k: Like) -> Numbers:
    """Return Schlick's masking in one direction, cos/(cos (1 − k) + k). Schlick 1994; Karis 2013.

    Examples
    --------
    >>> float(tt.shade.g1_schlick_ggx(0.8, k=0.25).round(4))
    0.9412
    """
    return _compute("g1_schlick_ggx", cosine=cosine, k=k)


def v_schlick_ggx(n_dot_l: Like, n_dot_v: Like, k: Like) -> Numbers:
    """Return the visibility of Schlick's masking in both directions. Schlick 1994; Karis 2013.

    Examples
    --------
    >>> float(tt.shade.v_schlick_ggx(0.8, 0.6, k=0.25).round(4))
    0.4202
    """
    return _compute("v_schlick_ggx", n_dot_l=n_dot_l, n_dot_v=n_dot_v, k=k)


def k_for_lights(roughness: Like) -> Numbers:
    """Return Schlick's k for lights. Karis 2013.

    Examples
    --------
    >>> float(tt.shade.k_for_lights(0.5).round(4))
    0.2812
    """
    return _compute("k_for_lights", roughness=roughness)


def k_for_environment(roughness: Like) -> Numbers:
    """Return Schlick's k for environments. Karis 2013.

    Examples
    --------
    >>> float(tt.shade.k_for_environment(0.5).round(4))
    0.125
    """
    return _compute("k_for_environment", roughness=roughness)


def v_neubelt(n_dot_l: Like, n_dot_v: Like) -> Numbers:
    """Return the visibility of sheen, sr⁻¹, at most 1. Neubelt and Pettineo 2013.

    Examples
    --------
    >>> float(tt.shade.v_neubelt(0.8, 0.6).round(4))
    0.2717
    """
    return _compute("v_neubelt", n_dot_l=n_dot_l, n_dot_v=n_dot_v)


def f_schlick(f0: Like, v_dot_h: Like) -> Numbers:
    """Return Schlick's Fresnel reflectance, ``(..., 3)``. Schlick 1994.

    Examples
    --------
    >>> tt.shade.f_schlick((1.0, 0.8, 0.3), 0.5).round(4)
    array([1.    , 0.8062, 0.3219])
    """
    return _compute("f_schlick", f0=f0, v_dot_h=v_dot_h)


def f_schlick_f90(f0: Like, f90: Like, v_dot_h: Like) -> Numbers:
    """Return Schlick's Fresnel reflectance between two colours, ``(..., 3)``.

    Examples
    --------
    >>> tt.shade.f_schlick_f90((0.04, 0.04, 0.04), (1, 1, 1), 0.5).round(4)
    array([0.07, 0.07, 0.07])
    """
    return _compute("f_schlick_f90", f0=f0, f90=f90, v_dot_h=v_dot_h)


def f82_drop(f0: Like, f82: Like) -> Numbers:
    """Return Lazányi's coefficient for a reflectance at 82 degrees, ``(..., 3)``. Kutz, Hašan and Edmondson 2021.

    Examples
    --------
    >>> tt.shade.f82_drop((1.0, 0.78, 0.34), (0.9, 0.8, 0.6)).round(4)
    array([1.7651, 1.4436, 0.8006])
    """
    return _compute("f82_drop", f0=f0, f82=f82)


def f_f82(f0: Like, f90: Like, drop: Like, v_dot_h: Like) -> Numbers:
    """Return Schlick's reflectance with Lazányi's correction for metals, ``(..., 3)``; ``drop`` from `f82_drop`.

    Examples
    --------
    >>> tt.shade.f_f82((1.0, 0.78, 0.34), 1.0, (0.1, 0.2, 0.3), 0.5).round(4)
    array([0.9992, 0.7853, 0.3583])
    """
    return _compute("f_f82", f0=f0, f90=f90, drop=drop, v_dot_h=v_dot_h)


def f_dielectric(cos_theta: Like, eta: Like) -> Numbers:
    """Return the exact Fresnel reflectance of a dielectric of relative index ``eta``. Born and Wolf, §1.5.2.

    Examples
    --------
    >>> float(tt.shade.f_dielectric(1.0, eta=1.5).round(4))
    0.04
    """
    return _compute("f_dielectric", cos_theta=cos_theta, eta=eta)


def f_conductor(cos_theta: Like, eta: Like, k: Like) -> Numbers:
    """Return the exact Fresnel reflectance of a conductor of index ``eta + i k``. Born and Wolf, §14.2.

    Examples
    --------
    >>> float(tt.shade.f_conductor(1.0, eta=0.2, k=3.0).round(4))
    0.9234
    """
    return _compute("f_conductor", cos_theta=cos_theta, eta=eta, k=k)


def coat_fresnel(cosine: Like) -> Numbers:
    """Return Schlick's reflectance of a clearcoat of index 1.5. KHR_materials_clearcoat.

    Examples
    --------
    >>> float(tt.shade.coat_fresnel(0.5).round(4))
    0.07
    """
    return _compute("coat_fresnel", cosine=cosine)


def specular_occlusion(n_dot_v: Like, occlusion: Like, roughness: Like) -> Numbers:
    """Return the unoccluded share of a highlight's environment. Lagarde and de Rousiers 2014, listing 26.

    Examples
    --------
    >>> float(tt.shade.specular_occlusion(0.8, occlusion=0.5, roughness=0.4).round(4))
    0.5016
    """
    return _compute("specular_occlusion", n_dot_v=n_dot_v, occlusion=occlusion, roughness=roughness)


def inverse_square(distance_squared: Like) -> Numbers:
    """Return the falloff of a point light, 1/d².

    Examples
    --------
    >>> float(tt.shade.inverse_square(4.0).round(4))
    0.25
    """
    return _compute("inverse_square", distance_squared=distance_squared)


def range_window(distance_squared: Like, range: Like) -> Numbers:
    """Return the window that fades a light to zero at its range. KHR_lights_punctual.

    Examples
    --------
    >>> float(tt.shade.range_window(4.0, range=3.0).round(4))
    0.8025
    """
    return _compute("range_window", distance_squared=distance_squared, range=range)


def spot_cone(cos_angle: Like, cos_inner: Like, cos_outer: Like) -> Numbers:
    """Return the share of a spot light's intensity at an angle to its axis. KHR_lights_punctual.

    Examples
    --------
    >>> float(tt.shade.spot_cone(0.95, cos_inner=0.98, cos_outer=0.9).round(4))
    0.3906
    """
    return _compute("spot_cone", cos_angle=cos_angle, cos_inner=cos_inner, cos_outer=cos_outer)


__all__ = [
    "NAMES",
    "alpha_from_roughness",
    "alpha_from_shininess",
    "coat_fresnel",
    "d_beckmann",
    "d_blinn",
    "d_charlie",
    "d_ggx",
    "f82_drop",
    "f_conductor",
    "f_dielectric",
    "f_f82",
    "f_schlick",
    "f_schlick_f90",
    "g1_schlick_ggx",
    "g_v_cavity",
    "gradient",
    "inverse_square",
    "k_for_environment",
    "k_for_lights",
    "range_window",
    "reflect",
    "shininess_from_alpha",
    "specular_occlusion",
    "spot_cone",
    "v_neubelt",
    "v_schlick_ggx",
    "v_smith_ggx",
]
