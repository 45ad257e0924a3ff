//! Environment light: the built-in studio or a file, rotated, scaled, and cached after filtering.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Image;
use taotie_engine::render::EnvironmentLight;
use taotie_engine::scene::Light;
use taotie_engine::shade::environment::{ENVIRONMENT_VERSION, Environment, STUDIO_VERSION, studio};
use taotie_io::parse::MOST;
use taotie_io::{Limits, cache_file, cached_file, decode_environment_within, read_bytes, sha256_of};

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
    if let Some(environment) = cached_file(&key).and_then(|file| Environment::read(file).ok()) {
        return Ok(environment);
    }
    let environment = Environment::new(picture()?)?;
    cache_file(&key, &environment.to_bytes());
    Ok(environment)
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
