//! Lists of lights that do not belong to the photographs are noticed, and those that do are not.

use crate::studio::{Finish, Photographs, Shooting, photograph, relief};
use std::path::Path;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::{Progress, Warnings};
use taotie_photometric::{Estimate, Estimator, Light, PhotographSet, Reading, Samples, Transfer};

fn estimate(lp: &Path, transfer: Transfer) -> (Estimate, String) {
    let mut warnings = Warnings::default();
    let set = PhotographSet::open(lp, &mut warnings).unwrap();
    let reading = Reading { mask: None, transfer, flat: None, limits: Default::default() };
    let samples = Samples::read(&set, &reading, Progress::SILENT).unwrap();
    let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
    estimate.note_doubts(&samples, &mut warnings);
    let words = warnings.list().into_iter().map(|warning| warning.what).collect::<Vec<_>>();
    (estimate, words.join("\n"))
}

/// Writes the list of lights with each changed; `change` has the number of a light and all of them.
fn with_lights(
    photographs: &Photographs,
    change: impl Fn(usize, &[[f64; 3]]) -> [f64; 3],
) -> std::path::PathBuf {
    let text = std::fs::read_to_string(&photographs.lp).unwrap();
    let lines: Vec<&str> = text.lines().skip(1).collect();
    let numbers = |line: &&str| -> [f64; 3] {
        let words: Vec<f64> = line.rsplit(' ').take(3).map(|word| word.parse().unwrap()).collect();
        [words[2], words[1], words[0]]
    };
    let lights: Vec<[f64; 3]> = lines.iter().map(numbers).collect();
    let line = |k: usize| {
        let [x, y, z] = change(k, &lights);
        format!("photo {:03}.png {x} {y} {z}\n", k + 1)
    };
    let changed: String = (0..lights.len()).map(line).collect();
    let path = photographs.lp.with_file_name("changed.lp");
    std::fs::write(&path, changed).unwrap();
    path
}

#[test]
fn wrong_lights_are_noticed() {
    let shooting = Shooting { side: 64, lights: 24, ..Shooting::default() };
    let satin = Finish::satin(0.5, 0.45);
    for (depth, finish) in [(0.35, &Finish::matt(0.6)), (1.2, &Finish::matt(0.6)), (1.2, &satin)] {
        let photographs = photograph(relief(depth), finish, shooting);
        let (found, words) = estimate(&photographs.lp, Transfer::Auto);
        assert!(words.is_empty(), "{depth}: {words}");
        println!("{depth}: {:?}", found.curl());
        let flipped = with_lights(&photographs, |k, lights| [lights[k][0], -lights[k][1], lights[k][2]]);
        let (found, words) = estimate(&flipped, Transfer::Auto);
        println!("{depth} flipped: {:?}", found.curl());
        assert!(words.starts_with("the lights' y seems to point down"), "{depth}: {words}");
        let reversed = with_lights(&photographs, |k, lights| lights[lights.len() - 1 - k]);
        let (_, words) = estimate(&reversed, Transfer::Auto);
        assert!(words.contains("check the order of the lights"), "{depth}: {words}");
        assert!(!words.contains("--encoding"), "{depth}: {words}");
    }
}

#[test]
fn an_exponent_of_an_encoding_is_noticed_as_such() {
    let shooting = Shooting { side: 64, lights: 24, ..Shooting::default() };
    let photographs = photograph(relief(0.35), &Finish::matt(0.6), shooting);
    let (_, words) = estimate(&photographs.lp, Transfer::Srgb);
    assert!(words.contains("see --encoding") && !words.contains("check the order"), "{words}");
}

#[test]
fn few_photographs_of_a_highlight_keep_the_robust_normals() {
    let shooting = Shooting { side: 64, lights: 12, ..Shooting::default() };
    for (finish, is_glossy) in [(Finish::matt(0.6), false), (Finish::satin(0.5, 0.25), true)] {
        let photographs = photograph(relief(0.6), &finish, shooting);
        let (found, words) = estimate(&photographs.lp, Transfer::Auto);
        println!("{is_glossy}: {:.3}", found.lit_residual());
        assert_eq!(found.is_glossy, is_glossy, "{words}");
        assert_eq!(words.contains("12 photographs are too few to fit"), is_glossy, "{words}");
        if is_glossy && found.shadows == 0 {
            assert_eq!(found.normals(Estimator::Best).pixels(), found.normals(Estimator::Robust).pixels());
        }
    }
}

#[test]
fn a_list_that_is_off_by_one_is_noticed() {
    // Rows of lamps: between the last of one row and the first of the next, the light jumps.
    let lights: Vec<Light> = [70.0, 45.0, 20.0]
        .iter()
        .flat_map(|elevation: &f64| (0..8).map(move |k| [elevation.to_radians(), 0.6 * f64::from(k)]))
        .map(|[e, a]| [scalar::cos(a) * scalar::cos(e), scalar::sin(a) * scalar::cos(e), scalar::sin(e)])
        .map(|vector| Light::towards(vector).unwrap())
        .collect();
    let side = 48_u32;
    let photograph = |light: &Light| {
        let texel = |i: u32| {
            let [x, y] = [i % side, i / side].map(|v| f64::from(v) / 5.0);
            let n = Vec3::new(0.5 * scalar::sin(x), 0.5 * scalar::sin(y), 1.0);
            let cosine = n.normalize_or(n).dot(light.direction).max(0.0);
            let code = (cosine * 40_000.0) as u16;
            [code, code, code, u16::MAX]
        };
        let texels = (0..side * side).map(texel);
        Bitmap::new(side, side, 1, Texels::U16(texels.collect())).unwrap()
    };
    let photographs: Vec<Bitmap> = lights.iter().map(photograph).collect();
    let words = |lights: &[Light]| {
        let samples = Samples::of(photographs.clone(), lights, None, Transfer::Auto).unwrap();
        let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
        let mut warnings = Warnings::default();
        estimate.note_doubts(&samples, &mut warnings);
        warnings.list().into_iter().map(|warning| warning.what).collect::<Vec<_>>().join("\n")
    };
    assert_eq!(words(&lights), "");
    let moved = |by: usize| -> Vec<Light> { (0..24).map(|k| lights[(k + by) % 24]).collect() };
    assert!(words(&moved(23)).contains("each has the light after its own"), "{}", words(&moved(23)));
    assert!(words(&moved(1)).contains("each has the light before its own"), "{}", words(&moved(1)));
}
