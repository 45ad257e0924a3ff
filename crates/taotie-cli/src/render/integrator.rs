//! The choice of renderer: rasteriser or path tracer.

use crate::options;
use crate::studio::{FilmArgs, ReflectionArgs};
use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use serde_json::json;
use taotie_engine::names::Named;
use taotie_engine::render::{NormalMapping, ReferenceSettings};

/// The choice of renderer, and its options.
#[derive(Args)]
#[command(next_help_heading = "Integrator")]
pub struct IntegratorArgs {
    /// Renderer
    #[arg(long, value_enum, default_value_t = Integrator::Raster)]
    pub integrator: Integrator,
    /// Paths per pixel of `reference`; four times as many at least halve the noise [default: 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65536))]
    pub spp: Option<u32>,
    /// Reflections of light after the first one in `reference`; 0 is direct light only [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=i64::from(ReferenceSettings::MOST_BOUNCES)))]
    pub bounces: Option<u32>,
    /// Seed of the noise of `reference` [default: 0]
    #[arg(long, value_name = "N")]
    pub seed: Option<u32>,
    /// Meaning of a mapped normal in `reference`: classic, or microfacet, a groove of two facets that conserves
    /// energy and leaves no black pixels [default: classic]
    #[arg(long, value_name = "HOW", value_parser = options::named::<NormalMapping>)]
    pub normal_mapping: Option<NormalMapping>,
}

/// A renderer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Integrator {
    /// Rasteriser: fast, direct light and environment
    Raster,
    /// Path tracer: slow, the reference, with shadows and interreflections
    Reference,
}

impl IntegratorArgs {
    /// Rejects options that the chosen integrator does not use.
    pub fn check(&self, film: &FilmArgs, reflection: &ReflectionArgs) -> Result<()> {
        match self.integrator {
            Integrator::Raster => {
                let given = [
                    ("--spp", self.spp.is_some()),
                    ("--bounces", self.bounces.is_some()),
                    ("--seed", self.seed.is_some()),
                    ("--normal-mapping", self.normal_mapping.is_some()),
                ];
                if let Some((option, _)) = given.iter().find(|(_, given)| *given) {
                    bail!(
                        "{option}: the rasteriser traces no paths; add --integrator reference or leave it out"
                    );
                }
            }
            Integrator::Reference if film.samples.is_some() => {
                bail!("--samples: --integrator reference takes the number of paths per pixel from --spp N");
            }
            Integrator::Reference if reflection.specular_aa.is_some() => {
                bail!("--specular-aa: --integrator reference averages many paths instead; leave it out");
            }
            Integrator::Reference => {}
        }
        Ok(())
    }

    /// Returns the settings of the path tracer, or `None` for the rasteriser.
    pub fn reference(&self) -> Option<ReferenceSettings> {
        let default = ReferenceSettings::default();
        (self.integrator == Integrator::Reference).then(|| ReferenceSettings {
            spp: self.spp.unwrap_or(default.spp),
            bounces: self.bounces.unwrap_or(default.bounces),
            seed: self.seed.unwrap_or(default.seed),
            normal_mapping: self.normal_mapping.unwrap_or(default.normal_mapping),
            ..default
        })
    }

    /// Returns the choice as JSON for reports.
    pub fn json(&self) -> serde_json::Value {
        match self.reference() {
            None => json!({ "name": "raster" }),
            Some(reference) => json!({
                "name": "reference",
                "spp": reference.spp,
                "bounces": reference.bounces,
                "seed": reference.seed,
                "normal_mapping": reference.normal_mapping.name(),
            }),
        }
    }
}
