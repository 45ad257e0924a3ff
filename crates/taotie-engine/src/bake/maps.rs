//! The maps of a bake: which there are, their texels while they are being baked, and the outcomes of the samples.
//!
//! A map holds one number or vector per texel, row by row from the top.

use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::names::Named;
use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

/// A map that a scan can be baked into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapKind {
    /// The scan's normals.
    Normal,
    /// The open part of the hemisphere over the scan, weighted by the cosine: 1 is open.
    #[serde(rename = "ao")]
    Occlusion,
    /// The scan's base colour, from its vertices, materials and textures.
    Albedo,
    /// The height of the scan above the low-poly mesh.
    Height,
    /// The mean open direction.
    Bent,
    /// The scan's mean curvature, above 0 where it bulges.
    Curvature,
    /// Roughness, widened by relief finer than a texel.
    Roughness,
    /// The scan's own metalness and roughness, from its materials and textures.
    MetallicRoughness,
    /// The radiance that the scan emits.
    Emission,
    /// The scan's alpha, from its vertices, materials and textures.
    Alpha,
    /// The scan's own occlusion texture.
    #[serde(rename = "occlusion")]
    OcclusionMap,
    /// The scan's positions.
    Position,
    /// The scan's normals in its own space, whatever the space of the normal map.
    WorldNormal,
    /// The mean distance through the scan to its opposite side, weighted by the cosine.
    Thickness,
    /// The colours of the scan's vertices.
    VertexColor,
    /// The number of the scan's material.
    MaterialId,
    /// The number of the scan's object.
    ObjectId,
    /// The edges of the low-poly mesh.
    Wireframe,
    /// The scan's normals with rounded edges.
    Bevel,
    /// The vector from the low-poly mesh to the scan.
    VectorDisplacement,
    /// The scan's mean curvature where it bulges, 0 elsewhere.
    Convexity,
    /// The amount of the scan's mean curvature where it is hollow, 0 elsewhere.
    Concavity,
    /// The height of the scan's points between its lowest and its highest.
    Gradient,
}

impl Named for MapKind {
    const WHAT: &'static str = "map";
    const NAMES: &'static [(&'static str, Self)] = &[
        ("normal", Self::Normal),
        ("ao", Self::Occlusion),
        ("albedo", Self::Albedo),
        ("height", Self::Height),
        ("bent", Self::Bent),
        ("curvature", Self::Curvature),
        ("roughness", Self::Roughness),
        ("metallic-roughness", Self::MetallicRoughness),
        ("emission", Self::Emission),
        ("alpha", Self::Alpha),
        ("occlusion", Self::OcclusionMap),
        ("position", Self::Position),
        ("world-normal", Self::WorldNormal),
        ("thickness", Self::Thickness),
        ("vertex-color", Self::VertexColor),
        ("material-id", Self::MaterialId),
        ("object-id", Self::ObjectId),
        ("wireframe", Self::Wireframe),
        ("bevel", Self::Bevel),
        ("vector-displacement", Self::VectorDisplacement),
        ("convexity", Self::Convexity),
        ("concavity", Self::Concavity),
        ("gradient", Self::Gradient),
    ];
}

/// The meaning of a map's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapContent {
    /// Unit vectors.
    Direction,
    /// Linear RGB.
    Color,
    /// Fractions, [0, 1].
    Fraction,
    /// Numbers or vectors in a unit of length or its inverse.
    Length,
    /// Numbers of things, from 0 up, which have no mean.
    Label,
}

