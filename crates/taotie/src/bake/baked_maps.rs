//! Maps while they are being baked: one number or vector per texel, row by row from the top.

use super::maps::{MapKind, Maps};

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
