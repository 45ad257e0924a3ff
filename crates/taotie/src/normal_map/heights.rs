//! Height maps as numeric values.

use crate::error::{Error, Result};
use crate::image::{Bitmap, Wrap};

/// The heights of a map, [0, 1] if they come from integers; row by row from the top.
///
/// ```
/// use taotie::image::Wrap;
/// use taotie::normal_map::Heights;
///
/// let ramp = Heights::new([5, 1], vec![0.0, 1.0, 2.0, 3.0, 4.0], [Wrap::Clamp; 2])?;
/// assert_eq!((ramp.at(2, 0), ramp.slopes(2, 0)), (2.0, [1.0, 0.0]));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Heights {
    width: usize,
    height: usize,
    values: Vec<f32>,
    wrap: [Wrap; 2],
}

impl Heights {
    /// Makes heights from numbers; `wrap` defines how they continue beyond the borders, along u and v.
    ///
    /// # Errors
    /// [`Error::Invalid`] if a side is zero or the count is not `width · height`.
    pub fn new([width, height]: [u32; 2], values: Vec<f32>, wrap: [Wrap; 2]) -> Result<Self> {
        let (width, height) = (width as usize, height as usize);
        if width == 0 || height == 0 || values.len() != width * height {
            return Err(Error::invalid(
                format!("heights of {width}x{height}"),
                format!("expected one number per texel, found {}", values.len()),
            ));
        }
        Ok(Self { width, height, values, wrap })
    }

    /// Takes the first channel of a bitmap, without decoding.
    pub fn from_bitmap(bitmap: &Bitmap, wrap: [Wrap; 2]) -> Self {
        let values = (0..bitmap.texels().len()).map(|i| bitmap.stored(i)[0]).collect();
        Self { width: bitmap.width() as usize, height: bitmap.height() as usize, values, wrap }
    }

    /// Returns the width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        [self.width as u32, self.height as u32]
    }

    /// Returns the height at a texel.
    pub fn at(&self, x: u32, y: u32) -> f64 {
        self.neighbour([x.into(), y.into()], [0, 0])
    }

    /// Returns the change of the height per texel to the right and per texel down: central differences over ±1 and ±2
    /// texels, exact for polynomials of the fourth degree (Fornberg 1988, table 1). Relief not confined to three
    /// texels is preserved better than by Sobel's or Prewitt's operators, which blur.
    pub fn slopes(&self, x: u32, y: u32) -> [f64; 2] {
        let at = |offset| self.neighbour([x.into(), y.into()], offset);
        let across = 8.0 * (at([1, 0]) - at([-1, 0])) - (at([2, 0]) - at([-2, 0]));
        let down = 8.0 * (at([0, 1]) - at([0, -1])) - (at([0, 2]) - at([0, -2]));
        [across / 12.0, down / 12.0]
    }

    fn neighbour(&self, [x, y]: [i64; 2], [dx, dy]: [i64; 2]) -> f64 {
        let column = within(self.wrap[0], x + dx, self.width);
        let row = within(self.wrap[1], y + dy, self.height);
        f64::from(self.values[row * self.width + column])
    }
}

/// Returns the texel in [0, size) to which index `i` wraps.
fn within(wrap: Wrap, i: i64, size: usize) -> usize {
    let size = size as i64;
    let i = match wrap {
        Wrap::Repeat => i.rem_euclid(size),
        Wrap::Clamp => i.clamp(0, size - 1),
        Wrap::Mirror => {
            let j = i.rem_euclid(2 * size);
            j.min(2 * size - 1 - j)
        }
    };
    i as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heights(size: [u32; 2], wrap: Wrap, value: impl Fn(f64, f64) -> f64) -> Heights {
        let values =
            (0..size[0] * size[1]).map(|i| value(f64::from(i % size[0]), f64::from(i / size[0])) as f32);
        Heights::new(size, values.collect(), [wrap; 2]).unwrap()
    }

    #[test]
    fn slopes_of_a_quartic_are_exact() {
        let map = heights([9, 9], Wrap::Clamp, |x, y| x * x * x * x - 3.0 * x * y + 2.0 * y * y * y);
        let (x, y) = (4.0, 3.0);
        assert_eq!(map.slopes(4, 3), [4.0 * x * x * x - 3.0 * y, -3.0 * x + 6.0 * y * y]);
    }

    #[test]
    fn borders_go_on_as_asked() {
        let slope = |wrap| heights([4, 1], wrap, |x, _| x).slopes(0, 0)[0];
        // Neighbours −2, −1, 1, 2: 2 3 1 2, then 0 0 1 2, then 1 0 1 2.
        assert_eq!(slope(Wrap::Repeat), (8.0 * (1.0 - 3.0) - (2.0 - 2.0)) / 12.0);
        assert_eq!(slope(Wrap::Clamp), (8.0 * (1.0 - 0.0) - (2.0 - 0.0)) / 12.0);
        assert_eq!(slope(Wrap::Mirror), (8.0 * (1.0 - 0.0) - (2.0 - 1.0)) / 12.0);
        assert_eq!(heights([1, 1], Wrap::Repeat, |_, _| 5.0).slopes(0, 0), [0.0; 2]);
    }

    #[test]
    fn a_wrong_count_is_refused() {
        assert!(Heights::new([2, 2], vec![0.0; 3], [Wrap::Clamp; 2]).is_err());
    }
}
