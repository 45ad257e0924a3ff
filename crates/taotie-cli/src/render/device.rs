//! The machine that draws: the processor, or a graphics processor.

use super::RenderArgs;
use crate::console;
use anyhow::{Result, bail};
use clap::ValueEnum;
use serde_json::json;
use taotie::Progress;
use taotie::film::Development;
use taotie::render::{Frame, Prepared, Renderer, Shot};
#[cfg(feature = "gpu")]
use taotie_gpu::{AdapterChoice, AdapterDescription, Gpu, GpuRenderer};

/// A kind of machine, as the command line names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Device {
    /// The processor: the same bits on every machine
    Cpu,
    /// A graphics processor, or a program that plays one, such as Mesa's lavapipe: nearly the same image, whose last digits
    /// depend on card and driver
    Gpu,
    /// A graphics processor if there is one, else the processor, which also draws for --aov and --integrator reference
    Auto,
}

impl Device {
    /// Refuses what a graphics processor does not draw at all.
    pub fn check(self, args: &RenderArgs) -> Result<()> {
        if self != Self::Gpu {
            return Ok(());
        }
        if args.integrator.reference().is_some() {
            bail!(
                "--device gpu: paths of light are followed by the processor; leave out --integrator reference"
            );
        }
        if !args.aovs.is_empty() {
            bail!("--device gpu: output variables are written by the processor; leave out --aov");
        }
        Ok(())
    }
}

/// A machine that is there.
pub enum Machine {
    /// The processor.
    Cpu,
    /// A graphics processor.
    #[cfg(feature = "gpu")]
    Gpu(Box<Gpu>),
}

impl Machine {
    /// Finds the machine that is asked for.
    #[cfg(feature = "gpu")]
    pub fn find(args: &RenderArgs) -> Result<Self> {
        match args.device {
            Device::Cpu => Ok(Self::Cpu),
            Device::Gpu => Ok(Self::Gpu(Box::new(Gpu::find(&AdapterChoice::default())?))),
            Device::Auto if asks_for_the_processor(args) => Ok(Self::Cpu),
            Device::Auto => {
                let hardware = AdapterChoice { hardware_only: true, name: None };
                Ok(Gpu::find(&hardware).map_or(Self::Cpu, |gpu| Self::Gpu(Box::new(gpu))))
            }
        }
    }

    /// Finds the machine that is asked for.
    #[cfg(not(feature = "gpu"))]
    pub fn find(args: &RenderArgs) -> Result<Self> {
        match args.device {
            Device::Cpu | Device::Auto => Ok(Self::Cpu),
            Device::Gpu => {
                bail!("--device gpu: this build lacks it; turn on the feature `gpu` of the crate taotie-cli")
            }
        }
    }

    /// Makes a renderer of this machine of one that has prepared a scene.
    pub fn drawer<'p>(&self, renderer: &'p mut Renderer) -> Result<Drawer<'p>> {
        match self {
            Self::Cpu => Ok(Drawer::Cpu(renderer)),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let prepared = renderer.prepared();
                Ok(Drawer::Gpu(prepared, Box::new(GpuRenderer::new(gpu, prepared)?)))
            }
        }
    }

    /// Returns the machine as JSON for reports, with the way in which shadows were found, if any were.
    pub fn json(&self, shadows: bool) -> serde_json::Value {
        let by = |way: &'static str| shadows.then_some(way);
        match self {
            Self::Cpu => json!({ "name": "cpu", "shadows": by("rays") }),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                json!({ "name": "gpu", "adapter": gpu.description(), "shadows": by("shader-rays") })
            }
        }
    }

    /// Says which machine draws and how shadows are found, where the user did not name the processor.
    pub fn tell(&self, args: &RenderArgs) {
        match self {
            Self::Cpu if args.device == Device::Cpu => {}
            Self::Cpu => {
                console::say(&format!("taotie: drawn by the processor: {}", why_the_processor(args)))
            }
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let AdapterDescription { name, backend, .. } = gpu.description();
                let shadows = if args.settings().shadows { "; shadows by rays in the shader" } else { "" };
                console::say(&format!("taotie: drawn by {name} through {backend}{shadows}"));
            }
        }
    }
}

/// The reason why `--device auto` takes the processor.
#[cfg(feature = "gpu")]
fn why_the_processor(args: &RenderArgs) -> &'static str {
    match asks_for_the_processor(args) {
        true => "output variables and the reference integrator are its work",
        false => "no graphics processor was found",
    }
}

/// The reason why `--device auto` takes the processor.
#[cfg(not(feature = "gpu"))]
fn why_the_processor(_: &RenderArgs) -> &'static str {
    "this build lacks the feature `gpu`"
}

/// Says whether anything is asked for that graphics processors do not draw.
#[cfg(feature = "gpu")]
fn asks_for_the_processor(args: &RenderArgs) -> bool {
    args.settings().aovs || args.integrator.reference().is_some()
}

/// A renderer of some machine, with a prepared scene.
pub enum Drawer<'p> {
    /// The processor's.
    Cpu(&'p mut Renderer),
    /// A graphics processor's.
    #[cfg(feature = "gpu")]
    Gpu(&'p Prepared, Box<GpuRenderer<'p>>),
}

impl Drawer<'_> {
    /// The scene, prepared.
    pub fn prepared(&self) -> &Prepared {
        match self {
            Self::Cpu(renderer) => renderer.prepared(),
            #[cfg(feature = "gpu")]
            Self::Gpu(prepared, _) => prepared,
        }
    }

    /// Renders an image in linear light.
    pub fn render(&mut self, shot: &Shot<'_>, progress: Progress<'_>) -> Result<Frame> {
        match self {
            Self::Cpu(renderer) => Ok(renderer.render(shot, progress)?),
            #[cfg(feature = "gpu")]
            Self::Gpu(_, renderer) => Ok(renderer.render(shot, progress)?),
        }
    }

    /// Renders an image and develops it to 8 bits a channel.
    pub fn develop(
        &mut self,
        shot: &Shot<'_>,
        development: &Development,
        progress: Progress<'_>,
    ) -> Result<Vec<[u8; 4]>> {
        let mut codes = Vec::new();
        match self {
            Self::Cpu(renderer) => renderer.develop(shot, development, &mut codes, progress)?,
            #[cfg(feature = "gpu")]
            Self::Gpu(_, renderer) => renderer.develop(shot, development, &mut codes, progress)?,
        }
        Ok(codes)
    }
}
