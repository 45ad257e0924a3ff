//! The report on a conversion, for people and for machines.

use super::args::NormalsArgs;
use super::input::{content_name, space_name};
use crate::console;
use crate::studio::Green;
use serde::Serialize;
use std::fmt::Write;
use taotie_engine::Warnings;
use taotie_engine::compare::{Field, Summary};
use taotie_engine::names::Named;
use taotie_engine::normal_map::{Conversion, MapSource};
use taotie_engine::scene::GreenChannel;
use taotie_report::summary;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// The report on a conversion.
#[derive(Serialize)]
pub struct Report {
    schema: u32,
    version: &'static str,
    input: String,
    output: String,
    size: [u32; 2],
    /// `height`, `tangent` or `object`.
    from: &'static str,
    /// `tangent` or `object`.
    to: &'static str,
    /// `up` or `down`.
    green_in: &'static str,
    green: &'static str,
    bits: u8,
    dither: bool,
    /// Degrees between the exact normals and the stored ones; `None` if the map holds no normal.
    stored: Option<Summary>,
    /// Degrees between the input's normals and those converted back from the output.
    round_trip: Option<Summary>,
    warnings: serde_json::Value,
}

impl Report {
    /// Makes the report on a conversion.
    pub fn new(args: &NormalsArgs, input: &MapSource, made: &Conversion, warnings: &Warnings) -> Self {
        Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            input: args.input.display().to_string(),
            output: args.output.display().to_string(),
            size: [made.bitmap.width(), made.bitmap.height()],
            from: content_name(input.content),
            to: space_name(made.space),
            green_in: input.green.name(),
            green: GreenChannel::from(args.green.unwrap_or(Green::Up)).name(),
            bits: made.bitmap.bits(),
            dither: args.dither,
            stored: made.stored.summary(),
            round_trip: made.round_trip.as_ref().and_then(Field::summary),
            warnings: console::json_warnings(warnings),
        }
    }

    /// Returns the report as text.
    pub fn text(&self) -> String {
        let mut text = format!(
            "wrote {}: {}x{}, {} bits, {} space",
            self.output, self.size[0], self.size[1], self.bits, self.to
        );
        if self.to == "tangent" {
            let _ = write!(text, ", green {}", self.green);
        }
        let what = if self.from == self.to { "conversion" } else { "storing" };
        for (name, angles) in [(what, &self.stored), ("round trip", &self.round_trip)] {
            if let Some(angles) = angles {
                let _ = write!(text, "\n{:<10} {}", name, summary::text(angles, 4, "°"));
            }
        }
        text
    }
}
