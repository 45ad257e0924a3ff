//! The maps of one low-poly mesh: baked through a cage, and stored as textures of an asset and as separate files.

use super::judgement::refuse_no_hit;
use crate::asset::ask::BakeOptions;
use crate::asset::source::{KeptTextures, LowPoly, Metalness, Pair, Rays, Scan};
use std::path::{Path, PathBuf};
use taotie_engine::bake::{
    self, BakeCounts, BakeInput, BakeSettings, Baked, BakedMaps, Cage, MapKind, Maps, TexelStatus,
};
use taotie_engine::error::Result;
use taotie_engine::image::{Bitmap, Sampler, Texture};
use taotie_engine::length::Unit;
use taotie_engine::math::Vec3;
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::names::Named;
use taotie_engine::normal_map::{CoveredNormals, Storage, store_codes, store_rgba, store_unit_vectors};
use taotie_engine::progress::Progress;
use taotie_engine::scene::{GreenChannel, Material, NormalMap, NormalSpace, Scene, TextureRef, UvTransform};
use taotie_engine::surface::encode_normal;
use taotie_io::{GltfImage, GltfMaterial};

/// Maps after baking.
pub(in crate::asset) struct StoredMaps {
    pub textures: Textures,
    /// The outcomes of the samples.
    pub counts: BakeCounts,
    /// The cage from which the scan was searched for.
    pub cage: Cage,
}

impl StoredMaps {
    /// Returns no maps, with the cage of a mesh without any.
    pub fn none(Pair { scan, low }: Pair<'_>) -> Self {
        let cage = Cage::automatic(&low.shape(), scan.sorted());
        Self { textures: Textures::default(), counts: BakeCounts::default(), cage }
    }
}

/// The options of a bake, with the cage that they name.
#[derive(Clone, Copy)]
pub(in crate::asset) struct Recipe<'a> {
    pub options: &'a BakeOptions,
    pub rays: &'a Rays,
}

/// Bakes the requested maps at this size.
pub(in crate::asset) fn bake_maps(
    Recipe { options, rays }: Recipe<'_>,
    size: [u32; 2],
    pair: Pair<'_>,
    progress: Progress<'_>,
) -> Result<StoredMaps> {
    let Pair { scan, low } = pair;
    scan.sort(progress)?;
    progress.begin("measure the gap")?;
    let cage = cage(rays, low, scan)?;
    let settings = BakeSettings {
        size,
        side: options.side,
        maps: options.maps.iter().copied().collect::<Maps>(),
        space: options.space,
        sky_rays: options.ao_rays,
        sky_distance: options.ao_distance.map(|distance| distance as f32),
        roughness: options.roughness.map(|v| v as f32),
        dilation: options.dilation,
    };
    let input = BakeInput { low: &low.mesh, cage: &cage, scan: scan.sorted() };
    let Baked { maps, counts } = bake::bake(input, &settings, progress.begin("bake")?)?;
    refuse_no_hit(pair, &cage, &counts)?;
    progress.begin("store")?;
    let textures = Textures::new(&maps, options, pair)?;
    Ok(StoredMaps { textures, counts, cage })
}

fn cage(rays: &Rays, low: &LowPoly, scan: &Scan) -> Result<Cage> {
    match rays {
        Rays::Auto => Ok(Cage::automatic(&low.shape(), scan.sorted())),
        Rays::Uniform(distance) => Cage::uniform(&low.shape(), *distance as f32),
        Rays::Cage(cage) => {
            let made = match &low.own {
                Some(own) => Cage::from_mesh(&low.mesh, &cage.part(&own.triangles)?),
                None => Cage::from_mesh(&low.mesh, &cage.mesh),
            };
            made.map_err(|error| cage.named(error))
        }
    }
}

/// The fraction of a map covered by banding above which normals are dithered.
const MOST_BANDED: f64 = 0.05;

/// The storage format of colours and factors.
const DITHERED: Storage = Storage { bits: 8, dither: true };

