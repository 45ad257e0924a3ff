//! The provenance that an asset records about itself: all parameters of its bake, as one JSON document in its XMP
//! metadata.

use crate::asset::ask::{BakeOptions, Channels, Lod, MeshSource, Packing, RayDistance, requirement};
use crate::asset::bake::Made;
use crate::asset::source::{ScanOptions, stated_unit};
use serde_json::Value;
use std::fmt;
use std::path::{Path, PathBuf};
use taotie_engine::bake::{MapKind, MatchRule, SetSizes};
use taotie_engine::error::Result;
use taotie_engine::length::Unit;
use taotie_engine::names::Named;
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_engine::surface::NoiseHandling;
use taotie_io::{Json, Limits, Loaded, Provenance, XmpProperties};

/// The options and packing of a bake, as a JSON document.
///
/// ```
/// use taotie::Result;
/// use taotie::asset::{Report, WrittenAsset};
///
/// /// Returns the parameters of a written asset as JSON; `None` if it was not baked here.
/// fn json(written: &WrittenAsset) -> Result<Option<String>> {
///     Ok(Report::of(written)?.parameters.map(|parameters| parameters.to_string()))
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(transparent)]
pub struct Parameters(Value);

/// The content of [`Parameters`].
#[derive(serde::Serialize)]
struct Fields<'a> {
    /// The requested number of triangles; `None` if the mesh was given or searched for.
    triangles: Option<u32>,
    /// `true` if the mesh was made from the scan's watertight outer surface; `None` if not.
    #[serde(skip_serializing_if = "Option::is_none")]
    remesh: Option<bool>,
    /// The requirements that the smallest asset had to meet, as for `--require`; `None` without a search.
    goal: Option<String>,
    /// The largest number of bytes; `None` if any is allowed.
    bytes: Option<u64>,
    /// The coarser levels of detail.
    lods: &'a [Lod],
    /// Texels along a side of the maps, or across and down; `None` if searched for.
    size: Sides,
    /// The maps baked.
    maps: Vec<MapKind>,
    /// The space of the normal map.
    space: NormalSpace,
    /// Samples per texel.
    samples: u32,
    /// Bits per channel of normals.
    bits: u8,
    /// Texels by which islands are extended.
    dilation: Auto,
    /// Rays per texel for ambient occlusion.
    ao_rays: u32,
    /// The distance beyond which nothing occludes, model units; `None` for no limit.
    ao_distance: Option<f64>,
    /// The roughness of the asset; `None` for that of the scan, [0, 1].
    roughness: Option<f64>,
    /// The radius of rounded edges, model units; `None` for the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    bevel_radius: Option<f64>,
    /// The length of projection rays, model units.
    ray_distance: Auto,
    /// How the scan was matched, as for `--match`; `None` for the default.
    #[serde(rename = "match", skip_serializing_if = "Option::is_none")]
    matching: Option<&'static str>,
    /// The sizes of the maps of several materials, as for `--sizes`; `None` if all are the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    sizes: Option<String>,
    /// `true` if the low-poly mesh was unwrapped again; `None` if not.
    #[serde(skip_serializing_if = "Option::is_none")]
    new_uvs: Option<bool>,
    /// `true` if its uvs are on UDIM tiles; `None` if not.
    #[serde(skip_serializing_if = "Option::is_none")]
    udim: Option<bool>,
    /// `true` if vertex colours scaled ray distances; `None` if not.
    #[serde(skip_serializing_if = "Option::is_none")]
    ray_colors: Option<bool>,
    /// `keep`, or the name of the mask of skew correction; `None` for the default.
    #[serde(skip_serializing_if = "Option::is_none")]
    skew: Option<String>,
    /// The name of the cage's file; `None` without a cage.
    cage: Option<String>,
    /// `remove` if the scan's noise was removed; `None` if not.
    #[serde(skip_serializing_if = "Option::is_none")]
    noise: Option<NoiseHandling>,
    /// The formats of the textures, as for `--images`.
    images: String,
    /// The formats that the search may choose from.
    image_formats: Vec<&'static str>,
    /// `true` if geometry is compressed by meshoptimizer.
    meshopt: bool,
    /// The set of codecs that the search may use, as for `--codecs`.
    codecs: &'static str,
    /// Bits of each coordinate of a position; `None` without compression.
    position_bits: Option<u8>,
    /// Bits of each coordinate of a normal; `None` without compression.
    normal_bits: Option<u8>,
    /// The green direction of maps next to the asset.
    green: GreenChannel,
    /// The textures that pack channels, as for `--channels`.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    channels: &'a [Channels],
    /// The angle above which edges of the scan are creases, degrees.
    crease_angle_deg: Auto,
    /// The green direction of the scan's normal maps: `up`, `down` or `auto`.
    scan_green: &'static str,
    /// The unit of the scan's coordinates, if specified.
    unit: Option<Unit>,
}

