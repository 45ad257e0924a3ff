//! Conversion of a stored map to another, and its error.

use super::storage::{Storage, green_turned, requantised, store_normals, unsigned};
use super::transforms::{
    Heights, decoded_normals, object_from_tangent, tangent_from_height, tangent_from_height_on,
    tangent_from_object,
};
use crate::bake::{TexelGrid, TexelSurface};
use crate::compare::{Field, angular_error};
use crate::error::{Error, Result, Warnings};
use crate::image::{Bitmap, Image, Wrap};
use crate::mesh::Mesh;
use crate::scene::{GreenChannel, NormalSpace};
use crate::surface::{NormalMapKind, TangentMethod, is_normal_map, with_frames};

/// The content of a map.
///
/// ```
/// use taotie_engine::normal_map::MapContent;
/// use taotie_engine::scene::NormalSpace;
///
/// let title = |content: MapContent| match content {
///     MapContent::Heights => "heights",
///     MapContent::Normals(NormalSpace::Tangent) => "normals in tangent space",
///     MapContent::Normals(NormalSpace::Object) => "normals in object space",
/// };
/// assert_eq!(title(MapContent::Normals(NormalSpace::Object)), "normals in object space");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MapContent {
    /// Heights in the first channel; white is high.
    Heights,
    /// Normals.
    Normals(NormalSpace),
}

/// A map to convert.
///
/// ```
/// use taotie_engine::image::{Bitmap, Texels};
/// use taotie_engine::normal_map::{MapContent, MapSource};
/// use taotie_engine::scene::{GreenChannel, NormalSpace};
///
/// let content = MapContent::Normals(NormalSpace::Tangent);
/// let bitmap = Bitmap::new(1, 1, 3, Texels::U8(vec![[128, 90, 240, 255]]))?;
/// let source = MapSource { bitmap, content, green: GreenChannel::Down };
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MapSource {
    /// The texels as stored.
    pub bitmap: Bitmap,
    /// The meaning of its values.
    pub content: MapContent,
    /// The direction in which green points; used only for tangent-space normals.
    pub green: GreenChannel,
}

/// Guesses the content of a map from its pixels: normals, or heights if it is grey; `None` if it looks like neither.
///
/// ```
/// use taotie_engine::image::{Bitmap, Texels};
/// use taotie_engine::normal_map::{MapContent, guessed_content};
/// use taotie_engine::scene::NormalSpace;
///
/// let even = |texel: [u8; 4]| Bitmap::new(2, 2, 3, Texels::U8(vec![texel; 4]));
/// assert_eq!(guessed_content(&even([90, 90, 90, 255])?), Some(MapContent::Heights));
/// let tangent = MapContent::Normals(NormalSpace::Tangent);
/// assert_eq!(guessed_content(&even([128, 128, 255, 255])?), Some(tangent));
/// assert_eq!(guessed_content(&even([255, 255, 90, 255])?), None);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
pub fn guessed_content(bitmap: &Bitmap) -> Option<MapContent> {
    match is_normal_map(bitmap) {
        NormalMapKind::Tangent => Some(MapContent::Normals(NormalSpace::Tangent)),
        NormalMapKind::Object => Some(MapContent::Normals(NormalSpace::Object)),
        NormalMapKind::No => is_grey(bitmap).then_some(MapContent::Heights),
    }
}

/// Returns a map with its content, guessed from its pixels unless it is given; normals that float files store as they are
/// become codes, as by [`unsigned`].
///
/// # Errors
/// Those of [`unsigned`].
pub fn with_content(stored: Bitmap, given: Option<MapContent>) -> Result<(Bitmap, Option<MapContent>)> {
    let content = given.or_else(|| guessed_content(&stored));
    if content == Some(MapContent::Heights) {
        return Ok((stored, content));
    }
    let bitmap = unsigned(stored)?;
    let content = content.or_else(|| guessed_content(&bitmap));
    Ok((bitmap, content))
}

fn is_grey(bitmap: &Bitmap) -> bool {
    (0..bitmap.texels().len()).map(|i| bitmap.stored(i)).all(|[r, g, b, _]| r == g && g == b)
}

