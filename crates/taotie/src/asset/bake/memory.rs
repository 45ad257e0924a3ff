//! The memory that a bake needs, estimated before it begins.

use crate::asset::ask::{BakeOptions, Packing};
use crate::asset::source::ScanSize;
use taotie_engine::bake::{MapKind, Maps, MatchRule, REMESH_BYTES, bytes_of_bands, bytes_on_device};
use taotie_engine::error::{Error, Result};
use taotie_engine::math::Vec3;
use taotie_engine::surface::{NoiseHandling, denoising_bytes};
use taotie_io::{Bytes, CodecKind, ImageCodec, Limits, TextureCodecs};

/// The peak memory of a bake: the scan with its textures, sorted for rays, and maps; or, if that is more, that of
/// computing tangents for a scan with a normal map, inspection, simplification, texture packing, measuring the asset,
/// or the page that shows it.
///
/// ```
/// use taotie::asset::{BakeOptions, Baker, ScanSize};
/// use taotie::{Bytes, Limits};
///
/// let baker = Baker::new(BakeOptions::default());
/// let size = ScanSize { triangles: 20_000_000, vertices: 10_000_000, ..ScanSize::default() };
/// let need = baker.need(size);
/// assert!(need.simplifies && need.bytes() > Bytes(1 << 30));
/// assert!(need.check(Limits { memory: Some(Bytes(1 << 30)), ..Limits::default() }).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct MemoryEstimate {
    /// The size of the scan.
    pub scan: ScanSize,
    /// `true` if an earlier bake has sorted the scan for rays; else that happens after inspection and simplification.
    pub is_sorted: bool,
    /// `true` if the low-poly mesh must be generated.
    pub simplifies: bool,
    /// The requested number of low-poly triangles; also used as an estimate if the mesh or its error is given
    /// instead.
    pub low_triangles: u64,
    /// `true` if the scan's watertight outer surface is built.
    pub remeshes: bool,
    /// `true` if the scan is inspected.
    pub inspects: bool,
    /// Whether the scan's noise is kept or removed; `None` if it is not measured.
    pub noise: Option<NoiseHandling>,
    /// Texels of a map.
    pub texels: u64,
    /// Bytes per texel over all maps during baking.
    pub texel_bytes: u64,
    /// Bytes of the bands of texels that threads bake concurrently.
    pub band_bytes: u64,
    /// Bytes for a device that casts rays instead of the CPU; 0 without one.
    #[serde(default)]
    pub device_bytes: u64,
    /// Bytes per texel over all maps as stored.
    pub stored_bytes: u64,
    /// The maximum number of stored maps.
    pub maps: u64,
    /// Materials with their own maps, at least 1; known once the low-poly mesh is read.
    pub materials: u64,
    /// Levels of detail, including the finest.
    pub levels: u64,
    /// The formats of its textures.
    pub images: TextureCodecs,
    /// `true` if channels are packed into further textures.
    pub packs_channels: bool,
    /// `true` if the scan's triangles are indexed by their uvs.
    pub matches_uvs: bool,
    /// `true` if the asset is measured against the scan afterwards.
    pub is_proved: bool,
    /// The maximum texture side on a page that shows the asset afterwards, texels; `None` without a page.
    pub shown_side: Option<u32>,
}

impl MemoryEstimate {
    pub(in crate::asset) fn of(options: &BakeOptions, scan: ScanSize) -> Self {
        let options = &options.sized(scan);
        let wanted = maps(options, scan.carries);
        let maps = wanted.iter().count() as u64;
        let size = options.map_size().map(|side| options.sizes.largest(side));
        Self {
            scan,
            is_sorted: false,
            simplifies: options.low.is_none(),
            low_triangles: u64::from(options.triangles).min(scan.triangles),
            remeshes: options.remesh,
            inspects: options.inspect,
            noise: options.noise,
            texels: size.map(u64::from).iter().product(),
            texel_bytes: texel_bytes(options, scan.carries),
            band_bytes: bytes_of_bands(size, options.side, wanted),
            device_bytes: 0,
            stored_bytes: wanted.iter().map(|map| codes(options, map)).sum(),
            maps,
            materials: 1,
            levels: 1 + options.lods.len() as u64,
            images: TextureCodecs::default(),
            packs_channels: false,
            matches_uvs: options.matching == MatchRule::Uv,
            is_proved: false,
            shown_side: None,
        }
    }

    /// Returns the need of a bake that is written with this packing; the default is PNG.
    pub fn with_packing(self, packing: &Packing) -> Self {
        Self { images: packing.images, packs_channels: !packing.channels.is_empty(), ..self }
    }

