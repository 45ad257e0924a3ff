//! The samples of all texels: their colours in all photographs that show them lit.

use super::frame::Frame;
use super::layout::Layout;
use super::model::Model;
use super::sight::{Seen, Sight};
use crate::photograph::{Shape, Transfer, decodable, is_transparent};
use crate::samples::white_pixels;
use std::sync::atomic::{AtomicUsize, Ordering};
use taotie_engine::error::{Error, Result};
use taotie_engine::image::{Bitmap, MipFilter, Sampler, Texels, Texture, Wrap};
use taotie_engine::math::{Vec2, scalar};
use taotie_engine::{Progress, parallel};
use taotie_io::{Bytes, Limits, most_threads, read_bitmap_within};

/// The colour of a texel in a photograph.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ColorSample {
    /// The photograph.
    pub frame: u32,
    /// Linear RGB.
    pub color: [f32; 3],
    /// The width of its pixel, or 1 if that is smaller than the texel, in texels.
    pub footprint: f32,
}

/// The samples of a material's texels.
pub struct Gathered {
    /// The first sample of each texel, and the number of all.
    starts: Vec<u32>,
    samples: Vec<ColorSample>,
    /// The texels that each photograph shows.
    pub shown: Vec<usize>,
    /// Samples left out because a pixel is saturated.
    pub saturated: usize,
}

/// How to read photographs.
#[derive(Debug, Clone, Copy)]
pub struct Photos<'a> {
    /// Their cameras and lights.
    pub frames: &'a [Frame],
    /// The encoding of their numbers.
    pub transfer: Transfer,
    /// Limits of memory and image sizes.
    pub limits: Limits,
}

/// A texel's colour in one photograph.
struct Found {
    texel: u32,
    color: [f32; 3],
    footprint: f32,
}

impl Gathered {
    /// Reads all photographs.
    ///
    /// # Errors
    /// Those of reading an image; [`Error::Invalid`] if a photograph has another size than stated; [`Error::Limit`],
    /// [`Error::Cancelled`].
    pub fn new(
        model: &Model,
        layouts: &[Layout],
        photos: &Photos<'_>,
        progress: Progress<'_>,
    ) -> Result<Vec<Self>> {
        let texels: usize = layouts.iter().map(|layout| layout.texels.len()).sum();
        check_memory(texels, photos)?;
        let done = AtomicUsize::new(0);
        let count = photos.frames.len();
        let of_frames = parallel::try_tasks(count, &|k| {
            let photo = Photo::read(&photos.frames[k], photos)?;
            let sight = Sight::new(model, &photos.frames[k], photo.size);
            let found: Vec<(Vec<Found>, usize)> =
                layouts.iter().map(|layout| photo.shows(&sight, layout)).collect();
            progress.at((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / count as f64)?;
            Ok(found)
        })?;
        let of_layout = |(i, layout): (usize, &Layout)| {
            let of_frames: Vec<&(Vec<Found>, usize)> = of_frames.iter().map(|frame| &frame[i]).collect();
            Self::sorted(layout.texels.len(), &of_frames)
        };
        Ok(layouts.iter().enumerate().map(of_layout).collect())
    }

    /// Sorts the samples of all photographs by texel.
    fn sorted(texels: usize, of_frames: &[&(Vec<Found>, usize)]) -> Self {
        let mut starts = vec![0_u32; texels + 1];
        let all = || of_frames.iter().flat_map(|(found, _)| found);
        all().for_each(|found| starts[found.texel as usize + 1] += 1);
        (0..texels).for_each(|i| starts[i + 1] += starts[i]);
        let mut next = starts.clone();
        let mut samples = vec![ColorSample::default(); starts[texels] as usize];
        for (frame, (found, _)) in of_frames.iter().enumerate() {
            for Found { texel, color, footprint } in found {
                let at = &mut next[*texel as usize];
                samples[*at as usize] =
                    ColorSample { frame: frame as u32, color: *color, footprint: *footprint };
                *at += 1;
            }
        }
        let shown = of_frames.iter().map(|(found, _)| found.len()).collect();
        let saturated = of_frames.iter().map(|(_, saturated)| saturated).sum();
        Self { starts, samples, shown, saturated }
    }

    /// Returns the samples of a texel.
    #[inline]
    pub fn of(&self, texel: usize) -> &[ColorSample] {
        &self.samples[self.starts[texel] as usize..self.starts[texel + 1] as usize]
    }
}

/// Rejects work that needs more memory than is allowed.
fn check_memory(texels: usize, photos: &Photos<'_>) -> Result<()> {
    /// A sample, twice while they are sorted.
    const SAMPLE: u64 = 40;
    /// A texel with its estimates and maps.
    const TEXEL: u64 = 800;
    /// A pixel with the decoder's copy and coarser levels.
    const PIXEL: u64 = 32;
    let first = read_bitmap_within(&photos.frames[0].path, &photos.limits)?;
    let pixels = u64::from(first.width()) * u64::from(first.height());
    let threads = most_threads().unwrap_or(16).min(photos.frames.len()) as u64;
    let count = photos.frames.len() as u64;
    let texels = texels as u64;
    // A convex surface is seen and lit in a quarter of all photographs.
    let need = texels * (TEXEL + SAMPLE * count / 4) + pixels * PIXEL * threads;
    if texels * count >= u64::from(u32::MAX) {
        return Err(Error::limit(
            format!("{texels} texels in {count} photographs"),
            "choose a smaller --size",
        ));
    }
    photos.limits.check(format!("{texels} texels in {count} photographs"), Bytes(need))
}

/// A photograph in linear light, with coarser levels.
struct Photo {
    texture: Texture,
    size: [u32; 2],
    /// `true` for each pixel that is transparent or black in the mask; empty if all count.
    left_out: Vec<bool>,
}

impl Photo {
    fn read(frame: &Frame, photos: &Photos<'_>) -> Result<Self> {
        let bitmap = read_bitmap_within(&frame.path, &photos.limits)?;
        let size = [bitmap.width(), bitmap.height()];
        check_size(frame, size)?;
        let left_out = left_out(frame, &bitmap, &photos.limits)?;
        let (bitmap, encoding) = decodable(bitmap, photos.transfer)?;
        Ok(Self { texture: Texture::new(bitmap, encoding), size, left_out })
    }