/// Baked maps, encoded for storage.
///
/// ```
/// use taotie::asset::Textures;
/// use taotie_engine::names::Named;
///
/// /// Returns the names of the maps inside an asset, and of those next to it.
/// fn names(textures: &Textures) -> [Vec<&'static str>; 2] {
///     let inside = textures.inside().map(|(map, _)| map.name()).collect();
///     [inside, textures.separate.iter().map(|file| file.map.name()).collect()]
/// }
/// ```
#[derive(Default)]
#[non_exhaustive]
pub struct Textures {
    /// The tangent-space normal map.
    pub normal: Option<Bitmap>,
    /// The base colour, sRGB; with linear alpha, if that is baked.
    pub color: Option<Bitmap>,
    /// Occlusion, roughness and metallic; or only occlusion.
    pub orm: Option<Bitmap>,
    /// The emitted radiance over `strength`, sRGB.
    pub emission: Option<Bitmap>,
    /// The radiance of white in `emission`.
    pub strength: f32,
    /// Which of the three are in `orm`.
    pub has: MapPresence,
    /// Maps that glTF has no slot for.
    pub separate: Vec<SeparateMap>,
    /// The places where projection rays missed; `None` if none did.
    pub misses: Option<Misses>,
    /// The maps that are stored in the textures above.
    stored: Maps,
}

/// The channels in use of an occlusion, roughness and metallic texture.
///
/// ```
/// use taotie::asset::MapPresence;
///
/// /// Returns the meaning of each channel.
/// fn channels(has: MapPresence) -> [&'static str; 3] {
///     let of = |is: bool, name: &'static str| if is { name } else { "" };
///     let [roughness, metallic] = ["roughness", "metallic"].map(|name| of(has.roughness, name));
///     [of(has.occlusion, "occlusion"), roughness, metallic]
/// }
/// ```
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MapPresence {
    /// Red is occlusion.
    pub occlusion: bool,
    /// Green is roughness, and blue is metallic: the scan's, or that of the material if the scan's is not baked.
    pub roughness: bool,
}

/// A map for a separate file.
///
/// ```
/// use taotie::asset::SeparateMap;
/// use taotie_engine::bake::MapKind;
///
/// /// Returns the height map of an asset, if one was baked.
/// fn height(files: &[SeparateMap]) -> Option<&SeparateMap> {
///     files.iter().find(|file| file.map == MapKind::Height)
/// }
/// ```
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SeparateMap {
    /// The kind of map.
    pub map: MapKind,
    /// Its texels.
    pub bitmap: Bitmap,
    /// The values of its black and white, if it stores numbers.
    pub range: Option<Range>,
}

/// The values of black and white.
///
/// ```
/// use taotie::asset::Range;
///
/// /// Returns the value of a texel with this `code`, [0, 1].
/// fn number(range: &Range, code: f64) -> f64 {
///     range.black + code * (range.white - range.black)
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Range {
    /// The value of black.
    pub black: f64,
    /// The value of white.
    pub white: f64,
    /// The unit of both.
    pub unit: &'static str,
}

impl Textures {
    /// Stores the baked maps; roughness is stored with the low-poly mesh's metalness if no other was baked.
    fn new(maps: &BakedMaps, options: &BakeOptions, Pair { scan, low }: Pair<'_>) -> Result<Self> {
        let mut textures = Self { misses: Misses::of(maps), stored: stored(options), ..Self::default() };
        let storage = |normals: &[[f32; 3]]| Storage {
            bits: options.bits,
            dither: is_dithered(maps, normals, options),
        };
        if !maps.normal.is_empty() {
            let (size, storage) = (maps.size(), storage(&maps.normal));
            match options.space {
                NormalSpace::Tangent => {
                    let code = |texel: usize| tangent_code(maps.normal[texel], options.bits);
                    textures.normal = Some(store_codes(size, code, 3, storage)?);
                }
                NormalSpace::Object => {
                    let bitmap = store_unit_vectors(size, &maps.normal, storage)?;
                    textures.separate.push(SeparateMap { map: MapKind::Normal, bitmap, range: None })
                }
            }
        }
        if !maps.albedo.is_empty() {
            textures.color = Some(color(maps)?);
        }
        if !maps.emission.is_empty() {
            textures.strength = strength(maps);
            textures.emission = Some(emission(maps, textures.strength)?);
        }
        textures.has =
            MapPresence { occlusion: !maps.occlusion.is_empty(), roughness: !maps.roughness.is_empty() };
        if textures.has != MapPresence::default() {
            textures.orm = Some(orm(maps, low)?);
        }
        if !maps.bent.is_empty() {
            let bitmap = store_unit_vectors(maps.size(), &maps.bent, storage(&maps.bent))?;
            textures.separate.push(SeparateMap { map: MapKind::Bent, bitmap, range: None });
        }
        let [length, curvature] = units(scan.unit());
        let numbers =
            [(MapKind::Height, &maps.heights, length), (MapKind::Curvature, &maps.curvature, curvature)];
        for (map, plane, unit) in numbers.into_iter().filter(|(_, plane, _)| !plane.is_empty()) {
            textures.separate.push(of_numbers(map, maps, plane, unit)?);
        }
        Ok(textures)
    }