    /// Returns the need of a bake whose rays are cast by a device other than the CPU.
    pub fn with_device(self) -> Self {
        Self { device_bytes: bytes_on_device(self.scan.triangles, self.scan.vertices), ..self }
    }

    /// Returns the need of a bake whose asset is measured against the scan afterwards.
    pub fn with_proof(self) -> Self {
        Self { is_proved: true, ..self }
    }

    /// Returns the need of a bake whose asset is shown on a page afterwards, with textures of at most `side` texels
    /// along a side.
    pub fn with_viewer(self, side: u32) -> Self {
        Self { shown_side: Some(side), ..self }
    }

    /// Returns the peak memory, scan included: the maximum over its stages, which run one after the other.
    pub fn bytes(&self) -> Bytes {
        /// The program itself, its threads, and the low-poly mesh.
        const REST: u64 = 32 << 20;
        /// The same while tangents are computed, plus memory freed then but not returned to the system.
        const FRAMING_REST: u64 = 96 << 20;
        /// Memory freed in pieces but kept by the allocator: per triangle, and at most.
        const KEPT: u64 = 96;
        const MOST_KEPT: u64 = 48 << 20;
        let proving = if self.is_proved { self.proving() } else { 0 };
        let showing = self.shown_side.map_or(0, |side| self.showing(side));
        let most = self
            .lightening()
            .max(self.baking())
            .max(self.writing())
            .max(proving)
            .max(showing)
            .saturating_add(if self.remeshes { REMESH_BYTES } else { 0 })
            .saturating_add(REST + (self.scan.triangles * KEPT).min(MOST_KEPT));
        let framing = match self.scan.framing_bytes() {
            0 => 0,
            bytes => bytes.saturating_add(FRAMING_REST),
        };
        Bytes(most.max(framing))
    }

    /// Returns the bytes during inspection of the scan and generation of the low-poly mesh.
    fn lightening(&self) -> u64 {
        /// The memory of simplification per triangle: joined vertices, blocks, and the half that remains of them.
        const SIMPLIFYING: u64 = 24;
        /// The scan's edges and triangles in groups, used to find its faults and to measure its noise.
        const INSPECTING: u64 = 40;
        let simplifying = if self.simplifies { SIMPLIFYING } else { 0 };
        let inspecting = if self.inspects || self.noise.is_some() { INSPECTING } else { 0 };
        let [denoised, denoising] = self.denoised();
        let scan = if self.is_sorted || self.remeshes { self.scan.bytes() } else { self.scan.mesh_bytes() };
        let working = (self.scan.triangles * simplifying.max(inspecting)).max(denoising);
        scan.saturating_add(denoised).saturating_add(working)
    }

    /// Returns the bytes while the scan is sorted and maps are baked.
    fn baking(&self) -> u64 {
        /// Keys while the tree is sorted.
        const SORTING: u64 = 8;
        let sorting = self.scan.triangles * SORTING;
        // Materials are baked one after the other.
        let stored = self.stored_of(self.materials.saturating_sub(1));
        let bands = self.band_bytes.saturating_add(self.device_bytes);
        let maps = (self.texels * self.texel_bytes).saturating_add(bands);
        let scan = self.scan.bytes().saturating_add(self.denoised()[0]).saturating_add(self.uv_index());
        scan.saturating_add(sorting.max(maps)).saturating_add(stored)
    }

    /// Returns the bytes of the scan's triangles by their uvs: a tree, corners and numbers.
    fn uv_index(&self) -> u64 {
        let tree = self.scan.bytes() - self.scan.mesh_bytes();
        let triangle = (size_of::<[Vec3; 3]>() + size_of::<u32>()) as u64;
        if self.matches_uvs { tree + self.scan.triangles * triangle } else { 0 }
    }

    /// Returns the bytes of the scan without its noise, next to the scan as given, and those to make it; zeros if the
    /// noise is kept.
    fn denoised(&self) -> [u64; 2] {
        match (self.noise, self.scan) {
            (Some(NoiseHandling::Remove), ScanSize { triangles, vertices, texture_bytes, .. }) => {
                [self.scan.mesh_bytes() - texture_bytes, denoising_bytes(triangles, vertices)]
            }
            _ => [0; 2],
        }
    }

    /// Returns the bytes while textures are packed, one per thread at a time.
    fn writing(&self) -> u64 {
        let packed =
            if self.packs_channels { self.texels * most(self.images, |coding| coding.packing) } else { 0 };
        let stored = self.stored_of(self.materials).saturating_add(packed);
        let scan = self.scan.bytes().saturating_add(self.uv_index());
        scan.saturating_add(stored).saturating_add(self.packing(self.texels, self.images))
    }

