//! AVIF, by `rav1e`.

use crate::error::{Error, Result};
use crate::image::Encoding;
use ravif::{BitDepth, ColorModel, Encoder, Img, RGB8};

/// rav1e's effort, 1 (best) to 10 (fastest).
const SPEED: u8 = 8;

/// Returns the file of an image of these samples of red, green and blue, with as many of chroma as of luma. Colours have 10 bits, since
/// luma and chroma of 8 are off by up to a step, always to the same side where a colour is plain. What is no colour keeps its
/// channels apart, in 8 bits. rav1e is given one thread, so that its bytes do not depend on their number.
///
/// # Errors
/// [`Error::Invalid`] if rav1e refuses the size.
pub(super) fn encode(
    [width, height]: [u32; 2],
    samples: &[u8],
    (encoding, quality): (Encoding, u8),
) -> Result<Vec<u8>> {
    let (model, depth) = match encoding {
        Encoding::Srgb => (ColorModel::YCbCr, BitDepth::Ten),
        Encoding::Normal | Encoding::Linear => (ColorModel::RGB, BitDepth::Eight),
    };
    let pixels: Vec<RGB8> =
        samples.as_chunks::<3>().0.iter().map(|[r, g, b]| RGB8::new(*r, *g, *b)).collect();
    let encoder = Encoder::new()
        .with_quality(quality.into())
        .with_speed(SPEED)
        .with_bit_depth(depth)
        .with_internal_color_model(model)
        .with_num_threads(Some(1));
    let encoded = encoder.encode_rgb(Img::new(&pixels[..], width as usize, height as usize));
    let what = || format!("a texture of {width}×{height} as AVIF");
    encoded.map(|image| image.avif_file).map_err(|error| Error::invalid(what(), error.to_string()))
}
