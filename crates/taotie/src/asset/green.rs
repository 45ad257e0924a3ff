//! Maps with green down, for programs that read them so; the asset's own points up, as glTF demands.

use super::packing::Packing;
use super::textures::{Beside, Textures};
use crate::bake::MapKind;
use crate::error::{Error, Result};
use crate::image::Bitmap;
use crate::normal_map::green_turned;
use crate::scene::{GreenChannel, NormalSpace};

/// Returns the tangent-space maps of a material with green down, where the packing asks for them.
///
/// # Errors
/// [`Error::Invalid`] where it does, and no such map was baked.
pub(super) fn turned(space: NormalSpace, textures: &Textures, packing: &Packing) -> Result<Vec<Beside>> {
    if packing.green == GreenChannel::Up {
        return Ok(Vec::new());
    }
    let is_tangent = space == NormalSpace::Tangent;
    let turned: Vec<Beside> = tangent_maps(textures)
        .filter(|_| is_tangent)
        .map(|(map, bitmap)| Beside { map, bitmap: green_turned(bitmap), range: None })
        .collect();
    match turned.is_empty() {
        false => Ok(turned),
        true => Err(Error::invalid(
            "green down",
            "no normal or bent map in tangent space is baked; bake one, or leave it out",
        )),
    }
}

fn tangent_maps(textures: &Textures) -> impl Iterator<Item = (MapKind, &Bitmap)> {
    let bent = textures.beside.iter().filter(|beside| beside.map == MapKind::Bent);
    let normal = textures.normal.as_ref().map(|bitmap| (MapKind::Normal, bitmap));
    normal.into_iter().chain(bent.map(|beside| (beside.map, &beside.bitmap)))
}
