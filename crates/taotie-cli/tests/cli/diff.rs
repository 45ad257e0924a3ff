//! The output and exit codes of `taotie diff`.

use super::models::{Green, TRIANGLE, write_ball, write_relief};
use super::pictures::write_square;
use super::place::Place;
use serde_json::{Value, json};
use snapbox::str;
use taotie_engine::image::{Encoding, Texels};
use taotie_io::{ExrLayer, PngSamples, read_bitmap, write_exr};

/// Writes a picture of `side`² pixels with a gradient, moved `shift` pixels to the right.
fn write_gradient(place: &Place, name: &str, side: u32, shift: u32) {
    let code = |i: u32| {
        let (x, y) = ((i % side + shift) % side, i / side);
        [(x * 255 / side) as u8, (y * 255 / side) as u8, ((x / 4 + y / 4) % 2 * 200) as u8]
    };
    let samples: Vec<u8> = (0..side * side).flat_map(code).collect();
    write_square(&place.path(name), PngSamples::U8(&samples), Encoding::Srgb);
}

fn gradients() -> Place {
    let place = Place::new();
    write_gradient(&place, "a.png", 40, 0);
    write_gradient(&place, "b.png", 40, 1);
    place
}

/// Writes the flat normal tilted by `degrees` towards x, as it is, with a transparent first texel.
fn write_signed(place: &Place, name: &str, degrees: f64) {
    let (sin, cos) = (
        taotie_engine::math::scalar::sin(degrees.to_radians()),
        taotie_engine::math::scalar::cos(degrees.to_radians()),
    );
    let mut samples = [sin as f32, 0.0, cos as f32, 1.0].repeat(16);
    samples[..4].fill(0.0);
    let layer = ExrLayer { name: "", channels: &["R", "G", "B", "A"], samples: &samples };
    write_exr(&place.path(name), (4, 4), &[layer]).expect("the folder can be written to");
}

