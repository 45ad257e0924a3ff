//! `taotie normals`: makes normal maps from heights, and converts them.

mod args;

pub use args::NormalsArgs;

use crate::options::{chosen, listed};
use crate::studio::Green;
use crate::{console, stop};
use anyhow::{Context, Result, anyhow, bail};
use args::Border;
use serde::Serialize;
use std::fmt::Write;
use std::path::Path;
use taotie::Warning;
use taotie_engine::Warnings;
use taotie_engine::bake::{TexelGrid, TexelSurface};
use taotie_engine::compare::{Field, Summary};
use taotie_engine::image::{Bitmap, Encoding};
use taotie_engine::names::Named;
use taotie_engine::normal_map::{
    Conversion, ConversionOptions, MapContent, MapSource, convert_map, lay_out, with_content,
};
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_engine::surface::{GreenVerdict, green_direction};
use taotie_io::{FileSet, Loaded};
use taotie_report::table::summary_text;

/// Runs the subcommand.
pub fn run(args: &NormalsArgs) -> Result<()> {
    args.check()?;
    let files = stop::files();
    args.claim(&files)?;
    let (report, warnings) = args.run.in_pool(|| convert(args, &files))??;
    console::say_warnings(&warnings);
    if args.run.json {
        return console::result(&serde_json::to_string_pretty(&report)?);
    }
    console::result(&report.text())
}

fn convert(args: &NormalsArgs, files: &FileSet) -> Result<(Report, Warnings)> {
    let source = read_map(args)?;
    let mut warnings = Warnings::default();
    note_unread(args, &source, &mut warnings);
    let size = [source.bitmap.width(), source.bitmap.height()];
    let surface = laid_out(args, files, size, &mut warnings)?;
    let options = options(args);
    check(&source, &options, surface.as_ref())?;
    let made = convert_map(&source, &options, surface.as_ref())?;
    warnings.absorb(made.warnings.clone());
    files.write_png_bitmap(&args.output, &made.bitmap, Encoding::Linear)?;
    files.commit()?;
    Ok((Report::new(args, &source, &made, &warnings), warnings))
}

fn options(args: &NormalsArgs) -> ConversionOptions {
    ConversionOptions {
        space: args.to.map(Into::into),
        green: args.green.unwrap_or(Green::Up).into(),
        bits: args.bits.as_deref().map(|bits| if bits == "8" { 8 } else { 16 }),
        dither: args.dither,
        height_scale: args.height_scale,
        border: args.border.unwrap_or(Border::Repeat).wrap(),
    }
}

/// Rejects a conversion that lacks an option, naming it.
fn check(source: &MapSource, options: &ConversionOptions, surface: Option<&TexelSurface>) -> Result<()> {
    let what = match (source.content, options.space) {
        (MapContent::Heights, _) if options.height_scale.is_none() => bail!(
            "--height-scale is needed for heights: the height of white in texels, or in model units with --mesh"
        ),
        (MapContent::Heights, Some(NormalSpace::Object)) => "object space needs the mesh",
        (MapContent::Normals(own), Some(space)) if own != space => "changing the space needs the mesh",
        _ => return Ok(()),
    };
    if surface.is_none() {
        bail!("{what}; name the model with --mesh");
    }
    Ok(())
}

/// Adds a warning for each option that has no effect on this conversion.
fn note_unread(args: &NormalsArgs, source: &MapSource, warnings: &mut Warnings) {
    let own = match source.content {
        MapContent::Heights => None,
        MapContent::Normals(space) => Some(space),
    };
    let to = args.to.map(NormalSpace::from).or(own).unwrap_or(NormalSpace::Tangent);
    let is_tangent = own == Some(NormalSpace::Tangent);
    let unread = [
        ("--green-in has no effect: the input is not a tangent-space normal map", {
            args.green_in.is_some() && !is_tangent
        }),
        ("--green has no effect: object-space normals have no green direction", {
            args.green.is_some() && to == NormalSpace::Object
        }),
        ("--height-scale has no effect: the input holds no heights", {
            args.height_scale.is_some() && own.is_some()
        }),
        ("--border has no effect: the input holds no heights", args.border.is_some() && own.is_some()),
        ("--mesh has no effect: the normals stay in their space", args.mesh.is_some() && own == Some(to)),
    ];
    unread.iter().for_each(|(what, is)| warnings.note(*what, usize::from(*is)));
}

/// Reads the map and determines its content; prints what was guessed.
fn read_map(args: &NormalsArgs) -> Result<MapSource> {
    let stored = taotie_io::read_bitmap_within(&args.input, &args.limits.limits())?;
    let given = match args.from {
        args::From::Height => Some(MapContent::Heights),
        args::From::Tangent => Some(MapContent::Normals(NormalSpace::Tangent)),
        args::From::Object => Some(MapContent::Normals(NormalSpace::Object)),
        args::From::Auto => None,
    };
    let (bitmap, content) = with_content(stored, given)?;
    let Some(content) = content else {
        let path = args.input.display();
        bail!("{path}: it looks like neither a normal map nor heights; specify its content with --from")
    };
    if given.is_none() {
        say_content(args, content);
    }
    let green = match (content, args.green_in) {
        (MapContent::Normals(NormalSpace::Tangent), Some(green)) => green.into(),
        (MapContent::Normals(NormalSpace::Tangent), None) => guessed_green(args, &bitmap),
        _ => GreenChannel::Up,
    };
    Ok(MapSource { bitmap, content, green })
}