impl MapKind {
    /// Returns the planes that the map is stored from.
    pub const fn planes(self) -> &'static [Plane] {
        match self {
            Self::Normal => &[Plane::Normal],
            Self::Occlusion | Self::OcclusionMap => &[Plane::Occlusion],
            Self::Albedo => &[Plane::Albedo],
            Self::Height => &[Plane::Height],
            Self::Bent => &[Plane::Bent],
            Self::Curvature | Self::Convexity | Self::Concavity => &[Plane::Curvature],
            Self::Roughness => &[Plane::Roughness],
            Self::MetallicRoughness => &[Plane::Roughness, Plane::Metallic],
            Self::Emission => &[Plane::Emission],
            Self::Alpha => &[Plane::Alpha],
            Self::Position | Self::Gradient => &[Plane::Position],
            Self::WorldNormal => &[Plane::WorldNormal],
            Self::Thickness => &[Plane::Thickness],
            Self::VertexColor => &[Plane::VertexColor],
            Self::MaterialId => &[Plane::MaterialId],
            Self::ObjectId => &[Plane::ObjectId],
            Self::Wireframe => &[Plane::Wireframe],
            Self::Bevel => &[Plane::Bevel],
            Self::VectorDisplacement => &[Plane::VectorDisplacement],
        }
    }

    /// Returns the meaning of its values.
    pub const fn content(self) -> MapContent {
        match self {
            Self::Normal | Self::Bent | Self::WorldNormal | Self::Bevel => MapContent::Direction,
            Self::Albedo | Self::Emission | Self::VertexColor => MapContent::Color,
            Self::Height | Self::Position | Self::Thickness | Self::VectorDisplacement => MapContent::Length,
            Self::Curvature | Self::Convexity | Self::Concavity => MapContent::Length,
            Self::MaterialId | Self::ObjectId => MapContent::Label,
            Self::Occlusion
            | Self::OcclusionMap
            | Self::Roughness
            | Self::MetallicRoughness
            | Self::Alpha
            | Self::Gradient
            | Self::Wireframe => MapContent::Fraction,
        }
    }

    /// Returns `true` if glTF materials have no slot for the map, so that it is a file next to the asset.
    pub const fn is_separate(self) -> bool {
        match self {
            Self::Wireframe | Self::Gradient | Self::VertexColor => true,
            Self::Bent | Self::WorldNormal | Self::Bevel => true,
            _ => matches!(self.content(), MapContent::Length | MapContent::Label),
        }
    }

    /// Returns `true` if its numbers need 16 bits.
    pub const fn is_fine(self) -> bool {
        matches!(self, Self::Gradient) || matches!(self.content(), MapContent::Length)
    }

    /// Returns the value of a map of curvature.
    pub fn of_curvature(self, curvature: f32) -> f32 {
        match self {
            Self::Convexity => curvature.max(0.0),
            Self::Concavity => (-curvature).max(0.0),
            _ => curvature,
        }
    }

    /// Returns the value of a gradient at this height of a scan: 0 at its lowest point, 1 at its highest.
    pub fn gradient(y: f32, [lowest, highest]: [f32; 2]) -> f32 {
        if highest > lowest { ((y - lowest) / (highest - lowest)).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// A set of maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(from = "Vec<MapKind>", into = "Vec<MapKind>")]
pub struct Maps(u32);

impl Maps {
    /// Returns the set with one more map.
    pub fn with(self, map: MapKind) -> Self {
        Self(self.0 | 1 << map as u8)
    }

    /// Returns `true` if a map is in the set.
    pub fn has(self, map: MapKind) -> bool {
        self.0 & 1 << map as u8 != 0
    }

    /// Returns `true` if any of several maps is in the set.
    pub fn has_any(self, maps: &[MapKind]) -> bool {
        maps.iter().any(|map| self.has(*map))
    }

    /// Returns the maps, in the order of [`MapKind`].
    pub fn iter(self) -> impl Iterator<Item = MapKind> {
        MapKind::NAMES.iter().map(|(_, map)| *map).filter(move |map| self.has(*map))
    }
}

impl From<Vec<MapKind>> for Maps {
    fn from(maps: Vec<MapKind>) -> Self {
        maps.into_iter().collect()
    }
}

impl From<Maps> for Vec<MapKind> {
    fn from(maps: Maps) -> Self {
        maps.iter().collect()
    }
}

impl FromIterator<MapKind> for Maps {
    fn from_iter<I: IntoIterator<Item = MapKind>>(maps: I) -> Self {
        maps.into_iter().fold(Self::default(), Self::with)
    }
}

/// The sizes of the maps of several materials. As text: `same`, `even`, or names as in `wood=1024,iron=512`.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum SetSizes {
    /// All have the same.
    #[default]
    Same,
    /// Texels are as wide on the surface for all; the largest maps have the size of the bake.
    Even,
    /// Texels across and down, by the name of the material; the others have the size of the bake.
    Named(BTreeMap<String, u32>),
}

impl SetSizes {
    /// Returns the largest side of any maps if those of the bake have `side`.
    pub fn largest(&self, side: u32) -> u32 {
        match self {
            Self::Named(sizes) => sizes.values().fold(side, |most, own| most.max(*own)),
            Self::Same | Self::Even => side,
        }
    }
}

impl FromStr for SetSizes {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::invalid(
                text,
                "expected same, even, or names with sizes from 16 to 16384, as in wood=1024,iron=512",
            )
        };
        let named = |item: &str| {
            let (name, side) = item.rsplit_once('=').ok_or_else(wrong)?;
            let side = side.trim().parse().ok().filter(|side| (16..=16_384).contains(side));
            side.map(|side| (name.trim().to_owned(), side)).ok_or_else(wrong)
        };
        match text {
            "same" => Ok(Self::Same),
            "even" => Ok(Self::Even),
            list => list.split(',').map(named).collect::<Result<_>>().map(Self::Named),
        }
    }
}