    /// Returns the colours of the texels that the photograph shows, and the number of those that are saturated.
    fn shows(&self, sight: &Sight<'_>, layout: &Layout) -> (Vec<Found>, usize) {
        let mut saturated = 0;
        let mut found = Vec::new();
        for (i, texel) in layout.texels.iter().enumerate() {
            let Some(seen) = sight.of(texel) else { continue };
            if !self.left_out.is_empty() && pixels(self.size, &seen).any(|i| self.left_out[i]) {
                continue;
            }
            if is_saturated(self.texture.bitmap(), &seen) {
                saturated += 1;
                continue;
            }
            let color = self.color(&seen, texel.width);
            if color.iter().all(|v| v.is_finite()) {
                let footprint = (seen.projected.pixel / texel.width).max(1.0) as f32;
                found.push(Found { texel: i as u32, color, footprint });
            }
        }
        (found, saturated)
    }

    /// Returns the mean colour over a texel.
    fn color(&self, seen: &Seen, width: f64) -> [f32; 3] {
        let sampler =
            Sampler { wrap_u: Wrap::Clamp, wrap_v: Wrap::Clamp, mip: MipFilter::Linear, ..Sampler::BILINEAR };
        let [u, v] = [0, 1].map(|axis| (seen.projected.place[axis] / f64::from(self.size[axis])) as f32);
        let lod = scalar::log2((width / seen.projected.pixel).max(1.0)) as f32;
        let [r, g, b, _] = sampler.sample(&self.texture, Vec2::new(u, v), lod);
        [r, g, b].map(|v| v.max(0.0))
    }
}

/// Rejects a photograph of another size than its lens states.
fn check_size(frame: &Frame, size: [u32; 2]) -> Result<()> {
    let Some(stated) = frame.lens.other_size(size) else { return Ok(()) };
    let what = format!("{}: {}x{} pixels", frame.path.display(), size[0], size[1]);
    let why = format!("`w` and `h` of its camera are {stated}; scale the photograph, or its camera");
    Err(Error::invalid(what, why))
}

/// Returns for each pixel whether it is transparent or black in the mask; nothing if all count.
fn left_out(frame: &Frame, bitmap: &Bitmap, limits: &Limits) -> Result<Vec<bool>> {
    let count = bitmap.texels().len();
    let mut left_out = Vec::new();
    if bitmap.has_alpha() {
        left_out = (0..count).map(|i| is_transparent(bitmap, i)).collect();
    }
    if let Some(path) = &frame.mask {
        let shape = Shape::of(bitmap);
        left_out.resize(count, false);
        // The object may not be in this frame.
        let mut inside = white_pixels(path, shape, limits)?.into_iter().peekable();
        for (i, left_out) in left_out.iter_mut().enumerate() {
            *left_out |= inside.next_if(|next| *next as usize == i).is_none();
        }
    }
    Ok(left_out)
}

/// Returns the pixels that show a texel.
fn pixels([width, height]: [u32; 2], seen: &Seen) -> impl Iterator<Item = usize> + use<> {
    let (place, reach) = (seen.projected.place, seen.reach);
    let range = |axis: usize, size: u32| {
        let last = f64::from(size - 1);
        let [from, to] = [-reach, reach].map(|by| (place[axis] + by).floor().clamp(0.0, last) as usize);
        from..=to
    };
    let (columns, rows) = (range(0, width), range(1, height));
    rows.flat_map(move |y| columns.clone().map(move |x| y * width as usize + x))
}

/// Returns true if a channel of a pixel that shows a texel has the largest code.
fn is_saturated(bitmap: &Bitmap, seen: &Seen) -> bool {
    fn any<T: PartialEq + Copy>(texels: &[[T; 4]], most: T, pixels: impl Iterator<Item = usize>) -> bool {
        let mut pixels = pixels;
        pixels.any(|i| texels[i][..3].contains(&most))
    }
    let pixels = pixels([bitmap.width(), bitmap.height()], seen);
    match bitmap.texels() {
        Texels::U8(texels) => any(texels, u8::MAX, pixels),
        Texels::U16(texels) => any(texels, u16::MAX, pixels),
        Texels::F32(_) => false,
    }
}
