//! Environment light: the built-in studio or a file, rotated, scaled, and cached after filtering.

use directories::ProjectDirs;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Image;
use taotie_engine::render::EnvironmentLight;
use taotie_engine::scene::Light;
use taotie_engine::shade::environment::{ENVIRONMENT_VERSION, Environment, STUDIO_VERSION, studio};
use taotie_io::parse::MOST;
use taotie_io::{Limits, decode_environment_within, read_bytes, sha256_of, write_bytes};

/// The names of the built-in studio and of the absence of an environment.
const STUDIO: &str = "studio";
const NONE: &str = "none";

/// The source of the environment light.
///
/// ```no_run
/// use taotie::Warnings;
/// use taotie::studio::{EnvironmentOptions, EnvironmentSource};
///
/// let source = Some(EnvironmentSource::Studio);
/// let options = EnvironmentOptions { source, rotation: 0.5, ..EnvironmentOptions::default() };
/// let light = options.load(&mut Warnings::default())?;
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum EnvironmentSource {
    /// The built-in studio.
    Studio,
    /// An equirectangular image, `.hdr` or `.exr`.
    File(PathBuf),
}

impl EnvironmentSource {
    /// Returns the source of this name: `studio`, a file's path, or `None` for `none`.
    ///
    /// ```
    /// use taotie::studio::EnvironmentSource;
    ///
    /// assert_eq!(EnvironmentSource::named("studio"), Some(EnvironmentSource::Studio));
    /// assert_eq!(EnvironmentSource::named("none"), None);
    /// assert_eq!(EnvironmentSource::named("sky.hdr"), Some(EnvironmentSource::File("sky.hdr".into())));
    /// ```
    pub fn named(name: &str) -> Option<Self> {
        match name {
            NONE => None,
            STUDIO => Some(Self::Studio),
            file => Some(Self::File(file.into())),
        }
    }

    fn name(&self) -> String {
        match self {
            Self::Studio => STUDIO.into(),
            Self::File(path) => path.display().to_string(),
        }
    }

    fn environment(&self, limits: &Limits) -> Result<Environment> {
        match self {
            Self::Studio => cached(&format!("studio-{STUDIO_VERSION}"), || Ok(studio())),
            Self::File(path) => read(path, limits),
        }
    }
}

/// Requested environment light.
///
/// ```
/// use taotie::Warnings;
/// use taotie::studio::EnvironmentOptions;
///
/// let light = EnvironmentOptions::default().load(&mut Warnings::default())?;
/// assert!(light.is_none());
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct EnvironmentOptions {
    /// Its image; `None` for no environment light.
    pub source: Option<EnvironmentSource>,
    /// Rotation in radians about +y, counter-clockwise as seen from above.
    pub rotation: f64,
    /// Multiplies its radiance, at least 0.
    pub intensity: f64,
    /// `true` if it is visible behind the objects.
    pub visible: bool,
}

impl Default for EnvironmentOptions {
    fn default() -> Self {
        Self { source: None, rotation: 0.0, intensity: 1.0, visible: false }
    }
}

impl EnvironmentOptions {
    /// Reads the image and filters it, or takes it from the cache: in the folder named by the environment variable
    /// `TAOTIE_CACHE_DIR`, or in the user's cache folder. Invalid texels are replaced and counted.
    ///
    /// # Errors
    /// Those of the file, and [`Error::Invalid`] for an option out of range.
    pub fn load(&self, warnings: &mut Warnings) -> Result<Option<EnvironmentLight>> {
        self.load_within(&Limits::default(), warnings)
    }

    /// Like [`EnvironmentOptions::load`], within limits of memory and pixels.
    ///
    /// # Errors
    /// As [`EnvironmentOptions::load`]; [`Error::Limit`] if a limit is exceeded.
    pub fn load_within(&self, limits: &Limits, warnings: &mut Warnings) -> Result<Option<EnvironmentLight>> {
        self.check()?;
        let Some(source) = &self.source else { return Ok(None) };
        let environment = source.environment(limits)?;
        let replaced = environment.repaired_texels();
        let what = "replaced invalid texels (negative, infinite or NaN)";
        warnings.note(format!("{}: {what}", source.name()), replaced);
        Ok(Some(EnvironmentLight {
            environment: Arc::new(environment),
            rotation: self.rotation,
            intensity: self.intensity as f32,
            visible: self.visible,
        }))
    }

