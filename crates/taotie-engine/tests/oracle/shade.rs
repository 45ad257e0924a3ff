//! Reflectance compared with values computed by NumPy in double precision from the papers (`tests/oracle/`).

use crate::common::data_folder;
use serde_json::Value;
use taotie_engine::math::{Lane, Vec3, poly};
use taotie_engine::names::Named;
use taotie_engine::scene::preset;
use taotie_engine::shade::fresnel::{f_conductor, f_dielectric, f_f82, f_schlick, f_schlick_f90, f82_drop};
use taotie_engine::shade::lights::{inverse_square, range_window, spot_cone};
use taotie_engine::shade::microfacets::{
    alpha_from_roughness, alpha_from_shininess, d_beckmann, d_blinn, d_ggx, shininess_from_alpha,
};
use taotie_engine::shade::microfacets::{
    g_v_cavity, k_for_environment, k_for_lights, v_schlick_ggx, v_smith_ggx,
};
use taotie_engine::shade::{Angles, MaterialSample, Shading, reflect};

/// Relative error allowed in `f64`, where only the polynomials of `exp` and `ln` differ: at most 1e-9 · |y ln x|.
const DOUBLE: f64 = 2e-8;
/// Relative error allowed in `f32`. Directions rounded to `f32` move n·h by 6e-8, which a highlight of α = 1e-3 or
/// an exponent of 1000 magnifies.
const SINGLE: f64 = 2e-4;

/// A scalar lane that can be set and read.
trait Scalar: Lane {
    fn of(value: f64) -> Self;
    fn get(self) -> f64;
}

impl Scalar for f32 {
    fn of(value: f64) -> Self {
        value as f32
    }
    fn get(self) -> f64 {
        f64::from(self)
    }
}

impl Scalar for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn get(self) -> f64 {
        self
    }
}

/// Compares values and remembers the largest error.
struct Check {
    tolerance: f64,
    worst: f64,
    at: String,
}

impl Check {
    fn new(tolerance: f64) -> Self {
        Self { tolerance, worst: 0.0, at: String::new() }
    }

    /// Compares `value` with `truth`, relatively, except for values too small to be visible.
    fn number(&mut self, name: &str, value: impl Scalar, truth: &Value) {
        let truth = truth.as_f64().expect(name);
        let error = (value.get() - truth).abs() / (truth.abs() + 1e-6);
        assert!(error <= self.tolerance, "{name}: {} for {truth}, {error:e} off", value.get());
        if error > self.worst {
            (self.worst, self.at) = (error, name.to_owned());
        }
    }

    fn color<L: Scalar>(&mut self, name: &str, value: Vec3<L>, truth: &Value) {
        for (i, channel) in value.to_array().into_iter().enumerate() {
            self.number(&format!("{name}[{i}]"), channel, &truth[i]);
        }
    }

    fn done(self, what: &str) {
        assert!(self.worst > 0.0, "{what}: nothing was compared");
        eprintln!("{what}: at most {:e}, at {}", self.worst, self.at);
    }
}

fn read(name: &str) -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/oracle/").to_owned() + name;
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn rows<'a>(oracle: &'a Value, name: &str) -> &'a Vec<Value> {
    oracle[name].as_array().unwrap()
}

fn scalar<L: Scalar>(value: &Value) -> L {
    L::of(value.as_f64().unwrap())
}

fn vector<L: Scalar>(value: &Value) -> Vec3<L> {
    Vec3::new(scalar(&value[0]), scalar(&value[1]), scalar(&value[2]))
}

fn sample<L: Scalar>(case: &Value) -> MaterialSample<L> {
    MaterialSample {
        base_color: vector(&case["base_color"]),
        metallic: scalar(&case["metallic"]),
        roughness: scalar(&case["roughness"]),
        f0: vector(&case["f0"]),
        f90: L::of(1.0),
        f82_drop: f82_drop(vector(&case["f0"]), vector(&case["f82"])),
        diffuse: vector(&case["diffuse"]),
        specular: vector(&case["specular"]),
        shininess: scalar(&case["shininess"]),
        slope: scalar(&case["slope"]),
        compensation: None,
    }
}

fn angles<L: Scalar>(case: &Value) -> Angles<L> {
    Angles::new(vector(&case["n"]), vector(&case["v"]), vector(&case["l"]))
}

