//! The memory that a bake will take, estimated before it begins.

use super::options::BakeOptions;
use super::scan_size::ScanSize;
use crate::bake::{MapKind, Maps};
use crate::error::{Error, Result};
use crate::io;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// A number of bytes, written as 4G, 1.5GB, 800M.
///
/// ```
/// use taotie::asset::Bytes;
///
/// let most: Bytes = "1.5GB".parse()?;
/// assert_eq!(most, Bytes(3 << 29));
/// assert_eq!(most.to_string(), "1.5 GiB");
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bytes(pub u64);

impl FromStr for Bytes {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong =
            || Error::invalid(format!("`{text}`"), "it is no amount of memory; write it as 4G or 800M");
        let upper = text.trim().to_ascii_uppercase();
        let digits = upper.trim_end_matches("IB").trim_end_matches('B');
        let (number, power) = match digits.char_indices().last() {
            Some((at, 'K')) => (&digits[..at], 10),
            Some((at, 'M')) => (&digits[..at], 20),
            Some((at, 'G')) => (&digits[..at], 30),
            Some((at, 'T')) => (&digits[..at], 40),
            _ => (digits, 0),
        };
        let number: f64 = number.trim().parse().map_err(|_| wrong())?;
        let bytes = number * (1u64 << power) as f64;
        if bytes >= 1.0 && bytes.is_finite() { Ok(Self(bytes as u64)) } else { Err(wrong()) }
    }
}

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.0 as f64;
        match self.0 {
            0..0x40_0000 => write!(f, "{:.0} KiB", bytes / 1024.0),
            0x40_0000..0x4000_0000 => write!(f, "{:.0} MiB", bytes / f64::from(1 << 20)),
            _ => write!(f, "{:.1} GiB", bytes / f64::from(1 << 30)),
        }
    }
}

/// The limits of what the work may take of the machine.
///
/// ```
/// use taotie::asset::{BakeOptions, Baker, Limits};
///
/// let limits = Limits { memory: Some("4G".parse()?) };
/// let baker = Baker::new(BakeOptions::default()).with_limits(limits);
/// assert_eq!(limits.or_free(), limits);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Limits {
    /// The most memory; `None` for what the machine has free.
    pub memory: Option<Bytes>,
}

impl Limits {
    /// Returns these limits with what the machine has free now where none is set; a machine that does not say sets none.
    pub fn or_free(self) -> Self {
        Self { memory: self.memory.or_else(|| io::free_memory().map(Bytes)) }
    }

    /// Refuses a file that cannot even be read within the limit.
    pub(super) fn check_file(self, path: &Path) -> Result<()> {
        // Reading says what is wrong with a file that has no size.
        let Ok(size) = io::file_size(path).map(Bytes) else { return Ok(()) };
        match self.memory {
            Some(limit) if size > limit => Err(Error::limit(
                path.display().to_string(),
                format!(
                    "the file has {size}, the limit is {limit}; raise the memory limit, free memory, or simplify the scan \
                     first"
                ),
            )),
            _ => Ok(()),
        }
    }
}

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
/// assert!(need.check(Limits { memory: Some(Bytes(1 << 30)) }).is_err());
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
    fn amounts_are_read_as_people_write_them() {
        let read = |text: &str| text.parse::<Bytes>().map(|bytes| bytes.0).ok();
        assert_eq!(read("4G"), Some(4 << 30));
        assert_eq!(read("1.5 GiB"), Some(3 << 29));
        assert_eq!(read("800mb"), Some(800 << 20));
        assert_eq!(read("4096"), Some(4096));
        for wrong in ["", "G", "-1G", "four", "0", "nan"] {
            assert!(read(wrong).is_none(), "{wrong}");
        }
        assert_eq!(Bytes(3 << 29).to_string(), "1.5 GiB");
    }

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
        let error = need.check(Limits { memory: Some(Bytes(1 << 30)) }).unwrap_err().to_string();
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
