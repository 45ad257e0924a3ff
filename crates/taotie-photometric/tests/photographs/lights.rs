//! Lists of lights that do not belong to the photographs are noticed, and those that do are not.

use crate::studio::{Finish, Photographs, Shooting, photograph, relief};
use std::path::Path;
use taotie_engine::compare::angle_deg;
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

/// Returns the unit vectors towards lights in a spiral, the lowest at an elevation of 27°.
fn spiral(count: u32) -> Vec<Light> {
    let vector = |k: u32| {
        let z = 0.45 + 0.45 * (f64::from(k) + 0.5) / f64::from(count);
        let (a, r) = (2.399_963 * f64::from(k), (1.0 - z * z).sqrt());
        [r * scalar::cos(a), r * scalar::sin(a), z]
    };
    (0..count).map(|k| Light::towards(vector(k)).unwrap()).collect()
}

/// The normal of drawn waves at a place in pixels, x to the right and y up.
fn waves(x: f64, y: f64) -> Vec3<f64> {
    let slope = [
        0.5 * scalar::cos(x / 6.0) * scalar::cos(y / 7.0),
        -0.5 * scalar::sin(x / 6.0) * scalar::sin(y / 7.0),
    ];
    let n = Vec3::new(slope[0], slope[1], 1.0);
    n.normalize_or(n)
}

const SIZE: [u32; 2] = [100, 60];

/// Returns a photograph whose grey, [0, 1], is that of a place in pixels from the picture's centre.
fn drawn(grey: impl Fn(f64, f64) -> f64) -> Bitmap {
    let [width, height] = SIZE;
    let texel = |i: u32| {
        let x = f64::from(i % width) + 0.5 - 0.5 * f64::from(width);
        let y = 0.5 * f64::from(height) - f64::from(i / width) - 0.5;
        let code = (grey(x, y).clamp(0.0, 1.0) * 65_535.0).round() as u16;
        [code, code, code, u16::MAX]
    };
    Bitmap::new(width, height, 4, Texels::U16((0..width * height).map(texel).collect())).unwrap()
}

/// Returns the errors of the best normals in degrees, NaN without one, at places in pixels from the picture's centre.
fn errors(estimate: &Estimate) -> Vec<([f64; 2], f64)> {
    let [width, height] = SIZE;
    let error = |(i, pixel): (usize, &[f32; 4])| {
        let x = (i as u32 % width) as f64 + 0.5 - 0.5 * f64::from(width);
        let y = 0.5 * f64::from(height) - (i as u32 / width) as f64 - 0.5;
        let [nx, ny, nz, known] = pixel.map(f64::from);
        let angle = angle_deg(Vec3::new(nx, ny, nz), waves(x, y));
        ([x, y], if known > 0.0 { angle } else { f64::NAN })
    };
    estimate.normals(Estimator::Best).pixels().iter().enumerate().map(error).collect()
}

#[test]
fn photographs_that_moved_are_named() {
    let lights = spiral(16);
    let words = |moved: [f64; 2]| {
        let photograph = |(k, light): (usize, &Light)| {
            let [dx, dy] = if k == 5 { moved } else { [0.0; 2] };
            drawn(|x, y| {
                let (x, y) = (x - dx, y + dy);
                let albedo = 0.6 + 0.2 * scalar::sin(x / 5.0) * scalar::sin(y / 4.0);
                albedo * waves(x, y).dot(light.direction)
            })
        };
        let photographs = lights.iter().enumerate().map(photograph).collect();
        let samples = Samples::of(photographs, &lights, None, Transfer::Auto).unwrap();
        let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
        let mut warnings = Warnings::default();
        estimate.note_doubts(&samples, &mut warnings);
        let shifts: Vec<[f64; 2]> = estimate.lights.iter().map(|light| light.shift.unwrap().pixels).collect();
        (warnings.list().into_iter().map(|warning| warning.what).collect::<Vec<_>>().join("\n"), shifts)
    };
    let (silent, shifts) = words([0.0; 2]);
    assert!(silent.is_empty(), "{silent}");
    assert!(shifts.as_flattened().iter().all(|v| v.abs() < 0.1), "{shifts:?}");
    let (found, shifts) = words([1.5, -1.0]);
    assert!(
        found.contains("moved: images[5] by 1.") && found.contains(" right and ") && found.contains(" up"),
        "{found}"
    );
    let [x, y] = shifts[5];
    assert!((x - 1.5).abs() < 0.3 && (y + 1.0).abs() < 0.3, "{shifts:?}");
    let others = shifts.iter().enumerate().filter(|(k, _)| *k != 5);
    assert!(others.flat_map(|(_, shift)| shift).all(|v| v.abs() < 0.3), "{shifts:?}");
}

