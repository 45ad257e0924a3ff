//! The structures that formulas take, as parameters of a recording, in the order of their fields.

use crate::recorder::{Recorded, Scope};
use taotie_engine::math::Vec3;
use taotie_engine::shade::dfg::Dfg;
use taotie_engine::shade::{Angles, Compensation, EnvironmentWeights, MaterialSample};

/// The material sample `s`, without energy compensation.
pub(crate) fn material(scope: Scope<'_>) -> MaterialSample<Recorded<'_>> {
    MaterialSample {
        base_color: scope.vector("s.base_color"),
        metallic: scope.number("s.metallic"),
        roughness: scope.number("s.roughness"),
        f0: scope.vector("s.f0"),
        f90: scope.number("s.f90"),
        f82_drop: scope.vector("s.f82_drop"),
        diffuse: scope.vector("s.diffuse"),
        specular: scope.vector("s.specular"),
        shininess: scope.number("s.shininess"),
        slope: scope.number("s.slope"),
        compensation: None,
    }
}

/// The angles `a`.
pub(crate) fn angles(scope: Scope<'_>) -> Angles<Recorded<'_>> {
    Angles {
        n_dot_l: scope.number("a.n_dot_l"),
        n_dot_v: scope.number("a.n_dot_v"),
        n_dot_h: scope.number("a.n_dot_h"),
        sin2_h: scope.number("a.sin2_h"),
        v_dot_h: scope.number("a.v_dot_h"),
        r_dot_v: scope.number("a.r_dot_v"),
    }
}

/// The energy compensation `c`.
pub(crate) fn compensation(scope: Scope<'_>) -> Compensation<Recorded<'_>> {
    Compensation { gain: scope.vector("c.gain"), transmitted: scope.number("c.transmitted") }
}

/// The directional albedos `dfg`.
pub(crate) fn dfg(scope: Scope<'_>) -> Dfg<Recorded<'_>> {
    Dfg {
        scale: scope.number("dfg.scale"),
        bias: scope.number("dfg.bias"),
        edge: scope.number("dfg.edge"),
        diffuse_edge: scope.number("dfg.diffuse_edge"),
    }
}

/// The environment weights `w`, which formulas return.
pub(crate) fn weights(scope: Scope<'_>) -> EnvironmentWeights<Recorded<'_>> {
    EnvironmentWeights { specular: scope.vector("w.specular"), diffuse: scope.vector("w.diffuse") }
}

/// The scalars of these vectors, one after the other.
pub(crate) fn numbers<'g, const N: usize>(vectors: [Vec3<Recorded<'g>>; N]) -> Vec<Recorded<'g>> {
    vectors.iter().flat_map(|vector| vector.to_array()).collect()
}