    /// Returns the asset's material: the factors and layers of `base`, with its textures from `kept` unless something
    /// was baked in their place.
    pub(in crate::asset) fn material<'a>(
        &'a self,
        base: &'a Material,
        kept: &'a KeptTextures,
    ) -> GltfMaterial<'a> {
        let color = self.color.as_ref().or(kept.color.as_ref());
        let orm = self.has.roughness.then_some(self.orm.as_ref()).flatten();
        let mr = orm.or(kept.metallic_roughness.as_ref());
        let occlusion = self.has.occlusion.then_some(self.orm.as_ref()).flatten().or(kept.occlusion.as_ref());
        let emission = self.emission.as_ref();
        GltfMaterial {
            name: &base.name,
            base_color: self.base_color(base.base_color),
            metallic: if orm.is_some() { 1.0 } else { base.metallic },
            roughness: if orm.is_some() { 1.0 } else { base.roughness },
            base_color_map: color.map(GltfImage::from),
            metallic_roughness_map: mr.map(GltfImage::from),
            occlusion_map: occlusion.map(GltfImage::from),
            occlusion_strength: if self.has.occlusion { 1.0 } else { base.occlusion_strength },
            normal_map: self.normal.as_ref().map(GltfImage::from),
            normal_scale: 1.0,
            emissive: if emission.is_some() { [self.strength; 3] } else { base.emissive },
            emissive_map: emission.or(kept.emission.as_ref()).map(GltfImage::from),
            alpha: base.alpha,
            layers: Some(base),
            double_sided: base.double_sided,
        }
    }

    /// Returns the factors of the base colour: those of `base`, except for what was baked.
    fn base_color(&self, [r, g, b, a]: [f32; 4]) -> [f32; 4] {
        let factors = match &self.color {
            Some(bitmap) if bitmap.channels() == 4 => [1.0; 4],
            Some(_) => [1.0, 1.0, 1.0, a],
            None => [r, g, b, a],
        };
        factors.map(|v| v.clamp(0.0, 1.0))
    }

    /// Returns the maps inside the asset, each with the texture that stores it.
    pub fn inside(&self) -> impl Iterator<Item = (MapKind, &Bitmap)> {
        let orm = |is: bool| self.orm.as_ref().filter(|_| is);
        let maps = [
            (MapKind::Normal, self.normal.as_ref()),
            (MapKind::Albedo, self.color.as_ref()),
            (MapKind::Occlusion, orm(self.has.occlusion)),
            (MapKind::Roughness, orm(self.has.roughness)),
            (MapKind::MetallicRoughness, orm(self.has.roughness)),
            (MapKind::Emission, self.emission.as_ref()),
            (MapKind::Alpha, self.color.as_ref()),
            (MapKind::OcclusionMap, orm(self.has.occlusion)),
        ];
        let stored = self.stored;
        let inside = maps.into_iter().filter(move |(map, _)| stored.has(*map));
        inside.filter_map(|(map, bitmap)| Some((map, bitmap?)))
    }
}

impl SeparateMap {
    /// Returns the map's file next to the model `path`, such as `scan.height.png` next to `scan.glb`; it is named
    /// after the material if `label` is not empty.
    pub(in crate::asset) fn file(&self, label: &str, path: &Path) -> PathBuf {
        path.with_extension(labeled(label, &format!("{}.png", self.map.name())))
    }
}

/// Returns a name prefixed with the label of its material, if it has one.
pub(in crate::asset) fn labeled(label: &str, name: &str) -> String {
    if label.is_empty() { name.to_owned() } else { format!("{label}.{name}") }
}

/// Returns the maps stored in textures of an asset. Ray-traced occlusion overrides that of a texture.
fn stored(options: &BakeOptions) -> Maps {
    let rays = options.bakes(&[MapKind::Occlusion]);
    options.maps.iter().copied().filter(|map| !(rays && *map == MapKind::OcclusionMap)).collect()
}

