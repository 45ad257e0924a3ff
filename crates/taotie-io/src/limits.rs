//! Limits on the memory and files used by reading, and by work on the content read; the memory that the machine, the
//! process's groups and its own limits leave, and the time that work takes.

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
#[derive(
    Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
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

/// Resources that content takes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Used {
    /// Its memory.
    pub memory: Bytes,
    /// Triangles of its models, over all instances.
    pub triangles: u64,
}

impl Used {
    /// Returns the sum of both.
    #[must_use]
    pub fn and(self, o: Self) -> Self {
        Self {
            memory: Bytes(self.memory.0.saturating_add(o.memory.0)),
            triangles: self.triangles.saturating_add(o.triangles),
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
    /// Maximum memory; `None` for [`free_memory`].
    pub memory: Option<Bytes>,
    /// Maximum number of pixels of an image that is read; never more than 2²⁸, which is 16384 × 16384.
    pub pixels: u64,
    /// Maximum number of triangles of a model, over all instances.
    pub triangles: u64,
    /// Maximum number of nodes of a model.
    pub nodes: u64,
    /// `true` if files outside the model's folder are read too, when the model refers to them.
    pub allow_outside: bool,
    /// The part of the limits that content read before takes.
    #[serde(skip)]
    pub used: Used,
}

impl Default for Limits {
    /// Limits to the free memory, images of 16384 × 16384 pixels, 2³² − 2 triangles, 16 million nodes, and
    /// files in the model's folder.
    fn default() -> Self {
        Self {
            memory: None,
            pixels: 1 << 28,
            triangles: u32::MAX as u64 - 1,
            nodes: 1 << 24,
            allow_outside: false,
            used: Used::default(),
        }
    }
}

impl Limits {
    /// Returns these limits with the free memory filled in if no memory limit is set and it is known.
    pub fn or_free(self) -> Self {
        Self { memory: self.memory.or_else(|| free_memory().map(Bytes)), ..self }
    }

    /// Returns the limits for reading a file that was just written: only those of the formats.
    pub fn of_own_files() -> Self {
        Self { memory: Some(Bytes(u64::MAX)), ..Self::default() }
    }

    /// Returns the memory that further content may take; `None` if it is unlimited.
    pub fn memory_left(&self) -> Option<Bytes> {
        self.memory.map(|limit| Bytes(limit.0.saturating_sub(self.used.memory.0)))
    }

    /// Rejects a model with more triangles than allowed. `what` is its file.
    ///
    /// # Errors
    /// [`Error::Limit`], with all figures.
    pub fn check_triangles(&self, what: impl fmt::Display, triangles: u64) -> Result<()> {
        let Self { triangles: most, used, .. } = self;
        match used.triangles.saturating_add(triangles) > *most {
            true => Err(Error::limit(
                format!("{what}: a model of {triangles} triangles"),
                match used.triangles {
                    0 => format!("the maximum is {most}; simplify the model"),
                    used => format!(
                        "the maximum is {most}, of which the files before it have {used}; simplify the models"
                    ),
                },
            )),
            false => Ok(()),
        }
    }

    /// Returns the memory limit with the part that is used, for messages.
    fn memory_text(&self) -> String {
        let limit = self.memory.unwrap_or_default();
        match self.used.memory {
            Bytes(0) => limit.to_string(),
            used => format!("{limit}, of which the files before it use {used}"),
        }
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
    /// [`Error::Limit`], with both figures, and with what is used already.
    pub fn check(&self, what: impl Into<String>, need: Bytes) -> Result<()> {
        match self.memory_left() {
            Some(left) if need > left => Err(Error::limit(
                what,
                format!(
                    "it needs about {need} of memory, but the limit is {}; raise it with --memory-limit, free memory, or \
                     request less{}",
                    self.memory_text(),
                    limits_note()
                ),
            )),
            _ => Ok(()),
        }
    }

    /// Rejects a file that cannot even be read within the limit.
    pub fn check_file(self, path: &Path) -> Result<()> {
        // Reading reports the error for a file without a size.
        let Ok(size) = file_size(path).map(Bytes) else { return Ok(()) };
        match self.memory_left() {
            Some(left) if size > left => Err(Error::limit(
                path.display().to_string(),
                format!(
                    "its size is {size}, but the limit is {}; raise the memory limit, free memory, or simplify the scan \
                     first{}",
                    self.memory_text(),
                    limits_note()
                ),
            )),
            _ => Ok(()),
        }
    }
}

/// Returns the memory available for new work, in bytes: the minimum of what the system has, what the limits on the
/// process's groups (cgroups) leave, and about half of what its own limit (`ulimit -v`, `ulimit -d`) leaves. File
/// caches count as available. `None` if unknown.
pub fn free_memory() -> Option<u64> {
    let mut system = sysinfo::System::new();
    system.refresh_memory();
    let of_system = Some(system.available_memory()).filter(|free| *free > 0);
    let of_groups = group_limit(ROOT).map(|group| group.left);
    let of_process = process_limit(ROOT).map(|process| process.for_work());
    [of_system, of_groups, of_process, module_memory()].into_iter().flatten().min()
}

/// Returns the memory that a WebAssembly module can still use of its 4 GiB, less an eighth for fragments.
#[cfg(target_family = "wasm")]
fn module_memory() -> Option<u64> {
    const PAGE: u64 = 1 << 16;
    Some((7_u64 << 29).saturating_sub(core::arch::wasm32::memory_size(0) as u64 * PAGE))
}

#[cfg(not(target_family = "wasm"))]
fn module_memory() -> Option<u64> {
    None
}

/// Returns the number of threads to start at most, if the process's own limit leaves too little for one on each
/// processor; `None` if all processors can be used.
pub fn most_threads() -> Option<usize> {
    let processors = processors();
    process_limit(ROOT).map(|process| process.threads(processors)).filter(|threads| *threads < processors)
}

/// Returns the limits that the system sets, in parentheses for the end of a message; an empty string without any.
pub fn limits_note() -> String {
    let process =
        process_limit(ROOT).map(|limit| format!(" (`{}` limits the process to {})", limit.name, limit.total));
    let group = || group_limit(ROOT).map(|group| format!(" (its cgroup is limited to {})", group.total));
    process.or_else(group).unwrap_or_default()
}

/// The root folder of the system's files.
const ROOT: &str = "/";

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// A limit that the system sets, and the bytes of it that are not used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct SystemLimit {
    /// The shell's command for it; empty if it has none.
    name: &'static str,
    total: Bytes,
    left: u64,
}

impl SystemLimit {
    /// The address space of a thread: its stack, and the arena that glibc reserves for its allocations.
    const THREAD: u64 = 66 << 20;
    /// The address space of what no estimate includes.
    const PROGRAM: u64 = 64 << 20;

    /// Returns the memory for work under a limit on the address space: half of what two pools of threads leave, since
    /// estimates are of the memory used, which is less than the address space reserved, and some work is estimated in
    /// two parts.
    fn for_work(&self) -> u64 {
        let threads = 2 * self.threads(processors()) as u64;
        self.left.saturating_sub(threads * Self::THREAD + Self::PROGRAM) / 2
    }

    /// Returns the number of threads of which a quarter of the limit has room, 1 to `processors`.
    fn threads(&self, processors: usize) -> usize {
        let fitting = usize::try_from(self.left / 4 / Self::THREAD).unwrap_or(usize::MAX);
        fitting.clamp(1, processors)
    }
}

/// Returns the limit on the address space or the data of this process that leaves less; `None` without one, and on
/// systems other than Linux.
fn process_limit(root: &str) -> Option<SystemLimit> {
    let [limits, status] = ["limits", "status"]
        .map(|name| std::fs::read_to_string(Path::new(root).join("proc/self").join(name)));
    let (limits, status) = (limits.ok()?, status.ok()?);
    let first_number = |text: &str, name: &str| -> Option<u64> {
        text.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
    };
    let limit = |name, limit, used| {
        let total = first_number(&limits, limit)?;
        let left = total.saturating_sub(first_number(&status, used)? << 10);
        Some(SystemLimit { name, total: Bytes(total), left })
    };
    let space = limit("ulimit -v", "Max address space", "VmSize:");
    let data = limit("ulimit -d", "Max data size", "VmData:");
    [space, data].into_iter().flatten().min_by_key(|limit| limit.left)
}

/// The files of a control group, and the entries of its statistics that count file caches.
struct GroupFiles {
    folder: &'static str,
    limit: &'static str,
    usage: &'static str,
    caches: [&'static str; 2],
}

/// Groups of version 2, and the memory controller of version 1.
const UNIFIED: GroupFiles = GroupFiles {
    folder: "sys/fs/cgroup",
    limit: "memory.max",
    usage: "memory.current",
    caches: ["inactive_file ", "active_file "],
};
const CONTROLLER: GroupFiles = GroupFiles {
    folder: "sys/fs/cgroup/memory",
    limit: "memory.limit_in_bytes",
    usage: "memory.usage_in_bytes",
    caches: ["total_inactive_file ", "total_active_file "],
};

/// Returns the limit of this process's groups and those above that leaves least; `None` without one.
fn group_limit(root: &str) -> Option<SystemLimit> {
    /// Version 1 has no word for "unlimited", but a number above any machine's memory.
    const UNLIMITED: u64 = 1 << 60;
    let groups = std::fs::read_to_string(Path::new(root).join("proc/self/cgroup")).ok()?;
    let limits = groups.lines().flat_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        let files = match controllers {
            "" => Some(UNIFIED),
            several => several.split(',').any(|name| name == "memory").then_some(CONTROLLER),
        };
        files.into_iter().flat_map(move |files| files.limits(root, path))
    });
    limits.filter(|limit| limit.total.0 < UNLIMITED).min_by_key(|limit| limit.left)
}

impl GroupFiles {
    /// Returns the limits of a group and of all above it. In a container, its own files may be at the top although its
    /// path is not.
    fn limits(&self, root: &str, path: &str) -> Vec<SystemLimit> {
        let top = Path::new(root).join(self.folder);
        let path = Path::new(path.trim_start_matches('/'));
        let leaves = path.components().any(|part| !matches!(part, std::path::Component::Normal(_)));
        let path = if leaves { Path::new("") } else { path };
        path.ancestors().filter_map(|group| self.limit(&top.join(group))).collect()
    }

