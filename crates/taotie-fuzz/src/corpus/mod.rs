//! The sound files that damage starts from: built by code, from the library's tests, and from a user's folder.

mod models;
mod pictures;
mod seed;

use anyhow::Result;
use std::path::Path;
use taotie::asset::{BakeOptions, Lod};

pub use seed::Seed;

/// Returns all sound files: those built by code, and those in `folder`, always in the same order.
///
/// # Errors
/// If the folder cannot be read.
pub fn seeds(folder: Option<&Path>) -> Result<Vec<Seed>> {
    let mut seeds = models::scans();
    seeds.extend(models::gltf());
    seeds.extend(pictures::seeds()?);
    seeds.extend(texts()?);
    if let Some(folder) = folder {
        seeds.extend(seed::seeds_in(folder)?);
    }
    Ok(seeds)
}

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

/// Returns small texts: materials in TOML, provenance and options in JSON, light specifications.
///
/// # Errors
/// If options cannot be written as JSON.
fn texts() -> Result<Vec<Seed>> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::Target;
    use clap::ValueEnum;
    use taotie::asset::Packing;
    use taotie::studio::{LightSpec, MaterialFile};
    use taotie_engine::shade::environment::Environment;
    use taotie_io::{decode_bitmap, load_model};

    /// If a file were refused from the start, nothing after its reader's first check would be tested.
    #[test]
    fn every_seed_is_sound() {
        let folder = tempfile::tempdir().unwrap();
        for seed in seeds(None).unwrap() {
            let path = folder.path().join(&seed.name);
            std::fs::write(&path, &seed.bytes).unwrap();
            let result = match seed.extension().as_str() {
                "gltf" | "glb" | "obj" | "ply" | "stl" | "fbx" => load_model(&path).map(drop),
                "toml" => MaterialFile::choose(&path.to_string_lossy()).map(drop),
                "provenance" => Packing { provenance: Some(path), ..Packing::default() }.check(),
                "environment" => Environment::from_bytes(&seed.bytes).map(drop),
                "light" => String::from_utf8_lossy(&seed.bytes)
                    .lines()
                    .try_for_each(|l| l.parse::<LightSpec>().map(drop)),
                "mtl" | "options" => Ok(()),
                _ => decode_bitmap(&seed.bytes, &seed.name, &path).map(drop),
            };
            result.unwrap_or_else(|error| panic!("{}: {error}", seed.name));
        }
    }

    #[test]
    fn every_target_has_seeds_and_every_seed_a_target_and_a_unique_name() {
        let seeds = seeds(None).unwrap();
        for target in Target::value_variants() {
            assert!(seeds.iter().any(|seed| target.takes(seed)), "{target:?}");
        }
        for seed in &seeds {
            assert!(Target::value_variants().iter().any(|target| target.takes(seed)), "{}", seed.name);
            assert_eq!(seeds.iter().filter(|other| other.name == seed.name).count(), 1, "{}", seed.name);
        }
    }
}