/// Returns `true` if 8-bit normals would show banding on gentle curves, and the bake is not a search, which compares
/// sizes.
fn is_dithered(maps: &BakedMaps, normals: &[[f32; 3]], options: &BakeOptions) -> bool {
    let is_covered = |i: usize| maps.texels[i] != TexelStatus::Free;
    let map = CoveredNormals { size: maps.size(), normals, is_covered: &is_covered };
    options.bits == 8 && !options.searches() && map.banded_share() > MOST_BANDED
}

fn color(maps: &BakedMaps) -> Result<Bitmap> {
    let codes = |i: usize| maps.albedo[i].map(srgb_code);
    if maps.alpha.is_empty() {
        return store_codes(maps.size(), codes, 3, DITHERED);
    }
    let with_alpha = |i: usize| {
        let [r, g, b] = codes(i);
        [r, g, b, maps.alpha[i]]
    };
    store_rgba(maps.size(), with_alpha, DITHERED)
}

fn srgb_code(linear: f32) -> f32 {
    srgb_from_linear(f64::from(linear.clamp(0.0, 1.0))) as f32
}

/// Returns the maximum radiance of any channel over texels covered by a triangle, at least 1.
fn strength(maps: &BakedMaps) -> f32 {
    let covered = maps.texels.iter().zip(&maps.emission).filter(|(texel, _)| **texel != TexelStatus::Free);
    covered.flat_map(|(_, radiance)| radiance).fold(1.0, |most: f32, v| most.max(*v))
}

fn emission(maps: &BakedMaps, strength: f32) -> Result<Bitmap> {
    let codes = |i: usize| maps.emission[i].map(|v| srgb_code(v / strength));
    store_codes(maps.size(), codes, 3, DITHERED)
}

fn orm(maps: &BakedMaps, low: &LowPoly) -> Result<Bitmap> {
    let occlusion = |i: usize| maps.occlusion.get(i).copied().unwrap_or(1.0);
    if maps.roughness.is_empty() {
        return store_codes(maps.size(), |i| [occlusion(i); 3], 1, DITHERED);
    }
    if !maps.metallic.is_empty() {
        let codes = |i: usize| [occlusion(i), maps.roughness[i], maps.metallic[i]];
        return store_codes(maps.size(), codes, 3, DITHERED);
    }
    let metalness = Metalness::of(&low.material, &low.kept, maps.size());
    store_codes(maps.size(), |i| [occlusion(i), maps.roughness[i], metalness.at(i)], 3, DITHERED)
}

/// Returns the units of a scan's lengths and curvatures.
fn units(unit: Option<Unit>) -> [&'static str; 2] {
    match unit {
        None => ["model units", "1 / model unit"],
        Some(Unit::Millimetre) => ["mm", "1 / mm"],
        Some(Unit::Centimetre) => ["cm", "1 / cm"],
        Some(Unit::Metre) => ["m", "1 / m"],
        Some(Unit::Inch) => ["in", "1 / in"],
    }
}

/// Creates a 16-bit map of numbers.
fn of_numbers(map: MapKind, maps: &BakedMaps, plane: &[f32], unit: &'static str) -> Result<SeparateMap> {
    let [black, white] = range(map, maps, plane);
    let number = |v: f32| (v - black) / (white - black);
    let fine = Storage { bits: 16, dither: false };
    let bitmap = store_codes(maps.size(), |i| [number(plane[i]); 3], 1, fine)?;
    let range = Range { black: f64::from(black), white: f64::from(white), unit };
    Ok(SeparateMap { map, bitmap, range: Some(range) })
}

/// Returns the values of black and white: for heights, the minimum and maximum; for curvature, a symmetric range that
/// covers all but one per cent of the texels.
fn range(map: MapKind, maps: &BakedMaps, plane: &[f32]) -> [f32; 2] {
    let mut covered = maps.covered(plane);
    covered.sort_unstable_by(f32::total_cmp);
    let (Some(least), Some(most)) = (covered.first(), covered.last()) else { return [0.0, 1.0] };
    let [low, high] = match map {
        MapKind::Curvature => {
            let rank = |part: f64| covered[((covered.len() - 1) as f64 * part) as usize].abs();
            let most = rank(0.005).max(rank(0.995));
            [-most, most]
        }
        _ => [*least, *most],
    };
    if high > low { [low, high] } else { [low, low + 1.0] }
}