impl fmt::Display for SetSizes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Same => f.write_str("same"),
            Self::Even => f.write_str("even"),
            Self::Named(sizes) => {
                let items: Vec<String> = sizes.iter().map(|(name, side)| format!("{name}={side}")).collect();
                f.write_str(&items.join(","))
            }
        }
    }
}

impl TryFrom<String> for SetSizes {
    type Error = Error;

    fn try_from(text: String) -> Result<Self> {
        text.parse()
    }
}

impl From<SetSizes> for String {
    fn from(sizes: SetSizes) -> Self {
        sizes.to_string()
    }
}

/// The result of baking a texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum TexelStatus {
    /// No triangle covers it.
    #[default]
    Free,
    /// All its projection rays hit the scan.
    Met,
    /// A projection ray missed and used the closest point of the scan.
    Closest,
    /// No point of the scan faces the right way either: the texel holds the low-poly mesh's own normal.
    Lost,
}

/// A quantity that maps are stored from: a number or a vector per texel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    /// Unit normals, in the requested space.
    Normal,
    /// The open part of the hemisphere, [0, 1], found by rays or read from the scan's textures.
    Occlusion,
    /// The base colour, linear RGB.
    Albedo,
    /// The height above the low-poly mesh, in model units.
    Height,
    /// The mean open direction, unit, in the requested space.
    Bent,
    /// The mean curvature, in 1 / model units.
    Curvature,
    /// The perceptual roughness, as artists set it, [0, 1].
    Roughness,
    /// [0, 1].
    Metallic,
    /// [0, 1].
    Alpha,
    /// Emitted radiance, linear RGB.
    Emission,
    /// The position on the scan, in model units.
    Position,
    /// Unit normals in the space of the scan.
    WorldNormal,
    /// The mean distance through the scan, in model units; 0 where every ray leaves it.
    Thickness,
    /// The colour of the scan's vertices, linear RGB.
    VertexColor,
    /// The index of the scan's material.
    MaterialId,
    /// The index of the scan's object.
    ObjectId,
    /// The share of the texel within one texel of an edge of the low-poly mesh, [0, 1].
    Wireframe,
    /// Unit normals with rounded edges, in the requested space.
    Bevel,
    /// The vector from the low-poly mesh to the scan in the requested space, in model units.
    VectorDisplacement,
}

