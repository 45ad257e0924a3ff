//! FLIP, SSIM, PSNR and RMSE of fixed pictures against their reference implementations: NVIDIA's `flip-evaluator` and
//! scikit-image (`tests/oracle/compare_oracle.py`); CIEDE2000 against its published pairs.

use serde_json::Value;
use taotie_engine::compare::{DisplayImage, ciede2000, flip, psnr, rmse, ssim};
use taotie_engine::math::Vec3;

/// The bound for every value; their use of single precision accounts for 2e-5.
const BOUND: f64 = 1e-4;

fn oracle() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/oracle/compare_oracle.json");
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// Returns noise from 0 to 31.
fn noise(x: i64, y: i64, seed: i64) -> i64 {
    let mixed = (x * 73_856_093) ^ (y * 19_349_663) ^ (seed * 83_492_791);
    i64::from((mixed as u32).wrapping_mul(2_654_435_761) >> 27)
}

/// Returns the picture of the same name in the Python script.
fn still_life([x, y]: [i64; 2], [width, height]: [i64; 2], changed: bool) -> [i64; 3] {
    let checks = if (x / 8 + y / 8) % 2 == 1 { 200 } else { 40 };
    let mut color = [x * 255 / (width - 1), y * 255 / (height - 1), checks];
    let (dx, dy) = if changed { (x - 62, y - 31) } else { (x - 60, y - 30) };
    if dx * dx + dy * dy < 300 {
        color = [230, 190, 60];
    }
    if x % 16 == 3 && y > 40 && !(changed && x > 60) {
        color = [20, 20, 30];
    }
    let seed = if changed && x < 30 && y < 30 { 2 } else { 1 };
    let [r, g, b] = color.map(|c| c + noise(x, y, seed) - 16);
    if changed { [r + 5, g, (b * 9).div_euclid(10)] } else { [r, g, b] }
}

/// Returns a pixel of one of the two pictures of a case.
fn color(name: &str, at: [i64; 2], size: [i64; 2], second: bool) -> [u8; 3] {
    let color = match (name, second) {
        ("still life", changed) => still_life(at, size, changed),
        ("the same", _) => still_life(at, size, false),
        ("black and white", false) => [0; 3],
        ("black and white", true) => [255; 3],
        ("green and blue", false) => [0, 255, 0],
        ("green and blue", true) => [0, 0, 255],
        ("noise", second) => [if second { 6 } else { 3 }, 4, 5].map(|seed| noise(at[0], at[1], seed) * 8),
        _ => panic!("the script has a case that the test lacks: {name}"),
    };
    color.map(|c| c.clamp(0, 255) as u8)
}

/// Returns the picture, after checking that its codes have the same sum as in the script.
fn picture(case: &Value, second: bool) -> DisplayImage {
    let [width, height] = ["width", "height"].map(|key| case[key].as_i64().unwrap());
    let name = case["name"].as_str().unwrap();
    let codes: Vec<[u8; 3]> =
        (0..width * height).map(|i| color(name, [i % width, i / width], [width, height], second)).collect();
    let sum: u64 =
        codes.as_flattened().iter().enumerate().map(|(i, c)| u64::from(*c) * (i as u64 % 251 + 1)).sum();
    assert_eq!(sum, case["sums"][usize::from(second)].as_u64().unwrap(), "{name} is a different picture");
    DisplayImage::from_8bit(width as u32, height as u32, &codes).unwrap()
}

fn close(what: &str, ours: f64, expected: f64) -> f64 {
    let off = (ours - expected).abs();
    assert!(off < BOUND, "{what}: {ours} against {expected}");
    off
}

#[test]
fn rmse_psnr_and_ssim_are_those_of_scikit_image() {
    for case in oracle()["cases"].as_array().unwrap() {
        let (a, b) = (picture(case, false), picture(case, true));
        let name = &case["name"];
        let off_rmse = close("rmse", rmse(&a, &b).unwrap(), number(&case["rmse"]));
        let off_psnr = match &case["psnr"] {
            Value::Null => f64::from(u8::from(psnr(&a, &b).unwrap() != f64::INFINITY)),
            expected => close("psnr", psnr(&a, &b).unwrap(), number(expected)),
        };
        assert!(off_psnr < BOUND);
        let off_ssim = close("ssim", ssim(&a, &b).unwrap(), number(&case["ssim"]));
        println!("{name}: rmse off by {off_rmse:.1e}, psnr by {off_psnr:.1e} dB, ssim by {off_ssim:.1e}");
    }
}

#[test]
fn flip_is_that_of_its_authors() {
    let oracle = oracle();
    let stride = oracle["stride"].as_u64().unwrap() as usize;
    for case in oracle["cases"].as_array().unwrap() {
        let (a, b) = (picture(case, false), picture(case, true));
        for expected in case["flip"].as_array().unwrap() {
            let pixels_per_degree = number(&expected["pixels_per_degree"]) as f32;
            let map = flip(&a, &b, pixels_per_degree).unwrap();
            let off_mean = close("mean", map.summary().unwrap().mean, number(&expected["mean"]));
            let every = expected["every"].as_array().unwrap();
            assert_eq!(every.len(), map.values().len().div_ceil(stride));
            let pixels = map.values().iter().step_by(stride).zip(every);
            let worst = pixels.fold(0.0f64, |w, (v, e)| w.max(close("pixel", f64::from(*v), number(e))));
            let name = &case["name"];
            println!("{name} at {pixels_per_degree}: mean off by {off_mean:.1e}, pixels by {worst:.1e}");
        }
    }
}

/// The table has four decimals. Hues that wrap around, greys and opposite hues are among its pairs.
#[test]
fn color_differences_are_those_of_the_paper() {
    let oracle = oracle();
    let pairs = oracle["color_pairs"].as_array().unwrap();
    assert_eq!(pairs.len(), 34);
    for pair in pairs {
        let value = |i: usize| number(&pair[i]);
        let [a, b] = [0, 3].map(|first| Vec3::new(value(first), value(first + 1), value(first + 2)));
        let differences = [ciede2000(a, b), ciede2000(b, a)];
        for difference in differences {
            let off = (difference - value(6)).abs();
            assert!(off < BOUND, "{pair}: {difference}");
        }
        assert_eq!(differences[0], differences[1], "{pair}: the colours may be swapped");
    }
}
