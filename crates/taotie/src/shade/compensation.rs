//! Energy compensation: the light that a lobe loses by single scattering.

use super::dfg::Dfg;
use crate::math::{Lane, Vec3};

/// The compensation that makes a microfacet model conserve energy, at one n·v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compensation<L> {
    /// Multiplies the highlight, linear RGB, at least 1.
    pub gain: Vec3<L>,
    /// The fraction of light that the highlight leaves for the diffuse reflection below, [0, 1].
    pub transmitted: L,
}

/// The compensation of a lobe whose directional albedos are `dfg`, for Schlick's Fresnel factor between `f0` and `f90`
/// with Lazányi's `drop`.
///
/// gain = 1 + F0 (1 − E)/E with E = scale + bias: light that is not reflected at the first facet meets another and is
/// coloured again, so that a white metal reflects all of it. transmitted = 1 − max(gain · albedo), over the channels,
/// so that a white dielectric reflects all of it too, and no colour more than it receives.
///
/// Law: a white furnace returns 1 within 1 % at roughness 0.1 to 1 (`laws::energy`).
/// Source: Turquin 2019, "Practical multiple scattering compensation for microfacet models", eq. 16; the diffuse
/// fraction as in Jakob et al. 2014 and glTF viewers.
#[inline(always)]
pub fn compensation<L: Lane>(dfg: &Dfg<L>, f0: Vec3<L>, f90: L, drop: Vec3<L>) -> Compensation<L> {
    let one = f90.lit(1.0);
    let total = dfg.total().max(one.lit(1e-3));
    let gain = Vec3::splat(one) + f0 * ((one - total) / total).max(one.lit(0.0));
    let albedo = dfg.albedo(f0, f90, drop).mul_elements(gain);
    let most = albedo.x.max(albedo.y).max(albedo.z);
    Compensation { gain, transmitted: (one - most).clamp(0.0, 1.0) }
}
