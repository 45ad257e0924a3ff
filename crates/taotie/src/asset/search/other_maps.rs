//! The size and the losses of maps that are not of normals.

use super::encodings::{Encodings, first_of};
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
    let (textures, goal) = (&draft.maps.textures, workshop.goal.clone());
    let surface = workshop.surface(draft)?;
    let side = Side::of(&surface);
    let look = Relook::new(&side, PIXELS);
    let loss = |bitmap: &Option<Bitmap>, encoding: Encoding, most: f64| -> Result<Option<Lossy>> {
        let (Some(bitmap), Some(shown)) = (bitmap, first_of(&surface, encoding)) else { return Ok(None) };
        let texture = LossyTexture::new(bitmap.clone(), encoding);
        let found = Encodings::new(&texture, look.at(shown)?, &goal).smallest_of(draft.shape.size, most)?;
        Ok(found.and_then(|found| found.loss))
    };
    let numbers = loss(&textures.orm, Encoding::Linear, 1.0)?;
    let colors = |most: f64| loss(&textures.color, Encoding::Srgb, most);
    let (near, normals) = (colors(LEAST_LOSS)?, None);
    let with = |colors: Option<Lossy>| Losses { normals, colors, numbers };
    let remaining = |trial: &Trial| {
        let of_size = trial.color_ratio.unwrap_or_default();
        (MOST * MOST - of_size * of_size).max(0.0).sqrt()
    };
    workshop.losses = with(near);
    let exact = workshop.trial(draft, workshop.rounding(VertexBits::default(), None))?;
    let far = colors(remaining(&exact).max(LEAST_LOSS))?;
    if exact.color_ratio.is_none_or(|ratio| ratio > MOST) || far == near {
        return Ok(exact);
    }
    workshop.losses = with(far);
    let lossy = workshop.trial(draft, workshop.rounding(VertexBits::default(), None))?;
    if !lossy.color_ratio.is_none_or(|ratio| ratio <= 1.0) {
        workshop.losses = with(near);
        return Ok(exact);
    }
    Ok(lossy)
}
