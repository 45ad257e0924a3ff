//! Errors of the estimators, and how well their uncertainty describes them, on photographs with known normals.

use crate::studio::{Finish, Photographs, Shooting, photograph, relief};
use std::path::{Path, PathBuf};
use taotie_engine::compare::{angle_deg, angular_error};
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::{Progress, Warnings};
use taotie_photometric::{Coverage, Estimate, Estimator, Light, PhotographSet, Reading, Samples, Transfer};

/// Reads photographs and estimates their normals.
pub fn estimate(photographs: &Photographs) -> Estimate {
    let mut warnings = Warnings::default();
    let set = PhotographSet::open(&photographs.lp, &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{:?}", warnings.list());
    let reading = Reading { mask: None, transfer: Transfer::Auto, flat: None, limits: Default::default() };
    let samples = Samples::read(&set, &reading, Progress::SILENT).unwrap();
    let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
    estimate.note_doubts(&samples, &mut warnings);
    assert!(warnings.is_empty(), "{:?}", warnings.list());
    estimate
}

/// Errors of a set in degrees, and the coverage of its uncertainty.
#[derive(Debug, Clone, Copy)]
struct Accuracy {
    least_squares: f64,
    robust: f64,
    direct: f64,
    best: f64,
    sigma: f64,
    coverage: Coverage,
}

fn accuracy(photographs: &Photographs) -> Accuracy {
    let estimate = estimate(photographs);
    let shifts = estimate.lights.iter().filter_map(|light| light.shift);
    assert!(shifts.clone().all(|shift| !shift.is_moved()), "{:?}", shifts.collect::<Vec<_>>());
    let mean = |estimator| {
        angular_error(&estimate.normals(estimator), &photographs.truth).unwrap().summary().unwrap().mean
    };
    Accuracy {
        least_squares: mean(Estimator::LeastSquares),
        robust: mean(Estimator::Robust),
        direct: mean(Estimator::Direct),
        best: mean(Estimator::Best),
        sigma: estimate.mean(|pixel| pixel.sigma_deg),
        coverage: estimate.coverage(&photographs.truth).unwrap(),
    }
}

/// Measures a set and prints a line of the table in docs/photometric.md.
fn measured(name: &str, mesh: Mesh, finish: &Finish, shooting: Shooting) -> Accuracy {
    let found = accuracy(&photograph(mesh, finish, shooting));
    let Accuracy { least_squares, robust, direct, best, sigma, coverage: Coverage { major, minor, radius } } =
        found;
    let [a, b, c, d, e] = [major[0], major[1], minor[0], minor[1], radius].map(|v| 100.0 * v);
    println!(
        "| {name} | {least_squares:.2}° | {robust:.2}° | {direct:.2}° | {best:.2}° | {sigma:.2}° | {a:.0}, {b:.0} % | \
         {c:.0}, {d:.0} % | {e:.0} % |"
    );
    found
}

/// Asserts that σ describes the errors: in each set to `each`, and in all together to `mean`, as fractions within one
/// and two standard deviations.
fn assert_calibrated(found: &[Accuracy], each: [f64; 2], mean: [f64; 2]) {
    let fractions = |k: usize| {
        found.iter().map(move |Accuracy { coverage, .. }| 0.5 * (coverage.major[k] + coverage.minor[k]))
    };
    for (k, nominal) in [0.683, 0.954].into_iter().enumerate() {
        let all = fractions(k).sum::<f64>() / found.len().max(1) as f64;
        assert!(found.is_empty() || (all - nominal).abs() < mean[k], "{k}: mean {all}");
        for (fraction, accuracy) in fractions(k).zip(found) {
            assert!((fraction - nominal).abs() < each[k], "{k}: {accuracy:?}");
        }
    }
}

#[test]
fn shadows_and_highlights_cost_the_robust_estimate_at_most_half_of_least_squares() {
    let deep = || relief(1.6);
    let eight = Shooting { bits: 8, ..Shooting::default() };
    let found = [
        measured("relief, matt", deep(), &Finish::matt(0.6), Shooting::default()),
        measured("relief, matt, 8 bits", deep(), &Finish::matt(0.6), eight),
        measured("relief, satin", deep(), &Finish::satin(0.5, 0.45), Shooting::default()),
        measured("relief, glossy", deep(), &Finish::satin(0.4, 0.25), Shooting::default()),
        measured("gentle relief, satin", relief(0.35), &Finish::satin(0.5, 0.45), Shooting::default()),
    ];
    for accuracy in &found {
        assert!(accuracy.best < 0.5 * accuracy.least_squares, "{accuracy:?}");
    }
    // The fit of the pixel program explains highlights, and costs matt surfaces nothing.
    for (i, accuracy) in found.iter().enumerate() {
        let most = if i < 2 { 1.02 } else { 0.75 };
        assert!(accuracy.best < most * accuracy.direct, "{accuracy:?}");
    }
    assert_calibrated(&found, [0.22, 0.06], [0.13, 0.05]);
}

#[test]
fn nothing_is_removed_from_photographs_without_indirect_light() {
    let shooting = Shooting { bounces: 0, noise: 0.03, ..Shooting::default() };
    let found = measured("relief, matt, direct light, noisy", relief(1.6), &Finish::matt(0.6), shooting);
    assert!(found.direct < 1.001 * found.robust && found.best < found.robust, "{found:?}");
}

#[test]
fn highlights_show_roughness_and_f0_and_matt_surfaces_have_none() {
    let shooting = Shooting { side: 64, ..Shooting::default() };
    for (albedo, roughness) in [(0.5, 0.45), (0.4, 0.25)] {
        let estimate = estimate(&photograph(relief(1.2), &Finish::satin(albedo, roughness), shooting));
        let [region] = estimate.regions.as_slice() else { panic!("{:?}", estimate.regions) };
        let finish = region.finish.unwrap();
        assert!((finish.roughness - f64::from(roughness)).abs() < 0.02, "{finish:?}");
        // F0 and albedo are known up to the same factor.
        let f0 = finish.f0 / estimate.albedo * f64::from(albedo);
        assert!((f0 / 0.04 - 1.0).abs() < 0.2, "{finish:?} {}", estimate.albedo);
        assert_eq!(region.pixels, estimate.pixels.len());
    }
    let estimate = estimate(&photograph(relief(1.2), &Finish::matt(0.5), shooting));
    assert!(estimate.regions.iter().all(|region| region.finish.is_none()), "{:?}", estimate.regions);
    assert!(estimate.roughness_codes().iter().all(|code| [0, 255].contains(code)));
}

#[test]
fn without_shadows_and_highlights_the_estimate_is_as_good_as_least_squares() {
    let steep = Shooting { lowest_deg: 45.0, noise: 0.01, ..Shooting::default() };
    let found = measured("gentle relief, matt, noisy", relief(0.35), &Finish::matt(0.6), steep);
    assert!(found.best < 1.02 * found.least_squares, "{found:?}");
    assert_calibrated(&[found], [0.2, 0.05], [0.2, 0.05]);
}

/// The folder of models by others, which may not exist.
pub fn data_folder() -> PathBuf {
    std::env::var_os("TAOTIE_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), Into::into)
}

#[test]
#[ignore = "traces 720 pictures, which takes minutes without optimisation"]
fn shared_statues_are_measured_if_present() {
    let data = data_folder();
    let models = [
        ("nefertiti", "odedstein-meshes/nefertiti/nefertiti-lowres.obj"),
        ("koala", "odedstein-meshes/koala/koala_low_resolution.obj"),
        ("gutenberg", "threedscans-keijiro/Gutenberg/Gutenberg.obj"),
        ("column", "threedscans-keijiro/Column03/Column03.obj"),
        ("dechalon", "threedscans-keijiro/DeChalon/DeChalon.obj"),
    ];
    let mut found = Vec::new();
    for (name, file) in models {
        let path = data.join(file);
        if !path.is_file() {
            println!("skipped: {} is missing", path.display());
            continue;
        }
        let model = taotie_io::load_model(&path).unwrap();
        let mesh = || model.scene.meshes()[0].clone();
        let shooting = Shooting { side: 128, ..Shooting::default() };
        found.push(measured(&format!("{name}, matt"), mesh(), &Finish::matt(0.6), shooting));
        found.push(measured(&format!("{name}, satin"), mesh(), &Finish::satin(0.5, 0.45), shooting));
    }
    for accuracy in &found {
        assert!(accuracy.best < 0.5 * accuracy.least_squares, "{accuracy:?}");
        assert!(accuracy.best < 1.02 * accuracy.direct, "{accuracy:?}");
    }
    assert_calibrated(&found, [0.22, 0.06], [0.13, 0.05]);
}

/// The colour of a pixel of the drawn waves, which varies with its number; the mean of the channels is 1.
fn tint(i: usize) -> [f64; 3] {
    let share = (i % 31) as f64 / 30.0;
    [1.0 + 0.6 * share, 1.0 - 0.2 * share, 1.0 - 0.4 * share]
}

/// Returns drawn photographs of waves with Blinn and Phong's highlight, which is white, their lights and the normals.
fn drawn(side: u32) -> (Vec<Bitmap>, Vec<Light>, Vec<Vec3<f64>>) {
    let normal = |i: u32| {
        let [x, y] = [i % side, side - 1 - i / side].map(f64::from);
        let slope = Vec3::new(
            -0.43 * scalar::cos(x / 14.0) * scalar::cos(y / 11.0),
            0.55 * scalar::sin(x / 14.0) * scalar::sin(y / 11.0),
            1.0,
        );
        slope.normalize_or(slope)
    };
    let normals: Vec<Vec3<f64>> = (0..side * side).map(normal).collect();
    let light = |k: u32| {
        let [azimuth, elevation] = [15.0 * f64::from(k) + 6.0, [30.0, 50.0, 65.0][k as usize % 3]];
        let [a, e] = [azimuth, elevation].map(f64::to_radians);
        [scalar::cos(a) * scalar::cos(e), scalar::sin(a) * scalar::cos(e), scalar::sin(e)]
    };
    let lights: Vec<Light> = (0..24).map(|k| Light::towards(light(k)).unwrap()).collect();
    let mut noise = 1_u64;
    let mut codes = |i: usize, n: &Vec3<f64>, l: Vec3<f64>| {
        let half = (l + Vec3::new(0.0, 0.0, 1.0)).normalize_or(l);
        let cosine = n.dot(l).max(0.0);
        let highlight = if cosine > 0.0 { 0.35 * scalar::pow(n.dot(half).max(0.0), 40.0) } else { 0.0 };
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let grain = ((noise >> 40) as f64 / (1_u64 << 24) as f64 - 0.5) * 0.004;
        let code = |tint: f64| {
            ((0.9 * (0.45 * tint * cosine + highlight) + grain).clamp(0.0, 1.0) * 65_535.0) as u16
        };
        let [red, green, blue] = tint(i).map(code);
        [red, green, blue, u16::MAX]
    };
    let mut photograph = |light: &Light| {
        let texels = normals.iter().enumerate().map(|(i, n)| codes(i, n, light.direction));
        Bitmap::new(side, side, 3, Texels::U16(texels.collect())).unwrap()
    };
    (lights.iter().map(&mut photograph).collect(), lights, normals)
}

#[test]
fn no_pixel_is_far_off_among_good_neighbours() {
    let (photographs, lights, normals) = drawn(96);
    let samples = Samples::of(photographs, &lights, None, Transfer::Auto).unwrap();
    let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
    let errors: Vec<f64> =
        estimate.best.iter().zip(&normals).map(|(best, n)| angle_deg(best.unwrap().normal, *n)).collect();
    let most = errors.iter().fold(0.0, |most: f64, error| most.max(*error));
    assert!(most < 3.0, "{most}, {} above 3°", errors.iter().filter(|error| **error > 3.0).count());
    // Colours are those of the surface, in spite of white highlights.
    let albedos = estimate.albedos();
    let off = |(i, pixel): (usize, &[f32; 4])| {
        let mean = f64::from(pixel[0] + pixel[1] + pixel[2]) / 3.0;
        (0..3).map(|c| (f64::from(pixel[c]) / mean - tint(i)[c]).abs()).fold(0.0, f64::max)
    };
    let mut offs: Vec<f64> = albedos.pixels().iter().enumerate().map(off).collect();
    offs.sort_unstable_by(f64::total_cmp);
    let [median, worst] = [0.5, 0.99].map(|q| offs[(q * offs.len() as f64) as usize]);
    println!("colours: {median:.4} {worst:.4}");
    assert!(estimate.has_color() && median < 0.002 && worst < 0.01, "{median} {worst}");
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let photographs = photograph(
        relief(1.0),
        &Finish::satin(0.5, 0.4),
        Shooting { side: 48, lights: 16, ..Shooting::default() },
    );
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| estimate(&photographs))
    };
    let (one, two) = (with(1), with(2));
    assert_eq!(one.best, two.best);
    assert_eq!(one.lights, two.lights);
    assert_eq!((&one.regions, &one.finishes), (&two.regions, &two.finishes));
    assert_eq!((one.albedo.to_bits(), one.shadows), (two.albedo.to_bits(), two.shadows));
    let reliefs = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| one.relief(Progress::SILENT)).unwrap()
    });
    assert_eq!(reliefs[0].heights, reliefs[1].heights);
    assert_eq!(reliefs[0].continues, reliefs[1].continues);
}
