//! Images of half floats as bytes that compress well, without loss.

/// The channels as they are told: green, and the other two by their difference from it.
const TOLD: [fn([u16; 3]) -> u16; 3] =
    [|[_, g, _]| g, |[r, g, _]| r.wrapping_sub(g), |[_, g, b]| b.wrapping_sub(g)];

/// Codes an image of half floats, `width` texels a row. Each number of a channel is told by its difference from what its
/// neighbours let expect: left + above − above left, which is 0 outside the image. All lower bytes come first, then all
/// upper ones.
pub(super) fn coded(texels: &[[u16; 3]], width: usize) -> Vec<u8> {
    let codes: Vec<u16> = TOLD.iter().flat_map(|told| differences(texels, width, told)).collect();
    let [lower, upper] = [0, 1].map(|byte| codes.iter().map(move |code| code.to_le_bytes()[byte]));
    lower.chain(upper).collect()
}

fn differences(
    texels: &[[u16; 3]],
    width: usize,
    told: impl Fn([u16; 3]) -> u16,
) -> impl Iterator<Item = u16> {
    let numbers: Vec<u16> = texels.iter().map(|texel| told(*texel)).collect();
    let at = move |x: usize, y: usize| match (x, y) {
        (0, _) | (_, 0) => 0,
        (x, y) => numbers[(y - 1) * width + x - 1],
    };
    (0..texels.len()).map(move |i| {
        let (x, y) = (i % width + 1, i / width + 1);
        let expected = at(x - 1, y).wrapping_add(at(x, y - 1)).wrapping_sub(at(x - 1, y - 1));
        folded(at(x, y).wrapping_sub(expected))
    })
}

/// Small differences of either sign as small numbers: 0, −1, 1, −2 become 0, 1, 2, 3.
fn folded(difference: u16) -> u16 {
    let signed = difference as i16;
    ((signed << 1) ^ (signed >> 15)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_nothing_new() {
        let texels: Vec<[u16; 3]> = (0..12u16).map(|i| [100 + i % 4 + 3 * (i / 4); 3]).collect();
        let codes = coded(&texels, 4);
        assert_eq!(codes.len(), 72);
        // The first row and the first column say where it begins and how it rises.
        assert_eq!(codes[..12], [200, 2, 2, 2, 6, 0, 0, 0, 6, 0, 0, 0]);
        assert!(codes[12..].iter().all(|code| *code == 0), "red and blue are green");
    }

    #[test]
    fn differences_of_either_sign_are_small() {
        assert_eq!([0u16, u16::MAX, 1, u16::MAX - 1, 0x8000].map(folded), [0, 1, 2, 3, u16::MAX]);
    }
}
