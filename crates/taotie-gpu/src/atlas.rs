//! Square pictures side by side in one.

/// The places of squares in a picture, in shelves from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Atlas {
    /// The size that holds all squares; at least one texel.
    pub size: [u32; 2],
    /// The column and row at which each square begins.
    pub places: Vec<[u32; 2]>,
}

impl Atlas {
    /// Places squares of these sides, about as wide as high.
    pub(crate) fn new(sides: &[u32]) -> Self {
        let area: u64 = sides.iter().map(|side| u64::from(*side) * u64::from(*side)).sum();
        let widest = sides.iter().copied().max().unwrap_or(1);
        let width = widest.max(area.isqrt() as u32);
        let (mut left, mut top, mut below) = (0, 0, 0);
        let mut places = Vec::with_capacity(sides.len());
        for side in sides {
            if left + side > width {
                (left, top) = (0, below);
            }
            places.push([left, top]);
            left += side;
            below = below.max(top + side);
        }
        Self { size: [width, below.max(1)], places }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_lie_apart_and_inside() {
        let sides = [514, 514, 258, 258, 130, 66, 66, 34, 18, 300];
        let atlas = Atlas::new(&sides);
        assert!(atlas.size[0] >= 514 && atlas.size[0] < 1200 && atlas.size[1] < 1700, "{:?}", atlas.size);
        for (i, ([x, y], side)) in atlas.places.iter().zip(sides).enumerate() {
            assert!(x + side <= atlas.size[0] && y + side <= atlas.size[1], "{i}");
            for ([other_x, other_y], other) in atlas.places[..i].iter().zip(sides) {
                let apart = x + side <= *other_x
                    || other_x + other <= *x
                    || y + side <= *other_y
                    || other_y + other <= *y;
                assert!(apart, "{i}");
            }
        }
        assert_eq!(Atlas::new(&[]), Atlas { size: [1, 1], places: vec![] });
    }
}
