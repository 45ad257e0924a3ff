"""Formulas over arrays: values from NumPy, shapes, precision, derivatives."""

from __future__ import annotations

import numpy as np
import pytest

import taotie as tt
from taotie import shade

#: A value of each argument within its range.
WITHIN = {
    "alpha": 0.3, "roughness": 0.6, "shininess": 20.0, "slope": 0.4, "n_dot_h": 0.9, "sin2_h": 0.19, "n_dot_l": 0.7,
    "n_dot_v": 0.5, "v_dot_h": 0.8, "cosine": 0.6, "k": 0.4, "f0": (0.9, 0.6, 0.3), "f90": 1.0, "f82": (0.8, 0.6, 0.4),
    "drop": (0.1, 0.2, 0.3), "cos_theta": 0.7, "eta": 1.5, "occlusion": 0.8, "distance_squared": 2.0, "range": 3.0,
    "cos_angle": 0.8, "cos_inner": 0.9, "cos_outer": 0.5,
}  # fmt: skip


def arguments(name: str) -> dict[str, object]:
    given = {argument: WITHIN[argument] for argument in shade._ARGUMENTS[name]}
    return {**given, "f90": (1.0, 1.0, 1.0)} if name == "f_schlick_f90" else given


def test_formulas_match_the_papers() -> None:
    c, a = np.linspace(0.01, 1, 50), 0.3
    d = a**2 / (np.pi * (c**2 * (a**2 - 1) + 1) ** 2)
    assert np.allclose(shade.d_ggx(c, a), d, rtol=1e-12)
    assert np.allclose(shade.f_schlick([0.04] * 3, c)[:, 0], 0.04 + 0.96 * (1 - c) ** 5, rtol=1e-14)
    assert shade.f_dielectric(1.0, 1.5) == pytest.approx(0.04)


@pytest.mark.parametrize("name", shade.NAMES)
def test_every_formula_has_its_derivatives(name: str) -> None:
    given = arguments(name)
    value = getattr(shade, name)(**given)
    again, by = shade.gradient(name, list(given), **given)
    assert np.array_equal(value, again) and np.all(np.isfinite(value))
    for argument, partial in by.items():
        step = 1e-6
        for i in range(np.size(given[argument])):
            moved = np.array(given[argument], dtype=float)
            ends = []
            for sign in (1, -1):
                at = moved.copy()
                at.reshape(-1)[i] += sign * step
                ends.append(np.asarray(getattr(shade, name)(**{**given, argument: at})))
            exact = partial[..., i] if moved.size > 1 else partial
            assert np.allclose((ends[0] - ends[1]) / (2 * step), exact, rtol=1e-4, atol=1e-7), argument


@pytest.mark.parametrize("model", ["lambert", "phong", "blinn-phong", "blinn-phong-classic", "cook-torrance", "ggx"])
def test_models_reflect_and_have_derivatives(model: str) -> None:
    v, l = np.array([0.6, 0.0, 0.8]), np.array([[-0.6, 0.0, 0.8], [0.0, 0.6, 0.8]])
    seen = dict(n=[0.0, 0.0, 1.0], v=v, l=l, base_color=(0.9, 0.5, 0.2), metallic=0.5, roughness=0.5)
    value = shade.reflect(model, **seen)
    assert value.shape == (2, 3) and np.all(value >= 0) and value.max() > 0.05
    again, by = shade.gradient("reflect", ["roughness", "base_color"], model=model, **seen)
    assert np.array_equal(value, again) and by["roughness"].shape == (2, 3) and by["base_color"].shape == (2, 3, 3)
    ends = [shade.reflect(model, **{**seen, "roughness": 0.5 + step}) for step in (1e-6, -1e-6)]
    assert np.allclose((ends[0] - ends[1]) / 2e-6, by["roughness"], rtol=1e-4, atol=1e-7)


def test_arguments_broadcast_and_keep_their_precision() -> None:
    n_dot_h = np.linspace(0.1, 1, 12, dtype=np.float32).reshape(3, 1, 4)
    alpha = np.array([[0.1], [0.5]], dtype=np.float32)
    single = shade.d_ggx(n_dot_h, alpha)
    assert single.shape == (3, 2, 4) and single.dtype == np.float32
    assert shade.d_ggx(n_dot_h, 0.5).dtype == np.float32 and shade.d_ggx(0.9, 0.5).dtype == np.float64
    assert np.allclose(single, shade.d_ggx(n_dot_h.astype(float), alpha), rtol=1e-4)
    assert shade.d_ggx(np.zeros((0,)), 0.5).shape == (0,) and shade.d_ggx(0.9, 0.5).shape == ()
    with pytest.raises(tt.Error, match="do not broadcast: "):
        shade.d_blinn(np.zeros(2), np.zeros(3))
    with pytest.raises(tt.Error, match=r"f0: .*\(2,\); expected \(\.\.\., 3\)"):
        shade.f_schlick([0.1, 0.2], 0.5)
    with pytest.raises(tt.Error, match="unknown; expected one of"):
        shade.gradient("d_gxx", "alpha", alpha=1.0)
    with pytest.raises(tt.Error, match="ggz"):
        shade.reflect("ggz", n=[0, 0, 1], v=[0, 0, 1], l=[0, 0, 1])
