//! Small texts: materials in TOML, provenance and options in JSON, light specifications.

use super::seed::Seed;
use anyhow::Result;
use taotie::asset::{BakeOptions, Lod};

const MATERIAL: &str = "preset = 'bronze'\nbase_color = [0.5, 0.25, 0.125]\nalpha = 0.5\nmetallic = 0.75\n\
    roughness = 0.375\nemissive = [0.0, 1.0, 2.0]\nalpha_mode = 'mask'\nalpha_cutoff = 0.25\ndouble_sided = true\n\
    unlit = false\n[maps]\nbase_color = 'none.png'\nnormal_scale = 1.5\ngreen = 'down'\nheight_scale = 0.1\n";
const CLASSIC: &str = "ambient = [0.1, 0.1, 0.1]\ndiffuse = [0.5, 0.5, 0.5]\nspecular = [1, 1, 1]\nshininess = 20\n\
    slope = 0.3\nf0 = [0.9, 0.8, 0.7]\nf82 = [0.9, 0.8, 0.7]\n";
const PROVENANCE: &str = r#"{"@context":{"dc":"http://purl.org/dc/elements/1.1/"},"dc:title":{"@type":"rdf:Alt",
    "rdf:_1":{"@language":"en","@value":"Jue"}},"dc:creator":{"@list":["A","B"]},"dc:rights":"CC0",
    "xmp:CreateDate":"2026-01-01"}"#;
const LIGHT: &str =
    "point at=1,2,3 strength=2\ndirectional from=90,0\nspot at=0,3,0 toward=0,0,0 angle=20 color=red";

/// Returns all texts.
///
/// # Errors
/// If options cannot be written as JSON.
pub fn seeds() -> Result<Vec<Seed>> {
    let options = serde_json::to_vec(&BakeOptions {
        lods: vec![Lod::Triangles(100), Lod::Triangles(50)],
        ..BakeOptions::default()
    })?;
    Ok(vec![
        Seed::single("bronze.toml", MATERIAL),
        Seed::single("classic.toml", CLASSIC),
        Seed::single("rights.provenance", PROVENANCE),
        Seed::single("bake.options", options),
        Seed::single("lights.light", LIGHT),
    ])
}
