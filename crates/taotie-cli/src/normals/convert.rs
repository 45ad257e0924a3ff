//! From the input to the map that is written, and how far off it is.

use super::args::NormalsArgs;
use super::input::{Input, Kind};
use anyhow::{Result, bail};
use taotie::Warnings;
use taotie::bake::{self, Heights, Storage, TexelSurface, decoded_normals};
use taotie::compare::{Field, angular_error};
use taotie::image::{Bitmap, Image};
use taotie::scene::{GreenChannel, NormalSpace};

/// A map that was made.
pub struct Converted {
    /// To be written.
    pub bitmap: Bitmap,
    /// The space of its normals.
    pub space: NormalSpace,
    /// The angle between the exact normals and the ones stored, degrees.
    pub stored: Field,
    /// The angle between the input's normals and those that come back from the output, degrees; where the space
    /// changed.
    pub round_trip: Option<Field>,
}

/// Converts the input to the space and the bits asked for.
pub fn convert(
    args: &NormalsArgs,
    input: &Input,
    surface: Option<&TexelSurface>,
    warnings: &mut Warnings,
) -> Result<Converted> {
    let space = match (args.to, input.kind) {
        (Some(space), _) => space.into(),
        (None, Kind::Normals(space)) => space,
        (None, Kind::Height) => NormalSpace::Tangent,
    };
    let green = args.green.into();
    match input.kind {
        Kind::Height => {
            from_height(args, input, surface, Target { space, green, storage: storage(args, 16) })
        }
        Kind::Normals(same) if same == space => {
            let bits = if input.bitmap.bits() == 8 { 8 } else { 16 };
            same_space(input, Target { space, green, storage: storage(args, bits) })
        }
        Kind::Normals(from) => {
            let target = Target { space, green, storage: storage(args, 16) };
            other_space(input, from, needed(surface, "between tangent and object space")?, target, warnings)
        }
    }
}

/// What is to be made.
#[derive(Clone, Copy)]
struct Target {
    space: NormalSpace,
    green: GreenChannel,
    storage: Storage,
}

impl Target {
    fn store(self, normals: &Image, surface: Option<&TexelSurface>) -> Result<(Bitmap, Field)> {
        let stored = bake::store_normals(normals, self.space, self.green, self.storage)?;
        Ok((stored.bitmap, in_charts(stored.error, surface)?))
    }
}

fn storage(args: &NormalsArgs, otherwise: u8) -> Storage {
    let bits = match args.bits.as_deref() {
        Some("8") => 8,
        Some(_) => 16,
        None => otherwise,
    };
    Storage { bits, dither: args.dither }
}

fn needed<'a>(surface: Option<&'a TexelSurface>, what: &str) -> Result<&'a TexelSurface> {
    match surface {
        Some(surface) => Ok(surface),
        None => bail!("{what} the mesh has to be known; name the model with --mesh"),
    }
}

/// The field where charts are, without their margins.
fn in_charts(field: Field, surface: Option<&TexelSurface>) -> Result<Field> {
    Ok(match surface {
        Some(surface) => field.within(&surface.coverage().mask())?,
        None => field,
    })
}

fn from_height(
    args: &NormalsArgs,
    input: &Input,
    surface: Option<&TexelSurface>,
    target: Target,
) -> Result<Converted> {
    let Some(scale) = args.height_scale else {
        bail!(
            "--height-scale is needed for heights: the height of white in texels, or in model units with --mesh"
        );
    };
    let heights = Heights::from_bitmap(&input.bitmap, [args.border.wrap(); 2]);
    let tangent = match surface {
        Some(surface) => bake::tangent_from_height_on(surface, &heights, scale)?,
        None => bake::tangent_from_height(&heights, scale)?,
    };
    let exact = match target.space {
        NormalSpace::Tangent => tangent,
        NormalSpace::Object => bake::object_from_tangent(needed(surface, "for object space")?, &tangent)?,
    };
    let (bitmap, stored) = target.store(&exact, surface)?;
    Ok(Converted { bitmap, space: target.space, stored, round_trip: None })
}

/// Other bits, green turned: number by number, so that what can stay does.
fn same_space(input: &Input, target: Target) -> Result<Converted> {
    let turned = (target.space == NormalSpace::Tangent && input.green != target.green)
        .then(|| bake::green_turned(&input.bitmap));
    let bitmap = bake::requantised(turned.as_ref().unwrap_or(&input.bitmap), target.storage)?;
    let before = decoded_normals(&input.bitmap, target.space, input.green)?;
    let after = decoded_normals(&bitmap, target.space, target.green)?;
    Ok(Converted { stored: angular_error(&before, &after)?, bitmap, space: target.space, round_trip: None })
}

fn other_space(
    input: &Input,
    from: NormalSpace,
    surface: &TexelSurface,
    target: Target,
    warnings: &mut Warnings,
) -> Result<Converted> {
    let before = decoded_normals(&input.bitmap, from, input.green)?;
    let (there, back): (Turn, Turn) = match target.space {
        NormalSpace::Object => (bake::object_from_tangent, bake::tangent_from_object),
        NormalSpace::Tangent => (bake::tangent_from_object, bake::object_from_tangent),
    };
    let exact = there(surface, &before)?;
    note_lost(surface, &exact, target.space, warnings);
    let (bitmap, stored) = target.store(&exact, Some(surface))?;
    let again = back(surface, &decoded_normals(&bitmap, target.space, target.green)?)?;
    let round_trip = in_charts(angular_error(&before, &again)?, Some(surface))?;
    Ok(Converted { bitmap, space: target.space, stored, round_trip: Some(round_trip) })
}

type Turn = fn(&TexelSurface, &Image) -> taotie::Result<Image>;

/// Counts what the map cannot hold.
fn note_lost(surface: &TexelSurface, exact: &Image, space: NormalSpace, warnings: &mut Warnings) {
    let mask = surface.coverage().mask();
    let covered =
        || exact.pixels().iter().zip(&mask).filter(|(_, covered)| **covered).map(|(pixel, _)| pixel);
    warnings
        .note("texels of the mesh without a normal in the input", covered().filter(|p| p[3] == 0.0).count());
    if space == NormalSpace::Tangent {
        let behind = covered().filter(|p| p[3] > 0.0 && p[2] <= 0.0).count();
        warnings
            .note("normals that point into the mesh, which renderers of tangent space bend outward", behind);
    }
}
