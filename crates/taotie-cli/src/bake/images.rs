//! `--images`: the formats of textures.

use crate::options;
use taotie_engine::Error;
use taotie_engine::names::Named;
use taotie_io::{CodecKind, TextureCodecs};

/// The formats of textures: candidates for a search, or fixed ones.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Images {
    /// The program's choice.
    Auto,
    /// Candidate formats; a search chooses the quality.
    Kinds(Vec<CodecKind>),
    /// Formats with a given quality.
    Given(TextureCodecs),
}

impl Images {
    /// Returns the formats to choose from; empty for the program's choice.
    pub fn kinds(&self) -> Vec<CodecKind> {
        match self {
            Self::Kinds(kinds) => kinds.clone(),
            Self::Auto | Self::Given(_) => Vec::new(),
        }
    }

    /// Returns the formats of a bake without a search.
    ///
    /// # Errors
    /// Several formats, and JPEG or AVIF without a quality.
    pub fn codecs(&self) -> Result<TextureCodecs, String> {
        match self {
            Self::Auto => Ok(TextureCodecs::default()),
            Self::Given(codecs) => Ok(*codecs),
            Self::Kinds(kinds) => match kinds[..] {
                [kind] => {
                    let without = || format!("specify a quality, such as {}:85", kind.name());
                    let codec = kind.least_lossy().ok_or_else(without)?;
                    Ok(codec.into())
                }
                _ => Err("these options run no search; specify one format".into()),
            },
        }
    }
}

/// Parses `auto`, names of formats separated by commas, or formats with their quality.
pub fn images(text: &str) -> Result<Images, String> {
    if text == "auto" {
        return Ok(Images::Auto);
    }
    let is_no_name = |name: &str| name.trim() == "auto" || name.contains([':', '/']);
    if text.contains(',') && text.split(',').any(is_no_name) {
        return Err(
            "a list takes names only: write webp,png, or one format with its quality, such as webp:85".into(),
        );
    }
    if text.contains([':', '/']) {
        return text.parse().map(Images::Given).map_err(|error: Error| error.to_string());
    }
    let mut kinds = text.split(',').map(options::named).collect::<Result<Vec<CodecKind>, _>>()?;
    kinds.sort_unstable();
    kinds.dedup();
    Ok(Images::Kinds(kinds))
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_io::ImageCodec;

    #[test]
    fn sets_and_formats_are_told_apart() {
        assert_eq!(images("auto"), Ok(Images::Auto));
        assert_eq!(images("webp, png,webp"), Ok(Images::Kinds(vec![CodecKind::Png, CodecKind::WebP])));
        assert_eq!(images("webp:85"), Ok(Images::Given(ImageCodec::LossyWebP(85).into())));
        assert!(images("webp:85,png").is_err() && images("gif").is_err());
        let codecs = |text: &str| images(text).unwrap().codecs();
        assert_eq!(codecs("ktx2"), Ok(ImageCodec::Ktx2(0).into()));
        assert!(
            codecs("jpeg").unwrap_err().contains("quality")
                && codecs("avif").unwrap_err().contains("avif:85")
                && codecs("png,webp").is_err()
        );
    }
}