/// Rows of 100 pixels: blocks of pixels end in the next row.
#[test]
fn each_pixel_has_its_own_direction_to_a_near_lamp() {
    let lights = spiral(24);
    let places: Vec<Vec3<f64>> = lights.iter().map(|light| light.direction * f64::from(SIZE[0])).collect();
    let photograph = |(k, place): (usize, &Vec3<f64>)| {
        let shadow = f64::from(k as u32 * 37 % SIZE[1]) - 0.5 * f64::from(SIZE[1]);
        drawn(|x, y| {
            let to = *place - Vec3::new(x, y, 0.0);
            let lit = if (y - shadow).abs() < 4.0 { 0.1 } else { 1.0 };
            0.6 * lit * waves(x, y).dot(to.normalize_or(to)).max(0.0)
        })
    };
    let photographs = places.iter().enumerate().map(photograph).collect();
    let mut samples = Samples::of(photographs, &lights, None, Transfer::Auto).unwrap();
    samples.positions = places.into_iter().map(Some).collect();
    let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
    let errors: Vec<f64> = errors(&estimate).into_iter().map(|(_, error)| error).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let most = errors.iter().fold(0.0, |most: f64, error| most.max(*error));
    println!("near lamps: {mean:.3}° on average, {most:.2}° at most");
    assert!(mean < 0.05 && most < 2.0, "{mean} {most}, albedo {} of {}", estimate.albedo, estimate.shadows);
}

/// Of six photographs, one is saturated on the right and another transparent on the left.
#[test]
fn unusable_samples_of_few_photographs_are_left_out() {
    let lights = spiral(6);
    let photograph = |(k, light): (usize, &Light)| {
        let grey = |x: f64, y: f64| {
            if k == 2 && x > 20.0 { 1.0 } else { 0.6 * waves(x, y).dot(light.direction).max(0.0) }
        };
        let mut bitmap = drawn(grey);
        if k == 3 {
            let Texels::U16(texels) = bitmap.texels() else { panic!("16 bits") };
            let is_left = |i: usize| i as u32 % SIZE[0] < 30;
            let texels = texels
                .iter()
                .enumerate()
                .map(|(i, [r, g, b, a])| [*r, *g, *b, if is_left(i) { 0 } else { *a }]);
            bitmap = Bitmap::new(SIZE[0], SIZE[1], 4, Texels::U16(texels.collect())).unwrap();
        }
        bitmap
    };
    let photographs = lights.iter().enumerate().map(photograph).collect();
    let samples = Samples::of(photographs, &lights, None, Transfer::Auto).unwrap();
    let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
    let errors = errors(&estimate);
    let most = |is: &dyn Fn(f64) -> bool| {
        errors.iter().filter(|([x, _], _)| is(*x)).map(|(_, error)| *error).fold(0.0, f64::max)
    };
    let [left, middle, right] = [most(&|x| x < -20.0), most(&|x| x.abs() < 20.0), most(&|x| x > 20.0)];
    println!("{left:.3}° {middle:.3}° {right:.3}°");
    assert!(left.max(middle).max(right) < 0.1, "{left} {middle} {right}");
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
