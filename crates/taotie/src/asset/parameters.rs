//! All that an asset depends on, as one JSON document.

use super::options::{BakeOptions, MeshSource, RayDistance};
use super::packing::Packing;
use super::scan_options::ScanOptions;
use crate::io::GltfImages;
use crate::names::Named;
use crate::scene::{GreenChannel, NormalSpace};
use serde_json::{Value, json};
use std::fmt;

/// The options of a bake and how it was packed, as a JSON document: what its text says.
///
/// ```
/// use taotie::Result;
/// use taotie::asset::{Report, Written};
///
/// /// Returns the parameters of a written asset as JSON.
/// fn json(written: &Written) -> Result<String> {
///     Ok(Report::of(written)?.parameters.to_string())
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(transparent))]
pub struct Parameters(Value);

impl fmt::Display for Parameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Parameters {
    /// Collects what was asked for; files are named without their folders, which are private.
    pub(super) fn new(options: &BakeOptions, scan: &ScanOptions, packing: &Packing) -> Self {
        let green = |green| match green {
            GreenChannel::Up => "up",
            GreenChannel::Down => "down",
        };
        let auto = |value: Option<f64>| value.map_or(json!("auto"), |value| json!(value));
        let searched = options.mean_error_deg.is_some();
        let (distance, cage) = match &options.ray_distance {
            RayDistance::Auto => (None, None),
            RayDistance::Uniform(distance) => (Some(*distance), None),
            RayDistance::Cage(source) => (None, Some(source)),
        };
        Self(json!({
            "triangles": (options.low.is_none() && !searched).then_some(options.triangles),
            "error_deg": options.mean_error_deg,
            "lods": options.lods,
            "size": match options.is_square() {
                true => json!((!searched).then_some(options.size)),
                false => json!(options.map_size()),
            },
            "maps": options.maps.iter().map(|map| map.name()).collect::<Vec<_>>(),
            "space": match options.space { NormalSpace::Tangent => "tangent", NormalSpace::Object => "object" },
            "samples": options.side * options.side,
            "bits": options.bits,
            "dilation": auto(options.dilation.map(f64::from)),
            "ao_rays": options.ao_rays,
            "ao_distance": options.ao_distance,
            "roughness": options.roughness,
            "ray_distance": auto(distance),
            "cage": cage.and_then(MeshSource::name),
            "images": match packing.images {
                GltfImages::Png => "png",
                GltfImages::WebP => "webp",
                GltfImages::Ktx2 => "ktx2",
            },
            "webp_quality": packing.webp_quality,
            "uastc_rdo": packing.uastc_rdo,
            "jpeg": packing.jpeg,
            "meshopt": packing.meshopt,
            "green": green(packing.green),
            "crease_angle_deg": auto(scan.crease_angle_deg),
            "scan_green": scan.green.map_or("auto", green),
        }))
    }

    /// Returns the same with the name of the low-poly mesh's file.
    pub(super) fn with_low(mut self, options: &BakeOptions) -> Self {
        self.0["low"] = options.low.as_ref().and_then(MeshSource::name).into();
        self
    }
}
