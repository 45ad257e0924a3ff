//! The laws of reflectance, and the models that break them.

use std::f64::consts::{LN_2, PI};
use taotie_engine::math::integration::integrate;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::names::Named;
use taotie_engine::shade::fresnel::{f_conductor, f_dielectric, f_f82, f_schlick, f_schlick_f90, f82_drop};
use taotie_engine::shade::furnace::{Furnace, over_hemisphere, polar_ends};
use taotie_engine::shade::lights::{inverse_square, range_window, spot_cone};
use taotie_engine::shade::microfacets::{
    MIN_ALPHA, alpha_from_roughness, alpha_from_shininess, d_beckmann, d_blinn, d_ggx, shininess_from_alpha,
};
use taotie_engine::shade::microfacets::{
    g_v_cavity, g1_schlick_ggx, k_for_environment, k_for_lights, v_schlick_ggx, v_smith_ggx,
};
use taotie_engine::shade::{Angles, MaterialSample, Shading, reflect};

type V = Vec3<f64>;

const N: V = Vec3::new(0.0, 0.0, 1.0);
const WHITE: V = Vec3::new(1.0, 1.0, 1.0);
const BLACK: V = Vec3::new(0.0, 0.0, 0.0);
const ROUGHNESS: [f64; 7] = [0.1, 0.2, 0.35, 0.5, 0.7, 0.85, 1.0];
const N_DOT_V: [f64; 8] = [0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0];

/// A mirror-white metal without a diffuse part: all losses are the lobe's.
fn white() -> MaterialSample<f64> {
    MaterialSample {
        base_color: WHITE,
        metallic: 1.0,
        roughness: 0.5,
        f0: WHITE,
        f90: 1.0,
        f82_drop: BLACK,
        diffuse: BLACK,
        specular: WHITE,
        shininess: 20.0,
        slope: 0.3,
        compensation: None,
    }
}

fn viewer(n_dot_v: f64) -> V {
    Vec3::new((1.0 - n_dot_v * n_dot_v).sqrt(), 0.0, n_dot_v)
}

/// The directional albedo, red channel.
fn albedo(shading: Shading, s: &MaterialSample<f64>, n_dot_v: f64) -> f64 {
    Furnace::default().directional_albedo(shading, s, n_dot_v).x
}

/// Pseudorandom numbers in [0, 1) that never change.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A unit vector with z from `low` to 1.
    fn direction(&mut self, low: f64) -> V {
        let z = low + (1.0 - low) * self.next();
        let (r, phi) = ((1.0 - z * z).sqrt(), 2.0 * PI * self.next());
        Vec3::new(r * scalar::cos(phi), r * scalar::sin(phi), z)
    }

    fn color(&mut self) -> V {
        Vec3::new(self.next(), self.next(), self.next())
    }

    fn sample(&mut self) -> MaterialSample<f64> {
        let (f0, f82) = (self.color(), self.color());
        MaterialSample {
            base_color: self.color(),
            metallic: self.next(),
            roughness: 0.1 + 0.9 * self.next(),
            f0,
            f90: 1.0,
            f82_drop: f82_drop(f0, f82),
            diffuse: self.color(),
            specular: self.color(),
            shininess: 200.0 * self.next(),
            slope: 0.05 + self.next(),
            compensation: None,
        }
    }
}

// Fresnel

#[test]
fn schlick_ends() {
    let (f0, f90) = (Vec3::new(0.04, 0.5, 0.9), Vec3::new(1.0, 0.7, 0.95));
    assert_eq!(f_schlick(f0, 1.0), f0);
    assert!((f_schlick(f0, 0.0) - WHITE).length() < 1e-15);
    assert!((f_schlick_f90(f0, f90, 0.0) - f90).length() < 1e-15);
    assert_eq!(f_schlick_f90(f0, f90, 1.0), f0);
}

#[test]
fn f82_passes_through_both_points() {
    let (f0, f82) = (Vec3::new(0.9626, 0.7133, 0.4640), Vec3::new(0.9511, 0.8406, 0.7258));
    let drop = f82_drop(f0, f82);
    assert_eq!(f_f82(f0, 1.0, drop, 1.0), f0);
    assert!((f_f82(f0, 1.0, drop, 1.0 / 7.0) - f82).length() < 1e-14);
    assert!((f_f82(f0, 1.0, drop, 0.0) - WHITE).length() < 1e-15);
    assert!(f82_drop(f0, f_schlick(f0, 1.0 / 7.0)).length() < 1e-14, "Schlick's own value drops nothing");
}

