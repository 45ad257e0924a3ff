//! The side of maps: a number of texels, or chosen automatically.

/// The value of [`BakeOptions::size`](super::BakeOptions::size) that preserves the scan's detail: the smallest power
/// of two, 256 to 8192, whose texels are at most as wide as a texel of the scan's textures or half its median edge,
/// on nearly all of the surface. It is `"auto"` in JSON and TOML.
///
/// ```
/// use taotie::asset::{AUTO_SIZE, BakeOptions};
///
/// let options = BakeOptions { size: AUTO_SIZE, ..BakeOptions::default() };
/// assert!(options.check().is_ok());
/// ```
pub const AUTO_SIZE: u32 = 0;

/// The range of automatically chosen sides.
const CHOSEN: [u32; 2] = [256, 8192];

/// Returns the side of maps for a scan whose detail needs `detail` texels.
pub(super) fn chosen(detail: u32) -> u32 {
    detail.clamp(CHOSEN[0], CHOSEN[1])
}

/// Returns a warning if the chosen side loses detail.
pub(super) fn shortfall(detail: u32) -> Option<String> {
    let side = chosen(detail);
    (detail > side).then(|| {
        format!(
            "maps of {side}×{side} texels, the largest that auto chooses, are about {} × coarser than the scan's detail; use \
             a larger size, or bake parts of the scan",
            detail / side
        )
    })
}

/// Sides as JSON: numbers, or `"auto"`.
#[cfg(feature = "serde")]
pub(super) mod as_text {
    use super::AUTO_SIZE;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    /// The text for [`AUTO_SIZE`].
    const AUTO: &str = "auto";

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Side {
        Texels(u32),
        Word(String),
    }

    #[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes fields by reference")]
    pub fn serialize<S: Serializer>(size: &u32, serializer: S) -> Result<S::Ok, S::Error> {
        if *size == AUTO_SIZE { serializer.serialize_str(AUTO) } else { serializer.serialize_u32(*size) }
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u32, D::Error> {
        match Side::deserialize(deserializer) {
            Ok(Side::Texels(texels)) => Ok(texels),
            Ok(Side::Word(word)) if word == AUTO => Ok(AUTO_SIZE),
            _ => Err(D::Error::custom("expected a number of texels, or \"auto\"")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_sides_are_bounded_and_a_loss_is_stated() {
        assert_eq!([1, 256, 2048, 8192, 32_768].map(chosen), [256, 256, 2048, 8192, 8192]);
        assert_eq!(shortfall(8192), None);
        assert!(shortfall(32_768).is_some_and(|text| text.contains("about 4 × coarser")));
    }
}
