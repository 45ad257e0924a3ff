//! WebP, by libwebp.

#[cfg(feature = "webp")]
use crate::error::{Error, Result};

/// The loss of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum WebPLoss {
    /// None.
    Lossless,
    /// None, after a shorter search for repetitions.
    LosslessQuick,
    /// That of a quality, 1 to 100; alpha loses nothing.
    Quality(u8),
}

/// An image to be written.
#[cfg(feature = "webp")]
pub(super) struct WebPImage<'a> {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// RGB, or RGBA where there is alpha.
    pub samples: &'a [u8],
    pub has_alpha: bool,
}

/// Returns the file. libwebp is given one thread, so that its bytes do not depend on their number.
///
/// # Errors
/// [`Error::Invalid`] where a side is longer than 16383 texels.
#[cfg(feature = "webp")]
pub(super) fn encode(image: &WebPImage<'_>, loss: WebPLoss) -> Result<Vec<u8>> {
    let [width, height] = image.size;
    let config = config(loss);
    let bytes = if image.has_alpha {
        config.encode_rgba(image.samples, width, height, webpx::Unstoppable)
    } else {
        config.encode_rgb(image.samples, width, height, webpx::Unstoppable)
    };
    let what = || format!("a texture of {width}×{height} as WebP");
    bytes.map_err(|e| Error::invalid(what(), e.error().to_string()))
}

/// Returns libwebp's options. Colours under clear texels stay, since lookups between texels read them.
#[cfg(feature = "webp")]
fn config(loss: WebPLoss) -> webpx::EncoderConfig {
    /// The effort of 6. Measured on colours of 2048²: 6 takes twice the time, and its file 2 % fewer bytes.
    const SEARCH: u8 = 4;
    /// The effort of the shorter search, of 100. Measured on a normal map of 2048²: it takes 0.70 s, and its file 3.4 %
    /// more bytes, where the usual effort of 75 takes 1.76 s.
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
