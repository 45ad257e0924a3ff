//! The memory that a bake will take, estimated before it begins.

use super::options::BakeOptions;
use super::scan_size::ScanSize;
use crate::bake::{MapKind, Maps};
use crate::error::{Error, Result};
use crate::io::{Bytes, Limits};

/// The memory of a bake at its peak: the scan with its textures, sorted for rays, simplification, maps; or, where that is
/// more, the tangents that a scan with a normal map gets before.
///
/// ```
/// use taotie::asset::{BakeOptions, Baker, Bytes, Limits, ScanSize};
///
/// let baker = Baker::new(BakeOptions::default());
/// let size = ScanSize { triangles: 20_000_000, vertices: 10_000_000, ..ScanSize::default() };
/// let need = baker.need(size);
/// assert!(need.simplifies && need.bytes() > Bytes(1 << 30));
/// assert!(need.check(Limits { memory: Some(Bytes(1 << 30)), ..Limits::default() }).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Need {
    /// The size of the scan.
    pub scan: ScanSize,
    /// `true` where the low-poly mesh has to be made.
    pub simplifies: bool,
    /// `true` where the scan is inspected.
    pub inspects: bool,
    /// Texels of a map.
    pub texels: u64,
    /// Bytes a texel over all maps while they are made.
    pub texel_bytes: u64,
    /// Bytes a texel over all maps as they are stored.
    pub stored_bytes: u64,
    /// Materials with maps of their own, at least 1; known where the low-poly mesh is read.
    pub materials: u64,
}

impl Need {
    pub(super) fn of(options: &BakeOptions, scan: ScanSize) -> Self {
        Self {
            scan,
            simplifies: options.low.is_none(),
            inspects: options.inspect,
            texels: options.map_size().map(u64::from).iter().product(),
            texel_bytes: texel_bytes(options, scan.carries),
            stored_bytes: maps(options, scan.carries).iter().count() as u64 * codes(options),
            materials: 1,
        }
    }

    /// Returns the whole, scan included.
    pub fn bytes(&self) -> Bytes {
        /// Keys while the tree is sorted.
        const SORTING: u64 = 8;
        /// The memory of simplification for a triangle: joined vertices, blocks, and the half that is left of them.
        const SIMPLIFYING: u64 = 24;
        /// The scan's edges and triangles as they are sorted to find its faults.
        const INSPECTING: u64 = 40;
        /// The program itself, its threads' bands, and the low-poly mesh.
        const REST: u64 = 96 << 20;
        let simplifying = if self.simplifies { SIMPLIFYING } else { 0 };
        let inspecting = if self.inspects { INSPECTING } else { 0 };
        let beside = self.scan.triangles * SORTING.max(simplifying).max(inspecting);
        // One material is baked after the other.
        let stored = self.materials.saturating_sub(1).saturating_mul(self.texels * self.stored_bytes);
        let baking = self.scan.bytes() + beside.max(self.texels * self.texel_bytes);
        Bytes(baking.saturating_add(stored).max(self.scan.framing_bytes()).saturating_add(REST))
    }

    /// Refuses what does not fit.
    ///
    /// # Errors
    /// [`Error::Limit`] where the limit is exceeded.
    pub fn check(&self, limits: Limits) -> Result<()> {
        match limits.memory {
            Some(limit) if self.bytes() > limit => Err(Error::limit(
                format!("a bake of {} triangles", self.scan.triangles),
                format!(
                    "it needs about {} of memory, the limit is {limit}; raise the memory limit, free memory, lower the \
                     maps' size, or bake fewer maps at once",
                    self.bytes()
                ),
            )),
            _ => Ok(()),
        }
    }
}

/// Bytes a texel over all maps: floats while they are baked, codes afterwards, and what filling takes.
fn texel_bytes(options: &BakeOptions, carries: Maps) -> u64 {
    let floats = |map: MapKind| match map {
        MapKind::Normal | MapKind::Albedo | MapKind::Bent | MapKind::Emission => 12,
        MapKind::MetallicRoughness => 8,
        _ => 4,
    };
    let codes = codes(options);
    8 + maps(options, carries).iter().map(|map| floats(map) + codes).sum::<u64>()
}

/// Bytes a texel of a map that is stored, at most.
fn codes(options: &BakeOptions) -> u64 {
    4 * u64::from(options.bits / 8)
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
        let need = Need {
            scan: ScanSize { triangles: 20_000_000, vertices: 10_000_000, ..ScanSize::default() },
            simplifies: true,
            inspects: true,
            texels: 1 << 22,
            texel_bytes: 20,
            stored_bytes: 8,
            materials: 1,
        };
        assert!(need.bytes() < Bytes(4 << 30), "{}", need.bytes());
        let error =
            need.check(Limits { memory: Some(Bytes(1 << 30)), ..Limits::default() }).unwrap_err().to_string();
        assert!(error.contains("20000000 triangles") && error.contains("1.0 GiB"), "{error}");
        assert!(need.check(Limits::default()).is_ok());
        let several = Need { materials: 4, ..need };
        assert_eq!(
            several.bytes().0 - need.bytes().0,
            3 * (8 << 22),
            "maps of three are held beside those baked"
        );
    }

    #[test]
    fn tangents_and_textures_of_a_scan_are_in_the_estimate() {
        let size = ScanSize { triangles: 20_000_000, vertices: 10_000_000, ..ScanSize::default() };
        let need = |size| Need::of(&BakeOptions::default(), size).bytes().0;
        let framed = ScanSize { framed_triangles: 20_000_000, framed_vertices: 10_000_000, ..size };
        assert!(need(framed) > 8 << 30, "{}", need(framed));
        assert_eq!(need(framed.sorted()), need(size));
        let textured = ScanSize { texture_bytes: 1 << 30, ..size };
        assert_eq!(need(textured), need(size) + (1 << 30));
    }
}