#[test]
fn pictures_by_every_metric() {
    let place = gradients();
    place.taotie("diff a.png b.png").assert().success().stderr_eq("").stdout_eq(str![[r#"
a         a.png: 8 bits, 3 channels
b         b.png: 8 bits, 3 channels
size      40x40, compared as pictures

rmse   0.24361
psnr   12.27 dB
ssim   0.82463
flip   mean 0.1680, median 0.1396, quartiles 0.0809 and 0.2086, p95 0.4551, max 0.9532, at 67 pixels per degree

"#]]);
    assert_eq!(place.files(), ["a.png", "b.png"]);
}

#[test]
fn equal_pictures() {
    let place = gradients();
    place.taotie("diff a.png a.png").assert().success().stderr_eq("").stdout_eq(str![[r#"
a         a.png: 8 bits, 3 channels
b         a.png: 8 bits, 3 channels
size      40x40, compared as pictures
equal     every number is the same in both files

rmse   0.00000
psnr   infinite
ssim   1.00000
flip   mean 0.0000, median 0.0000, quartiles 0.0000 and 0.0000, p95 0.0000, max 0.0000, at 67 pixels per degree

"#]]);
}

#[test]
fn normal_maps_by_their_angle() {
    let place = Place::new();
    write_relief(&place.path("up.png"), Green::Up);
    write_relief(&place.path("down.png"), Green::Down);
    place.taotie("diff up.png down.png").assert().success().stderr_eq("").stdout_eq(str![[r#"
a         up.png: 8 bits, 3 channels, unit normals; 0 texels transparent, 0 without a unit vector
b         down.png: 8 bits, 3 channels, unit normals; 0 texels transparent, 0 without a unit vector
size      192x192, compared as normals
left out  0 texels without a normal in one of the files

angle  mean 21.883°, median 19.381°, quartiles 9.420° and 37.874°, p95 49.687°, max 53.330°
       8-bit storage of normals accounts for 0.17° on average

"#]]);
    write_ball(&place.path("ball.png"));
    let report = place.json("diff ball.png ball.png --json");
    assert_eq!(
        (&report["compared_as"], &report["metrics"]["angle"]["max"]),
        (&json!("normals"), &json!(0.0))
    );
}

#[test]
fn rendered_normals_are_compared_where_both_saw_something() {
    let place = Place::with("a.obj", TRIANGLE);
    for (azimuth, name) in [(0, "front"), (10, "side")] {
        let line = format!("render a.obj -o {name}.png --size 24x24 --aov normals --orbit {azimuth},0");
        place.taotie(&line).assert().success();
    }
    let report = place.json("diff front.normals.exr side.normals.exr --json");
    assert_eq!((&report["a"]["normals"], &report["b"]["normals"]), (&json!("signed"), &json!("signed")));
    let angle = &report["metrics"]["angle"];
    assert!(angle["max"].as_f64().unwrap() < 1e-3, "a triangle has one normal: {angle}");
    let (count, left_out) = (angle["count"].as_u64().unwrap(), report["left_out"].as_u64().unwrap());
    assert!(count > 50 && left_out > 50 && count + left_out == 24 * 24, "{report}");
}

#[test]
fn signed_and_unit_normals_are_told_apart() {
    let place = Place::new();
    write_signed(&place, "flat.exr", 0.0);
    write_signed(&place, "tilted.exr", 3.0);
    let report = place.json("diff flat.exr tilted.exr --json");
    assert_eq!((&report["a"]["transparent"], &report["left_out"]), (&json!(1), &json!(1)));
    let mean = report["metrics"]["angle"]["mean"].as_f64().unwrap();
    assert!((mean - 3.0).abs() < 1e-4, "{mean}");
    let forced = place.json("diff flat.exr tilted.exr --encoding color --json");
    assert_eq!((&forced["compared_as"], &forced["metrics"]["angle"]), (&json!("pictures"), &Value::Null));
}

#[test]
fn the_exit_code_follows_the_threshold() {
    let place = gradients();
    let report = place.json("diff a.png b.png --json");
    for (metric, worse, better) in
        [("flip", -1.0, 1.0), ("rmse", -1.0, 1.0), ("ssim", 1.0, -1.0), ("psnr", 1.0, -1.0)]
    {
        let value = &report["metrics"][metric];
        let value = value.as_f64().unwrap_or_else(|| value["mean"].as_f64().unwrap());
        let code = |off: f64| {
            let limit = (value + off * 1e-3).to_string();
            let line = ["diff", "a.png", "b.png", "--metric", metric, "--threshold", &limit];
            place.taotie_with(&line).assert().get_output().status.code()
        };
        assert_eq!((code(worse), code(better)), (Some(1), Some(0)), "{metric}");
    }
    place.taotie("diff a.png a.png --metric psnr --threshold 99").assert().success();
}

#[test]
fn the_threshold_is_told() {
    let place = gradients();
    let line = "diff a.png b.png --metric rmse --threshold 0.01";
    place.taotie(line).assert().code(1).stderr_eq("").stdout_eq(str![[r#"
a         a.png: 8 bits, 3 channels
b         b.png: 8 bits, 3 channels
size      40x40, compared as pictures

rmse   0.24361

rmse is worse than the threshold 0.01

"#]]);
}

#[test]
fn a_heat_map_for_every_metric() {
    let place = gradients();
    write_signed(&place, "flat.exr", 0.0);
    write_signed(&place, "tilted.exr", 3.0);
    for metric in ["flip", "ssim", "psnr", "rmse"] {
        let line = format!("diff a.png b.png --metric {metric} --heat {metric}.png --heat-top 0.5");
        place.taotie(&line).assert().success().stderr_eq("");
    }
    let stdout = str![[r#"
a         flat.exr: 32 bits, 4 channels, signed normals; 1 texels transparent, 0 without a unit vector
b         tilted.exr: 32 bits, 4 channels, signed normals; 1 texels transparent, 0 without a unit vector
size      4x4, compared as normals
left out  1 texels without a normal in one of the files

angle  mean 3.000°, median 3.000°, quartiles 3.000° and 3.000°, p95 3.000°, max 3.000°
       8-bit storage of normals accounts for 0.17° on average

wrote angle.png

"#]];
    place
        .taotie("diff flat.exr tilted.exr --heat angle.png")
        .assert()
        .success()
        .stderr_eq("")
        .stdout_eq(stdout);
    let pixel = |name: &str, x: usize, y: usize| {
        let bitmap = read_bitmap(&place.path(name)).expect("it is a picture");
        assert!(bitmap.width() == 260, "wide enough for the scale");
        let Texels::U8(texels) = bitmap.texels() else { panic!("8 bits") };
        texels[y * 260 + x]
    };
    // Pictures are centred: 128 + 4 pixels. The first texel is transparent, all others have the largest angle.
    assert_eq!(pixel("angle.png", 128, 0), [96, 96, 96, 255]);
    let [r, g, b, _] = pixel("angle.png", 129, 0);
    assert!(r > 250 && g > 225 && b < 45, "viridis ends in yellow: {r} {g} {b}");
    // SSIM has no value at the border.
    assert_eq!(pixel("ssim.png", 110, 0), [96, 96, 96, 255]);
    assert_ne!(pixel("flip.png", 110, 0), [96, 96, 96, 255]);
}

#[test]
fn transparent_pictures_are_laid_over_the_background() {
    let place = Place::with("a.obj", TRIANGLE);
    place.taotie("render a.obj -o clear.png --size 32x32 --background transparent").assert().success();
    place.taotie("render a.obj -o green.png --size 32x32 --background #00ff00").assert().success();
    let rmse = |options: &str| {
        place.json(&format!("diff clear.png green.png --json {options}"))["metrics"]["rmse"].as_f64().unwrap()
    };
    assert!(rmse("") > 0.3);
    assert!(rmse("--background #00ff00") < 2e-3);
}

#[test]
fn a_small_picture_has_no_ssim() {
    let place = Place::new();
    write_gradient(&place, "a.png", 8, 0);
    assert_eq!(place.json("diff a.png a.png --json")["metrics"]["ssim"], Value::Null);
}
