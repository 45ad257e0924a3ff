//! WebP encoding with libwebp.

#[cfg(feature = "webp")]
use crate::error::{Error, Result};

/// The compression of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum WebPLoss {
    /// Lossless.
    Lossless,
    /// Lossless, with a shorter search for repetitions.
    LosslessQuick,
    /// Lossy with a quality from 1 to 100; alpha is lossless.
    Quality(u8),
}

/// An image to be encoded.
#[cfg(feature = "webp")]
pub(super) struct WebPImage<'a> {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// RGB, or RGBA with alpha.
    pub samples: &'a [u8],
    pub has_alpha: bool,
}

/// Encodes the image. libwebp gets one thread, so that the result does not depend on the number of threads.
///
/// # Errors
/// [`Error::Invalid`] if a side is longer than 16383 texels.
#[cfg(feature = "webp")]
pub(super) fn encode(image: &WebPImage<'_>, loss: WebPLoss) -> Result<Vec<u8>> {
    let [width, height] = image.size;
    let config = config(loss);
    let bytes = if image.has_alpha {
        config.encode_rgba(image.samples, width, height, webpx::Unstoppable)
    } else {
        config.encode_rgb(image.samples, width, height, webpx::Unstoppable)
    };
    let what = || format!("{width}×{height} WebP texture");
    bytes.map_err(|e| Error::invalid(what(), e.error().to_string()))
}

/// Returns libwebp's options. Colours of transparent texels are kept, since texture filtering reads them.
#[cfg(feature = "webp")]
fn config(loss: WebPLoss) -> webpx::EncoderConfig {
    /// Encoder effort, of 6. Measured on colours of 2048²: 6 takes twice the time and gives 2 % fewer bytes.
    const SEARCH: u8 = 4;
    /// Encoder effort for the shorter search, of 100. Measured on a normal map of 2048²: it takes 0.70 s and gives
    /// 3.4 % more bytes, while the default effort of 75 takes 1.76 s.
    const QUICK_EFFORT: f32 = 20.0;
    let lossless = webpx::EncoderConfig::new_lossless().exact(true);
    match loss {
        WebPLoss::Lossless => lossless,
        WebPLoss::LosslessQuick => lossless.quality(QUICK_EFFORT),
        WebPLoss::Quality(quality) => {
            webpx::EncoderConfig::new().quality(quality.into()).method(SEARCH).sharp_yuv(true).exact(true)
        }
    }
}