#[test]
fn exact_fresnel_limits() {
    for eta in [0.3f64, 0.75, 1.2, 1.5, 2.7] {
        let at_normal = (eta - 1.0) * (eta - 1.0) / ((eta + 1.0) * (eta + 1.0));
        assert!((f_dielectric(1.0, eta) - at_normal).abs() < 1e-15);
        for k in [0.0, 0.8, 3.6] {
            let at_normal = ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k);
            assert!((f_conductor(1.0, eta, k) - at_normal).abs() < 1e-14);
            assert!((f_conductor(0.0, eta, k) - 1.0).abs() < 1e-14, "grazing light is all reflected");
        }
        for i in 1..=50 {
            let cos = f64::from(i) / 50.0;
            assert!(
                (f_conductor(cos, eta, 0.0) - f_dielectric(cos, eta)).abs() < 1e-12,
                "η {eta}, cos {cos}"
            );
        }
    }
    let brewster = 1.0 / (1.0f64 + 1.5 * 1.5).sqrt();
    let r_s = (1.5 * 1.5 - 1.0) / (1.5 * 1.5 + 1.0);
    assert!(
        (f_dielectric(brewster, 1.5) - r_s * r_s / 2.0).abs() < 1e-15,
        "no p reflection at Brewster's angle"
    );
    assert_eq!(f_dielectric(0.3, 1.0 / 1.5), 1.0, "beyond the critical angle");
    assert!(f_dielectric(1.0, 1.0) == 0.0 && f_dielectric(0.0, 1.0) < 1e-10, "no interface, no reflection");
}

/// η and k at 650, 550 and 450 nm: copper, gold and silver (Johnson and Christy 1972), Cu90Zn10 (Querry 1985).
const METALS: [(f64, f64); 12] = [
    (0.2378, 3.6264),
    (1.0066, 2.5823),
    (1.2404, 2.3929),
    (0.1556, 3.6024),
    (0.4241, 2.4721),
    (1.3831, 1.9155),
    (0.0522, 4.4094),
    (0.0596, 3.5974),
    (0.0400, 2.6484),
    (0.3200, 3.3960),
    (0.5190, 2.4150),
    (0.9800, 1.9450),
];

/// Returns the largest difference between an approximation and the exact reflectance over all angles.
fn off(eta: f64, k: f64, f: impl Fn(f64) -> V) -> f64 {
    let cosines = (0..=500).map(|i| f64::from(i) / 500.0);
    cosines.map(|cos| (f(cos).x - f_conductor(cos, eta, k)).abs()).fold(0.0, f64::max)
}

#[test]
fn f82_follows_exact_conductors_closer_than_schlick() {
    let (mut schlick, mut f82) = (0.0f64, 0.0f64);
    for (eta, k) in METALS {
        let f0 = WHITE * f_conductor(1.0, eta, k);
        let drop = f82_drop(f0, WHITE * f_conductor(1.0 / 7.0, eta, k));
        schlick = schlick.max(off(eta, k, |cos| f_schlick(f0, cos)));
        f82 = f82.max(off(eta, k, |cos| f_f82(f0, 1.0, drop, cos)));
    }
    eprintln!("twelve conductors: Schlick off by up to {schlick:.4}, F82 by {f82:.4}");
    assert!(schlick < 0.04 && f82 < 0.017, "Schlick {schlick}, F82 {f82}");
    assert!(f82 < 0.5 * schlick, "Schlick {schlick}, F82 {f82}");
}

// Distributions and masking

#[test]
fn ndf_is_normalised() {
    let area = |d: &dyn Fn(f64, f64) -> f64| {
        integrate(12, &polar_ends(), |theta| {
            let (sin, cos) = (scalar::sin(theta), scalar::cos(theta));
            2.0 * PI * sin * cos * d(cos, sin * sin)
        })
    };
    for width in [MIN_ALPHA, 0.003, 0.01, 0.05, 0.2, 0.5, 0.8, 1.0] {
        let ggx = area(&|cos, sin2| d_ggx(cos, sin2, width));
        let beckmann = area(&|cos, sin2| d_beckmann(cos, sin2, width));
        let blinn = area(&|cos, _| d_blinn(cos, shininess_from_alpha(width.max(0.01))));
        assert!((ggx - 1.0).abs() < 1e-6, "GGX, α {width}: {ggx}");
        assert!((beckmann - 1.0).abs() < 1e-6, "Beckmann, m {width}: {beckmann}");
        assert!((blinn - 1.0).abs() < 1e-6, "Blinn, α {width}: {blinn}");
    }
}