/// The maximum number of texels along the longer side.
const SIDE: usize = 1024;

/// The places where projection rays missed the scan, downscaled for viewing: the status of a map's texels, the worst
/// of each block, so that even a single miss is visible.
///
/// ```
/// use taotie::asset::Misses;
/// use taotie_engine::bake::TexelStatus;
///
/// /// Returns the number of blocks for which nothing was found.
/// fn lost(misses: &Misses) -> usize {
///     misses.texels.iter().filter(|texel| **texel == TexelStatus::Lost).count()
/// }
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Misses {
    /// Blocks across.
    pub width: usize,
    /// Blocks down.
    pub height: usize,
    /// Row by row from the top.
    pub texels: Vec<TexelStatus>,
}

impl Misses {
    /// Examines the map; `None` if no ray missed.
    fn of(maps: &BakedMaps) -> Option<Self> {
        let [width, height] = maps.size().map(|side| side as usize);
        maps.texels.iter().find(|texel| matches!(texel, TexelStatus::Closest | TexelStatus::Lost))?;
        let step = width.max(height).div_ceil(SIDE);
        let (across, down) = (width / step, height / step);
        let worst = |i: usize| {
            let (x, y) = (i % across * step, i / across * step);
            let block = (y..y + step).flat_map(|y| maps.texels[y * width + x..][..step].iter());
            block.copied().max_by_key(|texel| *texel as u8).unwrap_or_default()
        };
        Some(Self { width: across, height: down, texels: (0..across * down).map(worst).collect() })
    }
}

/// Returns a tangent-space normal as stored: (n + 1)/2. Readers raise normals below the surface to it, so these are
/// stored in it, with the least positive z of this number of bits.
fn tangent_code(normal: [f32; 3], bits: u8) -> [f32; 3] {
    let up = Vec3::new(0.0, 0.0, 1.0);
    let n = Vec3::from_array(normal).normalize_or(up);
    let least = if bits == 8 { 1.0 / 255.0 } else { 1.0 / 65535.0 };
    let raised = || {
        let flat = Vec3::new(n.x, n.y, 0.0).normalize_or(up);
        Vec3::new(flat.x, flat.y, flat.z.max(least))
    };
    encode_normal(if n.z >= least { n } else { raised() }).to_array()
}

/// Assigns an object-space normal map, which glTF cannot reference, to the material with this number, or to all of
/// them.
pub(in crate::asset) fn assign_object_map(
    scene: &mut Scene,
    material: Option<usize>,
    (texture, sampler): (&Texture, Sampler),
) -> Result<()> {
    scene.edit(|scene| {
        scene.textures.push(texture.clone());
        let (number, transform) = (scene.textures.len() - 1, UvTransform::default());
        let texture = TextureRef { texture: number, uv_set: 0, sampler, transform };
        let map = NormalMap { texture, scale: 1.0, space: NormalSpace::Object, green: GreenChannel::Up };
        let shown =
            scene.materials.iter_mut().enumerate().filter(|(i, _)| material.is_none_or(|own| own == *i));
        shown.for_each(|(_, material)| material.normal = Some(map));
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::surface::decode_normal;

    #[test]
    fn normals_are_stored_above_the_surface() {
        let normals =
            [[0.8, 0.0, -0.6], [0.0, 0.0, -1.0], [0.6, 0.8, 0.0], [0.0, 0.0, 1.0], [0.1, 0.2, -0.9]];
        for (bits, dither) in [(8, false), (8, true), (16, false)] {
            for normal in normals {
                let storage = Storage { bits, dither };
                let map = store_codes([4, 4], |_| tangent_code(normal, bits), 3, storage).unwrap();
                assert!((0..16).all(|i| map.stored(i)[2] > 0.5), "{normal:?}");
                let read = |[r, g, b]: [f32; 3]| decode_normal(Vec3::new(r, g, b), 1.0, 1.0).normalize();
                let [r, g, b, _] = map.stored(5);
                let below = read(encode_normal(Vec3::from_array(normal)).to_array());
                assert!(read([r, g, b]).dot(below) > 0.9995, "{normal:?}: as readers raise it");
            }
        }
    }
}
