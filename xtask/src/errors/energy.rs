//! The share of incoming light that white surfaces reflect, by quadrature.

use crate::computed::row;
use taotie_engine::math::Vec3;
use taotie_engine::shade::dfg::{self, Dfg};
use taotie_engine::shade::furnace::Furnace;
use taotie_engine::shade::{MaterialSample, Shading, compensation};

const ROUGHNESS: [f64; 6] = [0.1, 0.2, 0.4, 0.6, 0.8, 1.0];
const N_DOT_V: [f64; 4] = [0.1, 0.3, 0.6, 1.0];

/// Returns for each roughness the albedo of white surfaces that is farthest from 1 over the angles, with single
/// scattering and with compensation.
pub fn table() -> String {
    let mut text = row(&[
        "roughness",
        "`ggx` single",
        "`ggx` compensated",
        "`cook-torrance` single",
        "`cook-torrance` compensated",
        "white dielectric, `ggx` single",
        "compensated",
    ]
    .map(String::from));
    text += "| --: | --: | --: | --: | --: | --: | --: |\n";
    for roughness in ROUGHNESS {
        let cells = [
            format!("{roughness:.1}"),
            lost(Shading::Ggx, 1.0, roughness, false),
            lost(Shading::Ggx, 1.0, roughness, true),
            lost(Shading::CookTorrance, 1.0, roughness, false),
            lost(Shading::CookTorrance, 1.0, roughness, true),
            lost(Shading::Ggx, 0.0, roughness, false),
            lost(Shading::Ggx, 0.0, roughness, true),
        ];
        text += &row(&cells);
    }
    text
}

/// Returns the albedo farthest from 1 over the angles.
fn lost(shading: Shading, metallic: f64, roughness: f64, compensated: bool) -> String {
    let albedo = |n_dot_v: f64| {
        let s = white(shading, metallic, roughness, compensated.then_some(n_dot_v));
        Furnace::default().directional_albedo(shading, &s, n_dot_v).x
    };
    let farthest = N_DOT_V
        .into_iter()
        .map(albedo)
        .fold(1.0f64, |worst, value| if (value - 1.0).abs() > (worst - 1.0).abs() { value } else { worst });
    format!("{farthest:.4}")
}

fn white(
    shading: Shading,
    metallic: f64,
    roughness: f64,
    compensated_at: Option<f64>,
) -> MaterialSample<f64> {
    let (white, black) = (Vec3::splat(1.0), Vec3::splat(0.0));
    let f0 = if metallic > 0.0 { white } else { white * 0.04 };
    let slope = roughness * roughness;
    let compensation = compensated_at.map(|n_dot_v| {
        let table = match shading {
            Shading::CookTorrance => dfg::of_cook_torrance(n_dot_v as f32, slope as f32),
            _ => dfg::of_ggx(n_dot_v as f32, roughness as f32),
        };
        let [scale, bias, edge, diffuse_edge] =
            [table.scale, table.bias, table.edge, table.diffuse_edge].map(f64::from);
        compensation(&Dfg { scale, bias, edge, diffuse_edge }, f0, 1.0, black)
    });
    MaterialSample {
        base_color: white,
        metallic,
        roughness,
        f0,
        f90: 1.0,
        f82_drop: black,
        diffuse: black,
        specular: white,
        shininess: 0.0,
        slope,
        compensation,
    }
}