#[test]
fn shininess_and_alpha_are_inverse() {
    for s in [0.0f64, 1.0, 5.0, 32.0, 1000.0, 1e5] {
        assert!((shininess_from_alpha(alpha_from_shininess(s)) - s).abs() <= 1e-10 * (s + 1.0));
    }
    assert_eq!(
        [alpha_from_roughness(0.0), alpha_from_roughness(0.5), alpha_from_roughness(1.0)],
        [1e-3, 0.25, 1.0]
    );
}

#[test]
fn masking_is_a_share() {
    let mut random = Random(1);
    for _ in 0..2000 {
        let a = Angles::new(N, random.direction(0.01), random.direction(0.01));
        let (l, v, roughness) = (a.n_dot_l, a.n_dot_v, 0.05 + 0.95 * random.next());
        let cavity = |l, v| g_v_cavity(l, v, a.n_dot_h, a.v_dot_h);
        let smith = |l: f64, v: f64| 4.0 * l * v * v_smith_ggx(l, v, roughness * roughness);
        for k in [k_for_lights(roughness), k_for_environment(roughness)] {
            let schlick = 4.0 * l * v * v_schlick_ggx(l, v, k);
            assert!((schlick - g1_schlick_ggx(l, k) * g1_schlick_ggx(v, k)).abs() < 1e-14);
            assert!((0.0..=1.0).contains(&schlick));
        }
        for g in [cavity(l, v), smith(l, v)] {
            assert!((0.0..=1.0 + 1e-15).contains(&g), "{g}");
        }
        assert_eq!(cavity(l, v), cavity(v, l));
        assert!((smith(l, v) - smith(v, l)).abs() < 1e-15);
    }
    assert_eq!([g1_schlick_ggx(0.0, 0.3), g1_schlick_ggx(1.0, 0.3)], [0.0, 1.0]);
}

/// The visible facets together have the area of the surface that the viewer sees: ∫ G1(v) D(h) (v·h)⁺ dh = n·v. Heitz
/// 2014, eq. 22. G1 is the masking for light from n, for which Smith's shadowing is nil.
#[test]
fn visible_normals_are_normalised() {
    for n_dot_v in [0.1, 0.3, 0.6, 0.9, 1.0] {
        for alpha in [0.05, 0.2, 0.5, 1.0] {
            let v = viewer(n_dot_v);
            let g1 = 4.0 * n_dot_v * v_smith_ggx(1.0, n_dot_v, alpha);
            let seen = over_hemisphere(32, |h| {
                let sin2_h = h.x * h.x + h.y * h.y;
                WHITE * (g1 * d_ggx(h.z, sin2_h, alpha) * v.dot(h).max(0.0))
            })
            .x;
            assert!((seen / n_dot_v - 1.0).abs() < 2e-5, "n·v {n_dot_v}, α {alpha}: {}", seen / n_dot_v);
        }
    }
}

// Models

/// All energy of a lobe without absorption, compared with integrals in one dimension.
///
/// For light along the normal, with u = (n·h)² and x = n·l = 2u − 1:
/// E(α) = ∫ from 1/2 to 1 of α²/(u(α² − 1) + 1)² · 2x/(x + √(α² + (1 − α²)x²)) du, which is 1 − ln 2 for α = 1.
#[test]
fn white_furnace_of_ggx() {
    for roughness in ROUGHNESS {
        let a2 = scalar::pow(roughness, 4.0);
        // 1 − u in geometric steps: the lobe of a small α is at u = 1.
        let ends: Vec<f64> =
            (0..=24).map(|i| if i == 0 { 0.0 } else { 0.5 / f64::from(1u32 << (24 - i)) }).collect();
        let exact = integrate(12, &ends, |rest| {
            let u = 1.0 - rest;
            let x = 2.0 * u - 1.0;
            let t = u * a2 + rest;
            a2 / (t * t) * 2.0 * x / (x + (a2 + (1.0 - a2) * x * x).sqrt())
        });
        let e = albedo(Shading::Ggx, &MaterialSample { roughness, ..white() }, 1.0);
        eprintln!("roughness {roughness}: E = {e}");
        assert!((e - exact).abs() < 1e-6, "roughness {roughness}: {e}, exactly {exact}");
    }
    let roughest = albedo(Shading::Ggx, &MaterialSample { roughness: 1.0, ..white() }, 1.0);
    assert!((roughest - (1.0 - LN_2)).abs() < 1e-6, "{roughest}");
    let smoothest = albedo(Shading::Ggx, &MaterialSample { roughness: 0.1, ..white() }, 0.8);
    assert!((0.9995..=1.0).contains(&smoothest), "tends to 1 with α → 0: {smoothest}");
}