    /// Returns the bytes while maps of `texels` texels are encoded as images, one per thread at a time.
    fn packing(&self, texels: u64, images: TextureCodecs) -> u64 {
        let at_once = (self.maps * self.materials).min(rayon::current_num_threads() as u64);
        (texels * most(images, |coding| coding.packing)).saturating_mul(at_once)
    }

    /// Returns the bytes while the asset is read back and measured.
    fn proving(&self) -> u64 {
        /// Points at which normals and distances are measured.
        const POINTS: u64 = 32 << 20;
        /// A triangle of the asset, sorted for rays and placed for pictures.
        const LOW_TRIANGLE: u64 = 220;
        // Its maps are measured by a second index.
        let scan = self.scan.bytes().max(self.scan.viewing_bytes()).saturating_add(2 * self.uv_index());
        let low = self.low_triangles * LOW_TRIANGLE;
        [self.stored_of(self.materials), self.read_back(), self.proof(), low, POINTS]
            .into_iter()
            .fold(scan, u64::saturating_add)
    }

    /// Returns the bytes while a page shows the asset: it is read back, and its textures are re-encoded smaller and
    /// lossless. The scan is gone, and the memory of its measurement is freed; the allocator keeps some of it.
    fn showing(&self, side: u32) -> u64 {
        /// A triangle of the asset: as drawn, as packed, and as text.
        const LOW_TRIANGLE: u64 = 550;
        const KEPT: u64 = 600;
        const MOST_KEPT: u64 = 64 << 20;
        let packing = self.packing(self.texels.min(u64::from(side).pow(2)), ImageCodec::WebP.into());
        let proof = if self.is_proved { self.proof() } else { 0 };
        let low = self.low_triangles * LOW_TRIANGLE + (self.scan.triangles * KEPT).min(MOST_KEPT);
        [self.stored_of(self.materials), self.read_back(), packing, low]
            .into_iter()
            .fold(proof, u64::saturating_add)
    }

    /// Returns the bytes of the asset's textures with their mip levels, as read from its file.
    fn read_back(&self) -> u64 {
        const TEXTURE: u64 = 7;
        let maps = (self.maps * self.materials).saturating_mul(self.texels * TEXTURE);
        maps.saturating_add(self.texels * most(self.images, |coding| coding.unpacking))
    }

    /// Returns the bytes held by a proof and by its display in the report.
    fn proof(&self) -> u64 {
        /// Images of scan and level from all sides in one look, and their differences.
        const VIEWS: u64 = 48 << 20;
        /// The maximum size of maps of errors and of lost detail, and bytes per texel of them.
        const MOST_ERRORS: u64 = 1 << 20;
        const ERROR: u64 = 53;
        let looks = if self.scan.has_material { 2 } else { 1 };
        let errors = self.materials.saturating_mul(self.texels.min(MOST_ERRORS) * ERROR * looks);
        errors.saturating_add(self.levels * looks * VIEWS)
    }

    /// Returns the bytes of the stored maps of this number of materials.
    fn stored_of(&self, materials: u64) -> u64 {
        materials.saturating_mul(self.texels * self.stored_bytes)
    }

    /// Refuses a bake that does not fit.
    ///
    /// # Errors
    /// [`Error::Limit`] if the limit is exceeded.
    pub fn check(&self, limits: Limits) -> Result<()> {
        match limits.memory {
            Some(limit) if self.bytes() > limit => Err(Error::limit(
                format!("a bake of {} triangles", self.scan.triangles),
                format!(
                    "it needs about {} of memory, but the limit is {limit}; raise the memory limit, free memory, lower the \
                     maps' size, or bake fewer maps at a time{}",
                    self.bytes(),
                    taotie_io::limits_note()
                ),
            )),
            _ => Ok(()),
        }
    }
}

/// The bytes per texel of a texture in addition to its codes, during packing and unpacking.
struct Coding {
    packing: u64,
    unpacking: u64,
}

fn most(images: TextureCodecs, of: fn(Coding) -> u64) -> u64 {
    let coding = |kind: CodecKind| match kind {
        CodecKind::Png | CodecKind::Jpeg => Coding { packing: 16, unpacking: 0 },
        CodecKind::WebP => Coding { packing: 36, unpacking: 14 },
        CodecKind::Avif => Coding { packing: 40, unpacking: 14 },
        CodecKind::Ktx2 => Coding { packing: 24, unpacking: 5 },
    };
    images.all().into_iter().map(|codec| of(coding(codec.kind()))).max().unwrap_or_default()
}

