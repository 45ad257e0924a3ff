//! The size and losses of maps other than normal maps.

use super::encodings::Encodings;
use super::trial::Trial;
use super::winner::Best;
use super::workshop::{Draft, Shape, Workshop};
use crate::error::Result;
use crate::image::{Bitmap, Encoding};
use crate::io::{ImageCodec, LossyTexture, TextureCodecs, VertexBits};
use crate::progress::Progress;
use crate::proof::{Relook, Side};

/// The sizes tried for the finest level, and the triangles of the mesh they are tried on.
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
const TRIANGLES: u32 = 8_000;
/// If a size has more than this fraction of the colour error of the size before, it is not worth its bytes: the mesh
/// is the cause.
const WORTH: f64 = 0.85;
/// The ratio of colours with a negligible loss, and the largest one that is chosen: the rest is for fewer triangles.
const LEAST_LOSS: f64 = 0.2;
const MOST: f64 = 0.95;

/// Chooses the smallest size at which colours are close enough, and the losses of maps at it. Returns that size, 0 if
/// there are only normal maps; `None` if these maps by themselves are larger than the best candidate. If no size is
/// close enough, it is the one beyond which colours hardly improve.
pub(super) fn chosen(
    workshop: &mut Workshop<'_>,
    best: &Best,
    progress: Progress<'_>,
) -> Result<Option<u32>> {
    if !workshop.has_other_maps() {
        return Ok(Some(0));
    }
    let triangles = workshop.level().triangles(TRIANGLES).min(workshop.triangles());
    let (level, most) = (workshop.level(), workshop.most_side());
    let mut before: Option<(u32, f64)> = None;
    for size in SIZES.into_iter().map(|size| level.side(size)).filter(|size| *size <= most) {
        let shape = Shape { triangles, size, has_normal_map: false };
        let Some(draft) = workshop.draft(shape, progress)? else { continue };
        let trial = choose_losses(workshop, &draft)?;
        let of_maps =
            trial.bytes.saturating_sub(draft.mesh_bytes(VertexBits::default(), workshop.codecs().set)?);
        if of_maps as f64 > best.bytes() {
            return Ok(None);
        }
        let Some(ratio) = trial.color_ratio.filter(|ratio| *ratio > 1.0) else { return Ok(Some(size)) };
        if before.is_some_and(|(_, known)| ratio > WORTH * known) {
            break;
        }
        before = Some((size, ratio));
    }
    let size = before.map_or(most.min(level.side(SIZES[SIZES.len() - 1])), |(size, _)| size);
    Ok(best.bytes().is_infinite().then_some(size))
}

/// Chooses the losses of a draft's maps, and returns the trial with them.
fn choose_losses(workshop: &mut Workshop<'_>, draft: &Draft) -> Result<Trial> {
    let surface = workshop.surface(draft)?;
    let side = Side::of(&surface);
    let look = Relook::new(&side, workshop.picture());
    let texture = |bitmap: &Option<Bitmap>, encoding: Encoding| {
        bitmap.as_ref().map(|bitmap| LossyTexture::new(bitmap.clone(), encoding))
    };
    let textures = &draft.maps.textures;
    let (colors, numbers) =
        (texture(&textures.color, Encoding::Srgb), texture(&textures.orm, Encoding::Linear));
    let colors = encodings(colors.as_ref(), &look, workshop)?;
    let numbers = encodings(numbers.as_ref(), &look, workshop)?;
    let least = workshop.codecs().least_lossy();
    let codec = |of: &Option<Encodings<'_>>, most: f64| -> Result<ImageCodec> {
        let found = of.as_ref().map(|of| of.smallest_of(draft.shape.size, most)).transpose()?;
        Ok(found.flatten().map_or(least, |found| found.codec))
    };
    let (near, numbers) = (codec(&colors, LEAST_LOSS)?, codec(&numbers, 1.0)?);
    workshop.images = TextureCodecs { colors: near, normals: least, numbers };
    let bits = VertexBits::default();
    let exact = workshop.trial(draft, workshop.rounding(bits, least))?;
    let Some(of_size) = exact.color_ratio.filter(|ratio| *ratio <= MOST) else { return Ok(exact) };
    let far = codec(&colors, (MOST * MOST - of_size * of_size).sqrt().max(LEAST_LOSS))?;
    if far == near {
        return Ok(exact);
    }
    workshop.images.colors = far;
    let lossy = workshop.trial(draft, workshop.rounding(bits, least))?;
    if lossy.color_ratio.is_none_or(|ratio| ratio <= 1.0) {
        return Ok(lossy);
    }
    workshop.images.colors = near;
    Ok(exact)
}

/// Returns the encodings of a texture of the examined surface; `None` if there is none.
fn encodings<'a>(
    texture: Option<&'a LossyTexture>,
    look: &'a Relook<'a>,
    workshop: &Workshop<'_>,
) -> Result<Option<Encodings<'a>>> {
    let Some(texture) = texture else { return Ok(None) };
    let limits = (&workshop.goal, workshop.codecs());
    Ok(look.first(texture.encoding())?.map(|look| Encodings::new(texture, look, limits)))
}
