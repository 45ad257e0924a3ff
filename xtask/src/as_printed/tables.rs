//! The light that each model reflects in a white furnace, as Markdown tables.

use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::scene::preset;
use taotie_engine::shade::furnace::Furnace;
use taotie_engine::shade::{MaterialSample, Shading};

/// Computes the lines of a table.
type Lines = fn() -> String;

/// The tables by name.
pub const TABLES: [(&str, Lines); 5] = [
    ("cook-torrance", cook_torrance),
    ("guo-wang-2025", guo_wang_2025),
    ("blinn-phong", blinn_phong),
    ("ggx-dielectric", ggx_dielectric),
    ("ggx-metal", ggx_metal),
];

/// Returns the lines of a table; `None` if there is no table with this name.
pub fn table(name: &str) -> Option<String> {
    TABLES.iter().find(|(known, _)| *known == name).map(|(_, lines)| lines())
}

/// The cosines of the angles between normal and viewer.
const N_DOT_V: [f64; 5] = [1.0, 0.7, 0.4, 0.2, 0.1];

/// A printed model and the intended one.
type Pair = [Shading; 2];

const COOK_TORRANCE: Pair = [Shading::CookTorrancePrinted, Shading::CookTorrance];
const BLINN_PHONG: Pair = [Shading::BlinnPhongPrinted, Shading::BlinnPhong];
const GGX: Pair = [Shading::GgxPrinted, Shading::Ggx];

/// Returns a white mirror metal, with only the highlight for models with k_d and k_s.
fn white() -> MaterialSample<f64> {
    let (white, black) = (Vec3::splat(1.0), Vec3::splat(0.0));
    MaterialSample {
        base_color: white,
        metallic: 1.0,
        roughness: 0.5,
        f0: white,
        f90: 1.0,
        f82_drop: black,
        diffuse: black,
        specular: white,
        shininess: 0.0,
        slope: 0.5,
        compensation: None,
    }
}

fn cook_torrance() -> String {
    let slopes = [0.1, 0.3, 0.5, 1.0];
    let rows = slopes.map(|slope| (format!("{slope}"), MaterialSample { slope, ..white() }));
    by_angle("k", &COOK_TORRANCE, &rows)
}

fn blinn_phong() -> String {
    let rows = [1.0, 5.0, 10.0, 100.0].map(|m| (format!("{m}"), MaterialSample { shininess: m, ..white() }));
    by_angle("m", &BLINN_PHONG, &rows)
}

fn ggx_dielectric() -> String {
    let plaster = MaterialSample { metallic: 0.0, f0: Vec3::splat(0.04), ..white() };
    by_roughness(plaster)
}

fn ggx_metal() -> String {
    by_roughness(white())
}

fn by_roughness(sample: MaterialSample<f64>) -> String {
    let rows = [0.2, 0.5, 0.8, 1.0]
        .map(|roughness| (format!("{roughness}"), MaterialSample { roughness, ..sample }));
    by_angle("roughness", &GGX, &rows)
}

/// Returns the table for the material of the paper's Table 1, without its ambient light.
fn guo_wang_2025() -> String {
    let preset = preset("guo-wang-2025").expect("the paper's material is a preset");
    let color =
        |authored: Option<[f32; 3]>| authored.map_or(Vec3::splat(0.0), |c| Vec3::from_array(c).to_f64());
    let material = MaterialSample {
        diffuse: color(preset.classic.diffuse),
        specular: color(preset.classic.specular),
        f0: color(preset.f0),
        slope: preset.classic.slope.map_or(0.0, f64::from),
        ..white()
    };
    let furnace = Furnace::default();
    let mut lines = heading(&["model", "red", "green", "blue", "red at n·v = 0.2", "green", "blue"]);
    for shading in COOK_TORRANCE {
        let all = furnace.hemispherical_albedo(shading, &material).to_array();
        let grazing = furnace.directional_albedo(shading, &material, 0.2).to_array();
        lines += &row(shading, all.into_iter().chain(grazing));
    }
    lines
}

/// Returns a row for each material sample and model, with a column for each angle and one for all directions.
fn by_angle(parameter: &str, pair: &Pair, samples: &[(String, MaterialSample<f64>)]) -> String {
    let angles = N_DOT_V.map(|n_dot_v| format!("n·v = {n_dot_v}"));
    let mut titles = vec![parameter, "model"];
    titles.extend(angles.iter().map(String::as_str));
    titles.push("all directions");
    let furnace = Furnace::default();
    let mut lines = heading(&titles);
    for (value, sample) in samples {
        for shading in pair {
            let directional = N_DOT_V.map(|n_dot_v| furnace.directional_albedo(*shading, sample, n_dot_v).x);
            let all = furnace.hemispherical_albedo(*shading, sample).x;
            lines += &format!("| {value} {}", row(*shading, directional.into_iter().chain([all])));
        }
    }
    lines
}

fn heading(titles: &[&str]) -> String {
    let rule = |title: &&str| if ["model"].contains(title) { " --- |" } else { " ---: |" };
    let rules: String = titles.iter().map(rule).collect();
    format!("| {} |\n|{rules}\n", titles.join(" | "))
}

fn row(shading: Shading, values: impl Iterator<Item = f64>) -> String {
    let values: String = values.map(|value| format!(" {value:.3} |")).collect();
    format!("| `{}` |{values}\n", shading.name())
}
