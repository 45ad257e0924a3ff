//! `xtask tables`: generates the directional albedos of the lobes as Rust source.

use crate::generated::{Content, Generated};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;
use taotie_engine::shade::dfg::{COLUMNS, ROWS, column_cosine, row_roughness};
use taotie_engine::shade::furnace;

/// Returns the file with the tables in `crates/taotie-engine/src/shade/dfg`.
pub fn generated(root: &Path) -> Generated {
    let slope = |roughness: f64| roughness * roughness;
    let tables = [
        source("GGX", "GGX", &table(furnace::dfg_of_ggx)),
        source("COOK_TORRANCE", "Cook-Torrance", &table(|v, r| furnace::dfg_of_cook_torrance(v, slope(r)))),
        source("SHEEN", "Sheen", &table(|v, r| [furnace::albedo_of_sheen(v, r)])),
    ];
    let header = "//! Tables of directional albedos. Made by `cargo run -p xtask -- tables`: do not edit.\n";
    let file = root.join("crates/taotie-engine/src/shade/dfg/albedos.rs");
    let text = header.to_owned() + &tables.concat();
    Generated { files: [(file, Content::Text(text))].into(), folder: None }
}

/// Returns a table with rows of ascending roughness, each with ascending n·v.
fn table<const N: usize>(numbers: impl Fn(f64, f64) -> [f64; N] + Sync) -> Vec<[f64; N]> {
    let node = |k: usize| numbers(column_cosine(k % COLUMNS), row_roughness(k / COLUMNS));
    (0..COLUMNS * ROWS).into_par_iter().map(node).collect()
}

/// Returns the source of the static `name`, the table of a `lobe`.
fn source<const N: usize>(name: &str, lobe: &str, table: &[[f64; N]]) -> String {
    let mut text = format!(
        "\n/// {lobe}'s table.\n\
         #[rustfmt::skip]\n\
         pub(super) static {name}: [[f32; {N}]; {}] = [\n",
        COLUMNS * ROWS
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