fn say_content(args: &NormalsArgs, content: MapContent) {
    let name = match content {
        MapContent::Normals(NormalSpace::Tangent) => "a tangent-space normal map",
        MapContent::Normals(NormalSpace::Object) => "an object-space normal map",
        MapContent::Heights => "a height map",
    };
    console::say(&format!("taotie: {}: its pixels look like {name}", args.input.display()));
}

fn guessed_green(args: &NormalsArgs, bitmap: &Bitmap) -> GreenChannel {
    let path = args.input.display();
    let guess = green_direction(bitmap);
    let (green, name) = match guess.verdict {
        GreenVerdict::Up => (GreenChannel::Up, "up"),
        GreenVerdict::Down => (GreenChannel::Down, "down"),
        GreenVerdict::Unclear => {
            console::say(&format!(
                "taotie: {path}: the direction of green is unclear from its pixels; assuming up, see --green-in"
            ));
            return GreenChannel::Up;
        }
    };
    console::say(&format!(
        "taotie: {path}: green points {name}, guessed from its pixels ({:.0} % sure)",
        guess.confidence * 100.0
    ));
    green
}

/// Lays out the requested mesh on a map of `size`, with the tangent frames of the renderer; `None` without a model.
/// Protects its files from being overwritten.
fn laid_out(
    args: &NormalsArgs,
    files: &FileSet,
    [width, height]: [u32; 2],
    warnings: &mut Warnings,
) -> Result<Option<TexelSurface>> {
    let Some(path) = &args.mesh else { return Ok(None) };
    let mut loaded = taotie_io::load_model_within(path, &args.limits.limits())?;
    files.protect(&loaded.files)?;
    warnings.absorb(std::mem::take(&mut loaded.warnings));
    let mesh = &loaded.scene.meshes()[part(args, path, &loaded)?];
    let grid = TexelGrid { width, height, uv_set: args.uv_set, padding: args.dilation };
    let (surface, found) = lay_out(mesh, &grid, args.tangents).with_context(|| path.display().to_string())?;
    if surface.coverage().covered() == 0 {
        bail!("{}: its uvs cover no texel of the map", path.display());
    }
    warnings.absorb(found);
    Ok(Some(surface))
}

/// Returns the number of the requested mesh, or of the only one.
fn part(args: &NormalsArgs, path: &Path, loaded: &Loaded) -> Result<usize> {
    let count = loaded.scene.meshes().len();
    let names: Vec<&str> = (0..count).map(|i| loaded.mesh_names.get(i).map_or("", String::as_str)).collect();
    let path = path.display();
    match &args.part {
        Some(asked) => chosen(asked, ["mesh", "meshes"], &names).map_err(|why| anyhow!("{path}: {why}")),
        None if count == 1 => Ok(0),
        None => {
            bail!("{path}: it has {count} meshes; choose one with --part: {}", listed(&names))
        }
    }
}

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// The report on a conversion.
#[derive(Serialize)]
struct Report {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The path of the input, as given.
    input: String,
    /// The path of the written map.
    output: String,
    /// Texels across and down.
    size: [u32; 2],
    /// The content of the input: `height`, `tangent` or `object`.
    from: &'static str,
    /// The space of the written normals: `tangent` or `object`.
    to: &'static str,
    /// The green direction of the input: `up` or `down`.
    green_in: &'static str,
    /// The green direction of the written map: `up` or `down`.
    green: &'static str,
    /// Bits per channel.
    bits: u8,
    /// `true` if rounding is dithered.
    dither: bool,
    /// Degrees between the exact normals and the stored ones; `None` if the map holds no normal.
    stored: Option<Summary>,
    /// Degrees between the input's normals and those converted back from the output.
    round_trip: Option<Summary>,
    /// Problems and corrections.
    warnings: Vec<Warning>,
}

impl Report {
    /// Makes the report on a conversion.
    fn new(args: &NormalsArgs, input: &MapSource, made: &Conversion, warnings: &Warnings) -> Self {
        Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            input: args.input.display().to_string(),
            output: args.output.display().to_string(),
            size: [made.bitmap.width(), made.bitmap.height()],
            from: content_name(input.content),
            to: made.space.name(),
            green_in: input.green.name(),
            green: GreenChannel::from(args.green.unwrap_or(Green::Up)).name(),
            bits: made.bitmap.bits(),
            dither: args.dither,
            stored: made.stored.summary(),
            round_trip: made.round_trip.as_ref().and_then(Field::summary),
            warnings: warnings.list(),
        }
    }

    /// Returns the report as text.
    fn text(&self) -> String {
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
                let _ = write!(text, "\n{:<10} {}", name, summary_text(angles, 4, "°"));
            }
        }
        text
    }
}

/// Returns the name on the command line.
fn content_name(content: MapContent) -> &'static str {
    match content {
        MapContent::Heights => "height",
        MapContent::Normals(space) => space.name(),
    }
}