/// The requested map.
///
/// ```
/// use taotie_engine::image::{Bitmap, Texels};
/// use taotie_engine::normal_map::{ConversionOptions, MapContent, MapSource, convert_map};
/// use taotie_engine::scene::GreenChannel;
///
/// let bitmap = Bitmap::new(4, 4, 1, Texels::U8(vec![[90, 90, 90, 255]; 16]))?;
/// let heights = MapSource { bitmap, content: MapContent::Heights, green: GreenChannel::Up };
/// let options = ConversionOptions { height_scale: Some(2.0), ..ConversionOptions::default() };
/// assert_eq!(convert_map(&heights, &options, None)?.bitmap.bits(), 16);
/// assert!(convert_map(&heights, &ConversionOptions::default(), None).is_err(), "no scale");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct ConversionOptions {
    /// Its space; `None` uses the source's, tangent space for heights.
    pub space: Option<NormalSpace>,
    /// The direction in which its green points.
    pub green: GreenChannel,
    /// Bits per channel, 8 or 16; `None` uses those of the source if its space is kept, else 16.
    pub bits: Option<u8>,
    /// See [`Storage::dither`].
    pub dither: bool,
    /// Height of white: in texels, or in model units on a mesh. Required to convert heights.
    pub height_scale: Option<f64>,
    /// How heights continue beyond the border of the map.
    pub border: Wrap,
}

impl Default for ConversionOptions {
    fn default() -> Self {
        Self {
            space: None,
            green: GreenChannel::Up,
            bits: None,
            dither: false,
            height_scale: None,
            border: Wrap::Repeat,
        }
    }
}

/// The converted map, and its errors.
///
/// ```
/// use taotie_engine::normal_map::Conversion;
///
/// /// Returns the largest angular error of this map, in degrees.
/// fn most(made: &Conversion) -> Option<f64> {
///     let round_trip = made.round_trip.as_ref().and_then(|field| field.summary());
///     Some(round_trip.or(made.stored.summary())?.max)
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Conversion {
    /// The map.
    pub bitmap: Bitmap,
    /// The space of its normals.
    pub space: NormalSpace,
    /// The angle between the exact normals and the stored ones, in degrees.
    pub stored: Field,
    /// The angle between the source's normals and those converted back from the map, in degrees; `None` if the space
    /// was kept.
    pub round_trip: Option<Field>,
    /// Counts of normals that the map cannot represent.
    pub warnings: Warnings,
}

/// Converts `source` to the requested space and bit depth. `surface` is the mesh that the map is for: it is required
/// between tangent and object space.
///
/// ```
/// use taotie_engine::image::{Bitmap, Texels};
/// use taotie_engine::normal_map::{ConversionOptions, MapContent, MapSource, convert_map};
/// use taotie_engine::scene::{GreenChannel, NormalSpace};
///
/// let bitmap = Bitmap::new(1, 1, 3, Texels::U8(vec![[128, 90, 240, 255]]))?;
/// let content = MapContent::Normals(NormalSpace::Tangent);
/// let directx = MapSource { bitmap, content, green: GreenChannel::Down };
/// let opengl = convert_map(&directx, &ConversionOptions::default(), None)?;
/// assert_eq!(opengl.bitmap.texels(), &Texels::U8(vec![[128, 165, 240, 255]]));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`] if the height of white or the mesh is missing, if the mesh covers no texel or was laid out on a
/// map of another size, and for bit depths other than 8 and 16.
pub fn convert_map(
    source: &MapSource,
    options: &ConversionOptions,
    surface: Option<&TexelSurface>,
) -> Result<Conversion> {
    if surface.is_some_and(|surface| surface.coverage().covered() == 0) {
        return Err(Error::invalid("the mesh for a map", "its uvs cover no texel of the map"));
    }
    let own = match source.content {
        MapContent::Heights => None,
        MapContent::Normals(space) => Some(space),
    };
    let space = options.space.or(own).unwrap_or(NormalSpace::Tangent);
    let task = Task { source, options, surface, space };
    match own {
        None => task.of_heights(),
        Some(own) if own == space => task.of_same_space(),
        Some(own) => task.of_other_space(own),
    }
}

/// Returns a mesh laid out on a map, with the frames that the renderer gives it, and warnings about what is lost.
///
/// ```
/// use taotie_engine::bake::TexelGrid;
/// use taotie_engine::mesh::Mesh;
/// use taotie_engine::normal_map::lay_out;
///
/// let grid = TexelGrid { width: 64, height: 64, uv_set: 0, padding: 2 };
/// let (ball, _) = lay_out(&Mesh::sphere(1.0, 32, 16), &grid, None)?;
/// assert!(ball.coverage().is_covered(32, 32));
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// As [`with_frames`] and [`TexelSurface::new`].
pub fn lay_out(
    mesh: &Mesh,
    grid: &TexelGrid,
    tangents: Option<TangentMethod>,
) -> Result<(TexelSurface, Warnings)> {
    let mut warnings = Warnings::default();
    let (mesh, without_area) = with_frames(mesh, grid.uv_set, tangents)?;
    warnings.note("triangles without uv area", without_area);
    let surface = TexelSurface::new(mesh.into_owned(), grid)?;
    let shared = surface.coverage().shared();
    warnings.note("texels covered by several triangles: the map holds only the normal of the first", shared);
    Ok((surface, warnings))
}

