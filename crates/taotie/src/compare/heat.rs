//! Fields as images.

use super::Field;
use crate::names::Named;

/// The map from numbers to colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColorMap {
    /// Dark blue over green to yellow; van der Walt and Smith 2015.
    #[default]
    Viridis,
    /// Black over purple to a light yellow; by the same authors, and used in FLIP's own images.
    Magma,
    /// Black to white.
    Gray,
}

impl Named for ColorMap {
    const WHAT: &'static str = "color map";
    const NAMES: &'static [(&'static str, Self)] =
        &[("viridis", Self::Viridis), ("magma", Self::Magma), ("gray", Self::Gray)];
}

impl ColorMap {
    /// Returns the 8-bit sRGB colour of a number, clamped to [0, 1].
    pub fn color(self, value: f64) -> [u8; 3] {
        let gradient = match self {
            Self::Viridis => colorous::VIRIDIS,
            Self::Magma => colorous::MAGMA,
            Self::Gray => return [(value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8; 3],
        };
        gradient.eval_continuous(value).as_array()
    }
}

/// Returns the field as 8-bit sRGB colours, row by row from the top: 0 and below get the map's first colour, `top`
/// and above its last, and pixels without a number the colour `nothing`.
pub fn heat(field: &Field, top: f32, map: ColorMap, nothing: [u8; 3]) -> Vec<[u8; 3]> {
    let color = |value: &f32| match value {
        v if v.is_nan() => nothing,
        v if *v <= 0.0 => map.color(0.0),
        v => map.color(f64::from(*v) / f64::from(top.max(0.0))),
    };
    field.values().iter().map(color).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_maps_are_theirs() {
        let near = |a: [u8; 3], b: [u8; 3]| (0..3).all(|c| a[c].abs_diff(b[c]) <= 2);
        assert!(
            near(ColorMap::Viridis.color(0.0), [68, 1, 84])
                && near(ColorMap::Viridis.color(1.0), [253, 231, 37])
        );
        assert!(
            near(ColorMap::Magma.color(0.0), [0, 0, 4]) && near(ColorMap::Magma.color(1.0), [252, 253, 191])
        );
        assert!(near(ColorMap::Magma.color(0.5), [183, 55, 121]), "{:?}", ColorMap::Magma.color(0.5));
        assert_eq!((ColorMap::Gray.color(0.2), ColorMap::Gray.color(9.0)), ([51; 3], [255; 3]));
    }

    #[test]
    fn numbers_beyond_the_scale_take_its_ends() {
        let field = Field::new(6, 1, vec![-1.0, 0.0, 1.0, 2.0, f32::INFINITY, f32::NAN]).unwrap();
        let colors = heat(&field, 2.0, ColorMap::Gray, [9, 8, 7]);
        assert_eq!(colors, [[0; 3], [0; 3], [128; 3], [255; 3], [255; 3], [9, 8, 7]]);
        assert_eq!(heat(&field, 0.0, ColorMap::Gray, [9; 3])[1..3], [[0; 3], [255; 3]]);
    }
}
