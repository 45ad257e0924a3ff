//! Environments by others: their prefiltered levels compared with integrals over all of their texels, and with the
//! results published by Filament's `cmgen`.

use crate::common::absent;
use crate::files::{data_files, files_below};
use crate::ktx;
use crate::random::Random;
use crate::skies;
use crate::skies::Texels;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use taotie_engine::image::Image;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::shade::environment::Environment;

/// Roughnesses of levels and between them.
const ROUGHNESSES: [f64; 9] = [0.2, 0.204, 0.21, 0.25, 0.303, 0.4, 0.56, 0.78, 1.0];

fn read(path: &Path) -> Image {
    let bitmap = taotie_io::read_bitmap(path).expect("it is readable");
    let mut image = Image::new(bitmap.width(), bitmap.height(), [0.0; 4]).expect("a size");
    image.pixels_mut().iter_mut().enumerate().for_each(|(i, pixel)| *pixel = bitmap.stored(i));
    image
}

/// `TAOTIE_DIRECTIONS` sets the number of directions.
#[test]
fn levels_are_integrals_over_all_texels() {
    let count = std::env::var("TAOTIE_DIRECTIONS").map_or(24, |n| n.parse().expect("a number"));
    for path in data_files("environments", &["hdr", "exr"]) {
        let image = read(&path);
        let environment = Environment::new(image.clone()).expect("it is an environment");
        eprintln!("{}:", path.display());
        let texels = Texels::new(&image);
        for directions in skies::directions(&environment, count, &mut Random(12)) {
            let errors = skies::specular_errors(&environment, &texels, &directions, &ROUGHNESSES);
            for (roughness, error) in ROUGHNESSES.iter().zip(&errors) {
                eprintln!("  roughness {roughness}: {:.2} %", error * 100.0);
                assert!(*error < 0.01, "{}: roughness {roughness}: {error}", path.display());
            }
        }
    }
}

/// Returns the environments with `cmgen` results in a folder of the same name: the environment, and that folder.
fn published() -> Vec<(Environment, PathBuf)> {
    let of = |path: PathBuf| {
        let name = path.file_name()?.to_string_lossy().into_owned();
        let siblings = std::fs::read_dir(path.parent()?).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
        let results = siblings
            .filter(|f| f.is_dir())
            .find(|f| f.file_name().is_some_and(|folder| name.starts_with(&*folder.to_string_lossy())))?;
        Some((Environment::new(read(&path)).expect("it is an environment"), results))
    };
    let found: Vec<_> = data_files("environments", &["hdr"]).into_iter().filter_map(of).collect();
    if found.is_empty() {
        absent("no environment has cmgen results in a folder of the same name");
    }
    found
}

/// Converts one of their directions to our space: their +z is our +x.
fn ours(d: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(d.z, d.y, -d.x)
}

/// `cmgen`'s "pre-scaled base" is irradiance over π as a polynomial 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y², with
/// each degree l damped by sinc⁴(πl/w) against ringing. The w that damps degree 1 as found must damp degree 2.
#[test]
fn irradiance_is_what_another_program_published() {
    for (environment, folder) in published() {
        let text = std::fs::read_to_string(folder.join("sh.txt")).expect("its harmonics");
        let number = |line: &str| line.trim_start_matches('(').split(',').next()?.trim().parse::<f64>().ok();
        let theirs: Vec<f64> = text.lines().filter_map(number).collect();
        let harmonics = environment.irradiance_harmonics();
        let mut products = [[0.0; 2]; 9];
        let grid = skies::equirect(256, |_| Vec3::splat(0.0));
        for (d, _, angle) in skies::texels(&grid) {
            let Vec3 { x, y, z } = d;
            let polynomials = [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y];
            let e = f64::from(harmonics.at(ours(d).to_f32()).x) / PI;
            for (product, p) in products.iter_mut().zip(polynomials) {
                product[0] += e * p * angle;
                product[1] += p * p * angle;
            }
        }
        let ratios: Vec<f64> = products.iter().zip(&theirs).map(|([e, p], c)| c / (e / p)).collect();
        eprintln!("{}: theirs / ours {ratios:.4?}", folder.display());
        assert!((ratios[0] - 1.0).abs() < 1e-3);
        let linear = (ratios[1] + ratios[2] + ratios[3]) / 3.0;
        let damped = |l: f64, w: f64| scalar::pow(scalar::sin(PI * l / w) / (PI * l / w), 4.0);
        let widths = (20..4000).map(|k| f64::from(k) / 100.0);
        let off = |w: &f64| (damped(1.0, *w) - linear).abs();
        let w = widths.min_by(|a, b| off(a).total_cmp(&off(b))).expect("widths");
        for (i, ratio) in ratios.iter().enumerate().skip(1) {
            let expected = damped(if i < 4 { 1.0 } else { 2.0 }, w);
            // The last coefficient of the known one is a hundredth of the first.
            assert!((ratio - expected).abs() < 5e-3, "{i}: {ratio} {expected}");
        }
    }
}

/// Level n of 4 has roughness 1 − √(1 − n/4). They are sums over 1024 samples of the original picture, while ours is
/// a copy at cube-map resolution, so they agree only to a few percent; all other levels are farther off than the
/// right one.
#[test]
fn levels_are_what_another_program_published() {
    for (environment, folder) in published() {
        let files = files_below(&folder, &["ktx"]);
        assert!(!files.is_empty(), "{} holds no level", folder.display());
        for path in files {
            let cubes = ktx::cubes(&std::fs::read(&path).expect("it is readable"));
            for (n, cube) in cubes.iter().enumerate() {
                let roughness = 1.0 - (1.0 - n as f64 / (cubes.len() - 1) as f64).sqrt();
                let at = |roughness: f64| difference(&environment, cube, roughness.clamp(0.0, 1.0));
                let (rms, mean) = at(roughness);
                eprintln!("level {n}, roughness {roughness:.3}: rms {rms:.4}, mean {mean:.4}");
                assert!(rms < 0.08, "{}: level {n}: {rms}", path.display());
                let [smoother, rougher] = [roughness - 0.03, roughness + 0.03].map(|r| at(r).0);
                assert!(n == 0 || smoother > rms, "level {n}: {smoother} {rms}");
                assert!(n == 0 || n + 1 == cubes.len() || rougher > rms, "level {n}: {rougher} {rms}");
            }
        }
    }
}

/// Returns the root mean square difference of red, ours minus theirs, relative to theirs, and the mean difference.
fn difference(environment: &Environment, cube: &ktx::Cube, roughness: f64) -> (f64, f64) {
    let (mut square, mut light, mut sum, mut total) = (0.0, 0.0, 0.0, 0.0);
    for (i, theirs) in cube.texels.iter().enumerate() {
        let (d, angle) = ktx::direction(cube.side, i);
        let found = f64::from(environment.specular(ours(d).to_f32(), roughness as f32).x);
        square += (found - theirs.x) * (found - theirs.x) * angle;
        light += theirs.x * theirs.x * angle;
        sum += (found - theirs.x) * angle;
        total += theirs.x * angle;
    }
    ((square / light).sqrt(), sum / total)
}
