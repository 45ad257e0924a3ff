//! Development from scene-referred light to a file's code values: exposure, tone curve, background, sRGB, rounding.

mod development;
mod srgb;
mod tone;

pub use development::{Developer, Development, develop_pixel, develop8, develop8_into, develop16};
pub use srgb::{round_to_codes, srgb_from_linear};
pub use tone::{ToneCurve, aces, agx, linear, neutral, reinhard};
