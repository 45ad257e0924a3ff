//! The file formats of the pictures of a run.

use anyhow::{Result, bail};
use std::path::Path;
use taotie_io::{AnimationFormat, ImageFormat};

/// The file formats of the pictures of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Formats {
    /// The format of each picture.
    pub still: ImageFormat,
    /// The format of the animation, if there are several pictures and the format supports one.
    pub moving: Option<AnimationFormat>,
}

impl Formats {
    /// Chooses the formats by the extension of the output, the bits per channel of a PNG, and whether there are
    /// several pictures.
    pub fn of(output: &Path, bits: Option<&str>, several: bool) -> Result<Self> {
        let extension = output.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let png = if bits == Some("16") { ImageFormat::Png16 } else { ImageFormat::Png8 };
        let (still, moving) = match extension.as_str() {
            "png" => (png, Some(AnimationFormat::Png)),
            "gif" => (png, Some(AnimationFormat::Gif)),
            "exr" => (ImageFormat::Exr, None),
            _ => bail!(
                "{}: pictures are written as .png or .exr, animations as .png or .gif",
                output.display()
            ),
        };
        if !several && moving == Some(AnimationFormat::Gif) {
            let path = output.display();
            bail!("{path}: a .gif holds an animation; add --turntable, --frames or --fps, or write a .png");
        }
        Ok(Self { still, moving: moving.filter(|_| several) })
    }
}
