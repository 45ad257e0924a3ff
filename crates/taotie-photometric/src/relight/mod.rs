//! Relightable images: each pixel's brightness as a function of the light's direction, fitted to photographs.
//!
//! Files of three kinds are written and read: polynomial texture maps (`.ptm`), hemispherical harmonics (`.rti`), and
//! the folders of images that web viewers load (`info.json`). Their values are for display, thus encoded by the sRGB
//! curve like photographs of 8 bits.

mod basis;
mod coefficients;
mod colors;
mod fit;
mod format;
mod header;
mod image;
mod plane;
mod ptm;
mod quality;
mod rti;
#[cfg(test)]
mod tests;
mod web;

pub use basis::Basis;
pub use coefficients::Coefficients;
pub(crate) use colors::BATCH;
pub use colors::ColorReader;
pub use format::RelightFormat;
pub use image::{ColorModel, Relightable, lights_of_relit};
pub use plane::Plane;
pub use quality::Quality;
