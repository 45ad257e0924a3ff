//! Laws of environment light: quantities derived from an environment's picture, compared with their definitions.

use crate::random::Random;
use crate::skies::{self, Texels, direction, equirect, speckled};
use std::f64::consts::{PI, TAU};
use taotie_engine::image::Image;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::shade::environment::{ENVIRONMENT_VERSION, Environment, STUDIO_VERSION, studio};

fn environment(image: &Image) -> Environment {
    Environment::new(image.clone()).expect("a valid environment")
}

/// Returns the position of a direction.
fn uv(d: Vec3<f64>) -> [f64; 2] {
    [scalar::atan2(d.z, d.x) / TAU + 0.5, scalar::acos(d.y.clamp(-1.0, 1.0)) / PI]
}

/// Returns ∫ L (n·l)⁺ dl over all texels.
fn brute_irradiance(image: &Image, n: Vec3<f64>) -> Vec3<f64> {
    let mut sum = Vec3::splat(0.0);
    for (l, light, angle) in skies::texels(image) {
        sum += light * (n.dot(l).max(0.0) * angle);
    }
    sum
}

/// Returns light of the second degree at most, and its irradiance by Ramamoorthi and Hanrahan 2001, eq. 8.
#[test]
fn irradiance_of_light_of_the_second_degree_is_exact() {
    let parts = |n: Vec3<f64>| {
        let quadratic = n.x * n.y * 0.3 - (n.y * n.y - 1.0 / 3.0) * 0.25 + n.x * n.z * 0.2;
        [1.0, 0.4 * n.x - 0.2 * n.y + 0.3 * n.z, quadratic]
    };
    let image = equirect(256, |n| {
        let [constant, linear, quadratic] = parts(n);
        Vec3::new(constant + linear + quadratic, constant - linear, 2.0 * constant + quadratic)
    });
    let environment = environment(&image);
    let mut random = Random(1);
    for _ in 0..100 {
        let n = random.unit();
        let [constant, linear, quadratic] = parts(n);
        let [e0, e1, e2] = [PI * constant, 2.0 * PI / 3.0 * linear, PI / 4.0 * quadratic];
        let truth = Vec3::new(e0 + e1 + e2, e0 - e1, 2.0 * e0 + e2);
        let harmonics = environment.irradiance_harmonics().at(n.to_f32()).to_f64();
        assert!((harmonics - truth).length() < 1e-3, "{n:?}: {harmonics:?} against {truth:?}");
        let whole = environment.irradiance(n.to_f32()).to_f64();
        assert!((whole - truth).length() < 0.01 * truth.length(), "{n:?}: {whole:?} against {truth:?}");
    }
}

/// Where nine coefficients fail: a single bright lamp, on its dark side too.
#[test]
fn irradiance_is_the_integral_over_all_texels() {
    let lamp = Vec3::new(0.6, 0.0, 0.8);
    let image = equirect(128, |n| Vec3::splat(if n.dot(lamp) > 0.97 { 50.0 } else { 0.2 + 0.1 * n.y }));
    let environment = environment(&image);
    let mut random = Random(5);
    for _ in 0..60 {
        let n = random.unit();
        let (truth, found) = (brute_irradiance(&image, n), environment.irradiance(n.to_f32()).to_f64());
        assert!((found - truth).length() < 0.02 * truth.length(), "{n:?}: {found:?} against {truth:?}");
    }
}

#[test]
fn irradiance_is_never_negative() {
    let sun = equirect(64, |n| Vec3::splat(if n.y > 0.99 { 1e4 } else { 0.0 }));
    let environment = environment(&sun);
    let mut random = Random(2);
    for _ in 0..1000 {
        let e = environment.irradiance(random.unit().to_f32());
        assert!(e.x >= 0.0 && e.y >= 0.0 && e.z >= 0.0, "{e:?}");
    }
}

/// Pearson's test of samples against the density, in boxes that are not multiples of the cells.
#[test]
fn samples_fall_as_the_density_says() {
    const BOXES: [usize; 2] = [12, 9];
    const SAMPLES: usize = 200_000;
    for environment in [environment(&speckled(32)), environment(&equirect(8, |_| Vec3::splat(0.0)))] {
        let box_of = |d: Vec3<f64>| {
            let [u, v] = uv(d);
            let at = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
            at(v, BOXES[1]) * BOXES[0] + at(u, BOXES[0])
        };
        let mut expected = vec![0.0; BOXES[0] * BOXES[1]];
        const FINE: usize = 1152;
        for y in 0..FINE / 2 {
            for x in 0..FINE {
                let d = direction((x as f64 + 0.5) / FINE as f64, (y as f64 + 0.5) / (FINE / 2) as f64);
                let angle = skies::solid_angle(FINE, y);
                expected[box_of(d)] += f64::from(environment.pdf(d.to_f32())) * angle;
            }
        }
        let total: f64 = expected.iter().sum();
        assert!((total - 1.0).abs() < 1e-3, "the density integrates to {total}");
        let mut seen = vec![0.0; expected.len()];
        let mut random = Random(3);
        for _ in 0..SAMPLES {
            let sample = environment.sample([random.next() as f32, random.next() as f32]);
            assert!(sample.pdf > 0.0 && (sample.direction.length() - 1.0).abs() < 1e-5);
            assert_eq!(sample.radiance, environment.radiance(sample.direction));
            seen[box_of(sample.direction.to_f64())] += 1.0;
        }
        let chi2: f64 = expected
            .iter()
            .zip(&seen)
            .map(|(e, s): (&f64, &f64)| (e * SAMPLES as f64, s))
            .map(|(e, s)| (e - s) * (e - s) / e)
            .sum();
        // 107 degrees of freedom: above 162 once in 2000 times.
        assert!(chi2 < 162.0, "chi² {chi2}");
    }
}

