//! The texture specified by a comment in the header.

use super::super::bitmap::read_map;
use super::super::reading::Reading;
use super::super::texture_room::texture;
use super::super::{Loaded, locate};
use crate::error::Warnings;
use crate::image::{Encoding, Sampler, Texture};
use crate::scene::{TextureRef, UvTransform};
use ply_rs_bw::ply::Header;

/// Returns the texture file specified in the header.
pub(super) fn name<'a>(header: &'a Header, warnings: &mut Warnings) -> Option<&'a str> {
    let mut names = header.comments.iter().filter_map(|c| c.trim().strip_prefix("TextureFile"));
    let first = names.next()?.trim();
    warnings.note("ignored texture files beyond the first", names.count());
    Some(first)
}

/// Returns a reference to the only texture, unscaled.
pub(super) fn whole() -> TextureRef {
    let (sampler, transform) = (Sampler::default(), UvTransform::default());
    TextureRef { texture: 0, uv_set: 0, sampler, transform }
}

/// Reads the file `name` next to the model; failures are noted.
pub(super) fn load(reading: &Reading, name: &str, loaded: &mut Loaded) -> Option<Texture> {
    let file = locate::find(name, &[reading.folder()], reading);
    let file = file.and_then(|file| file.ok_or_else(|| "file not found".to_owned()));
    let file = match file {
        Ok(file) => file,
        Err(why) => {
            loaded.warnings.note(format!("skipped texture '{name}': {why}"), 1);
            loaded.missing_files.push(name.to_owned());
            return None;
        }
    };
    loaded.files.push(file.clone());
    match read_map(&file, reading) {
        Ok(bitmap) => {
            loaded.texture_names.push(name.to_owned());
            texture(reading, bitmap, Encoding::Srgb)
        }
        Err(error) => {
            loaded.warnings.note(format!("skipped texture '{name}': {error}"), 1);
            None
        }
    }
}
