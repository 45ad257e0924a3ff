//! Laws of the two facets that represent a mapped normal.

use crate::random::Random;
use std::f64::consts::FRAC_1_PI;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::shade::Facets;
use taotie_engine::shade::furnace::over_hemisphere;

type V = Vec3<f64>;

const G: V = Vec3::new(0.0, 0.0, 1.0);

/// Returns facets for a map that tilts by `tilt` radians towards +x.
fn leaning(tilt: f64) -> Facets<f64> {
    Facets::new(G, Vec3::new(scalar::sin(tilt), 0.0, scalar::cos(tilt)))
}

fn above(random: &mut Random) -> V {
    let v = random.unit();
    Vec3::new(v.x, v.y, v.z.abs())
}

/// Returns the light that a white Lambertian facet reflects to the true or mirrored viewer, and the total.
fn lambert(facets: &Facets<f64>, v: V, l: V) -> f64 {
    let base = |v: V| {
        let seen = if facets.p.dot(v) > 0.0 { FRAC_1_PI } else { 0.0 };
        move |l: V| facets.p.dot(l).max(0.0) * seen
    };
    whole(facets, v, l, base)
}

/// Returns the light that the true and the mirrored viewer see together, if `base` makes the facet's reflection for a
/// viewer.
fn whole<B: Fn(V) -> f64>(facets: &Facets<f64>, v: V, l: V, base: impl Fn(V) -> B) -> f64 {
    let seen = |v: V| {
        let base = base(v);
        facets.ways(l).into_iter().map(|(l, share)| base(l) * share).sum::<f64>()
    };
    let mirror = facets.share_of_mirror(v);
    mirror * seen(facets.mirrored(v)) + (1.0 - mirror) * seen(v)
}

/// Like [`lambert`], for a reciprocal gloss about the mirror direction.
fn glossy(facets: &Facets<f64>, v: V, l: V) -> f64 {
    let base = |v: V| {
        move |l: V| {
            let h = (v + l).normalize();
            let lobe = scalar::pow(facets.p.dot(h).max(0.0), 12.0);
            let seen = if facets.p.dot(v) > 0.0 { 1.0 } else { 0.0 };
            lobe * facets.p.dot(l).max(0.0) * seen
        }
    };
    whole(facets, v, l, base)
}

#[test]
fn the_mean_normal_is_the_surface_s() {
    let mut random = Random(1);
    for _ in 0..200 {
        let (g, mapped) = (random.unit(), random.unit());
        let facets = Facets::new(g, mapped);
        let cos = facets.p.dot(g);
        let tan = (1.0 - cos * cos).max(0.0).sqrt() / cos;
        let mean = facets.p * (1.0 / cos) + facets.t * tan;
        assert!((mean - g).length() < 1e-9, "{g:?} {mapped:?}: {mean:?}");
        assert!(facets.t.dot(g).abs() < 1e-12 && (facets.t.length() - 1.0).abs() < 1e-12);
        if mapped.dot(g) > 0.02 {
            assert!((facets.p - mapped).length() < 1e-9);
        }
    }
}

#[test]
fn the_seen_area_is_that_of_the_surface() {
    let mut random = Random(2);
    for _ in 0..500 {
        let facets = leaning(1.4 * random.next());
        let w = above(&mut random);
        let cos = facets.p.dot(G);
        let tan = (1.0 - cos * cos).sqrt() / cos;
        let (p, t) = (facets.p.dot(w).max(0.0) / cos, tan * facets.t.dot(w).max(0.0));
        let seen = facets.escape(w) * (p + t);
        assert!((seen - w.z).abs() < 1e-9, "{w:?}: {seen}");
        assert!((facets.share_of_mirror(w) - t / (p + t)).abs() < 1e-9);
        let below = Vec3::new(w.x, w.y, -w.z);
        assert_eq!(facets.escape(below), 0.0);
    }
}

#[test]
fn a_flat_map_is_no_map() {
    let mut random = Random(3);
    for _ in 0..100 {
        let (v, l) = (above(&mut random), above(&mut random));
        assert!((lambert(&leaning(0.0), v, l) - l.z * FRAC_1_PI).abs() < 1e-12);
    }
}

#[test]
fn facets_are_reciprocal() {
    let mut random = Random(4);
    let mut both_ways = 0;
    for _ in 0..2000 {
        let facets = leaning(1.3 * random.next());
        let (v, l) = (above(&mut random), above(&mut random));
        for model in [lambert, glossy] {
            let (there, back) = (model(&facets, v, l) / l.z, model(&facets, l, v) / v.z);
            assert!((there - back).abs() < 1e-9 * (1.0 + there), "{v:?} {l:?}: {there} {back}");
            both_ways += usize::from(there > 1e-3);
        }
    }
    assert!(both_ways > 1000, "{both_ways}");
}

/// Returns all light that a white facet reflects to a viewer.
fn albedo(facets: &Facets<f64>, v: V) -> f64 {
    over_hemisphere(12, |l| Vec3::splat(lambert(facets, v, l))).x
}

#[test]
fn a_white_matt_facet_reflects_the_cosine_of_its_tilt() {
    // The sky is as large as the surface, the facet larger by 1/cos θ, and mirrors lose nothing.
    for tilt_deg in [0.0f64, 5.0, 15.0, 30.0, 45.0, 60.0] {
        let tilt = tilt_deg.to_radians();
        let facets = leaning(tilt);
        for elevation in [2.0f64, 10.0, 30.0, 50.0, 70.0, 90.0] {
            for azimuth in [0.0f64, 60.0, 120.0, 180.0] {
                let (elevation, azimuth) = (elevation.to_radians(), azimuth.to_radians());
                let flat = scalar::cos(elevation);
                let (x, y) = (flat * scalar::cos(azimuth), flat * scalar::sin(azimuth));
                let found = albedo(&facets, Vec3::new(x, y, scalar::sin(elevation)));
                assert!((found - scalar::cos(tilt)).abs() < 2e-3, "{tilt_deg}°: {found}");
            }
        }
    }
}
