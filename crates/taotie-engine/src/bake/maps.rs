//! The maps of a bake: which there are, their texels while they are being baked, and the outcomes of the samples.
//!
//! A map holds one number or vector per texel, row by row from the top.

use crate::names::Named;

/// A map that a scan can be baked into.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
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
    #[serde(rename = "metallic-roughness")]
    MetallicRoughness,
    /// The radiance that the scan emits.
    Emission,
    /// The scan's alpha, from its vertices, materials and textures.
    Alpha,
    /// The scan's own occlusion texture.
    #[serde(rename = "occlusion")]
    OcclusionMap,
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
    ];
}

/// A set of maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(from = "Vec<MapKind>", into = "Vec<MapKind>")]
pub struct Maps(u16);

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

/// Baked maps; those not requested are empty.
#[derive(Debug, Clone, Default)]
pub struct BakedMaps {
    /// Texels across.
    pub width: u32,
    /// Texels down.
    pub height: u32,
    /// The status of each texel.
    pub texels: Vec<TexelStatus>,
    /// Unit normals, in the requested space.
    pub normal: Vec<[f32; 3]>,
    /// The open part of the hemisphere, [0, 1], found by rays or read from the scan's textures.
    pub occlusion: Vec<f32>,
    /// The base colour, linear RGB.
    pub albedo: Vec<[f32; 3]>,
    /// The height above the low-poly mesh, in model units.
    pub heights: Vec<f32>,
    /// The mean open direction, unit, in the requested space.
    pub bent: Vec<[f32; 3]>,
    /// The mean curvature, in 1 / model units.
    pub curvature: Vec<f32>,
    /// The perceptual roughness, as artists set it, [0, 1].
    pub roughness: Vec<f32>,
    /// [0, 1].
    pub metallic: Vec<f32>,
    /// [0, 1].
    pub alpha: Vec<f32>,
    /// Emitted radiance, linear RGB.
    pub emission: Vec<[f32; 3]>,
}

impl BakedMaps {
    pub(super) fn new([width, height]: [u32; 2], maps: Maps) -> Self {
        let count = width as usize * height as usize;
        let any = |kinds: &[MapKind]| if maps.has_any(kinds) { count } else { 0 };
        let of = |kind: MapKind| any(&[kind]);
        const UP: [f32; 3] = [0.0, 0.0, 1.0];
        Self {
            width,
            height,
            texels: vec![TexelStatus::Free; count],
            normal: vec![UP; of(MapKind::Normal)],
            occlusion: vec![1.0; any(&[MapKind::Occlusion, MapKind::OcclusionMap])],
            albedo: vec![[0.0; 3]; of(MapKind::Albedo)],
            heights: vec![0.0; of(MapKind::Height)],
            bent: vec![UP; of(MapKind::Bent)],
            curvature: vec![0.0; of(MapKind::Curvature)],
            roughness: vec![0.0; any(&[MapKind::Roughness, MapKind::MetallicRoughness])],
            metallic: vec![0.0; of(MapKind::MetallicRoughness)],
            alpha: vec![1.0; of(MapKind::Alpha)],
            emission: vec![[0.0; 3]; of(MapKind::Emission)],
        }
    }

    /// Texels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Returns the values of a plane at texels that a triangle covers.
    pub fn covered(&self, plane: &[f32]) -> Vec<f32> {
        let covered = self.texels.iter().zip(plane).filter(|(texel, _)| **texel != TexelStatus::Free);
        covered.map(|(_, v)| *v).collect()
    }

    /// Splits the maps into bands of at most `rows` rows.
    pub(super) fn bands(&mut self, rows: u32) -> Vec<BandMaps<'_>> {
        let count = rows as usize * self.width as usize;
        let bands = self.height.div_ceil(rows) as usize;
        fn cut<T>(plane: &mut [T], count: usize, bands: usize) -> impl Iterator<Item = &mut [T]> {
            let mut chunks = plane.chunks_mut(count);
            (0..bands).map(move |_| chunks.next().unwrap_or_default())
        }
        let mut texels = cut(&mut self.texels, count, bands);
        let mut normal = cut(&mut self.normal, count, bands);
        let mut occlusion = cut(&mut self.occlusion, count, bands);
        let mut albedo = cut(&mut self.albedo, count, bands);
        let mut heights = cut(&mut self.heights, count, bands);
        let mut bent = cut(&mut self.bent, count, bands);
        let mut curvature = cut(&mut self.curvature, count, bands);
        let mut roughness = cut(&mut self.roughness, count, bands);
        let mut metallic = cut(&mut self.metallic, count, bands);
        let mut alpha = cut(&mut self.alpha, count, bands);
        let mut emission = cut(&mut self.emission, count, bands);
        (0..bands)
            .filter_map(|_| {
                Some(BandMaps {
                    texels: texels.next()?,
                    normal: normal.next()?,
                    occlusion: occlusion.next()?,
                    albedo: albedo.next()?,
                    heights: heights.next()?,
                    bent: bent.next()?,
                    curvature: curvature.next()?,
                    roughness: roughness.next()?,
                    metallic: metallic.next()?,
                    alpha: alpha.next()?,
                    emission: emission.next()?,
                })
            })
            .collect()
    }
}

/// The rows of [`BakedMaps`] that a band covers.
pub(super) struct BandMaps<'a> {
    pub texels: &'a mut [TexelStatus],
    pub normal: &'a mut [[f32; 3]],
    pub occlusion: &'a mut [f32],
    pub albedo: &'a mut [[f32; 3]],
    pub heights: &'a mut [f32],
    pub bent: &'a mut [[f32; 3]],
    pub curvature: &'a mut [f32],
    pub roughness: &'a mut [f32],
    pub metallic: &'a mut [f32],
    pub alpha: &'a mut [f32],
    pub emission: &'a mut [[f32; 3]],
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
