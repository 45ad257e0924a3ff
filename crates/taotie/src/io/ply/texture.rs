//! The texture that a comment in the header names.

use super::super::{Loaded, locate, read_bitmap};
use crate::error::Warnings;
use crate::image::{Encoding, Sampler, Texture};
use crate::scene::{TextureRef, UvTransform};
use ply_rs_bw::ply::Header;
use std::path::Path;

/// The file that the header names.
pub(super) fn name<'a>(header: &'a Header, warnings: &mut Warnings) -> Option<&'a str> {
    let mut names = header.comments.iter().filter_map(|c| c.trim().strip_prefix("TextureFile"));
    let first = names.next()?.trim();
    warnings.note("texture files beyond the first are not used", names.count());
    Some(first)
}

/// Returns how the material reads the only texture.
pub(super) fn whole() -> TextureRef {
    let (sampler, transform) = (Sampler::default(), UvTransform::default());
    TextureRef { texture: 0, uv_set: 0, sampler, transform }
}

/// Reads the file `name` beside the model; what cannot be had is noted.
pub(super) fn load(path: &Path, name: &str, loaded: &mut Loaded) -> Option<Texture> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let Some(file) = locate::find(name, &[folder]) else {
        loaded.warnings.note(format!("texture '{name}' is left out: it is not there"), 1);
        loaded.missing_files.push(name.to_owned());
        return None;
    };
    loaded.files.push(file.clone());
    match read_bitmap(&file) {
        Ok(bitmap) => {
            loaded.texture_names.push(name.to_owned());
            Some(Texture::new(bitmap, Encoding::Srgb))
        }
        Err(error) => {
            loaded.warnings.note(format!("texture '{name}' is left out: {error}"), 1);
            None
        }
    }
}
