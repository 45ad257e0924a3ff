//! What is converted: its kind and its green, as they are said to be or by the pixels.

use super::args::{From, NormalsArgs};
use crate::console;
use anyhow::{Result, bail};
use taotie::image::Bitmap;
use taotie::io;
use taotie::scene::{GreenChannel, NormalSpace};
use taotie::surface::{GreenVerdict, NormalMapKind, green_direction, is_normal_map};

/// What a map holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Heights in the first channel.
    Height,
    /// Normals.
    Normals(NormalSpace),
}

/// The map that is converted.
pub struct Input {
    /// As it is stored.
    pub bitmap: Bitmap,
    /// What it holds.
    pub kind: Kind,
    /// Which way its green points; up for heights and in object space.
    pub green: GreenChannel,
}

impl Input {
    /// Reads the map and decides what it holds; says what was guessed.
    pub fn read(args: &NormalsArgs) -> Result<Self> {
        let bitmap = io::read_bitmap(&args.input)?;
        let kind = match args.from {
            From::Height => Kind::Height,
            From::Tangent => Kind::Normals(NormalSpace::Tangent),
            From::Object => Kind::Normals(NormalSpace::Object),
            From::Auto => guessed_kind(args, &bitmap)?,
        };
        let green = match (kind, args.green_in) {
            (Kind::Normals(NormalSpace::Tangent), Some(green)) => green.into(),
            (Kind::Normals(NormalSpace::Tangent), None) => guessed_green(args, &bitmap),
            _ => GreenChannel::Up,
        };
        Ok(Self { bitmap, kind, green })
    }
}

impl Kind {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Height => "height",
            Self::Normals(space) => space_name(space),
        }
    }
}

/// The name on the command line.
pub fn space_name(space: NormalSpace) -> &'static str {
    match space {
        NormalSpace::Tangent => "tangent",
        NormalSpace::Object => "object",
    }
}

fn guessed_kind(args: &NormalsArgs, bitmap: &Bitmap) -> Result<Kind> {
    let path = args.input.display();
    let (kind, name) = match is_normal_map(bitmap) {
        NormalMapKind::Tangent => (Kind::Normals(NormalSpace::Tangent), "a tangent-space normal map"),
        NormalMapKind::Object => (Kind::Normals(NormalSpace::Object), "an object-space normal map"),
        NormalMapKind::No if is_grey(bitmap) => (Kind::Height, "a height map"),
        NormalMapKind::No => {
            bail!("{path}: it looks neither like a normal map nor like heights; say what it is with --from")
        }
    };
    console::say(&format!("taotie: {path}: {name} by its pixels"));
    Ok(kind)
}

fn is_grey(bitmap: &Bitmap) -> bool {
    (0..bitmap.texels().len()).map(|i| bitmap.stored(i)).all(|[r, g, b, _]| r == g && g == b)
}

fn guessed_green(args: &NormalsArgs, bitmap: &Bitmap) -> GreenChannel {
    let path = args.input.display();
    let guess = green_direction(bitmap);
    let (green, name) = match guess.verdict {
        GreenVerdict::Up => (GreenChannel::Up, "up"),
        GreenVerdict::Down => (GreenChannel::Down, "down"),
        GreenVerdict::Unclear => {
            console::say(&format!(
                "taotie: {path}: its pixels do not tell which way green points; taken as up (--green-in)"
            ));
            return GreenChannel::Up;
        }
    };
    console::say(&format!(
        "taotie: {path}: green points {name} by its pixels ({:.0} % sure)",
        guess.confidence * 100.0
    ));
    green
}
