//! The map to convert: its content and green direction, from options or guessed from its pixels.

use super::args::{From, NormalsArgs};
use crate::console;
use anyhow::{Result, bail};
use taotie_engine::image::Bitmap;
use taotie_engine::normal_map::{MapContent, MapSource, guessed_content};
use taotie_engine::scene::{GreenChannel, NormalSpace};
use taotie_engine::surface::{GreenVerdict, green_direction};

/// Reads the map and determines its content; prints what was guessed.
pub fn read(args: &NormalsArgs) -> Result<MapSource> {
    let bitmap = taotie_io::read_bitmap_within(&args.input, &args.limits.limits())?;
    let content = match args.from {
        From::Height => MapContent::Heights,
        From::Tangent => MapContent::Normals(NormalSpace::Tangent),
        From::Object => MapContent::Normals(NormalSpace::Object),
        From::Auto => guess(args, &bitmap)?,
    };
    let green = match (content, args.green_in) {
        (MapContent::Normals(NormalSpace::Tangent), Some(green)) => green.into(),
        (MapContent::Normals(NormalSpace::Tangent), None) => guessed_green(args, &bitmap),
        _ => GreenChannel::Up,
    };
    Ok(MapSource { bitmap, content, green })
}

/// Returns the name on the command line.
pub fn content_name(content: MapContent) -> &'static str {
    match content {
        MapContent::Heights => "height",
        MapContent::Normals(space) => space_name(space),
    }
}

/// Returns the name on the command line.
pub fn space_name(space: NormalSpace) -> &'static str {
    match space {
        NormalSpace::Tangent => "tangent",
        NormalSpace::Object => "object",
    }
}

fn guess(args: &NormalsArgs, bitmap: &Bitmap) -> Result<MapContent> {
    let path = args.input.display();
    let Some(content) = guessed_content(bitmap) else {
        bail!("{path}: it looks like neither a normal map nor heights; specify its content with --from")
    };
    let name = match content {
        MapContent::Normals(NormalSpace::Tangent) => "a tangent-space normal map",
        MapContent::Normals(NormalSpace::Object) => "an object-space normal map",
        MapContent::Heights => "a height map",
    };
    console::say(&format!("taotie: {path}: its pixels look like {name}"));
    Ok(content)
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
