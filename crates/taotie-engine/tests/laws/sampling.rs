//! Randomly sampled directions follow their stated densities.

use crate::random::Random;
use std::f64::consts::{PI, TAU};
use taotie_engine::math::integration::nodes;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::names::Named;
use taotie_engine::shade::furnace::{Furnace, over_hemisphere};
use taotie_engine::shade::microfacets::v_smith_ggx;
use taotie_engine::shade::microfacets::{MIN_ALPHA, d_ggx};
use taotie_engine::shade::sampling::{
    Lobes, cosine_direction, cosine_pdf, ggx_visible_normal, ggx_visible_pdf, mirrored, uniform_direction,
};
use taotie_engine::shade::{Angles, MaterialSample, Shading, reflect};

type V = Vec3<f64>;

const N: V = Vec3::new(0.0, 0.0, 1.0);

fn viewer(n_dot_v: f64) -> V {
    let r = (1.0 - n_dot_v * n_dot_v).sqrt();
    Vec3::new(r * scalar::cos(0.4), r * scalar::sin(0.4), n_dot_v)
}

/// Bins along each of two axes.
const BINS: usize = 16;

/// Samples per histogram.
const SAMPLES: usize = 200_000;

/// Compares a histogram over [0, 1)² of `place(sample)` with the integral of `density` over each bin. Returns how
/// many standard deviations χ² is above its mean; bins with fewer than ten expected samples are merged.
fn chi_squared(mut sample: impl FnMut([f64; 2]) -> [f64; 2], density: impl Fn([f64; 2]) -> f64) -> f64 {
    let mut counts = [[0.0; BINS]; BINS];
    let mut random = Random(7);
    for _ in 0..SAMPLES {
        let place = sample([random.next(), random.next()]);
        let [i, j] = place.map(|p| ((p * BINS as f64) as usize).min(BINS - 1));
        counts[i][j] += 1.0;
    }
    let rule = nodes(24, &[0.0, 1.0]);
    let (mut chi, mut cells, mut rest) = (0.0, 0.0, [0.0; 2]);
    for (i, row) in counts.iter().enumerate() {
        for (j, count) in row.iter().enumerate() {
            let mut mass = 0.0;
            for (x, wx) in &rule {
                for (y, wy) in &rule {
                    mass += wx * wy * density([(i as f64 + x) / BINS as f64, (j as f64 + y) / BINS as f64]);
                }
            }
            let expected = mass / (BINS * BINS) as f64 * SAMPLES as f64;
            if expected < 10.0 {
                rest = [rest[0] + expected, rest[1] + count];
                continue;
            }
            chi += (count - expected) * (count - expected) / expected;
            cells += 1.0;
        }
    }
    let slack = rest[0] + 5.0 * (rest[0] + 1.0).sqrt();
    assert!(rest[1] <= slack, "{} samples in bins where {} belong", rest[1], rest[0]);
    assert!(cells >= 8.0, "only {cells} bins");
    (chi - cells) / (2.0f64 * cells).sqrt()
}

fn turn_of(v: V) -> f64 {
    let turn = scalar::atan2(v.y, v.x) / TAU;
    turn - turn.floor()
}

/// Maps a facet to [0, 1)² so that those of a GGX surface seen from above are uniform.
fn place_of_facet(m: V, [ax, ay]: [f64; 2]) -> [f64; 2] {
    let s = Vec3::new(m.x / ax, m.y / ay, m.z);
    let tan2 = (s.x * s.x + s.y * s.y) / (s.z * s.z);
    [tan2 / (tan2 + 1.0), turn_of(s)]
}

/// Returns the facet at a position.
fn facet_at([t, turn]: [f64; 2], [ax, ay]: [f64; 2]) -> V {
    let tan = (t / (1.0 - t)).sqrt();
    Vec3::new(ax * tan * scalar::cos(TAU * turn), ay * tan * scalar::sin(TAU * turn), 1.0).normalize()
}

/// Returns the density: D(m) (n·m) dm = dt dturn, so this is D_v(m) dm per unit of position: G₁(v) (v·m)⁺ / (n·v
/// n·m).
fn visible_density(v: V, place: [f64; 2], alpha: [f64; 2]) -> f64 {
    let m = facet_at(place, alpha);
    let stretched = (v.x * alpha[0]) * (v.x * alpha[0]) + (v.y * alpha[1]) * (v.y * alpha[1]);
    let g1 = 2.0 / (1.0 + (1.0 + stretched / (v.z * v.z)).sqrt());
    g1 * v.dot(m).max(0.0) / (v.z * m.z)
}

