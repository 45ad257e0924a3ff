//! The maps of one low-poly mesh: baked through a cage, and stored as textures of an asset and as separate files.

use super::judgement::{Misses, refuse_no_hit};
use crate::asset::ask::BakeOptions;
use crate::asset::source::{KeptTextures, LowPoly, Metalness, Pair, Rays, Scan};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use taotie_engine::bake::{
    self, BakeCounts, BakeInput, BakeSettings, Baked, BakedMaps, Cage, MapContent, MapKind, Maps, MatchRule,
    Plane, RayPreview, TexelStatus,
};
use taotie_engine::error::Result;
use taotie_engine::image::Bitmap;
use taotie_engine::length::Unit;
use taotie_engine::math::Vec3;
use taotie_engine::math::srgb::srgb_from_linear;
use taotie_engine::names::Named;
use taotie_engine::normal_map::{CoveredNormals, Storage, store_codes, store_rgba, store_unit_vectors};
use taotie_engine::progress::Progress;
use taotie_engine::scene::{Material, NormalSpace};
use taotie_engine::surface::encode_normal;
use taotie_io::{GltfImage, GltfMaterial};

/// Maps after baking.
pub(in crate::asset) struct StoredMaps {
    pub textures: Textures,
    /// The outcomes of the samples.
    pub counts: BakeCounts,
    /// The cage from which the scan was searched for.
    pub cage: Cage,
    /// Some of its rays, to look at.
    pub rays: RayPreview,
    /// Texels across and down.
    pub size: [u32; 2],
}

impl StoredMaps {
    /// Returns no maps, with the cage of a mesh without any.
    pub fn none(Pair { scan, low }: Pair<'_>) -> Self {
        let cage = Cage::automatic(&low.shape(), scan.sorted());
        Self {
            textures: Textures::default(),
            counts: BakeCounts::default(),
            cage,
            rays: RayPreview::default(),
            size: [0; 2],
        }
    }
}

/// The number of rays of each mesh to look at.
const SHOWN_RAYS: usize = 2_000;

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
    let cage = rays.cage(pair)?;
    let settings = BakeSettings {
        size,
        side: options.side,
        maps: options.maps.iter().copied().collect::<Maps>(),
        space: options.space,
        sky_rays: options.ao_rays,
        sky_distance: options.ao_distance.map(|distance| distance as f32),
        roughness: options.roughness.map(|v| v as f32),
        bevel_radius: options.bevel_radius.map(|v| v as f32),
        isolated: options.matching == MatchRule::Isolated,
        dilation: options.dilation,
    };
    let input = BakeInput { low: &low.mesh, cage: &cage, scan: scan.sorted() };
    let Baked { maps, counts } = bake::bake(input, &settings, progress.begin("bake")?)?;
    refuse_no_hit(pair, &cage, &counts)?;
    progress.begin("store")?;
    let textures = Textures::new(&maps, options, pair)?;
    let shown = if options.inspect && !options.searches() { SHOWN_RAYS } else { 0 };
    let rays = RayPreview::of(&low.mesh, &cage, (scan.sorted(), shown));
    Ok(StoredMaps { textures, counts, cage, rays, size })
}

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
    pub(in crate::asset) has: MapPresence,
    /// Maps that glTF has no slot for.
    pub separate: Vec<SeparateMap>,
    /// The places where projection rays missed; `None` if none did.
    pub misses: Option<Misses>,
    /// The requested maps in their order, without those that others replace.
    pub(in crate::asset) stored: Vec<MapKind>,
}

/// The channels in use of an occlusion, roughness and metallic texture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(in crate::asset) struct MapPresence {
    /// Red is occlusion.
    pub occlusion: bool,
    /// Green is roughness, and blue is metallic: the scan's, or that of the material if the scan's is not baked.
    pub roughness: bool,
}

