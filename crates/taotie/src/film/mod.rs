//! Development from scene-referred light to a file's code values: exposure, tone curve, background, sRGB, rounding.

mod codes8;
mod curves;
mod develop;
mod developer;
mod development;
mod encode;
mod tone;

pub use curves::{aces, agx, linear, neutral, reinhard};
pub use develop::{develop8, develop8_into, develop16};
pub use developer::Developer;
pub use development::{Development, develop_pixel};
pub use encode::{round_to_codes, srgb_from_linear};
pub use tone::ToneCurve;