fn models_agree<L: Scalar>(tolerance: f64) {
    let oracle = read("shade_oracle.json");
    let mut check = Check::new(tolerance);
    for (i, case) in rows(&oracle, "cases").iter().enumerate() {
        let (s, a) = (sample::<L>(case), angles::<L>(case));
        for (name, shading) in Shading::NAMES.iter().copied() {
            check.color(&format!("case {i} {name}"), reflect(shading, &s, &a), &case["models"][name]);
        }
    }
    check.done("models");
}

#[test]
fn all_models_in_double_precision() {
    models_agree::<f64>(DOUBLE);
}

#[test]
fn all_models_in_single_precision() {
    models_agree::<f32>(SINGLE);
}

fn blocks_agree<L: Scalar>(tolerance: f64) {
    let oracle = read("shade_oracle.json");
    let mut check = Check::new(tolerance);
    for (i, case) in rows(&oracle, "cases").iter().enumerate() {
        let (s, a) = (sample::<L>(case), angles::<L>(case));
        cosines_agree(&mut check, i, &a, &case["angles"]);
        fresnel_agrees(&mut check, i, &s, &a, case);
        distributions_agree(&mut check, i, &s, &a, &case["blocks"]);
        masking_agrees(&mut check, i, &s, &a, &case["blocks"]);
    }
    check.done("blocks");
}

fn cosines_agree<L: Scalar>(check: &mut Check, i: usize, a: &Angles<L>, truth: &Value) {
    check.number(&format!("case {i} n·l"), a.n_dot_l, &truth["n_dot_l"]);
    check.number(&format!("case {i} n·v"), a.n_dot_v, &truth["n_dot_v"]);
    check.number(&format!("case {i} n·h"), a.n_dot_h, &truth["n_dot_h"]);
    check.number(&format!("case {i} v·h"), a.v_dot_h, &truth["v_dot_h"]);
    check.number(
        &format!("case {i} r·v"),
        a.r_dot_v + L::of(2.0),
        &(truth["r_dot_v"].as_f64().unwrap() + 2.0).into(),
    );
}

fn fresnel_agrees<L: Scalar>(
    check: &mut Check,
    i: usize,
    s: &MaterialSample<L>,
    a: &Angles<L>,
    case: &Value,
) {
    let truth = &case["blocks"];
    check.color(&format!("case {i} f82_drop"), s.f82_drop, &case["f82_drop"]);
    check.color(&format!("case {i} f_schlick"), f_schlick(s.f0, a.v_dot_h), &truth["f_schlick"]);
    check.color(
        &format!("case {i} f_f90"),
        f_schlick_f90(s.f0, s.specular, a.v_dot_h),
        &truth["f_schlick_f90"],
    );
    check.color(&format!("case {i} f_f82"), f_f82(s.f0, s.f90, s.f82_drop, a.v_dot_h), &truth["f_f82"]);
}

fn distributions_agree<L: Scalar>(
    check: &mut Check,
    i: usize,
    s: &MaterialSample<L>,
    a: &Angles<L>,
    truth: &Value,
) {
    let alpha = alpha_from_roughness(s.roughness);
    check.number(
        &format!("case {i} d_beckmann"),
        d_beckmann(a.n_dot_h, a.sin2_h, s.slope),
        &truth["d_beckmann"],
    );
    check.number(&format!("case {i} d_ggx"), d_ggx(a.n_dot_h, a.sin2_h, alpha), &truth["d_ggx"]);
    check.number(&format!("case {i} d_blinn"), d_blinn(a.n_dot_h, s.shininess), &truth["d_blinn"]);
    check.number(&format!("case {i} α"), alpha_from_shininess(s.shininess), &truth["alpha_from_shininess"]);
    check.number(&format!("case {i} s"), shininess_from_alpha(alpha), &truth["shininess_from_alpha"]);
}

fn masking_agrees<L: Scalar>(
    check: &mut Check,
    i: usize,
    s: &MaterialSample<L>,
    a: &Angles<L>,
    truth: &Value,
) {
    let n_dot_l = a.n_dot_l.abs();
    let environment = k_for_environment(s.roughness.max(L::of(0.05)));
    let g = g_v_cavity(n_dot_l, a.n_dot_v, a.n_dot_h, a.v_dot_h);
    let smith = v_smith_ggx(n_dot_l, a.n_dot_v, alpha_from_roughness(s.roughness));
    let lights = v_schlick_ggx(n_dot_l, a.n_dot_v, k_for_lights(s.roughness));
    check.number(&format!("case {i} g_v_cavity"), g, &truth["g_v_cavity"]);
    check.number(&format!("case {i} v_smith_ggx"), smith, &truth["v_smith_ggx"]);
    check.number(&format!("case {i} v_schlick lights"), lights, &truth["v_schlick_lights"]);
    let indirect = v_schlick_ggx(n_dot_l, a.n_dot_v, environment);
    check.number(&format!("case {i} v_schlick environment"), indirect, &truth["v_schlick_environment"]);
}