impl Textures {
    /// Stores the baked maps; roughness is stored with the low-poly mesh's metalness if no other was baked.
    fn new(maps: &BakedMaps, options: &BakeOptions, Pair { scan, low }: Pair<'_>) -> Result<Self> {
        let mut textures = Self { misses: Misses::of(maps), stored: stored(options), ..Self::default() };
        let separate = Separate { maps, options, scan };
        if maps.has(Plane::Normal) && options.space == NormalSpace::Tangent {
            let normals = maps.vectors(Plane::Normal);
            let code = |texel: usize| tangent_code(normals[texel], options.bits);
            textures.normal = Some(store_codes(maps.size(), code, 3, separate.storage(normals))?);
        }
        if maps.has(Plane::Albedo) {
            textures.color = Some(color(maps, options)?);
        }
        if maps.has(Plane::Emission) {
            textures.strength = strength(maps);
            textures.emission = Some(emission(maps, (textures.strength, options))?);
        }
        textures.has =
            MapPresence { occlusion: maps.has(Plane::Occlusion), roughness: maps.has(Plane::Roughness) };
        if textures.has != MapPresence::default() {
            textures.orm = Some(orm(maps, (low, options))?);
        }
        textures.separate = separate.all()?;
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
        let orm = self.roughness_texture();
        let mr = orm.or(kept.metallic_roughness.as_ref());
        let occlusion = self.occlusion_texture().or(kept.occlusion.as_ref());
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

    /// Returns the texture whose green is roughness and whose blue is metalness.
    pub(in crate::asset) fn roughness_texture(&self) -> Option<&Bitmap> {
        self.orm.as_ref().filter(|_| self.has.roughness)
    }

    /// Returns the texture whose red is occlusion.
    pub(in crate::asset) fn occlusion_texture(&self) -> Option<&Bitmap> {
        self.orm.as_ref().filter(|_| self.has.occlusion)
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
        let maps = [
            (MapKind::Normal, self.normal.as_ref()),
            (MapKind::Albedo, self.color.as_ref()),
            (MapKind::Occlusion, self.occlusion_texture()),
            (MapKind::Roughness, self.roughness_texture()),
            (MapKind::MetallicRoughness, self.roughness_texture()),
            (MapKind::Emission, self.emission.as_ref()),
            (MapKind::Alpha, self.color.as_ref()),
            (MapKind::OcclusionMap, self.occlusion_texture()),
        ];
        let inside = maps.into_iter().filter(|(map, _)| self.stored.contains(map));
        inside.filter_map(|(map, bitmap)| Some((map, bitmap?)))
    }
}

/// Returns the maps to store, in the order of the request. Ray-traced occlusion overrides that of a texture.
fn stored(options: &BakeOptions) -> Vec<MapKind> {
    let rays = options.bakes(&[MapKind::Occlusion]);
    options.maps.iter().copied().filter(|map| !(rays && *map == MapKind::OcclusionMap)).collect()
}

fn color(maps: &BakedMaps, options: &BakeOptions) -> Result<Bitmap> {
    let storage = or_floats(DITHERED, options);
    let codes = |i: usize| maps.vectors(Plane::Albedo)[i].map(srgb_code);
    if !maps.has(Plane::Alpha) {
        return store_codes(maps.size(), codes, 3, storage);
    }
    let with_alpha = |i: usize| {
        let [r, g, b] = codes(i);
        [r, g, b, maps.numbers(Plane::Alpha)[i]]
    };
    store_rgba(maps.size(), with_alpha, storage)
}

/// Returns the maximum radiance of any channel over texels covered by a triangle, at least 1.
fn strength(maps: &BakedMaps) -> f32 {
    let covered = maps
        .texels
        .iter()
        .zip(maps.vectors(Plane::Emission))
        .filter(|(texel, _)| **texel != TexelStatus::Free);
    covered.flat_map(|(_, radiance)| radiance).fold(1.0, |most: f32, v| most.max(*v))
}

fn emission(maps: &BakedMaps, (strength, options): (f32, &BakeOptions)) -> Result<Bitmap> {
    let codes = |i: usize| maps.vectors(Plane::Emission)[i].map(|v| srgb_code(v / strength));
    store_codes(maps.size(), codes, 3, or_floats(DITHERED, options))
}

fn orm(maps: &BakedMaps, (low, options): (&LowPoly, &BakeOptions)) -> Result<Bitmap> {
    let storage = or_floats(DITHERED, options);
    let occlusion = |i: usize| maps.numbers(Plane::Occlusion).get(i).copied().unwrap_or(1.0);
    if !maps.has(Plane::Roughness) {
        return store_codes(maps.size(), |i| [occlusion(i); 3], 1, storage);
    }
    if maps.has(Plane::Metallic) {
        let codes =
            |i: usize| [occlusion(i), maps.numbers(Plane::Roughness)[i], maps.numbers(Plane::Metallic)[i]];
        return store_codes(maps.size(), codes, 3, storage);
    }
    let metalness = Metalness::of(&low.material, &low.kept, maps.size());
    store_codes(
        maps.size(),
        |i| [occlusion(i), maps.numbers(Plane::Roughness)[i], metalness.at(i)],
        3,
        storage,
    )
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

/// The fraction of a map covered by banding above which normals are dithered.
const MOST_BANDED: f64 = 0.05;

/// The storage format of colours and factors.
const DITHERED: Storage = Storage { bits: 8, dither: true };

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
    /// The point that positions are relative to, in the scan's space and unit.
    pub origin: Option<[f64; 3]>,
    /// The colours of materials or objects, as `#rrggbb` in sRGB, by their names.
    pub legend: BTreeMap<String, String>,
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

impl SeparateMap {
    /// Takes a map whose codes need no explanation.
    pub(in crate::asset) fn plain(map: MapKind, bitmap: Bitmap) -> Self {
        Self { map, bitmap, range: None, origin: None, legend: BTreeMap::new() }
    }

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

/// The contents of separate maps.
struct Separate<'a> {
    pub maps: &'a BakedMaps,
    pub options: &'a BakeOptions,
    pub scan: &'a Scan,
}

impl Separate<'_> {
    /// Returns all requested separate maps, directions first.
    pub fn all(&self) -> Result<Vec<SeparateMap>> {
        let wanted: Maps = self.options.maps.iter().copied().collect();
        let is_separate = |map: &MapKind| {
            map.is_separate() || *map == MapKind::Normal && self.options.space == NormalSpace::Object
        };
        let is_direction = |map: &MapKind| map.content() == MapContent::Direction;
        let (directions, others): (Vec<_>, Vec<_>) =
            wanted.iter().filter(is_separate).partition(is_direction);
        directions.into_iter().chain(others).map(|map| self.stored(map)).collect()
    }

    fn stored(&self, map: MapKind) -> Result<SeparateMap> {
        let plane = map.planes()[0];
        let (size, vectors) = (self.maps.size(), self.maps.vectors(plane));
        let of = |bitmap| SeparateMap::plain(map, bitmap);
        Ok(match map.content() {
            MapContent::Direction => of(store_unit_vectors(size, vectors, self.storage(vectors))?),
            MapContent::Color => {
                of(store_codes(size, |i| vectors[i].map(srgb_code), 3, or_floats(DITHERED, self.options))?)
            }
            MapContent::Fraction if map == MapKind::Gradient => {
                let extent = self.scan.mesh().vertical_extent();
                let code = |i: usize| [MapKind::gradient(vectors[i][1], extent); 3];
                of(store_codes(size, code, 1, or_floats(FINE, self.options))?)
            }
            MapContent::Fraction => of(store_codes(
                size,
                |i| [self.maps.numbers(plane)[i]; 3],
                1,
                or_floats(DITHERED, self.options),
            )?),
            MapContent::Label => {
                let color = |i: usize| match self.maps.numbers(plane)[i] {
                    label if label < 0.0 => [0; 3],
                    label => label_color(label as u32),
                };
                let codes = |i: usize| color(i).map(|code| f32::from(code) / 255.0);
                let bitmap = store_codes(size, codes, 3, Storage { bits: 8, dither: false })?;
                SeparateMap { legend: self.legend(map), ..of(bitmap) }
            }
            MapContent::Length if map == MapKind::Position => self.positions()?,
            MapContent::Length if map == MapKind::VectorDisplacement => self.vectors(map)?,
            MapContent::Length => self.of_numbers(map)?,
        })
    }

    /// Returns the storage of normals, dithered if 8 bits would show banding on gentle curves and the bake is not a
    /// search, which compares sizes.
    pub fn storage(&self, normals: &[[f32; 3]]) -> Storage {
        let is_covered = |i: usize| self.maps.texels[i] != TexelStatus::Free;
        let map = CoveredNormals { size: self.maps.size(), normals, is_covered: &is_covered };
        let bits = self.options.bits;
        let dither = bits == 8 && !self.options.searches() && map.banded_share() > MOST_BANDED;
        Storage { bits, dither }
    }

    /// Creates a 16-bit map of numbers.
    fn of_numbers(&self, map: MapKind) -> Result<SeparateMap> {
        let (maps, plane) = (self.maps, map.planes()[0]);
        let [black, white] = range(map, maps);
        let numbers = maps.numbers(plane);
        let number = |i: usize| [(map.of_curvature(numbers[i]) - black) / (white - black); 3];
        let bitmap = store_codes(maps.size(), number, 1, or_floats(FINE, self.options))?;
        let [length, curvature] = units(self.scan.unit());
        let unit = if plane == Plane::Curvature { curvature } else { length };
        let range = Range { black: f64::from(black), white: f64::from(white), unit };
        Ok(SeparateMap { range: Some(range), ..SeparateMap::plain(map, bitmap) })
    }

    /// Creates a 16-bit map of positions relative to the centre of the scan.
    fn positions(&self) -> Result<SeparateMap> {
        let [least, most] = self.bounds(Plane::Position);
        let is_any = least[0] <= most[0];
        let center =
            std::array::from_fn(
                |k| if is_any { (f64::from(least[k]) + f64::from(most[k])) / 2.0 } else { 0.0 },
            );
        let half = (0..3).map(|k| f64::from(most[k]) - center[k]).fold(f64::MIN_POSITIVE, f64::max);
        let map = self.around(MapKind::Position, (center, half))?;
        Ok(SeparateMap { origin: Some(center), ..map })
    }

    /// Creates a 16-bit map of vectors; mid grey is 0.
    fn vectors(&self, map: MapKind) -> Result<SeparateMap> {
        let ends = self.bounds(map.planes()[0]);
        let longest = ends.as_flattened().iter().filter(|v| v.is_finite()).map(|v| f64::from(v.abs()));
        self.around(map, ([0.0; 3], longest.fold(f64::MIN_POSITIVE, f64::max)))
    }

    /// Returns the least and the largest components of a plane of vectors at texels that a triangle covers.
    fn bounds(&self, plane: Plane) -> [[f32; 3]; 2] {
        let vectors = self.maps.vectors(plane).iter().zip(&self.maps.texels);
        let covered = vectors.filter(|(_, texel)| **texel != TexelStatus::Free);
        let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for (axis, v) in covered.flat_map(|(vector, _)| vector.iter().enumerate()) {
            least[axis] = least[axis].min(*v);
            most[axis] = most[axis].max(*v);
        }
        [least, most]
    }

    /// Creates a 16-bit map of vectors relative to a centre, up to `half` along each axis.
    fn around(&self, map: MapKind, (center, half): ([f64; 3], f64)) -> Result<SeparateMap> {
        let vectors = self.maps.vectors(map.planes()[0]);
        let code = |i: usize| {
            std::array::from_fn(|k| (0.5 + (f64::from(vectors[i][k]) - center[k]) / (2.0 * half)) as f32)
        };
        let bitmap = store_codes(self.maps.size(), code, 3, or_floats(FINE, self.options))?;
        let [unit, _] = units(self.scan.unit());
        let range = Some(Range { black: -half, white: half, unit });
        Ok(SeparateMap { range, ..SeparateMap::plain(map, bitmap) })
    }

    /// Returns the colours of the materials or objects in a map, by their names. Those without a separate name have
    /// their kind and number.
    fn legend(&self, map: MapKind) -> BTreeMap<String, String> {
        let (kind, names) = match map {
            MapKind::MaterialId => ("material", self.scan.surface().material_names()),
            _ => ("object", self.scan.about.objects.names.clone()),
        };
        let mut legend = BTreeMap::new();
        let numbers: BTreeSet<u32> =
            self.maps.covered(map.planes()[0]).into_iter().map(|v| v as u32).collect();
        for number in numbers {
            let named =
                names.get(number as usize).filter(|name| !name.is_empty() && !legend.contains_key(*name));
            let name = named.cloned().unwrap_or_else(|| format!("{kind} {number}"));
            let [r, g, b] = label_color(number);
            legend.insert(name, format!("#{r:02x}{g:02x}{b:02x}"));
        }
        legend
    }
}

/// Numbers in 16 bits.
const FINE: Storage = Storage { bits: 16, dither: false };

/// Returns the storage of numbers and colours if floats are requested, else the usual one.
fn or_floats(usual: Storage, options: &BakeOptions) -> Storage {
    if options.bits == 32 { Storage { bits: 32, dither: false } } else { usual }
}

/// Returns the colour of the thing with this number, sRGB codes: bright, and far from those of its neighbours.
///
/// Source: Roberts 2018, "The unreasonable effectiveness of quasirandom sequences", R3, in integers.
pub(in crate::asset) fn label_color(number: u32) -> [u8; 3] {
    /// 2³² over powers of the root of x⁴ = x + 1.
    const STEPS: [u32; 3] = [3_518_319_155, 2_882_110_345, 2_360_945_575];
    const DARKEST: u64 = 48;
    STEPS.map(|step| {
        let fraction = u64::from(number.wrapping_add(1).wrapping_mul(step));
        (DARKEST + ((fraction * (256 - DARKEST)) >> 32)) as u8
    })
}

/// Returns the sRGB code of linear light.
fn srgb_code(linear: f32) -> f32 {
    srgb_from_linear(f64::from(linear.clamp(0.0, 1.0))) as f32
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

/// Returns the values of black and white: the minimum and maximum; for curvature, a symmetric range that covers all but
/// one per cent of the texels.
fn range(map: MapKind, maps: &BakedMaps) -> [f32; 2] {
    let mut covered = maps.covered(map.planes()[0]);
    covered.sort_unstable_by(f32::total_cmp);
    let (Some(least), Some(most)) = (covered.first(), covered.last()) else { return [0.0, 1.0] };
    let [low, high] = match map {
        MapKind::Curvature | MapKind::Convexity | MapKind::Concavity => {
            let rank = |part: f64| covered[((covered.len() - 1) as f64 * part) as usize].abs();
            let most = rank(0.005).max(rank(0.995));
            [if map == MapKind::Curvature { -most } else { 0.0 }, most]
        }
        _ => [*least, *most],
    };
    if high > low { [low, high] } else { [low, low + 1.0] }
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
    use std::collections::HashSet;

    #[test]
    fn things_have_different_colours() {
        let colors: HashSet<[u8; 3]> = (0..2000).map(label_color).collect();
        assert_eq!(colors.len(), 2000);
        let apart = |a: [u8; 3], b: [u8; 3]| a.iter().zip(b).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0);
        let first: Vec<[u8; 3]> = (0..12).map(label_color).collect();
        for (i, a) in first.iter().enumerate() {
            assert!(first[..i].iter().all(|b| apart(*a, *b) > 30), "{i}: {a:?}");
        }
    }
}