#[test]
fn directions_follow_their_densities() {
    let mut worst = 0.0f64;
    let mut check = |what: String, deviations: f64| {
        worst = worst.max(deviations);
        assert!(deviations < 4.5, "{what}: {deviations} standard deviations");
    };
    let place = |d: V| [d.z, turn_of(d)];
    check("cosine".into(), chi_squared(|u| place(cosine_direction(u)), |[z, _]| TAU * cosine_pdf(z)));
    check("uniform".into(), chi_squared(|u| place(uniform_direction(u)), |_| 1.0));
    for alpha in [[1.0, 1.0], [0.5, 0.5], [0.1, 0.1], [MIN_ALPHA, MIN_ALPHA], [0.3, 0.9], [0.8, 0.02]] {
        for n_dot_v in [1.0, 0.7, 0.3, 0.05, 1e-3] {
            let v = viewer(n_dot_v);
            let facet = |u| place_of_facet(ggx_visible_normal(v, alpha, u), alpha);
            let deviations = chi_squared(facet, |at| visible_density(v, at, alpha));
            check(format!("facets of α {alpha:?} seen at {n_dot_v}"), deviations);
        }
    }
    eprintln!("χ² at most {worst:.2} standard deviations above its mean");
}

#[test]
fn a_wrong_density_is_noticed() {
    let place = |d: V| [d.z, turn_of(d)];
    assert!(chi_squared(|u| place(cosine_direction(u)), |_| 1.0) > 100.0);
    let wider = chi_squared(
        |u| place_of_facet(ggx_visible_normal(viewer(0.5), [0.5; 2], u), [0.52; 2]),
        |at| visible_density(viewer(0.5), at, [0.52; 2]),
    );
    assert!(wider > 20.0, "{wider}");
}

#[test]
fn densities_integrate_to_one() {
    let total = |f: &dyn Fn(V) -> f64| over_hemisphere(24, |d| Vec3::splat(f(d))).x;
    assert!((total(&|l| cosine_pdf(l.z)) - 1.0).abs() < 1e-9);
    let mirroring = |v: V, alpha: [f64; 2], counts: &dyn Fn(V) -> bool| {
        total(&|h| match v.dot(h) > 0.0 && counts(mirrored(v, h)) {
            true => ggx_visible_pdf(v, mirrored(v, h), alpha) * 4.0 * v.dot(h),
            false => 0.0,
        })
    };
    for alpha in [[0.02; 2], [0.1; 2], [0.3; 2], [1.0; 2], [0.2, 0.7]] {
        for n_dot_v in [1.0, 0.6, 0.2, 0.05] {
            let sum = mirroring(viewer(n_dot_v), alpha, &|_| true);
            assert!((sum - 1.0).abs() < 2e-3, "α {alpha:?}, n·v {n_dot_v}: {sum}");
        }
    }
    // Mirrored directions reach below the horizon, the others do not.
    let v = viewer(0.8);
    let lobes = Lobes { alpha: [0.2; 2], glossy: 0.5, even: 0.2 };
    let above = total(&|l| lobes.pdf(v, l));
    let below = mirroring(v, lobes.alpha, &|l| l.z <= 0.0);
    assert!(
        (above + lobes.glossy * below - 1.0).abs() < 1e-3,
        "{above} above, {below} of the mirrored below"
    );
}

/// A mirror-white metal.
fn white(roughness: f64) -> MaterialSample<f64> {
    let (white, black) = (Vec3::splat(1.0), Vec3::splat(0.0));
    MaterialSample {
        base_color: white,
        metallic: 1.0,
        roughness,
        f0: white,
        f90: 1.0,
        f82_drop: black,
        diffuse: black,
        specular: white,
        shininess: 20.0,
        slope: 0.3,
        compensation: None,
    }
}