    fn check(&self) -> Result<()> {
        if !(0.0..=f64::from(Light::MOST)).contains(&self.intensity) {
            let what = format!("intensity {}", self.intensity);
            return Err(Error::invalid(what, "it must be between 0 and 1e12"));
        }
        if self.rotation.is_nan() || self.rotation.abs() > MOST {
            return Err(Error::invalid(
                format!("rotation {}", self.rotation),
                "it must be finite, in radians",
            ));
        }
        Ok(())
    }
}

fn read(path: &Path, limits: &Limits) -> Result<Environment> {
    let bytes = read_bytes(path)?;
    cached(&sha256_of(&bytes), || decode_environment_within(&bytes, path, limits))
}

/// Returns the filtered environment of this name from the cache; otherwise makes it from its image and caches it.
fn cached(name: &str, picture: impl FnOnce() -> Result<Image>) -> Result<Environment> {
    let key = format!("{name}-{ENVIRONMENT_VERSION}.env");
    if let Some(environment) = opened(&key).and_then(|file| Environment::read(file).ok()) {
        return Ok(environment);
    }
    let environment = Environment::new(picture()?)?;
    keep(&key, &environment.to_bytes());
    Ok(environment)
}

/// Maximum number of bytes in the cache; the least recently used files are removed first.
const MOST_BYTES: u64 = 512 << 20;

/// Opens the file `name` of the cache if it exists. Opening counts as use.
fn opened(name: &str) -> Option<File> {
    let path = cache_folder()?.join(name);
    let file = File::open(&path).ok()?;
    if let Ok(file) = File::options().append(true).open(&path) {
        let _ = file.set_modified(SystemTime::now());
    }
    Some(file)
}

/// Writes the file `name` to the cache, completely or not at all. A failure only costs time later.
fn keep(name: &str, bytes: &[u8]) {
    if let Some(folder) = cache_folder() {
        let _ = write_in(&folder, name, bytes);
        make_room(&folder, MOST_BYTES);
    }
}

/// Returns the folder of cached files, such as filtered environments: the one in the environment variable
/// `TAOTIE_CACHE_DIR` if set, otherwise one in the user's cache folder; `None` if the system has no such folder. It
/// may not exist, and can be removed at any time.
fn cache_folder() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os("TAOTIE_CACHE_DIR") {
        return Some(PathBuf::from(folder));
    }
    ProjectDirs::from("", "", "taotie").map(|dirs| dirs.cache_dir().to_owned())
}

fn write_in(folder: &Path, name: &str, bytes: &[u8]) -> Result<()> {
    fs::create_dir_all(folder).map_err(|e| Error::io(folder, e))?;
    write_bytes(&folder.join(name), bytes)
}

/// Removes the least recently used files until at most `most` bytes are left.
fn make_room(folder: &Path, most: u64) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let ours = entries.flatten().filter(|entry| entry.path().extension().is_some_and(|e| e == "env"));
    let known = ours.filter_map(|entry| {
        let metadata = entry.metadata().ok()?;
        Some((metadata.modified().ok()?, metadata.len(), entry.path()))
    });
    let mut files: Vec<(SystemTime, u64, PathBuf)> = known.collect();
    files.sort();
    let mut bytes: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, size, path) in files {
        if bytes <= most {
            return;
        }
        if fs::remove_file(path).is_ok() {
            bytes -= size;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn what_is_out_of_range_is_refused() {
        let refused = |options: EnvironmentOptions| options.load(&mut Warnings::default()).is_err();
        assert!(refused(EnvironmentOptions { intensity: -1.0, ..EnvironmentOptions::default() }));
        assert!(refused(EnvironmentOptions { intensity: 1e39, ..EnvironmentOptions::default() }));
        assert!(refused(EnvironmentOptions { intensity: f64::NAN, ..EnvironmentOptions::default() }));
        assert!(refused(EnvironmentOptions { rotation: f64::INFINITY, ..EnvironmentOptions::default() }));
        let source = Some(EnvironmentSource::File("nowhere.hdr".into()));
        assert!(refused(EnvironmentOptions { source, ..EnvironmentOptions::default() }));
    }

    #[test]
    fn what_was_used_longest_ago_makes_room() {
        let folder = tempfile::tempdir().unwrap();
        for (age, name) in [(30, "old.env"), (10, "young.env"), (20, "middle.env"), (99, "foreign.txt")] {
            write_in(folder.path(), name, &[0; 100]).unwrap();
            let file = File::options().append(true).open(folder.path().join(name)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(age)).unwrap();
        }
        make_room(folder.path(), 250);
        let left = |name: &str| folder.path().join(name).exists();
        assert_eq!(
            ["old.env", "young.env", "middle.env", "foreign.txt"].map(left),
            [false, true, true, true]
        );
    }
}
