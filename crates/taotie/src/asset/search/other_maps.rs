//! The size and the losses of maps that are not of normals.

use super::encodings::Encodings;
use super::goal::Goal;
use super::trial::Trial;
use super::winner::Best;
use super::workshop::{Draft, Losses, PIXELS, Shape, Workshop};
use crate::error::Result;
use crate::image::{Bitmap, Encoding};
use crate::io::{Lossy, LossyTexture, VertexBits};
use crate::progress::Progress;
use crate::proof::{Relook, Side};

/// Sizes that are tried, on a mesh of so many triangles.
const SIZES: [u32; 5] = [256, 512, 1024, 2048, 4096];
const TRIANGLES: u32 = 8_000;
/// The ratio of colours that lose as good as nothing, and the largest one of those that are chosen: the rest is for fewer
/// triangles.
const LEAST_LOSS: f64 = 0.2;
const MOST: f64 = 0.95;

/// Chooses the least size at which colours are near enough, and what maps then lose. Returns that size, 0 if there are no maps
/// but that of normals; `None` if such maps alone are larger than the best candidate.
pub(super) fn chosen(
    workshop: &mut Workshop<'_>,
    best: &Best,
    progress: Progress<'_>,
) -> Result<Option<u32>> {
    if !workshop.has_other_maps() {
        return Ok(Some(0));
    }
    let triangles = TRIANGLES.min(workshop.triangles());
    let most = workshop.most_side();
    for size in SIZES.into_iter().filter(|size| *size <= most) {
        let shape = Shape { triangles, size, has_normal_map: false };
        let Some(draft) = workshop.draft(shape, progress)? else { continue };
        let trial = choose_losses(workshop, &draft)?;
        let of_maps = trial.bytes.saturating_sub(draft.mesh_bytes(VertexBits::default())?);
        if of_maps as f64 > best.bytes() {
            return Ok(None);
        }
        if trial.color_ratio.is_none_or(|ratio| ratio <= 1.0) {
            return Ok(Some(size));
        }
    }
    Ok(best.bytes().is_infinite().then_some(most.min(SIZES[SIZES.len() - 1])))
}

/// Chooses what the maps of a draft lose, and returns the trial with it.
fn choose_losses(workshop: &mut Workshop<'_>, draft: &Draft) -> Result<Trial> {
    let surface = workshop.surface(draft)?;
    let side = Side::of(&surface);
    let look = Relook::new(&side, PIXELS);
    let texture = |bitmap: &Option<Bitmap>, encoding: Encoding| {
        bitmap.as_ref().map(|bitmap| LossyTexture::new(bitmap.clone(), encoding))
    };
    let textures = &draft.maps.textures;
    let (colors, numbers) =
        (texture(&textures.color, Encoding::Srgb), texture(&textures.orm, Encoding::Linear));
    let colors = encodings(colors.as_ref(), &look, &workshop.goal)?;
    let numbers = encodings(numbers.as_ref(), &look, &workshop.goal)?;
    let loss = |of: &Option<Encodings<'_>>, most: f64| -> Result<Option<Lossy>> {
        let found = of.as_ref().map(|of| of.smallest_of(draft.shape.size, most)).transpose()?;
        Ok(found.flatten().and_then(|found| found.loss))
    };
    let (near, numbers) = (loss(&colors, LEAST_LOSS)?, loss(&numbers, 1.0)?);
    workshop.losses = Losses { normals: None, colors: near, numbers };
    let bits = VertexBits::default();
    let exact = workshop.trial(draft, workshop.rounding(bits, None))?;
    let Some(of_size) = exact.color_ratio.filter(|ratio| *ratio <= MOST) else { return Ok(exact) };
    let far = loss(&colors, (MOST * MOST - of_size * of_size).sqrt().max(LEAST_LOSS))?;
    if far == near {
        return Ok(exact);
    }
    workshop.losses.colors = far;
    let lossy = workshop.trial(draft, workshop.rounding(bits, None))?;
    if lossy.color_ratio.is_none_or(|ratio| ratio <= 1.0) {
        return Ok(lossy);
    }
    workshop.losses.colors = near;
    Ok(exact)
}

/// Returns the encodings of a texture of the surface that is looked at; `None` if there is none.
fn encodings<'a>(
    texture: Option<&'a LossyTexture>,
    look: &'a Relook<'a>,
    goal: &Goal,
) -> Result<Option<Encodings<'a>>> {
    let Some(texture) = texture else { return Ok(None) };
    Ok(look.first(texture.encoding())?.map(|look| Encodings::new(texture, look, goal)))
}
