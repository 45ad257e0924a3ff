//! How much memory a bake will take, told before it begins.

use anyhow::{Result, bail};
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// A number of bytes, written as 4G, 1.5GB, 800M.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bytes(pub u64);

impl FromStr for Bytes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is no amount of memory; write it as 4G or 800M");
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

/// The limit that was asked for, or what the machine has free; `None` where it does not tell.
pub fn limit(asked: Option<Bytes>) -> Option<Bytes> {
    asked.or_else(free)
}

/// What the system says is free for new work, and what this process has taken already.
fn free() -> Option<Bytes> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let limits = system.cgroup_limits().map(|limits| limits.free_memory);
    let free = limits.map_or(system.available_memory(), |group| group.min(system.available_memory()));
    (free > 0).then_some(Bytes(free))
}

/// Refuses a file that cannot even be read within the limit.
///
/// # Errors
/// Where the file is larger than the limit.
pub fn check_file(path: &Path, limit: Option<Bytes>) -> Result<()> {
    let Ok(size) = std::fs::metadata(path).map(|data| data.len()) else { return Ok(()) };
    if let Some(limit) = limit.filter(|limit| size > limit.0) {
        bail!(
            "{}: the file has {}, the limit is {limit}; raise --memory-limit, free memory, or simplify the scan first",
            path.display(),
            Bytes(size)
        );
    }
    Ok(())
}

/// What baking takes at its peak, beside the scan itself: sorting for rays, simplification, maps.
#[derive(Debug, Clone, Copy)]
pub struct Need {
    /// Triangles and vertices of the scan.
    pub scan: [u64; 2],
    /// Whether the light mesh has to be made.
    pub simplifies: bool,
    /// Whether the scan is inspected and the asset proved.
    pub proves: bool,
    /// Texels of a map.
    pub texels: u64,
    /// Bytes a texel over all maps while they are made.
    pub texel_bytes: u64,
}

impl Need {
    /// The whole, scan included.
    pub fn bytes(&self) -> Bytes {
        /// Positions and normals; what else vertices have is small beside the rest.
        const VERTEX: u64 = 24;
        const TRIANGLE: u64 = 12;
        /// Corners, order and boxes of the tree.
        const TREE: u64 = 41;
        /// Keys while it is sorted.
        const SORTING: u64 = 8;
        /// What simplification takes a triangle: joined vertices, blocks, and the half that is left of them.
        const SIMPLIFYING: u64 = 24;
        /// The scan's edges and triangles as they are sorted to find its faults.
        const INSPECTING: u64 = 40;
        /// The program itself, its threads' bands, and the light mesh.
        const REST: u64 = 96 << 20;
        let [triangles, vertices] = self.scan;
        let scan = triangles * (TRIANGLE + TREE) + vertices * VERTEX;
        let simplifying = if self.simplifies { SIMPLIFYING } else { 0 };
        let inspecting = if self.proves { INSPECTING } else { 0 };
        let beside = triangles * SORTING.max(simplifying).max(inspecting);
        Bytes(scan + beside.max(self.texels * self.texel_bytes) + REST)
    }

    /// Refuses what does not fit.
    ///
    /// # Errors
    /// Where the limit is exceeded.
    pub fn check(&self, limit: Option<Bytes>) -> Result<()> {
        if let Some(limit) = limit.filter(|limit| self.bytes() > *limit) {
            bail!(
                "baking {} triangles takes about {}, the limit is {limit}; raise --memory-limit, free memory, lower --size, \
                 or bake fewer maps at once",
                self.scan[0],
                self.bytes()
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_read_as_people_write_them() {
        let read = |text: &str| text.parse::<Bytes>().map(|bytes| bytes.0);
        assert_eq!(read("4G"), Ok(4 << 30));
        assert_eq!(read("1.5 GiB"), Ok(3 << 29));
        assert_eq!(read("800mb"), Ok(800 << 20));
        assert_eq!(read("4096"), Ok(4096));
        for wrong in ["", "G", "-1G", "four", "0", "nan"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
        assert_eq!(Bytes(3 << 29).to_string(), "1.5 GiB");
    }

    #[test]
    fn what_does_not_fit_is_refused_with_both_numbers() {
        let need = Need {
            scan: [20_000_000, 10_000_000],
            simplifies: true,
            proves: true,
            texels: 1 << 22,
            texel_bytes: 20,
        };
        assert!(need.bytes() < Bytes(4 << 30), "{}", need.bytes());
        let error = need.check(Some(Bytes(1 << 30))).unwrap_err().to_string();
        assert!(error.contains("20000000 triangles") && error.contains("1.0 GiB"), "{error}");
        assert!(need.check(None).is_ok());
    }
}
