//! AVIF, by `rav1e`.

use crate::error::{Error, Result};
use ravif::{BitDepth, ColorModel, Encoder, Img, RGB8};

/// rav1e's effort, 1 (best) to 10 (fastest).
const SPEED: u8 = 8;

/// Returns the file of an image of these samples of red, green and blue, which stay apart (the identity matrix): decoders round luma and chroma
/// in different ways, each with a bias over flat colours. rav1e is given one thread, so that its bytes do not depend on their number.
///
/// # Errors
/// [`Error::Invalid`] if rav1e refuses the size.
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
    let what = || format!("a texture of {width}×{height} as AVIF");
    encoded.map(|image| image.avif_file).map_err(|error| Error::invalid(what(), error.to_string()))
}