/// A number, or `auto`.
#[derive(serde::Serialize)]
#[serde(untagged)]
enum Auto {
    /// The number.
    Given(f64),
    /// `auto`.
    Auto(&'static str),
}

/// The size of maps, texels.
#[derive(serde::Serialize)]
#[serde(untagged)]
enum Sides {
    /// Along both sides; `None` if searched for.
    Square(Option<u32>),
    /// Across and down.
    Both([u32; 2]),
}

/// The command that these parameters belong to.
const RUN: &str = "taotie bake";

impl ScanOptions {
    /// Returns how the scan of an asset was read, as recorded in the history of the asset's XMP metadata; all options
    /// are unset if there is no record.
    ///
    /// ```no_run
    /// use taotie::Progress;
    /// use taotie::asset::{ScanFile, ScanOptions, VerifyOptions, verify};
    /// use taotie::Limits;
    ///
    /// let limits = Limits::default();
    /// let options = ScanOptions::recorded("bracket.glb", &limits)?;
    /// let file = ScanFile::read("bracket.stl", &limits, Progress::SILENT)?.with_options(options);
    /// let scan = file.into_scan(Progress::SILENT)?;
    /// let proof = verify("bracket.glb", scan, &VerifyOptions::default(), Progress::SILENT)?;
    /// # Ok::<(), taotie::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of reading the file.
    pub fn recorded(asset: impl AsRef<Path>, limits: &Limits) -> Result<Self> {
        let packet = taotie_io::read_xmp(asset.as_ref(), limits)?;
        let recorded = packet.as_ref().and_then(Parameters::recorded);
        Ok(recorded.map_or_else(Self::default, |parameters| parameters.scan_options()))
    }
}

/// Returns the unit of a model's coordinates: the metre for glTF and FBX, unless it is an asset baked from a scan with an
/// unknown unit; `None` if unknown.
///
/// ```
/// use taotie::Loaded;
/// use taotie::asset::model_unit;
/// use taotie_engine::length::Unit;
///
/// assert_eq!(model_unit(&Loaded { format: "GLB", ..Loaded::default() }), Some(Unit::Metre));
/// assert_eq!(model_unit(&Loaded { format: "STL", ..Loaded::default() }), None);
/// ```
pub fn model_unit(model: &Loaded) -> Option<Unit> {
    let recorded = model.xmp.first().and_then(Parameters::recorded);
    let is_unknown = recorded.is_some_and(|Parameters(all)| all.get("unit").is_some_and(Value::is_null));
    stated_unit(model.format).filter(|_| !is_unknown).map(|_| Unit::Metre)
}

impl fmt::Display for Parameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Parameters {
    /// Collects the options; files are named without their folders, which are private.
    pub(in crate::asset) fn new(options: &BakeOptions, scan: &ScanOptions, packing: &Packing) -> Self {
        let auto = |value: Option<f64>| value.map_or(Auto::Auto("auto"), Auto::Given);
        let searched = options.searches();
        let (distance, cage) = match &options.ray_distance {
            RayDistance::Auto => (None, None),
            RayDistance::Uniform(distance) => (Some(*distance), None),
            RayDistance::Cage(source) => (None, Some(source)),
        };
        let fields = Fields {
            triangles: (options.low.is_none() && !searched).then_some(options.triangles),
            remesh: options.remesh.then_some(true),
            goal: options.goal.as_deref().map(requirement::argument),
            bytes: options.bytes,
            lods: &options.lods,
            size: match options.is_square() {
                true => Sides::Square((!searched).then_some(options.size)),
                false => Sides::Both(options.map_size()),
            },
            maps: options.maps.to_vec(),
            space: options.space,
            samples: options.side * options.side,
            bits: options.bits,
            dilation: auto(options.dilation.map(f64::from)),
            ao_rays: options.ao_rays,
            ao_distance: options.ao_distance,
            roughness: options.roughness,
            bevel_radius: options.bevel_radius,
            ray_distance: auto(distance),
            matching: (options.matching != MatchRule::ByName).then_some(options.matching.name()),
            sizes: (options.sizes != SetSizes::Same).then(|| options.sizes.to_string()),
            new_uvs: options.new_uvs.then_some(true),
            udim: options.udim.then_some(true),
            ray_colors: options.ray_colors.then_some(true),
            skew: skew(options),
            cage: cage.and_then(MeshSource::name),
            noise: options.noise.filter(|handling| *handling == NoiseHandling::Remove),
            images: packing.images.to_string(),
            image_formats: options.images.iter().map(|kind| kind.name()).collect(),
            meshopt: packing.meshopt,
            codecs: packing.codecs.name(),
            position_bits: packing.meshopt.then_some(packing.bits.positions),
            normal_bits: packing.meshopt.then_some(packing.bits.normals),
            green: packing.green,
            channels: &packing.channels,
            crease_angle_deg: auto(scan.crease_angle_deg),
            scan_green: scan.green.map_or("auto", Named::name),
            unit: scan.unit,
        };
        Self(serde_json::to_value(fields).expect("all keys are text"))
    }

