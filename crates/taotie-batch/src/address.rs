//! Content addresses: the SHA-256 of everything that a file depends on.

use crate::input::InputFile;
use crate::settings::AssetSettings;
use serde::Serialize;
use sha2::{Digest, Sha256};

/// The version of the program; files depend on it too.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Returns the address of an asset's files: the hash of its input, its settings and the version.
pub fn of_asset(settings: &AssetSettings, input: &[InputFile]) -> String {
    let input: Vec<_> = input.iter().map(|file| [&file.name, &file.sha256]).collect();
    of(&("asset", VERSION, settings.with_names(), input))
}

/// Returns the address of files derived from the asset with the address `asset`.
pub fn of_derived(kind: &str, settings: &impl Serialize, asset: &str) -> String {
    of(&(kind, VERSION, settings, asset))
}

/// Returns the SHA-256 of a value as JSON, hexadecimal. Struct fields are hashed in declaration order.
pub fn of(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value).expect("all keys are text");
    hexadecimal(&Sha256::digest(text))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie::asset::{BakeOptions, MeshSource};

    fn file(name: &str, sha256: &str) -> InputFile {
        InputFile { name: name.into(), sha256: sha256.into(), bytes: 1, ..InputFile::default() }
    }

    #[test]
    fn an_address_depends_on_content_names_and_options_and_on_no_folder() {
        let low = |path: &str| AssetSettings {
            bake: BakeOptions { low: Some(MeshSource::File(path.into())), ..BakeOptions::default() },
            ..AssetSettings::default()
        };
        let address = of_asset(&low("a/low.glb"), &[file("x.ply", "1")]);
        assert_eq!(address.len(), 64);
        assert_eq!(address, of_asset(&low("b/low.glb"), &[file("x.ply", "1")]));
        let others = [
            of_asset(&low("a/other.glb"), &[file("x.ply", "1")]),
            of_asset(&low("a/low.glb"), &[file("y.ply", "1")]),
            of_asset(&low("a/low.glb"), &[file("x.ply", "2")]),
            of_asset(&low("a/low.glb"), &[file("x.ply", "1"), file("x.png", "1")]),
            of_asset(&AssetSettings { report: true, ..low("a/low.glb") }, &[file("x.ply", "1")]),
        ];
        assert!(others.iter().all(|other| *other != address));
        assert_ne!(of_derived("thumbnail", &1, &address), of_derived("turntable", &1, &address));
    }
}