#[test]
fn the_density_of_a_sample_is_that_of_its_direction() {
    let environment = environment(&speckled(64));
    let mut random = Random(4);
    let mut apart = 0;
    for _ in 0..10_000 {
        let sample = environment.sample([random.next() as f32, random.next() as f32]);
        apart += usize::from(environment.pdf(sample.direction) != sample.pdf);
    }
    // A direction at the very edge of a cell may be rounded into the next.
    assert!(apart < 10, "{apart} of 10000");
}

/// A path tracer's estimate, in which no single sample has much weight.
#[test]
fn a_mean_over_samples_is_the_integral() {
    let environment = environment(&speckled(64));
    let n = Vec3::new(0.3, 0.8, -0.52).normalize();
    let between = equirect(1024, |d| environment.radiance(d.to_f32()).to_f64());
    let truth = brute_irradiance(&between, n);
    const SAMPLES: usize = 1_000_000;
    let mut random = Random(9);
    let mut sum = Vec3::splat(0.0);
    let mut most = 0.0f64;
    for _ in 0..SAMPLES {
        let sample = environment.sample([random.next() as f32, random.next() as f32]);
        let weight = sample.radiance.to_f64() * (1.0 / f64::from(sample.pdf));
        most = most.max(weight.x.max(weight.y).max(weight.z));
        sum += weight * n.dot(sample.direction.to_f64()).max(0.0);
    }
    let mean = sum * (1.0 / SAMPLES as f64);
    assert!((mean - truth).length() < 0.003 * truth.length(), "{mean:?} against {truth:?}");
    // The density is as high as the light can be within a cell, which gives a lone texel's light a factor of four;
    // one channel has three times the mean.
    let all: f64 = skies::texels(&between).map(|(_, l, angle)| (l.x + l.y + l.z) / 3.0 * angle).sum();
    assert!(most < 3.0 * 4.0 * 1.02 * all, "{most} of {all}");
}

#[test]
fn a_picture_of_one_texel_shines_alike_from_everywhere() {
    let environment = environment(&Image::new(1, 1, [0.5, 1.0, 2.0, 1.0]).expect("a size"));
    let mut random = Random(5);
    for _ in 0..100 {
        let d = random.unit().to_f32();
        let [radiance, irradiance] = [environment.radiance(d), environment.irradiance(d) * (1.0 / PI as f32)];
        assert!((radiance - Vec3::new(0.5, 1.0, 2.0)).length() < 1e-3);
        assert!((irradiance - radiance).length() < 4e-3, "{irradiance:?}");
        let harmonics = environment.irradiance_harmonics().at(d) * (1.0 / PI as f32);
        assert!((harmonics - radiance).length() < 1e-3, "{harmonics:?}");
        let pdf = environment.pdf(d);
        assert!((f64::from(pdf) * 4.0 * PI - 1.0).abs() < 1e-6);
    }
}

#[test]
fn broken_texels_are_counted_and_harmless() {
    let mut image = equirect(16, |_| Vec3::splat(1.0));
    image.pixels_mut()[5] = [f32::NAN, f32::INFINITY, -1.0, 0.0];
    image.pixels_mut()[77] = [f32::NEG_INFINITY, 0.0, 0.0, 0.0];
    let environment = environment(&image);
    assert_eq!(environment.repaired_texels(), 2);
    let mut random = Random(6);
    for _ in 0..1000 {
        let d = random.unit().to_f32();
        assert!(environment.radiance(d).is_finite() && environment.irradiance(d).is_finite());
        assert!(environment.pdf(d) > 0.0 && environment.pdf(d).is_finite());
    }
}