/// A dielectric, an equally rough metal, and intermediate materials, for each model.
fn of_width(width: f64) -> MaterialSample<f64> {
    MaterialSample {
        diffuse: WHITE * 0.5,
        roughness: width.sqrt(),
        slope: width,
        shininess: shininess_from_alpha(width),
        metallic: 0.0,
        f0: Vec3::new(0.04, 0.3, 1.0),
        ..white()
    }
}

/// Returns the largest relative difference made by twice as many nodes, and where.
fn refinement(albedo: impl Fn(Furnace, Shading) -> V) -> (f64, &'static str) {
    let mut worst = (0.0, "");
    for (name, shading) in Shading::NAMES.iter().copied() {
        let (usual, fine) = (albedo(Furnace::default(), shading), albedo(Furnace { fineness: 18 }, shading));
        for (a, b) in usual.to_array().into_iter().zip(fine.to_array()) {
            let off = (a - b).abs() / b.max(1.0);
            worst = if off > worst.0 { (off, name) } else { worst };
        }
    }
    worst
}

#[test]
fn albedos_are_as_exact_as_stated() {
    for width in [0.01, 0.1, 1.0] {
        let s = of_width(width);
        for n_dot_v in [0.1, 0.4, 1.0] {
            let worst = refinement(|furnace, shading| furnace.directional_albedo(shading, &s, n_dot_v));
            assert!(worst.0 < 5e-5, "width {width}, n·v {n_dot_v}: {worst:?}");
        }
    }
    let worst = refinement(|furnace, shading| furnace.hemispherical_albedo(shading, &of_width(0.1)));
    assert!(worst.0 < 1e-4, "all directions: {worst:?}");
}

/// Blinn's lobe along the normal: n·h = cos(θ/2), so with u = cos²(θ/2) the albedo is (m + 8)/2 · ∫ from 1/2 to 1 of
/// u^(s/2) (2u − 1) du; s = m in the intended formula and 5 in the printed one. Over all directions the printed one
/// gives (m + 8)/18.
#[test]
fn white_furnace_of_blinn_phong() {
    for m in [0.0, 5.0, 10.0, 100.0] {
        let power = |u: f64, e: f64| scalar::pow(u, e) / e;
        let at = |u: f64, s: f64| 2.0 * power(u, s / 2.0 + 2.0) - power(u, s / 2.0 + 1.0);
        for (shading, s) in [(Shading::BlinnPhong, m), (Shading::BlinnPhongPrinted, 5.0)] {
            let exact = (m + 8.0) / 2.0 * (at(1.0, s) - at(0.5, s));
            let e = albedo(shading, &MaterialSample { shininess: m, ..white() }, 1.0);
            assert!((e / exact - 1.0).abs() < 1e-6, "{}, m {m}: {e}, exactly {exact}", shading.name());
        }
    }
    let ten = MaterialSample { shininess: 10.0, ..white() };
    let all = Furnace::default().hemispherical_albedo(Shading::BlinnPhongPrinted, &ten).x;
    assert!((all - 1.0).abs() < 1e-5, "{all}");
}

/// Without 1/π the diffuse part of the printed Cook-Torrance returns π times the incoming light; a white metal with
/// the article's GGX has no highlight at all, and returns twice the light, because n·l is missing.
#[test]
fn white_furnace_of_what_is_printed() {
    let chalk = MaterialSample { diffuse: WHITE, specular: BLACK, ..white() };
    for n_dot_v in [0.3, 1.0] {
        assert!((albedo(Shading::CookTorrance, &chalk, n_dot_v) - 1.0).abs() < 1e-9);
        assert!((albedo(Shading::CookTorrancePrinted, &chalk, n_dot_v) - PI).abs() < 1e-9);
        let metal = albedo(Shading::GgxPrinted, &white(), n_dot_v);
        assert!((metal - 2.0).abs() < 1e-9, "{metal}");
    }
}

