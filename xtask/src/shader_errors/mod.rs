//! `docs/shaders.md`: the differences between the shaders and the pixel program in `f64` at random points, on
//! emulated GPUs.

mod cases;
mod harness;
mod inputs;
mod lighting;
mod points;
mod random;
mod reference;
mod tally;
mod vulkan;
mod webgl;

use crate::computed;
use crate::generated::Generated;
use anyhow::Result;
use cases::Case;
use inputs::{Draw, Inputs};
use rayon::prelude::*;
use reference::Scene;
use std::path::Path;
use tally::Tally;
use taotie_engine::math::Number;
use taotie_engine::names::Named;
use vulkan::Vulkan;
use webgl::WebGl;

const PAGE: &str = "docs/shaders.md";

/// Rows of 256 points under each of the five kinds of light: 102,400 in all.
const ROWS: usize = 80;

/// The differences of a surface from the pixel program in `f64`.
struct Measured {
    case: Case,
    /// The pixel program in `f32`.
    single: Tally,
    wgsl: Tally,
    glsl: Tally,
}

/// The measurements, and the drivers used.
struct Run {
    measured: Vec<Measured>,
    vulkan: String,
    browser: String,
    points: usize,
}

/// Returns the page with its table updated, below the repository's `root`.
///
/// # Errors
/// If there is no Vulkan driver or no Chromium, if they reject a shader, or if the page cannot be read.
pub fn generated(root: &Path) -> Result<Generated> {
    let table = run(root, &cases::all(), ROWS)?.table();
    computed::page(root, PAGE, |name| (name == "points").then(|| table.clone()))
}

/// Measures surfaces at `rows` rows of points under each kind of light.
fn run(root: &Path, cases: &[Case], rows: usize) -> Result<Run> {
    let inputs = Inputs::new(rows);
    let (vulkan, browser) = (Vulkan::new(&inputs)?, WebGl::find(root)?);
    let drawn = browser.radiance(cases, &inputs)?;
    let measured = cases.iter().enumerate().map(|(number, case)| {
        let truth = radiance::<f64>(case, &inputs);
        let single = radiance::<f32>(case, &inputs).into_iter().map(|color| color.map(f64::from));
        let shaded = |texels: Vec<[f32; 4]>| {
            let colors = texels.into_iter().map(|[r, g, b, _]| [r, g, b].map(f64::from));
            Tally::new(&truth, colors)
        };
        Ok(Measured {
            case: *case,
            wgsl: shaded(vulkan.radiance(case)?),
            glsl: shaded(drawn.radiance(number)?),
            single: Tally::new(&truth, single),
        })
    });
    let measured = measured.collect::<Result<_>>()?;
    Ok(Run { measured, vulkan: vulkan.name.clone(), browser: browser.name()?, points: inputs.points() })
}

/// Returns the radiance of all points by the pixel program, draw by draw.
fn radiance<L: Number + From<f32> + Send>(case: &Case, inputs: &Inputs) -> Vec<[L; 3]> {
    let materials = inputs.materials(case);
    let draws = inputs.draws.iter().zip(&materials);
    let scenes = draws.map(|(Draw { points, lighting }, material)| Scene {
        case,
        material,
        points,
        lighting,
        sky: &inputs.sky,
    });
    let all = |scene: Scene<'_>| {
        let points = (0..scene.points.len()).into_par_iter();
        points.map(|at| scene.radiance::<L>(at).to_array()).collect::<Vec<_>>()
    };
    scenes.flat_map(all).collect()
}

impl Run {
    fn table(&self) -> String {
        let Self { vulkan, browser, points, .. } = self;
        let mut text = format!(
            "{points} points of each surface. WGSL by {vulkan}; GLSL ES by {browser} (WebGL 2, SwiftShader).\n\n\
             | model | method | layers | `f32`: largest | mean | WGSL: largest | mean | GLSL ES: largest | mean |\n\
             |---|---|---|---:|---:|---:|---:|---:|---:|\n"
        );
        self.measured.iter().for_each(|measured| text += &measured.row());
        text + &format!("\nDifferences above 1e-3: {}.\n", self.beyond())
    }

    /// Returns the numbers of channels of all surfaces that differ by more than 1e-3.
    fn beyond(&self) -> String {
        let beyond = |side: fn(&Measured) -> &Tally| -> usize {
            self.measured.iter().map(|measured| side(measured).beyond).sum()
        };
        let [single, wgsl, glsl] =
            [beyond(|all| &all.single), beyond(|all| &all.wgsl), beyond(|all| &all.glsl)];
        format!("`f32` {single}, WGSL {wgsl}, GLSL ES {glsl}")
    }
}

impl Measured {
    fn row(&self) -> String {
        let Self { case, single, wgsl, glsl } = self;
        let (model, method, layers) = (case.shading.name(), case.method_name(), case.layers.name);
        format!("| `{model}` | `{method}` | {layers} | {single} | {wgsl} | {glsl} |\n")
    }
}

#[cfg(test)]
mod tests;
