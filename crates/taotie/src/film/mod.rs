//! temporary
use crate::{
    error::Result,
    image::Image,
    math::{SimdLevel, Vec3},
};
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum ToneCurve {
    Neutral,
    Linear,
}
impl ToneCurve {
    pub const NAMES: [(&'static str, ToneCurve); 2] = [("neutral", Self::Neutral), ("linear", Self::Linear)];
    pub fn name(self) -> &'static str {
        "x"
    }
}
pub struct Development {
    pub exposure_stops: f32,
    pub tone: ToneCurve,
    pub background: Option<Vec3>,
    pub simd: SimdLevel,
}
impl Default for Development {
    fn default() -> Self {
        Self { exposure_stops: 0.0, tone: ToneCurve::Neutral, background: None, simd: SimdLevel::Auto }
    }
}
pub fn develop8(i: &Image, d: &Development) -> Result<Vec<[u8; 4]>> {
    Ok(i.pixels()
        .iter()
        .map(|p| {
            let bg = d.background.unwrap_or_default().to_array();
            let mut o = [0u8; 4];
            for c in 0..3 {
                o[c] = (crate::math::srgb::srgb_from_linear(
                    f64::from(p[c] + bg[c] * (1.0 - p[3])).clamp(0.0, 1.0),
                ) * 255.0
                    + 0.5) as u8;
            }
            o[3] = (p[3] * 255.0) as u8;
            o
        })
        .collect())
}
pub fn develop16(_: &Image, _: &Development) -> Result<Vec<[u16; 4]>> {
    Ok(vec![])
}