    /// Returns the parameters as an asset records them: the command and its options.
    fn record(&self) -> String {
        format!("{RUN} {self}")
    }

    /// Reads the parameters of the last bake in the history of an XMP packet; `None` if there is none.
    fn recorded(packet: &Json) -> Option<Self> {
        let events = taotie_io::xmp_history(packet).into_iter().rev();
        let mut records = events.filter_map(|event| {
            let json = event.parameters?.strip_prefix(RUN)?.parse::<Value>().ok();
            json.filter(Value::is_object).map(Self)
        });
        records.next()
    }

    /// Returns how the scan was read.
    fn scan_options(&self) -> ScanOptions {
        let Self(all) = self;
        let name = |of: &str| all.get(of).and_then(Value::as_str);
        let green = name("scan_green").and_then(|name| GreenChannel::from_name(name).ok());
        let unit = name("unit").and_then(|name| Unit::from_name(name).ok());
        ScanOptions { crease_angle_deg: all.get("crease_angle_deg").and_then(Value::as_f64), green, unit }
    }

    /// Adds the name of the low-poly mesh's file.
    fn with_low(mut self, options: &BakeOptions) -> Self {
        self.0["low"] = options.low.as_ref().and_then(MeshSource::name).into();
        self
    }
}

/// Returns how skew correction differs from the default, as for `--skew`; a mask by its name without folders.
fn skew(options: &BakeOptions) -> Option<String> {
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mask = options.skew_mask.as_ref().map(name);
    mask.or((!options.straighten).then(|| "keep".into()))
}

/// Returns the XMP metadata of the scan, merged with that of the packing and extended by the record of the bake.
///
/// # Errors
/// Fails if a file cannot be read, or has no valid XMP properties.
pub(super) fn packet(made: &Made, packing: &Packing) -> Result<Json> {
    let about = &made.about;
    let sources = about.models.iter().map(|model| Ok([model.name(), model.sha256()?]));
    let sources = sources.collect::<Result<Vec<_>>>()?;
    let sources: Vec<[&str; 2]> =
        sources.iter().map(|source| source.each_ref().map(String::as_str)).collect();
    let parameters = Parameters::new(&made.options, &made.about.options, packing).with_low(&made.options);
    let done = Provenance {
        sources: &sources,
        tool: concat!("taotie ", env!("CARGO_PKG_VERSION")),
        parameters: &parameters.record(),
    };
    let given = packing.provenance.as_deref().map(XmpProperties::read).transpose()?;
    let merged = given.map(|given| given.merged_into(about.xmp.as_ref()));
    Ok(done.extend(merged.as_ref().or(about.xmp.as_ref())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_recorded_is_read_again() {
        let all = [
            ScanOptions::default(),
            ScanOptions {
                crease_angle_deg: Some(40.5),
                green: Some(GreenChannel::Down),
                unit: Some(Unit::Inch),
            },
            ScanOptions { crease_angle_deg: None, green: Some(GreenChannel::Up), unit: Some(Unit::Metre) },
        ];
        let mut packet =
            Provenance { tool: "another program", parameters: "--fast", ..Provenance::default() }
                .extend(None);
        assert!(Parameters::recorded(&packet).is_none());
        for options in all {
            let record = Parameters::new(&BakeOptions::default(), &options, &Packing::default()).record();
            packet = Provenance { tool: "taotie", parameters: &record, ..Provenance::default() }
                .extend(Some(&packet));
            assert_eq!(
                Parameters::recorded(&packet).unwrap().scan_options(),
                options,
                "the last bake counts"
            );
        }
    }
}
