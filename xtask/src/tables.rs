//! `xtask tables`: generates the directional albedos of the lobes as Rust source.

use crate::generated::{Content, Generated};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;
use taotie::shade::dfg::{COLUMNS, ROWS, column_cosine, integrate, row_roughness};

/// Returns the files with tables in `crates/taotie/src/shade/dfg`.
pub fn generated(root: &Path) -> Generated {
    let folder = root.join("crates/taotie/src/shade/dfg");
    let slope = |roughness: f64| roughness * roughness;
    let files = [
        ("ggx.rs", source("GGX", &table(integrate::ggx))),
        ("cook_torrance.rs", source("Cook-Torrance", &table(|v, r| integrate::cook_torrance(v, slope(r))))),
        ("sheen.rs", source("Sheen", &table(|v, r| [integrate::sheen(v, r)]))),
    ];
    let files = files.map(|(name, text)| (folder.join(name), Content::Text(text))).into();
    Generated { files, folder: None }
}

/// Returns a table with rows of ascending roughness, each with ascending n·v.
fn table<const N: usize>(numbers: impl Fn(f64, f64) -> [f64; N] + Sync) -> Vec<[f64; N]> {
    let node = |k: usize| numbers(column_cosine(k % COLUMNS), row_roughness(k / COLUMNS));
    (0..COLUMNS * ROWS).into_par_iter().map(node).collect()
}

fn source<const N: usize>(lobe: &str, table: &[[f64; N]]) -> String {
    let mut text = format!(
        "//! {lobe}'s table. Made by `cargo run -p xtask -- tables`: do not edit.\n\n\
         use super::{{COLUMNS, ROWS}};\n\n\
         #[rustfmt::skip]\n\
         pub(super) static TABLE: [[f32; {N}]; COLUMNS * ROWS] = [\n"
    );
    for row in table.chunks(COLUMNS) {
        let nodes: Vec<String> = row.iter().map(|node| entry(node)).collect();
        let _ = writeln!(text, "    {},", nodes.join(", "));
    }
    text.push_str("];\n");
    text
}

/// Formats an entry with six decimals, as short as `f32` allows.
fn entry(node: &[f64]) -> String {
    let numbers: Vec<String> =
        node.iter().map(|value| format!("{:?}", ((value * 1e6).round() / 1e6) as f32)).collect();
    format!("[{}]", numbers.join(", "))
}