#[test]
fn building_blocks_in_double_precision() {
    blocks_agree::<f64>(DOUBLE);
}

#[test]
fn building_blocks_in_single_precision() {
    blocks_agree::<f32>(SINGLE);
}

fn tables_agree<L: Scalar>(tolerance: f64) {
    let oracle = read("shade_oracle.json");
    let mut check = Check::new(tolerance);
    for row in rows(&oracle, "fresnel") {
        let (cos, eta, k) = (scalar::<L>(&row["cos"]), scalar::<L>(&row["eta"]), scalar::<L>(&row["k"]));
        check.number("dielectric", f_dielectric(cos, eta), &row["dielectric"]);
        check.number("conductor", f_conductor(cos, eta, k), &row["conductor"]);
    }
    for row in rows(&oracle, "lights") {
        let squared = scalar::<L>(&row["distance_squared"]);
        let cone =
            spot_cone::<L>(scalar(&row["cos_angle"]), scalar(&row["cos_inner"]), scalar(&row["cos_outer"]));
        check.number("inverse square", inverse_square(squared), &row["inverse_square"]);
        check.number("window", range_window(squared, scalar(&row["range"])), &row["window"]);
        check.number("cone", cone, &row["cone"]);
    }
    for row in rows(&oracle, "powers") {
        let (x, y) = (scalar::<L>(&row["x"]), scalar::<L>(&row["y"]));
        check.number("exp", poly::exp(x), &row["exp_x"]);
        check.number("ln", poly::ln(y), &row["ln_y"]);
        check.number("pow", poly::pow(y, scalar(&row["p"])), &row["pow"]);
    }
    check.done("tables");
}

#[test]
fn fresnel_lights_and_powers_in_double_precision() {
    tables_agree::<f64>(DOUBLE);
}

#[test]
fn fresnel_lights_and_powers_in_single_precision() {
    tables_agree::<f32>(SINGLE);
}

/// The presets' names, and the names in the tables they were computed from.
const METALS: [(&str, &str); 6] = [
    ("copper", "copper"),
    ("bronze", "cu90zn10"),
    ("cu85zn15", "cu85zn15"),
    ("brass", "brass"),
    ("gold", "gold"),
    ("silver", "silver"),
];

/// Checks that colours are equal to four decimals, after clipping out-of-gamut values.
fn same_color(name: &str, shipped: [f32; 3], computed: &Value) {
    for (i, shipped) in shipped.into_iter().enumerate() {
        let computed = computed[i].as_f64().unwrap().min(1.0);
        assert!((f64::from(shipped) - computed).abs() < 1.01e-4, "{name}[{i}]: {shipped} for {computed}");
    }
}

#[test]
fn metal_presets_follow_from_measured_indices() {
    let oracle = read("metals_oracle.json");
    for (name, metal) in METALS {
        let material = preset(name).unwrap();
        same_color(name, material.f0.unwrap(), &oracle[metal]["f0"]);
        same_color(name, material.f82.unwrap(), &oracle[metal]["f82"]);
    }
}

#[test]
fn metal_presets_agree_with_the_shared_table() {
    let Some(folder) = data_folder("material-constants") else { return };
    let text = std::fs::read_to_string(folder.join("f0-linear-srgb.json")).unwrap();
    let table: Value = serde_json::from_str(&text).unwrap();
    let oracle = read("metals_oracle.json");
    for (name, metal) in METALS {
        let source = oracle[metal]["source"].as_str().unwrap();
        let entries = table.as_object().unwrap().values();
        let entry =
            entries.into_iter().find(|e| e["source"].as_str().is_some_and(|s| s.ends_with(source))).unwrap();
        same_color(name, preset(name).unwrap().f0.unwrap(), &entry["F0_linear_sRGB"]);
        same_color(name, preset(name).unwrap().f82.unwrap(), &entry["F_at_cos_1_7_linear_sRGB"]);
    }
}
