//! Development from scene-referred light to a file's code values: exposure, tone curve, background, sRGB, rounding.

mod curves;
mod development;

pub use curves::{ToneCurve, aces, agx, linear, neutral, reinhard, round_to_codes, srgb_from_linear};
pub use development::{Developer, Development, develop_pixel, develop8, develop8_into, develop16};
