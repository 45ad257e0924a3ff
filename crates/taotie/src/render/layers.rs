//! The layers over the base of a surface: clearcoat, sheen, and the soft edge of its relief's shadow.

use super::batch::Lanes;
use crate::math::{Lane, Pack, Vec3};
use crate::shade::sheen::{d_charlie, v_neubelt};
use crate::shade::{Angles, coat_lobe};

/// A clearcoat: KHR_materials_clearcoat.
///
/// The base loses what the coat reflects of equal light from everywhere, so that a white surface under a clearcoat
/// returns all light at any roughness. Where the coat is smooth that is the extension's 1 − F(n·v); where it is rough,
/// 1 − F(n·v) alone would leave a dark rim, since a rough coat seen at a grazing angle reflects less than F.
/// Law: `white_room::clearcoat_over_white_returns_what_arrives`.
pub(super) struct Coat<L> {
    /// The normal: unit, world space.
    pub n: Vec3<L>,
    /// The part of the surface that it covers, [0, 1].
    pub factor: L,
    pub roughness: L,
    /// The part of the light that it lets through to the viewer, [0, 1].
    pub kept: L,
    /// The part of equal light from everywhere that it reflects.
    albedo: L,
}

impl<P: Pack> Coat<P> {
    #[inline(always)]
    pub(super) fn new(at: Lanes<'_, P>) -> Self {
        let layers = &at.batch.layers;
        let factor = at.load(&layers.coat);
        let albedo = at.load(&layers.coat_albedo);
        let kept = at.splat(1.0) - factor * albedo;
        Self { n: at.load3(&layers.coat_n), factor, roughness: at.load(&layers.coat_roughness), kept, albedo }
    }
}

impl<L: Lane> Coat<L> {
    /// Puts the clearcoat over what the base reflects of a light.
    #[inline(always)]
    pub(super) fn over(&self, base: Vec3<L>, v: Vec3<L>, l: Vec3<L>) -> Vec3<L> {
        let lobe = coat_lobe(self.roughness, &Angles::new(self.n, v, l));
        base * self.kept + Vec3::splat(self.factor * lobe)
    }

    /// Puts the clearcoat over what the base reflects of the environment; `gathered` is what its own highlight sees.
    #[inline(always)]
    pub(super) fn over_environment(&self, base: Vec3<L>, gathered: Vec3<L>) -> Vec3<L> {
        base * self.kept + gathered * (self.factor * self.albedo)
    }
}

/// Sheen: KHR_materials_sheen.
pub(super) struct Sheen<L> {
    color: Vec3<L>,
    roughness: L,
    /// The part of the light that it lets through to the base, [0, 1].
    kept: L,
    albedo: L,
}

impl<P: Pack> Sheen<P> {
    #[inline(always)]
    pub(super) fn new(at: Lanes<'_, P>) -> Self {
        let layers = &at.batch.layers;
        let color = at.load3(&layers.sheen_color);
        let albedo = at.load(&layers.sheen_albedo);
        let most = color.x.max(color.y).max(color.z);
        let roughness = at.load(&layers.sheen_roughness);
        Self { color, roughness, kept: at.splat(1.0) - most * albedo, albedo }
    }
}

impl<L: Lane> Sheen<L> {
    /// Puts the sheen over what the base reflects of a light.
    #[inline(always)]
    pub(super) fn over(&self, base: Vec3<L>, a: &Angles<L>) -> Vec3<L> {
        let zero = a.n_dot_l.lit(0.0);
        let lobe = d_charlie(a.sin2_h, self.roughness) * v_neubelt(a.n_dot_l, a.n_dot_v) * a.n_dot_l;
        base * self.kept + self.color * L::select(zero.lt(a.n_dot_l), lobe, zero)
    }

    /// Puts the sheen over what the base reflects of the environment, whose mean radiance is `mean`.
    #[inline(always)]
    pub(super) fn over_mean(&self, base: Vec3<L>, mean: Vec3<L>) -> Vec3<L> {
        base * self.kept + self.color.mul_elements(mean) * self.albedo
    }
}

/// The softened edge between the lit and the dark side of a surface whose normals come from a map.
///
/// A map turns normals without moving the surface, so light ends abruptly where the surface turns away but its mapped
/// normal does not. The slope of the map is taken as a roughness of the surface's own facets, and the light fades by
/// how much those would hide.
/// Source: Estevez, Lecocq and Stein 2019, "A Microfacet-Based Shadowing Function to Solve the Bump Terminator
/// Problem".
pub(super) struct Terminator<L> {
    smooth: Vec3<L>,
    /// The squared slope of the map; 0 where nothing is to be softened.
    squared_slope: L,
}

impl<P: Pack> Terminator<P> {
    #[inline(always)]
    pub(super) fn new(at: Lanes<'_, P>) -> Self {
        Self { smooth: at.load3(&at.batch.smooth), squared_slope: at.load(&at.batch.bump) }
    }
}

impl<L: Lane> Terminator<L> {
    /// The share of light from `l` that arrives: 2 / (1 + √(1 + α² tan²θ)), α² = tan²(n, n')/8, θ between the smooth
    /// normal and `l`; 0 below the horizon, and 1 where no map turns the normal.
    #[inline(always)]
    pub(super) fn share(&self, l: Vec3<L>) -> L {
        let (zero, one) = (l.x.lit(0.0), l.x.lit(1.0));
        let cosine = self.smooth.dot(l);
        let squared = (cosine * cosine).max(one.lit(1e-12));
        let tan2 = ((one - squared) / squared).max(zero);
        let share = one.lit(2.0) / (one + (one + self.squared_slope * tan2).sqrt());
        let softened = L::select(zero.lt(cosine), share, zero);
        L::select(zero.lt(self.squared_slope), softened, one)
    }
}

/// α² of [`Terminator::share`] for a map that turns the unit normal `smooth` into `n`: tan² of the angle between over
/// eight, at most 1.
#[inline(always)]
pub(super) fn squared_slope<L: Lane>(smooth: Vec3<L>, n: Vec3<L>) -> L {
    let cosine = smooth.dot(n).abs().clamp(1e-3, 1.0);
    let squared = cosine * cosine;
    ((squared.lit(1.0) - squared) / squared * squared.lit(0.125)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terminators_agree_with_the_oracle() {
        let oracle = include_str!("../../../../tests/oracle/light_oracle.json");
        let oracle: serde_json::Value = serde_json::from_str(oracle).unwrap();
        let rows = oracle["terminator"].as_array().unwrap();
        assert!(rows.len() > 30);
        for row in rows {
            let vector = |name: &str| {
                let [x, y, z] = [0, 1, 2].map(|i| row[name][i].as_f64().unwrap());
                Vec3::new(x, y, z)
            };
            let smooth = vector("smooth");
            let terminator = Terminator { smooth, squared_slope: squared_slope(smooth, vector("n")) };
            let (share, truth) = (terminator.share(vector("l")), row["share"].as_f64().unwrap());
            assert!((share - truth).abs() < 1e-9, "{share} for {truth} in {row}");
        }
    }
}