impl Plane {
    const ALL: [Self; 19] = [
        Self::Normal,
        Self::Occlusion,
        Self::Albedo,
        Self::Height,
        Self::Bent,
        Self::Curvature,
        Self::Roughness,
        Self::Metallic,
        Self::Alpha,
        Self::Emission,
        Self::Position,
        Self::WorldNormal,
        Self::Thickness,
        Self::VertexColor,
        Self::MaterialId,
        Self::ObjectId,
        Self::Wireframe,
        Self::Bevel,
        Self::VectorDisplacement,
    ];

    /// Returns the numbers per texel: 1 or 3.
    pub const fn channels(self) -> usize {
        match self {
            Self::Normal | Self::Bent | Self::WorldNormal | Self::Bevel => 3,
            Self::Position | Self::VectorDisplacement => 3,
            Self::Albedo | Self::Emission | Self::VertexColor => 3,
            _ => 1,
        }
    }

    /// Returns `true` if its numbers have no mean.
    pub(super) const fn is_label(self) -> bool {
        matches!(self, Self::MaterialId | Self::ObjectId)
    }

    /// Returns the values of texels that no triangle covers.
    fn free(self, count: usize) -> Vec<f32> {
        match self {
            Self::Normal | Self::Bent | Self::WorldNormal | Self::Bevel => [0.0, 0.0, 1.0].repeat(count),
            Self::Occlusion | Self::Alpha => vec![1.0; count],
            // Labels begin at 0.
            Self::MaterialId | Self::ObjectId => vec![-1.0; count],
            _ => vec![0.0; count * self.channels()],
        }
    }
}

/// Baked maps; planes that no requested map needs are empty.
#[derive(Debug, Clone, Default)]
pub struct BakedMaps {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// The status of each texel.
    pub texels: Vec<TexelStatus>,
    /// The numbers of each plane, in the order of [`Plane`].
    planes: [Vec<f32>; Plane::ALL.len()],
}

impl BakedMaps {
    pub(super) fn new([width, height]: [u32; 2], maps: Maps) -> Self {
        let count = width as usize * height as usize;
        let mut planes = <[Vec<f32>; Plane::ALL.len()]>::default();
        for plane in maps.iter().flat_map(MapKind::planes) {
            planes[*plane as usize] = plane.free(count);
        }
        Self { width, height, texels: vec![TexelStatus::Free; count], planes }
    }

    /// Texels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Returns `true` if a requested map needs a plane.
    pub fn has(&self, plane: Plane) -> bool {
        !self.planes[plane as usize].is_empty()
    }

    /// Returns the numbers of a plane, one per texel, or three of each vector; empty if no requested map needs them.
    pub fn numbers(&self, plane: Plane) -> &[f32] {
        &self.planes[plane as usize]
    }

    /// Returns the vectors of a plane, one per texel; empty if no requested map needs them.
    pub fn vectors(&self, plane: Plane) -> &[[f32; 3]] {
        self.numbers(plane).as_chunks().0
    }

    /// Returns the planes that requested maps need, with their numbers.
    pub fn planes(&self) -> impl Iterator<Item = (Plane, &[f32])> {
        Plane::ALL.into_iter().map(|plane| (plane, self.numbers(plane))).filter(|(_, v)| !v.is_empty())
    }

    /// Returns the planes that are filled between UV islands: all but drawings of the islands themselves.
    pub(super) fn filled_planes(&mut self) -> impl Iterator<Item = (Plane, &mut Vec<f32>)> {
        let is_filled =
            |(plane, numbers): &(Plane, &mut Vec<f32>)| *plane != Plane::Wireframe && !numbers.is_empty();
        Plane::ALL.into_iter().zip(&mut self.planes).filter(is_filled)
    }