#[test]
fn weights_of_visible_normals_are_shadowing_alone() {
    let mut random = Random(3);
    let mut seen = 0;
    for roughness in [0.1f64, 0.4, 0.8, 1.0] {
        let (s, alpha) = (white(roughness), roughness * roughness);
        for _ in 0..2000 {
            let v = viewer(0.01 + 0.99 * random.next());
            let m = ggx_visible_normal(v, [alpha; 2], [random.next(), random.next()]);
            let l = mirrored(v, m);
            if l.z <= 1e-6 {
                continue;
            }
            let a = Angles::new(N, v, l);
            let weight = reflect(Shading::Ggx, &s, &a).x / ggx_visible_pdf(v, l, [alpha; 2]);
            let g2 = v_smith_ggx(l.z, v.z, alpha) * 4.0 * l.z * v.z;
            // Light along the normal casts no shadow.
            let g1 = v_smith_ggx(1.0, v.z, alpha) * 4.0 * v.z;
            assert!((weight - g2 / g1).abs() < 1e-9, "{weight} {}", g2 / g1);
            assert!((0.0..=1.0 + 1e-12).contains(&weight));
            let direct = d_ggx(m.z, 1.0 - m.z * m.z, alpha) * g1 / (4.0 * v.z);
            assert!((ggx_visible_pdf(v, l, [alpha; 2]) / direct - 1.0).abs() < 1e-6);
            seen += 1;
        }
    }
    assert!(seen > 6000, "{seen}");
}

/// Returns the mean and standard error of the albedo by sampling.
fn sampled_albedo(shading: Shading, s: &MaterialSample<f64>, n_dot_v: f64, samples: usize) -> [f64; 2] {
    let v = viewer(n_dot_v);
    let lobes = Lobes::of(shading, s, n_dot_v);
    let mut random = Random(11);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..samples {
        let l = lobes.direction(v, [random.next(), random.next()]);
        if l.z > 0.0 {
            let a = Angles::new(N, v, l);
            let weight = reflect(shading, s, &a).x / lobes.pdf(v, l);
            assert!(weight.is_finite() && weight >= 0.0, "{shading:?}: {weight}");
            sum += weight;
            squares += weight * weight;
        }
    }
    let n = samples as f64;
    [sum / n, ((squares / n - (sum / n) * (sum / n)).max(0.0) / n).sqrt()]
}

/// Returns `true` if the highlight has wider tails than the density.
fn skirted(shading: Shading) -> bool {
    matches!(shading, Shading::CookTorrancePrinted | Shading::GgxPrinted)
}

#[test]
fn the_furnace_by_sampling_is_that_by_quadrature() {
    let mut random = Random(5);
    let furnace = Furnace::default();
    let mut worst = 0.0f64;
    for (name, shading) in Shading::NAMES {
        let mut spread = 0.0f64;
        for n_dot_v in [1.0, 0.5, 0.1] {
            let mut color = || Vec3::new(random.next(), random.next(), random.next());
            let (base_color, f0, diffuse, specular) = (color(), color(), color(), color());
            let s = MaterialSample {
                base_color,
                f0,
                diffuse,
                specular,
                metallic: random.next(),
                roughness: 0.2 + 0.8 * random.next(),
                f90: 1.0,
                f82_drop: Vec3::splat(0.0),
                shininess: 80.0 * random.next(),
                slope: 0.1 + 0.5 * random.next(),
                compensation: None,
            };
            let [mean, error] = sampled_albedo(*shading, &s, n_dot_v, 40_000);
            let exact = furnace.directional_albedo(*shading, &s, n_dot_v).x;
            let deviations = (mean - exact).abs() / (error + 2e-5 * exact);
            worst = worst.max(deviations);
            spread = spread.max(error / exact * 200.0);
            assert!(deviations < 4.0, "{name} at {n_dot_v}: {mean} ± {error}, exactly {exact}");
        }
        eprintln!("{name}: a sample's standard deviation is at most {spread:.2} of its mean");
        assert!(spread < if skirted(*shading) { 6.0 } else { 1.0 }, "{name}: {spread}");
    }
    eprintln!("off by at most {worst:.2} standard errors");
}

#[test]
fn lobes_reach_wherever_light_is_reflected() {
    let mut random = Random(9);
    for (name, shading) in Shading::NAMES {
        for metallic in [0.0, 1.0] {
            let s = MaterialSample { metallic, ..white(0.3) };
            for _ in 0..500 {
                let v = viewer(0.001 + 0.999 * random.next());
                let z = random.next();
                let (r, phi) = ((1.0 - z * z).sqrt(), 2.0 * PI * random.next());
                let l = Vec3::new(r * scalar::cos(phi), r * scalar::sin(phi), z);
                let a = Angles::new(N, v, l);
                let pdf = Lobes::of(*shading, &s, v.z).pdf(v, l);
                let value = reflect(*shading, &s, &a).x;
                assert!(pdf > 0.0, "{name}: {value} at density {pdf}");
                assert!(value / pdf < 200.0 || skirted(*shading), "{name}: {value} at density {pdf}");
            }
        }
    }
}