/// A conversion with all its inputs.
#[derive(Clone, Copy)]
struct Task<'a> {
    source: &'a MapSource,
    options: &'a ConversionOptions,
    surface: Option<&'a TexelSurface>,
    space: NormalSpace,
}

impl Task<'_> {
    fn of_heights(self) -> Result<Conversion> {
        let Some(scale) = self.options.height_scale else {
            let why = "set the height of white: in texels, or in model units on a mesh";
            return Err(Error::invalid("heights without a scale", why));
        };
        let heights = Heights::from_bitmap(&self.source.bitmap, [self.options.border; 2]);
        let tangent = match self.surface {
            Some(surface) => tangent_from_height_on(surface, &heights, scale)?,
            None => tangent_from_height(&heights, scale)?,
        };
        let exact = match self.space {
            NormalSpace::Tangent => tangent,
            NormalSpace::Object => object_from_tangent(self.needed_surface()?, &tangent)?,
        };
        self.stored(&exact)
    }

    /// Converts the bits and flips green, value by value, so that unchanged values are preserved.
    fn of_same_space(self) -> Result<Conversion> {
        let (source, green) = (self.source, self.options.green);
        let turned = self.space == NormalSpace::Tangent && source.green != green;
        let turned = turned.then(|| green_turned(&source.bitmap));
        let bits = if source.bitmap.bits() == 8 { 8 } else { 16 };
        let bitmap = requantised(turned.as_ref().unwrap_or(&source.bitmap), self.storage(bits))?;
        let before = decoded_normals(&source.bitmap, self.space, source.green)?;
        let after = decoded_normals(&bitmap, self.space, green)?;
        let stored = angular_error(&before, &after)?;
        let warnings = Warnings::default();
        Ok(Conversion { bitmap, space: self.space, stored, round_trip: None, warnings })
    }

    fn of_other_space(self, own: NormalSpace) -> Result<Conversion> {
        let surface = self.needed_surface()?;
        let before = decoded_normals(&self.source.bitmap, own, self.source.green)?;
        let (there, back): (Turn, Turn) = match self.space {
            NormalSpace::Object => (object_from_tangent, tangent_from_object),
            NormalSpace::Tangent => (tangent_from_object, object_from_tangent),
        };
        let exact = there(surface, &before)?;
        let made = self.stored(&exact)?;
        let read = decoded_normals(&made.bitmap, self.space, self.options.green)?;
        let round_trip = self.in_islands(angular_error(&before, &back(surface, &read)?)?)?;
        let warnings = lost(surface, &exact, self.space);
        Ok(Conversion { round_trip: Some(round_trip), warnings, ..made })
    }

    fn stored(self, exact: &Image) -> Result<Conversion> {
        let stored = store_normals(exact, self.space, self.options.green, self.storage(16))?;
        let (bitmap, warnings) = (stored.bitmap, Warnings::default());
        let stored = self.in_islands(stored.error)?;
        Ok(Conversion { bitmap, space: self.space, stored, round_trip: None, warnings })
    }

    fn storage(self, otherwise: u8) -> Storage {
        Storage { bits: self.options.bits.unwrap_or(otherwise), dither: self.options.dither }
    }

    fn needed_surface(&self) -> Result<&TexelSurface> {
        self.surface.ok_or_else(|| {
            Error::invalid(
                "normals between tangent and object space",
                "a mesh is required; lay it out on the map",
            )
        })
    }

    /// Returns the field inside UV islands, without their padding.
    fn in_islands(self, field: Field) -> Result<Field> {
        match self.surface {
            Some(surface) => field.within(&surface.coverage().mask()),
            None => Ok(field),
        }
    }
}

type Turn = fn(&TexelSurface, &Image) -> Result<Image>;

/// Counts the normals that the map cannot represent.
fn lost(surface: &TexelSurface, exact: &Image, space: NormalSpace) -> Warnings {
    let mut warnings = Warnings::default();
    let mask = surface.coverage().mask();
    let covered =
        || exact.pixels().iter().zip(&mask).filter(|(_, covered)| **covered).map(|(pixel, _)| pixel);
    let lacking = covered().filter(|pixel| pixel[3] == 0.0).count();
    warnings.note("texels of the mesh without a normal in the input", lacking);
    if space == NormalSpace::Tangent {
        let behind = covered().filter(|pixel| pixel[3] > 0.0 && pixel[2] <= 0.0).count();
        let what = "normals that point into the mesh, which renderers of tangent space bend outward";
        warnings.note(what, behind);
    }
    warnings
}
