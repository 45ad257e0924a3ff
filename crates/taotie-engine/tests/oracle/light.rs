//! Energy, layers and antialiasing compared with values computed by NumPy in double precision from the papers
//! (`tests/oracle/light_oracle.py`).

use serde_json::Value;
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::math::Vec3;
use taotie_engine::shade::dfg::{self, Dfg};
use taotie_engine::shade::furnace;
use taotie_engine::shade::microfacets::{alpha_squared_from_divergence_ggx, divergence_ggx};
use taotie_engine::shade::sheen::{d_charlie, v_neubelt};
use taotie_engine::shade::{Angles, AnisotropicLobe, coat_lobe, compensation, specular_occlusion};

/// Returns the rows of a table of the oracle.
fn rows(name: &str) -> Vec<Value> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/oracle/light_oracle.json");
    let oracle: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    oracle[name].as_array().unwrap().clone()
}

fn number(row: &Value, name: &str) -> f64 {
    row[name].as_f64().expect(name)
}

fn vector(value: &Value) -> Vec3<f64> {
    let [x, y, z] = [0, 1, 2].map(|i| value[i].as_f64().unwrap());
    Vec3::new(x, y, z)
}

/// Remembers the largest error of a kind, and where it occurred.
#[derive(Default)]
struct Worst {
    error: f64,
    at: String,
}

impl Worst {
    fn see(&mut self, found: f64, truth: f64, at: impl Fn() -> String) {
        let error = (found - truth).abs();
        if error > self.error || !error.is_finite() {
            (self.error, self.at) = (error, format!("{}: {found} for {truth}", at()));
        }
    }

    fn relative(&mut self, found: f64, truth: f64, at: impl Fn() -> String) {
        let unit = truth.abs() + 1e-6;
        self.see(found / unit, truth / unit, at);
    }

    fn at_most(&self, limit: f64, what: &str) {
        assert!(self.error <= limit, "{what}: {:e} off at {}", self.error, self.at);
        assert!(self.error > 0.0, "{what}: nothing was compared");
        eprintln!("{what}: at most {:e}, at {}", self.error, self.at);
    }
}

const PARTS: [&str; 4] = ["scale", "bias", "edge", "diffuse_edge"];

fn see_parts(worst: &mut Worst, found: [f64; 4], row: &Value) {
    for (name, found) in PARTS.into_iter().zip(found) {
        worst.see(found, number(row, name), || format!("{name} of {row}"));
    }
}

fn wide(dfg: Dfg<f32>) -> [f64; 4] {
    [dfg.scale, dfg.bias, dfg.edge, dfg.diffuse_edge].map(f64::from)
}

#[test]
fn directional_albedos_of_both_lobes() {
    let (mut exact, mut table) = (Worst::default(), Worst::default());
    for row in rows("ggx") {
        let (n_dot_v, roughness) = (number(&row, "n_dot_v"), number(&row, "roughness"));
        see_parts(&mut exact, furnace::dfg_of_ggx(n_dot_v, roughness), &row);
        see_parts(&mut table, wide(dfg::of_ggx(n_dot_v as f32, roughness as f32)), &row);
    }
    for row in rows("cook_torrance") {
        let (n_dot_v, slope) = (number(&row, "n_dot_v"), number(&row, "slope"));
        see_parts(&mut exact, furnace::dfg_of_cook_torrance(n_dot_v, slope), &row);
        see_parts(&mut table, wide(dfg::of_cook_torrance(n_dot_v as f32, slope as f32)), &row);
    }
    exact.at_most(1e-3, "quadrature of the lobes");
    table.at_most(5e-3, "tables of the lobes");
}

#[test]
fn directional_albedo_of_sheen() {
    let (mut exact, mut table) = (Worst::default(), Worst::default());
    for row in rows("sheen") {
        let (n_dot_v, roughness) = (number(&row, "n_dot_v"), number(&row, "roughness"));
        let (truth, at) = (number(&row, "albedo"), || format!("n·v {n_dot_v}, roughness {roughness}"));
        exact.see(furnace::albedo_of_sheen(n_dot_v, roughness), truth, at);
        table.see(f64::from(dfg::of_sheen(n_dot_v as f32, roughness as f32)), truth, at);
    }
    exact.at_most(1e-3, "quadrature of the sheen");
    table.at_most(1e-2, "table of the sheen");
}