#[test]
fn lambert_reflects_its_colour() {
    for n_dot_v in [0.3, 1.0] {
        let v = viewer(n_dot_v);
        let s = MaterialSample { base_color: Vec3::new(0.37, 0.0, 0.0), ..white() };
        let total = over_hemisphere(12, |l| reflect(Shading::Lambert, &s, &Angles::new(N, v, l))).x;
        assert!((total - 0.37).abs() < 1e-13, "{total}");
    }
}

const PHYSICAL: [Shading; 4] = [Shading::Lambert, Shading::BlinnPhong, Shading::CookTorrance, Shading::Ggx];

/// Returns the largest relative difference of f when viewer and light are swapped.
fn asymmetry(shading: Shading) -> f64 {
    let mut random = Random(7);
    let mut worst = 0.0f64;
    for _ in 0..500 {
        let (s, v, l) = (random.sample(), random.direction(0.05), random.direction(0.05));
        let there = reflect(shading, &s, &Angles::new(N, v, l)).x / l.z;
        let back = reflect(shading, &s, &Angles::new(N, l, v)).x / v.z;
        worst = worst.max((there - back).abs() / there.max(back).max(1e-12));
    }
    worst
}

#[test]
fn physical_models_are_reciprocal() {
    for shading in PHYSICAL {
        assert!(asymmetry(shading) < 1e-12, "{}: {}", shading.name(), asymmetry(shading));
    }
}

#[test]
fn physical_models_stay_within_energy() {
    let split =
        |share: f64| MaterialSample { diffuse: WHITE * share, specular: WHITE * (1.0 - share), ..white() };
    for n_dot_v in N_DOT_V {
        for (i, roughness) in ROUGHNESS.into_iter().enumerate() {
            let slope = [0.05, 0.1, 0.2, 0.35, 0.5, 0.8, 1.2][i];
            let shininess = [0.0, 1.0, 9.0, 30.0, 100.0, 300.0, 1000.0][i];
            for share in [0.0, 0.5] {
                let s = MaterialSample { roughness, slope, shininess, ..split(share) };
                let e = [Shading::Lambert, Shading::CookTorrance, Shading::Ggx]
                    .map(|shading| albedo(shading, &s, n_dot_v));
                assert!(
                    e.iter().all(|e| *e <= 1.0 + 1e-4),
                    "n·v {n_dot_v}, roughness {roughness}, m {slope}: {e:?}"
                );
                // (s + 8)/(8π) is an approximation: 7.5 % too much for s = 9 seen along the normal.
                let blinn = albedo(Shading::BlinnPhong, &s, n_dot_v);
                assert!(blinn <= 1.0755, "n·v {n_dot_v}, s {shininess}: {blinn}");
            }
        }
    }
}

/// glTF weights the diffuse part by 1 − F(v·h), not by the energy of the highlight, so a white dielectric seen at
/// grazing angles returns more than it receives; a metal never does. Stated here so that nobody relies on the
/// opposite.
#[test]
fn a_white_dielectric_of_ggx_exceeds_its_energy_at_grazing_view_only() {
    let dielectric = |roughness| MaterialSample { metallic: 0.0, f0: WHITE * 0.04, roughness, ..white() };
    for roughness in ROUGHNESS {
        for n_dot_v in [0.6, 0.8, 1.0] {
            let e = albedo(Shading::Ggx, &dielectric(roughness), n_dot_v);
            assert!(e < 1.01, "roughness {roughness}, n·v {n_dot_v}: {e}");
        }
        let grazing = albedo(Shading::Ggx, &dielectric(roughness), 0.02);
        assert!((1.0..1.75).contains(&grazing), "roughness {roughness}: {grazing}");
    }
    let total = Furnace::default().hemispherical_albedo(Shading::Ggx, &dielectric(0.35)).x;
    eprintln!("white dielectric of roughness 0.35 under a uniform sky: {total}");
    assert!((1.0..1.04).contains(&total), "{total}");
}

#[test]
fn unphysical_models_earn_their_names() {
    let s = MaterialSample {
        metallic: 0.0,
        f0: WHITE * 0.9,
        diffuse: WHITE * 0.5,
        specular: WHITE * 0.5,
        shininess: 100.0,
        ..white()
    };
    for (_, shading) in Shading::NAMES.iter().copied() {
        if PHYSICAL.contains(&shading) {
            continue;
        }
        let most = N_DOT_V.into_iter().map(|n_dot_v| albedo(shading, &s, n_dot_v)).fold(0.0, f64::max);
        eprintln!("{}: albedo up to {most:.3}, asymmetry {:.3}", shading.name(), asymmetry(shading));
        assert!(most > 1.2, "{} conserves energy: {most}", shading.name());
        // The article's Blinn-Phong violates only energy conservation.
        assert_eq!(asymmetry(shading) > 0.1, shading != Shading::BlinnPhongPrinted, "{}", shading.name());
    }
}

