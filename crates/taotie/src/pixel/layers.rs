//! The layers over the base of a surface: clearcoat and sheen.

use crate::math::{Lane, Vec3};
use crate::shade::dfg::Dfg;
use crate::shade::sheen::{d_charlie, v_neubelt};
use crate::shade::{Angles, COAT_F0, coat_lobe};

/// A clearcoat: KHR_materials_clearcoat.
///
/// The base loses what the coat reflects of equal light from everywhere, so that a white surface under a clearcoat
/// returns all light at any roughness. Where the coat is smooth that is the extension's 1 − F(n·v); where it is rough,
/// 1 − F(n·v) alone would leave a dark rim, since a rough coat seen at a grazing angle reflects less than F.
/// Law: `white_room::clearcoat_over_white_returns_what_arrives`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coat<L> {
    /// The normal: unit, world space.
    pub n: Vec3<L>,
    /// The part of the surface that it covers, [0, 1].
    pub factor: L,
    /// The roughness as artists set it, [0, 1].
    pub roughness: L,
    /// The part of equal light from everywhere that it reflects: [`coat_albedo`].
    pub albedo: L,
}

impl<L: Lane> Coat<L> {
    /// The part of the light that it lets through to the viewer, [0, 1].
    #[inline(always)]
    pub fn kept(&self) -> L {
        self.factor.lit(1.0) - self.factor * self.albedo
    }

    /// Puts the clearcoat over what the base reflects of a light.
    #[inline(always)]
    pub fn over(&self, base: Vec3<L>, v: Vec3<L>, l: Vec3<L>) -> Vec3<L> {
        let lobe = coat_lobe(self.roughness, &Angles::new(self.n, v, l));
        base * self.kept() + Vec3::splat(self.factor * lobe)
    }

    /// Puts the clearcoat over what the base reflects of the environment; `gathered` is what its own highlight sees.
    #[inline(always)]
    pub fn over_environment(&self, base: Vec3<L>, gathered: Vec3<L>) -> Vec3<L> {
        base * self.kept() + gathered * (self.factor * self.albedo)
    }
}

/// The part of equal light from everywhere that a clearcoat reflects, [0, 1]; `dfg` of GGX at its own n·v and
/// roughness.
#[inline(always)]
pub fn coat_albedo<L: Lane>(dfg: &Dfg<L>) -> L {
    dfg.scale.lit(COAT_F0) * dfg.scale + dfg.bias
}

/// Sheen: KHR_materials_sheen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sheen<L> {
    /// The colour, linear RGB in [0, 1].
    pub color: Vec3<L>,
    /// The roughness as artists set it, [0, 1].
    pub roughness: L,
    /// The part of equal light from everywhere that white sheen reflects: [`sheen_albedo`].
    pub albedo: L,
}

impl<L: Lane> Sheen<L> {
    /// The part of the light that it lets through to the base, [0, 1].
    #[inline(always)]
    pub fn kept(&self) -> L {
        let most = self.color.x.max(self.color.y).max(self.color.z);
        most.lit(1.0) - most * self.albedo
    }

    /// Puts the sheen over what the base reflects of a light.
    #[inline(always)]
    pub fn over(&self, base: Vec3<L>, a: &Angles<L>) -> Vec3<L> {
        let zero = a.n_dot_l.lit(0.0);
        let lobe = d_charlie(a.sin2_h, self.roughness) * v_neubelt(a.n_dot_l, a.n_dot_v) * a.n_dot_l;
        base * self.kept() + self.color * L::select(zero.lt(a.n_dot_l), lobe, zero)
    }

    /// Puts the sheen over what the base reflects of the environment, whose mean radiance is `mean`.
    #[inline(always)]
    pub fn over_mean(&self, base: Vec3<L>, mean: Vec3<L>) -> Vec3<L> {
        base * self.kept() + self.color.mul_elements(mean) * self.albedo
    }
}

/// The part of equal light from everywhere that white sheen reflects, [0, 1], of what the table says. Edge-on the lobe
/// sends back more than arrives; nothing negative may be left for what lies below.
#[inline(always)]
pub fn sheen_albedo<L: Lane>(of_table: L) -> L {
    of_table.min(of_table.lit(1.0))
}
