//! Tone curves and the sRGB encoding against NumPy in double precision (`tests/oracle/film_oracle.py`).

use serde_json::Value;
use taotie_engine::film::{ToneCurve, srgb_from_linear};
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;

fn oracle() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/oracle/film_oracle.json");
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

fn colors(value: &Value) -> Vec<Vec3<f64>> {
    let color = |v: &Value| Vec3::from_array(numbers(v).try_into().unwrap());
    value.as_array().unwrap().iter().map(color).collect()
}

fn distance(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    (a - b).to_array().iter().fold(0.0, |worst, d| worst.max(d.abs()))
}

#[test]
fn every_curve_follows_its_publication() {
    let oracle = oracle();
    let inputs = colors(&oracle["inputs"]);
    assert_eq!(oracle["curves"].as_object().unwrap().len(), ToneCurve::NAMES.len());
    for (name, curve) in ToneCurve::NAMES.iter().copied() {
        let expected = colors(&oracle["curves"][name]);
        assert_eq!(expected.len(), inputs.len());
        let (mut worst, mut worst_wide) = (0.0f64, 0.0f64);
        for (input, expected) in inputs.iter().zip(expected) {
            worst = worst.max(distance(curve.apply(input.to_f32()).to_f64(), expected));
            worst_wide = worst_wide.max(distance(curve.apply(*input), expected));
        }
        println!("{name}: {worst:.2e} in f32, {worst_wide:.2e} in f64");
        let bound = if curve == ToneCurve::Agx { 1e-5 } else { 3e-7 };
        assert!(worst < bound, "{name}: {worst:e}");
        assert!(worst_wide < 5e-7, "{name}: {worst_wide:e}");
    }
}

#[test]
fn the_encoding_follows_its_standard() {
    let oracle = oracle();
    for (linear, expected) in numbers(&oracle["linear"]).into_iter().zip(numbers(&oracle["srgb"])) {
        let ours = f64::from(srgb_from_linear(linear as f32));
        assert!((ours - expected).abs() < 3e-7, "{linear}: {ours} against {expected}");
    }
}
