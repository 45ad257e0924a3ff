//! An available device, and renderers for it.

use super::args::{Device, RenderArgs};
use crate::console;
use anyhow::Result;
#[cfg(not(feature = "gpu"))]
use anyhow::bail;
use serde_json::json;
use taotie_engine::Progress;
use taotie_engine::film::Development;
use taotie_engine::render::{Frame, Prepared, Renderer, Shot};
#[cfg(feature = "gpu")]
use taotie_gpu::{AdapterChoice, AdapterDescription, Gpu, GpuRenderer};

/// An available device.
pub enum Machine {
    /// The CPU.
    Cpu,
    /// A GPU.
    #[cfg(feature = "gpu")]
    Gpu(Box<Gpu>),
}

impl Machine {
    /// Finds the requested device.
    #[cfg(feature = "gpu")]
    pub fn find(args: &RenderArgs) -> Result<Self> {
        match args.device {
            Device::Cpu => Ok(Self::Cpu),
            Device::Gpu => Ok(Self::Gpu(Box::new(Gpu::find(&AdapterChoice::default())?))),
            Device::Auto if requires_cpu(args) => Ok(Self::Cpu),
            Device::Auto => {
                let hardware = AdapterChoice { hardware_only: true, name: None };
                Ok(Gpu::find(&hardware).map_or(Self::Cpu, |gpu| Self::Gpu(Box::new(gpu))))
            }
        }
    }

    /// Finds the requested device.
    #[cfg(not(feature = "gpu"))]
    pub fn find(args: &RenderArgs) -> Result<Self> {
        match args.device {
            Device::Cpu | Device::Auto => Ok(Self::Cpu),
            Device::Gpu => {
                bail!("--device gpu: this build lacks it; enable the feature `gpu` of the crate taotie-cli")
            }
        }
    }

    /// Makes a renderer for this device from one with a prepared scene.
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

    /// Returns the device as JSON for reports, with the method for shadows, if any.
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

    /// Prints the device and the method for shadows, unless the user chose the CPU.
    pub fn report(&self, args: &RenderArgs) {
        match self {
            Self::Cpu if args.device == Device::Cpu => {}
            Self::Cpu => console::say(&format!("taotie: rendered on the CPU: {}", why_cpu(args))),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let AdapterDescription { name, backend, .. } = gpu.description();
                let shadows = if args.settings().shadows { "; shadows by rays in the shader" } else { "" };
                console::say(&format!("taotie: rendered on {name} via {backend}{shadows}"));
            }
        }
    }
}

/// Returns why `--device auto` uses the CPU.
#[cfg(feature = "gpu")]
fn why_cpu(args: &RenderArgs) -> &'static str {
    match requires_cpu(args) {
        true => "output variables and the reference integrator need it",
        false => "no GPU was found",
    }
}

/// Returns why `--device auto` uses the CPU.
#[cfg(not(feature = "gpu"))]
fn why_cpu(_: &RenderArgs) -> &'static str {
    "this build lacks the feature `gpu`"
}

/// Returns true if an option requires the CPU.
#[cfg(feature = "gpu")]
fn requires_cpu(args: &RenderArgs) -> bool {
    args.settings().aovs || args.integrator.reference().is_some()
}

/// A renderer for a device, with a prepared scene.
pub enum Drawer<'p> {
    /// For the CPU.
    Cpu(&'p mut Renderer),
    /// For a GPU.
    #[cfg(feature = "gpu")]
    Gpu(&'p Prepared, Box<GpuRenderer<'p>>),
}

impl Drawer<'_> {
    /// Returns the prepared scene.
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