/// Lone bright texels, which reveal every flaw of a lobe, at the equator, near a pole and in between.
#[test]
fn rough_mirrors_gather_the_integral_over_all_texels() {
    const ROUGHNESSES: [f64; 8] = [0.25, 0.27, 0.32, 0.4, 0.53, 0.7, 0.93, 1.0];
    let mut image = equirect(512, |n| Vec3::new(0.6 + 0.4 * n.y, 0.5, 0.5 - 0.3 * n.x));
    for (x, y) in [(130, 128), (17, 2), (340, 60), (511, 200)] {
        image.pixels_mut()[y * 512 + x] = [4e4, 3e4, 2e4, 1.0];
    }
    let environment = environment(&image);
    let texels = Texels::new(&image);
    for directions in skies::directions(&environment, 60, &mut Random(8)) {
        let errors = skies::specular_errors(&environment, &texels, &directions, &ROUGHNESSES);
        for (roughness, error) in ROUGHNESSES.iter().zip(errors) {
            assert!(error < 0.01, "roughness {roughness}: {error}");
        }
    }
}

/// Any size: tiny, odd, not twice as wide as high.
#[test]
fn even_light_stays_even_at_every_roughness() {
    for [width, height] in [[1, 1], [3, 7], [514, 257], [600, 900]] {
        let environment = environment(&Image::new(width, height, [0.5, 3.0, 70_000.0, 1.0]).expect("a size"));
        let mut random = Random(9);
        for _ in 0..500 {
            let (d, roughness) = (random.unit().to_f32(), random.next() as f32);
            let found = environment.specular(d, roughness);
            let ratios = [found.x / 0.5, found.y / 3.0, found.z / 70_000.0];
            let even = ratios.iter().all(|ratio| (ratio - 1.0).abs() < 1.1e-3);
            assert!(even, "{width}x{height}, roughness {roughness}: {ratios:?}");
        }
    }
}

#[test]
fn a_smooth_mirror_shows_the_picture_and_roughness_goes_on_from_there() {
    let environment = environment(&speckled(256));
    let mut random = Random(10);
    for _ in 0..60 {
        let d = random.unit().to_f32();
        assert_eq!(environment.specular(d, 0.0), environment.radiance(d));
        let (mut last, mut roughness) = (environment.specular(d, 0.0), 0.0);
        while roughness < 1.0 {
            roughness += 1e-4;
            let next = environment.specular(d, roughness);
            assert!((next - last).length() < 0.02 * (next.length() + last.length()), "{d:?} {roughness}");
            last = next;
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let image = speckled(256);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| environment(&image))
    };
    let [one, three] = [with(1), with(3)];
    let mut random = Random(11);
    for _ in 0..5000 {
        let (d, roughness) = (random.unit().to_f32(), random.next() as f32);
        assert_eq!(one.specular(d, roughness), three.specular(d, roughness));
        assert_eq!(one.irradiance(d), three.irradiance(d));
        assert_eq!(one.pdf(d), three.pdf(d));
    }
}

/// The key of cached environments identifies the studio only by its version.
#[test]
fn the_studio_has_the_bits_of_its_version() {
    let pixels = studio().pixels().as_flattened().to_vec();
    let hash = pixels.iter().fold(0xcbf2_9ce4_8422_2325u64, |hash, v| {
        (hash ^ u64::from(v.to_bits())).wrapping_mul(0x0100_0000_01b3)
    });
    assert_eq!((STUDIO_VERSION, hash), (1, 11007174786164598874), "changed bits need a new STUDIO_VERSION");
}

#[test]
fn the_studio_is_grey_and_as_bright_as_it_says() {
    let image = studio();
    assert!(image.pixels().iter().all(|[r, g, b, a]| r == g && g == b && *r > 0.02 && *a == 1.0));
    let radiance = |n: Vec3<f64>| brute_irradiance(&image, n).x / PI;
    let [front, left, right] = [[0.0, 0.0, 1.0], [-0.6, 0.5, 0.6], [1.0, 0.0, 0.0]];
    let [front, left, right] = [front, left, right].map(|n| radiance(Vec3::from_array(n).normalize()));
    assert!((front - 0.8).abs() < 0.01, "{front}");
    assert!(left > 1.5 * front && right < 0.6 * front, "{left} {right}");
}

/// Cached environments are identified only by their version.
#[test]
fn an_environment_has_the_bits_of_its_version() {
    let bytes = environment(&speckled(64)).to_bytes();
    let hash = bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325u64, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x0100_0000_01b3));
    assert_eq!(
        (ENVIRONMENT_VERSION, hash),
        (3, 237003072150934336),
        "changed bits need a new ENVIRONMENT_VERSION"
    );
    let (made, kept) = (environment(&speckled(64)), Environment::from_bytes(&bytes).expect("they are valid"));
    let mut random = Random(12);
    for _ in 0..1000 {
        let (d, roughness) = (random.unit().to_f32(), random.next() as f32);
        assert_eq!(made.specular(d, roughness), kept.specular(d, roughness));
        assert_eq!((made.radiance(d), made.irradiance(d)), (kept.radiance(d), kept.irradiance(d)));
        assert_eq!(made.pdf(d), kept.pdf(d));
    }
}
