//! Maps with green down, for programs that expect them; the asset's own has green up, as glTF requires.

use super::packing::Packing;
use super::textures::{SeparateMap, Textures};
use crate::bake::MapKind;
use crate::error::{Error, Result};
use crate::image::Bitmap;
use crate::normal_map::green_turned;
use crate::scene::{GreenChannel, NormalSpace};

/// Returns the tangent-space maps of a material with green down, if the packing asks for them.
///
/// # Errors
/// [`Error::Invalid`] if it does, and no such map was baked.
pub(super) fn turned(space: NormalSpace, textures: &Textures, packing: &Packing) -> Result<Vec<SeparateMap>> {
    if packing.green == GreenChannel::Up {
        return Ok(Vec::new());
    }
    let is_tangent = space == NormalSpace::Tangent;
    let turned: Vec<SeparateMap> = tangent_maps(textures)
        .filter(|_| is_tangent)
        .map(|(map, bitmap)| SeparateMap { map, bitmap: green_turned(bitmap), range: None })
        .collect();
    match turned.is_empty() {
        false => Ok(turned),
        true => Err(Error::invalid(
            "green down",
            "needs a normal or bent map in tangent space; bake one, or omit it",
        )),
    }
}

fn tangent_maps(textures: &Textures) -> impl Iterator<Item = (MapKind, &Bitmap)> {
    let bent = textures.separate.iter().filter(|file| file.map == MapKind::Bent);
    let normal = textures.normal.as_ref().map(|bitmap| (MapKind::Normal, bitmap));
    normal.into_iter().chain(bent.map(|file| (file.map, &file.bitmap)))
}
