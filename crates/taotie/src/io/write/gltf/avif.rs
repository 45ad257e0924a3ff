//! AVIF encoding with `rav1e`.

use crate::error::{Error, Result};
use ravif::{BitDepth, ColorModel, Encoder, Img, RGB8};

/// rav1e's speed setting, 1 (best quality) to 10 (fastest).
const SPEED: u8 = 8;

/// Encodes an image from RGB samples, which are kept as RGB (the identity matrix): decoders round luma and chroma in
/// different ways, each with a bias over flat colours. rav1e gets one thread, so that the result does not depend on
/// the number of threads.
///
/// # Errors
/// [`Error::Invalid`] if rav1e rejects the size.
pub(super) fn encode([width, height]: [u32; 2], samples: &[u8], quality: u8) -> Result<Vec<u8>> {
    let pixels: Vec<RGB8> =
        samples.as_chunks::<3>().0.iter().map(|[r, g, b]| RGB8::new(*r, *g, *b)).collect();
    let encoder = Encoder::new()
        .with_quality(quality.into())
        .with_speed(SPEED)
        .with_bit_depth(BitDepth::Eight)
        .with_internal_color_model(ColorModel::RGB)
        .with_num_threads(Some(1));
    let encoded = encoder.encode_rgb(Img::new(&pixels[..], width as usize, height as usize));
    let what = || format!("{width}×{height} AVIF texture");
    encoded.map(|image| image.avif_file).map_err(|error| Error::invalid(what(), error.to_string()))
}
