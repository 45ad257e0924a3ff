//! From scene-referred light to a file's code values: exposure, tone curve, background, sRGB, rounding.

mod curves;
mod develop;
mod encode;
mod tone;

pub use curves::{aces, agx, linear, neutral, reinhard};
pub use develop::{Development, develop_pixel, develop8, develop16};
pub use encode::{round_to_codes, srgb_from_linear};
pub use tone::ToneCurve;
