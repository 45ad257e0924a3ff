//! Limits on the memory and files used by reading, and by work on the content read; the machine's free memory, and
//! the time that work takes.

use super::file::file_size;
use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::time::Instant;
use taotie_engine::error::{Error, Result};

/// A number of bytes, written as e.g. 4G, 1.5GB or 800M.
///
/// ```
/// use taotie_io::Bytes;
///
/// let most: Bytes = "1.5GB".parse()?;
/// assert_eq!(most, Bytes(3 << 29));
/// assert_eq!(most.to_string(), "1.5 GiB");
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct Bytes(pub u64);

impl FromStr for Bytes {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        let wrong = || {
            Error::invalid(
                format!("invalid memory size `{text}`"),
                "use a number with a unit, e.g. 4G or 800M",
            )
        };
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

/// Limits on the resources that work may use, and on the files that a model may cause to be read.
///
/// ```
/// use taotie_io::Limits;
///
/// let limits = Limits { memory: Some("4G".parse()?), ..Limits::default() };
/// assert_eq!(limits.or_free(), limits);
/// # Ok::<(), taotie_engine::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Limits {
    /// Maximum memory; `None` for the machine's free memory.
    pub memory: Option<Bytes>,
    /// Maximum number of pixels of an image that is read; never more than 2²⁸, which is 16384 × 16384.
    pub pixels: u64,
    /// Maximum number of triangles of a model, over all instances.
    pub triangles: u64,
    /// Maximum number of nodes of a model.
    pub nodes: u64,
    /// `true` if files outside the model's folder are read too, when the model refers to them.
    pub allow_outside: bool,
}

impl Default for Limits {
    /// Limits to the machine's free memory, images of 16384 × 16384 pixels, 2³² − 2 triangles, 16 million nodes, and
    /// files in the model's folder.
    fn default() -> Self {
        Self {
            memory: None,
            pixels: 1 << 28,
            triangles: u32::MAX as u64 - 1,
            nodes: 1 << 24,
            allow_outside: false,
        }
    }
}

impl Limits {
    /// Returns these limits with the machine's free memory filled in if no memory limit is set and it is known.
    pub fn or_free(self) -> Self {
        Self { memory: self.memory.or_else(|| free_memory().map(Bytes)), ..self }
    }

    /// Returns the limits for reading a file that was just written: only those of the formats.
    pub fn of_own_files() -> Self {
        Self { memory: Some(Bytes(u64::MAX)), ..Self::default() }
    }

    /// Rejects work that needs more memory than allowed. `what` is the work.
    ///
    /// ```
    /// use taotie_io::{Bytes, Limits};
    ///
    /// let limits = Limits { memory: Some(Bytes(1 << 30)), ..Limits::default() };
    /// assert!(limits.check("a small image", Bytes(1 << 20)).is_ok());
    /// let error = limits.check("a poster", Bytes(3 << 30)).unwrap_err().to_string();
    /// assert!(error.contains("a poster") && error.contains("3.0 GiB") && error.contains("1.0 GiB"));
    /// ```
    ///
    /// # Errors
    /// [`Error::Limit`], with both figures.
    pub fn check(&self, what: impl Into<String>, need: Bytes) -> Result<()> {
        match self.memory {
            Some(limit) if need > limit => Err(Error::limit(
                what,
                format!(
                    "it needs about {need} of memory, but the limit is {limit}; raise it with --memory-limit, free \
                     memory, or request less"
                ),
            )),
            _ => Ok(()),
        }
    }

    /// Rejects a file that cannot even be read within the limit.
    pub fn check_file(self, path: &Path) -> Result<()> {
        // Reading reports the error for a file without a size.
        let Ok(size) = file_size(path).map(Bytes) else { return Ok(()) };
        match self.memory {
            Some(limit) if size > limit => Err(Error::limit(
                path.display().to_string(),
                format!(
                    "its size is {size}, but the limit is {limit}; raise the memory limit, free memory, or simplify \
                     the scan first"
                ),
            )),
            _ => Ok(()),
        }
    }
}

/// Returns the memory available for new work, in bytes: the system's figure, or the rest of its limit on this process
/// group if that is less; file caches count as available. `None` if unknown.
pub fn free_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    // If the system reports nothing, as without /proc, the limits of groups are not queried: that panics.
    if system.total_memory() == 0 {
        return None;
    }
    let limits = system.cgroup_limits().map(|limits| limits.total_memory.saturating_sub(limits.rss));
    let free = limits.map_or(system.available_memory(), |group| group.min(system.available_memory()));
    (free > 0).then_some(free)
}

/// A running clock that measures elapsed time.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts a clock.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Returns the time since the start in milliseconds.
    pub fn milliseconds(&self) -> f64 {
        self.0.elapsed().as_secs_f64() * 1e3
    }
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
}
