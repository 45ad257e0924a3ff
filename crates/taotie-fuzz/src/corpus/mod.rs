//! The sound files that damage starts from: built by code, from the library's tests, and from a user's folder.

mod folder;
mod gltf;
mod pictures;
mod scans;
mod seed;
mod texts;

use anyhow::Result;
use std::path::Path;

pub use seed::Seed;

/// Returns all sound files: those built by code, and those in `folder`, always in the same order.
///
/// # Errors
/// If the folder cannot be read.
pub fn seeds(folder: Option<&Path>) -> Result<Vec<Seed>> {
    let mut seeds = scans::seeds();
    seeds.extend(gltf::seeds());
    seeds.extend(pictures::seeds()?);
    seeds.extend(texts::seeds()?);
    if let Some(folder) = folder {
        seeds.extend(folder::seeds(folder)?);
    }
    Ok(seeds)
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
                "gltf" | "glb" | "obj" | "ply" | "stl" => load_model(&path).map(drop),
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