/// Bytes per texel over all maps: floats during baking, codes afterwards, and the buffers for filling.
fn texel_bytes(options: &BakeOptions, carries: Maps) -> u64 {
    let floats = |map: MapKind| map.planes().iter().map(|plane| 4 * plane.channels() as u64).sum::<u64>();
    8 + maps(options, carries).iter().map(|map| floats(map) + codes(options, map)).sum::<u64>()
}

/// The bytes per texel of a stored map: numbers with a unit have 16 bits.
fn codes(options: &BakeOptions, map: MapKind) -> u64 {
    let bits = if map.is_fine() { options.bits.max(16) } else { options.bits };
    4 * u64::from(bits / 8)
}

fn maps(options: &BakeOptions, carries: Maps) -> Maps {
    let carried = carries.iter().filter(|_| options.carry);
    options.maps.iter().copied().chain(carried).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_both_numbers() {
        let need = MemoryEstimate {
            scan: ScanSize { triangles: 20_000_000, vertices: 10_000_000, ..ScanSize::default() },
            is_sorted: false,
            simplifies: true,
            low_triangles: 50_000,
            remeshes: false,
            inspects: true,
            noise: None,
            matches_uvs: false,
            texels: 1 << 22,
            texel_bytes: 20,
            band_bytes: 0,
            device_bytes: 0,
            stored_bytes: 8,
            maps: 2,
            materials: 1,
            levels: 1,
            images: TextureCodecs::default(),
            packs_channels: false,
            is_proved: false,
            shown_side: None,
        };
        assert!(need.bytes() < Bytes(4 << 30), "{}", need.bytes());
        let error =
            need.check(Limits { memory: Some(Bytes(1 << 30)), ..Limits::default() }).unwrap_err().to_string();
        assert!(error.contains("20000000 triangles") && error.contains("1.0 GiB"), "{error}");
        assert!(need.check(Limits::default()).is_ok());
        let several = MemoryEstimate { materials: 4, ..need };
        assert_eq!(
            several.bytes().0 - need.bytes().0,
            3 * (8 << 22),
            "maps of three are held next to those being baked"
        );
    }

    #[test]
    fn tangents_and_textures_of_a_scan_are_in_the_estimate() {
        let size = ScanSize { triangles: 20_000_000, vertices: 10_000_000, ..ScanSize::default() };
        let need = |size| MemoryEstimate::of(&BakeOptions::default(), size).bytes().0;
        let framed = ScanSize { framed_triangles: 20_000_000, framed_vertices: 10_000_000, ..size };
        assert!(need(framed) > 8 << 30, "{}", need(framed));
        assert_eq!(need(framed.joined()), need(size));
        let on_device = MemoryEstimate::of(&BakeOptions::default(), size).with_device();
        let batches = (rayon::current_num_threads() as u64) << 26;
        assert_eq!(on_device.device_bytes, 20_000_000 * (32 + 16) + batches + (96 << 20));
        // Simplification takes a little more than baking without a device.
        assert!(on_device.bytes().0 - need(size) > on_device.device_bytes / 2);
        let textured = ScanSize { texture_bytes: 1 << 30, ..size };
        assert_eq!(need(textured), need(size) + (1 << 30));
    }

    #[test]
    fn each_thread_has_a_band_of_its_own() {
        let of_threads = |count: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
            pool.install(|| MemoryEstimate::of(&BakeOptions::default(), ScanSize::default()).bytes().0)
        };
        let band = (of_threads(16) - of_threads(2)) / 14;
        assert!((6 << 20..8 << 20).contains(&band), "{band}");
        assert_eq!(of_threads(1000), of_threads(64), "a map of 2048 rows has 64 bands");
    }

    #[test]
    fn packing_and_proof_count_where_they_are_the_most() {
        let options = BakeOptions::default();
        let need = MemoryEstimate::of(
            &options,
            ScanSize { triangles: 20_000, vertices: 10_000, ..ScanSize::default() },
        );
        let webp = Packing { images: ImageCodec::WebP.into(), ..Packing::default() };
        assert!(need.with_packing(&webp).bytes() > need.bytes());
        assert!(need.with_packing(&webp).with_proof().bytes() > need.with_proof().bytes());
        assert!(need.with_proof().with_viewer(2048).bytes() > need.with_proof().bytes());
        let proved = |need: MemoryEstimate| need.with_proof().bytes().0;
        assert!(proved(need) > need.bytes().0);
        let levels = MemoryEstimate { levels: 3, ..need };
        assert_eq!(proved(levels) - proved(need), 2 * (48 << 20), "the images of two further levels");
        let material = MemoryEstimate { scan: ScanSize { has_material: true, ..need.scan }, ..need };
        assert!(proved(material) >= proved(need) + (48 << 20));
    }
}