#[test]
fn light_from_behind_gives_nothing() {
    let mut random = Random(3);
    for (_, shading) in Shading::NAMES.iter().copied() {
        let (s, v, l) = (random.sample(), random.direction(0.1), -random.direction(0.0));
        let value = reflect(shading, &s, &Angles::new(N, v, l));
        if shading == Shading::GgxPrinted {
            // F0 ρ/π of the first channel: lit from below, as in its code.
            assert!((value - s.base_color * (s.f0.x / PI)).length() < 1e-15);
        } else {
            assert_eq!(value, BLACK, "{}", shading.name());
        }
    }
}

/// Every corner of the ranges in `f32`: no infinity, no NaN, nothing below zero.
#[test]
fn every_value_is_a_plain_number() {
    let n = Vec3::new(0.0f32, 0.0, 1.0);
    let ends = [0.0f32, 1.0];
    let mut directions: Vec<Vec3<f32>> = Vec::new();
    for tilt in [0.0f32, 1e-20, 1e-7, 1e-4, 0.01, 0.5, 1.0, 1e4, 1e7, 1e20, 1e38] {
        for side in [1.0f32, -1.0] {
            let length = if tilt > 1e18 { tilt } else { (1.0 + tilt * tilt).sqrt() };
            let (sin, cos) = (tilt / length, side / length);
            directions.extend([
                Vec3::new(sin, 0.0, cos),
                Vec3::new(-sin, 0.0, cos),
                Vec3::new(0.0, sin, cos),
            ]);
        }
    }
    for v in &directions {
        for l in &directions {
            let a = Angles::new(n, *v, *l);
            for i in 0..64 {
                let bit = |k: usize| ends[i >> k & 1];
                let s = MaterialSample {
                    base_color: Vec3::splat(1.0),
                    metallic: bit(0),
                    roughness: bit(1),
                    f0: Vec3::splat(bit(2)),
                    f90: 1.0,
                    f82_drop: Vec3::splat((bit(3) - 0.5) * 30.0),
                    diffuse: Vec3::splat(1.0),
                    specular: Vec3::splat(1.0),
                    shininess: bit(4) * 1e5,
                    slope: if bit(5) > 0.0 { 10.0 } else { 1e-9 },
                    compensation: None,
                };
                for (name, shading) in Shading::NAMES.iter().copied() {
                    let value = reflect(shading, &s, &a);
                    assert!(value.is_finite(), "{name}: {value:?} at v {v:?} l {l:?} {s:?}");
                    assert!(
                        value.to_array().iter().all(|c| *c >= 0.0),
                        "{name}: {value:?} at v {v:?} l {l:?} {s:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn light_falloff() {
    assert_eq!([inverse_square(4.0), inverse_square(0.0)], [0.25, 1e12]);
    assert_eq!([range_window(0.0, 3.0), range_window(9.0, 3.0), range_window(100.0, 3.0)], [1.0, 0.0, 0.0]);
    let (inner, outer) = (scalar::cos(0.3), scalar::cos(0.6));
    assert_eq!([spot_cone(1.0, inner, outer), spot_cone(inner, inner, outer)], [1.0; 2]);
    assert_eq!([spot_cone(outer, inner, outer), spot_cone(-1.0, inner, outer)], [0.0; 2]);
    assert!((spot_cone((inner + outer) / 2.0, inner, outer) - 0.25).abs() < 1e-14, "the middle is squared");
    assert_eq!(
        [spot_cone(0.9, 0.8, 0.8), spot_cone(0.7, 0.8, 0.8)],
        [1.0, 0.0],
        "equal cones are a hard edge"
    );
    for i in 0..100 {
        let (near, far) = (f64::from(i) / 100.0, f64::from(i + 1) / 100.0);
        assert!(range_window(near * near, 0.7) >= range_window(far * far, 0.7));
        assert!(spot_cone(near, 0.9, 0.2) <= spot_cone(far, 0.9, 0.2));
    }
}
