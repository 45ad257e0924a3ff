//! An asset to be made.

use crate::collection::Scan;
use crate::input::InputFile;
use crate::settings::Settings;

/// An asset to be made.
#[derive(Debug, Clone)]
pub struct Todo {
    /// The scan.
    pub scan: Scan,
    /// Its settings.
    pub settings: Settings,
    /// The SHA-256 of the settings, except for requirements.
    pub settings_hash: String,
    /// The scan's own file, not read yet; empty if it does not exist.
    pub input: Vec<InputFile>,
    /// Its size in bytes.
    pub bytes: u64,
}

impl Todo {
    /// Returns the relative cost of the work: a fixed part per asset, plus a part for its size.
    pub fn cost(&self) -> f64 {
        const EACH: u64 = 1 << 18;
        (EACH + self.bytes) as f64
    }
}
