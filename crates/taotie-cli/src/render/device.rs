//! The machine that draws: the processor, or a graphics processor.

use super::RenderArgs;
use anyhow::{Result, bail};
use clap::ValueEnum;
use serde_json::json;
use taotie::film::Development;
use taotie::render::{Frame, Prepared, Renderer, Shot};
use taotie::{Progress, Warnings};
#[cfg(feature = "gpu")]
use taotie_gpu::{AdapterChoice, Gpu, GpuRenderer};

/// A kind of machine, as the command line names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Device {
    /// The processor: the same bits on every machine
    Cpu,
    /// A graphics processor, or a program that plays one: no shadows and no ground yet
    Gpu,
    /// A graphics processor where there is one and it draws all that is asked for, else the processor
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

    /// Returns the machine as JSON for reports.
    pub fn json(&self) -> serde_json::Value {
        match self {
            Self::Cpu => json!({ "name": "cpu" }),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => json!({ "name": "gpu", "adapter": gpu.description() }),
        }
    }
}

/// Says whether anything is asked for that graphics processors do not draw.
#[cfg(feature = "gpu")]
fn asks_for_the_processor(args: &RenderArgs) -> bool {
    let settings = args.settings();
    settings.shadows || settings.ground || settings.aovs || args.integrator.reference().is_some()
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

    /// What the machine could not draw as asked.
    pub fn warnings(&self) -> Warnings {
        match self {
            Self::Cpu(_) => Warnings::default(),
            #[cfg(feature = "gpu")]
            Self::Gpu(_, renderer) => renderer.warnings().clone(),
        }
    }
}