    pub(super) fn numbers_mut(&mut self, plane: Plane) -> &mut [f32] {
        &mut self.planes[plane as usize]
    }

    pub(super) fn vectors_mut(&mut self, plane: Plane) -> &mut [[f32; 3]] {
        self.numbers_mut(plane).as_chunks_mut().0
    }

    /// Returns the values of a plane of numbers at texels that a triangle covers.
    pub fn covered(&self, plane: Plane) -> Vec<f32> {
        let is_covered = |(texel, _): &(&TexelStatus, &f32)| **texel != TexelStatus::Free;
        self.texels.iter().zip(self.numbers(plane)).filter(is_covered).map(|(_, v)| *v).collect()
    }

    /// Splits the maps into bands of at most `rows` rows.
    pub(super) fn bands(&mut self, rows: u32) -> Vec<BandMaps<'_>> {
        let count = rows as usize * self.width as usize;
        let mut bands: Vec<BandMaps<'_>> =
            self.texels.chunks_mut(count).map(|texels| BandMaps { texels, planes: Vec::new() }).collect();
        for (plane, numbers) in Plane::ALL.into_iter().zip(&mut self.planes) {
            let mut chunks = numbers.chunks_mut(count * plane.channels());
            bands.iter_mut().for_each(|band| band.planes.push(chunks.next().unwrap_or_default()));
        }
        bands
    }
}

/// The rows of [`BakedMaps`] that a band covers.
pub(super) struct BandMaps<'a> {
    pub texels: &'a mut [TexelStatus],
    planes: Vec<&'a mut [f32]>,
}

impl BandMaps<'_> {
    /// Returns `true` if a requested map needs a plane.
    pub fn has(&self, plane: Plane) -> bool {
        !self.planes[plane as usize].is_empty()
    }

    /// Returns the value of a texel in a plane of numbers.
    pub fn number(&self, plane: Plane, texel: usize) -> f32 {
        self.planes[plane as usize][texel]
    }

    /// Sets a texel of a plane of numbers, if a requested map needs it.
    pub fn set(&mut self, plane: Plane, texel: usize, value: f32) {
        if let Some(number) = self.planes[plane as usize].get_mut(texel) {
            *number = value;
        }
    }

    /// Sets a texel of a plane of vectors, if a requested map needs it.
    pub fn set_vector(&mut self, plane: Plane, texel: usize, value: Vec3) {
        if let Some(vector) = self.planes[plane as usize].as_chunks_mut().0.get_mut(texel) {
            *vector = value.to_array();
        }
    }
}

/// Counts of sample outcomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BakeCounts {
    /// Samples on the low-poly mesh.
    pub samples: usize,
    /// Those whose projection ray hit nothing that faces the right way, so that the closest point of the scan was
    /// used.
    pub missed: usize,
    /// Those of them whose closest point faces the wrong way too or is too far away: they have the low-poly mesh's
    /// normal.
    pub lost: usize,
    /// Samples covered by more than one triangle.
    pub shared: usize,
    /// Texels on the low-poly mesh.
    pub texels: usize,
    /// Texels with a sample that missed.
    pub missed_texels: usize,
    /// Triangles of the low-poly mesh whose uvs span no area.
    pub flat: usize,
}

impl BakeCounts {
    /// Returns the sum of both counts.
    #[must_use]
    pub fn and(self, o: Self) -> Self {
        Self {
            samples: self.samples + o.samples,
            missed: self.missed + o.missed,
            lost: self.lost + o.lost,
            shared: self.shared + o.shared,
            texels: self.texels + o.texels,
            missed_texels: self.missed_texels + o.missed_texels,
            flat: self.flat + o.flat,
        }
    }
}

/// Baked maps and the outcomes of their samples.
#[derive(Debug, Clone)]
pub struct Baked {
    /// The maps.
    pub maps: BakedMaps,
    /// The outcomes of the samples.
    pub counts: BakeCounts,
}
