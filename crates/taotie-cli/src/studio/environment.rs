//! The environment asked for.

use super::{LightArgs, cache};
use anyhow::{Context, Result, bail};
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::Arc;
use taotie::Warnings;
use taotie::io::{decode_environment, read_bytes};
use taotie::render::EnvironmentLight;
use taotie::shade::environment::{ENVIRONMENT_VERSION, Environment, STUDIO_VERSION, studio};

/// The name of the studio that is built in, and of no environment at all.
const STUDIO: &str = "studio";
const NONE: &str = "none";

impl LightArgs {
    /// What can be refused before any work is done.
    pub fn check(&self) -> Result<()> {
        let is_there = self.environment_name().is_some();
        if self.show_env && !is_there {
            bail!(
                "--show-env: there is no environment to be seen; name one by --env studio or --env FILE.hdr"
            );
        }
        if !(self.env_intensity >= 0.0 && self.env_intensity.is_finite()) {
            bail!("--env-intensity {}: it must be 0 or more", self.env_intensity);
        }
        if !self.env_rotate_deg.is_finite() {
            bail!("--env-rotate-deg {}: write an angle in degrees", self.env_rotate_deg);
        }
        Ok(())
    }

    /// The studio or a file; `None` where there is to be none.
    fn environment_name(&self) -> Option<&str> {
        self.env.as_deref().filter(|name| *name != NONE)
    }

    /// Reads the environment asked for and filters it, or takes it from the cache.
    ///
    /// # Errors
    /// Those of the file.
    pub fn environment(&self, warnings: &mut Warnings) -> Result<Option<EnvironmentLight>> {
        let Some(name) = self.environment_name() else { return Ok(None) };
        let environment = match name {
            STUDIO => built_in()?,
            file => read(Path::new(file))?,
        };
        let mended = environment.mended_texels();
        warnings.note(
            format!("{name}: texels that no light can have (negative, infinite, not a number): mended"),
            mended,
        );
        Ok(Some(EnvironmentLight {
            environment: Arc::new(environment),
            rotation: self.env_rotate_deg.to_radians(),
            intensity: self.env_intensity as f32,
            visible: self.show_env,
        }))
    }

    /// What was asked for, for reports; null where there is none.
    pub fn environment_json(&self) -> serde_json::Value {
        match self.environment_name() {
            None => serde_json::Value::Null,
            Some(name) => serde_json::json!({
                "name": name,
                "rotate_deg": self.env_rotate_deg,
                "intensity": self.env_intensity,
                "seen": self.show_env,
            }),
        }
    }
}

fn built_in() -> Result<Environment> {
    kept(&format!("studio-{STUDIO_VERSION}"), || Ok(studio()))
}

fn read(path: &Path) -> Result<Environment> {
    let bytes = read_bytes(path).context("--env")?;
    let hash: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    kept(&hash, || decode_environment(&bytes, path).context("--env"))
}

/// The filtered environment of this name from the cache; else made of its picture, and left there.
fn kept(name: &str, picture: impl FnOnce() -> Result<taotie::image::Image>) -> Result<Environment> {
    let key = format!("{name}-{ENVIRONMENT_VERSION}.env");
    if let Some(environment) = cache::open(&key).and_then(|file| Environment::read(file).ok()) {
        return Ok(environment);
    }
    let environment = Environment::new(picture()?)?;
    cache::write(&key, &environment.to_bytes());
    Ok(environment)
}