#[test]
fn what_compensation_gives_back_and_lets_through() {
    let mut worst = Worst::default();
    for row in rows("compensation") {
        let [scale, bias, edge, diffuse_edge] = PARTS.map(|name| number(&row, name));
        let dfg = Dfg { scale, bias, edge, diffuse_edge };
        let found = compensation(&dfg, vector(&row["f0"]), number(&row, "f90"), vector(&row["drop"]));
        let truth = vector(&row["gain"]);
        worst.see((found.gain - truth).length(), 0.0, || format!("gain of {row}"));
        worst.see(found.transmitted, number(&row, "transmitted"), || format!("transmitted of {row}"));
    }
    worst.at_most(1e-10, "compensation");
}

#[test]
fn anisotropic_lobes_sheen_and_clearcoat() {
    let mut worst = Worst::default();
    for (i, row) in rows("lobes").iter().enumerate() {
        let [n, v, l, t, b] = ["n", "v", "l", "t", "b"].map(|name| vector(&row[name]));
        let (roughness, strength) = (number(row, "roughness"), number(row, "strength"));
        let a = Angles::new(n, v, l);
        let anisotropic = AnisotropicLobe::new(t, b, roughness, strength).lobe(&a, v, l);
        let found = [
            ("stretched", anisotropic),
            ("d_charlie", d_charlie(a.sin2_h, roughness)),
            ("v_neubelt", v_neubelt(a.n_dot_l, a.n_dot_v)),
            ("coat", coat_lobe(roughness, &a)),
        ];
        for (name, found) in found {
            worst.relative(found, number(row, name), || format!("{name} of case {i}"));
        }
    }
    worst.at_most(2e-8, "layers");
}

#[test]
fn specular_occlusion_of_lagarde() {
    let mut worst = Worst::default();
    for row in rows("occlusion") {
        let [n_dot_v, occlusion, roughness] =
            ["n_dot_v", "occlusion", "roughness"].map(|name| number(&row, name));
        let found = specular_occlusion(n_dot_v, occlusion, roughness);
        worst.see(found, number(&row, "seen"), || row.to_string());
    }
    worst.at_most(1e-7, "specular occlusion");
}

#[test]
fn means_and_variances_of_normals_in_mips() {
    let (mut means, mut variances) = (Worst::default(), Worst::default());
    for row in rows("mips") {
        let code = |n: &Value, c: usize| n[c].as_f64().unwrap() as u16;
        let normals = row["normals"].as_array().unwrap();
        let texels = normals.iter().map(|n| [code(n, 0), code(n, 1), code(n, 2), 65535]).collect();
        let texture = Texture::new(Bitmap::new(2, 2, 3, Texels::U16(texels)).unwrap(), Encoding::Normal);
        let [r, g, b, variance] = texture.texel(1, 0, 0).map(f64::from);
        let mean = Vec3::new(2.0 * r - 1.0, 2.0 * g - 1.0, 2.0 * b - 1.0);
        means.see((mean - vector(&row["mean"])).length(), 0.0, || row.to_string());
        variances.see(variance, number(&row, "variance"), || row.to_string());
    }
    // Half a code of 65535 in each component.
    means.at_most(4e-5, "means");
    variances.at_most(1e-5, "variances");
}

#[test]
fn divergence_of_ggx() {
    let (mut there, mut back) = (Worst::default(), Worst::default());
    for row in rows("divergence") {
        let (alpha, divergence) = (number(&row, "alpha"), number(&row, "divergence"));
        there.relative(divergence_ggx(alpha), divergence, || row.to_string());
        there.relative(f64::from(divergence_ggx(alpha as f32)), divergence, || format!("{row} in f32"));
        let double = alpha_squared_from_divergence_ggx(divergence).sqrt();
        back.relative(double, alpha, || row.to_string());
        let single = f64::from(alpha_squared_from_divergence_ggx(divergence as f32).sqrt());
        back.relative(single, alpha, || format!("{row} in f32"));
    }
    there.at_most(2e-4, "divergence");
    back.at_most(2e-4, "α from divergence");
}