    fn limit(&self, group: &Path) -> Option<SystemLimit> {
        let read = |name: &str| std::fs::read_to_string(group.join(name)).ok();
        let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
        let (total, usage) = (number(self.limit)?, number(self.usage)?);
        let statistics = read("memory.stat").unwrap_or_default();
        let entry = |name: &&str| {
            statistics.lines().find_map(|line| line.strip_prefix(*name)?.trim().parse::<u64>().ok())
        };
        let cache: u64 = self.caches.iter().filter_map(entry).sum();
        let left = total.saturating_sub(usage.saturating_sub(cache));
        Some(SystemLimit { name: "", total: Bytes(total), left })
    }
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

    /// Writes files under a new root folder of a system.
    fn system(files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = root.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        root
    }

    #[test]
    fn the_limit_of_the_process_counts() {
        let limits = |space: &str, data: &str| {
            let limits = format!(
                "Limit                     Soft Limit           Hard Limit           Units     \n\
                 Max data size             {data}            unlimited            bytes     \n\
                 Max address space         {space}           unlimited            bytes     \n"
            );
            let status = "Name:\ttaotie\nVmSize:\t  100000 kB\nVmData:\t   50000 kB\n";
            let root = system(&[("proc/self/limits", &limits), ("proc/self/status", status)]);
            process_limit(root.path().to_str().unwrap())
        };
        assert_eq!(limits("unlimited", "unlimited"), None);
        let (space, data) =
            (limits("2048000000", "unlimited").unwrap(), limits("2048000000", "90000000").unwrap());
        assert_eq!((space.name, space.left), ("ulimit -v", 2_048_000_000 - 102_400_000));
        assert_eq!((data.name, data.left), ("ulimit -d", 90_000_000 - 51_200_000));
        assert_eq!([space, data].map(|limit| limit.threads(64)), [7, 1]);
        assert!((300 << 20..space.left / 2).contains(&space.for_work()), "{}", space.for_work());
        assert_eq!(data.for_work(), 0);
        assert_eq!(process_limit(system(&[]).path().to_str().unwrap()), None);
    }

    #[test]
    fn the_limits_of_groups_count() {
        let left = |files: &[(&str, &str)]| {
            let root = system(files);
            group_limit(root.path().to_str().unwrap()).map(|limit| (limit.total.0, limit.left))
        };
        let slice = [
            ("proc/self/cgroup", "0::/user.slice/run.scope\n"),
            ("sys/fs/cgroup/user.slice/memory.max", "4000\n"),
            ("sys/fs/cgroup/user.slice/memory.current", "3000\n"),
            ("sys/fs/cgroup/user.slice/memory.stat", "anon 900\ninactive_file 1500\nactive_file 500\n"),
            ("sys/fs/cgroup/user.slice/run.scope/memory.max", "max\n"),
            ("sys/fs/cgroup/user.slice/run.scope/memory.current", "10\n"),
        ];
        assert_eq!(left(&slice), Some((4000, 3000)), "the group above has the limit");
        let old = [
            ("proc/self/cgroup", "5:cpu,cpuacct:/\n4:memory:/docker/1a\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "6000\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "1000\n"),
        ];
        assert_eq!(left(&old), Some((6000, 5000)), "a container sees its own files at the top");
        let unlimited = [
            ("proc/self/cgroup", "4:memory:/../x\n"),
            ("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n"),
            ("sys/fs/cgroup/memory/memory.usage_in_bytes", "1000\n"),
        ];
        assert_eq!((left(&unlimited), left(&[])), (None, None));
    }
}
