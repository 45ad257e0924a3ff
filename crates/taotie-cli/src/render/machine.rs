//! An available device, and renderers for it.

use super::args::{Device, RenderArgs};
use crate::console;
use anyhow::Result;
#[cfg(not(feature = "gpu"))]
use anyhow::bail;
use serde::Serialize;
use taotie_engine::Progress;
use taotie_engine::film::Development;
use taotie_engine::render::{Frame, Prepared, Renderer, Shot};
#[cfg(feature = "gpu")]
use taotie_gpu::{AdapterChoice, AdapterDescription, Gpu, GpuError, GpuRenderer};

/// An available device.
pub enum Machine {
    /// The CPU, with the reason if the user left the choice.
    Cpu(Option<String>),
    /// A GPU.
    #[cfg(feature = "gpu")]
    Gpu(Box<Gpu>),
}

impl Machine {
    /// Finds the requested device.
    #[cfg(feature = "gpu")]
    pub fn find(args: &RenderArgs) -> Result<Self> {
        let find = |choice| console::with_quiet_drivers(|| Gpu::find(&choice)).map(Box::new).map(Self::Gpu);
        match args.device {
            Device::Cpu => Ok(Self::Cpu(None)),
            Device::Gpu => Ok(find(AdapterChoice::default())?),
            Device::Auto if requires_cpu(args) => {
                Ok(Self::Cpu(Some("output variables and the reference integrator need it".into())))
            }
            Device::Auto => {
                let hardware = AdapterChoice { hardware_only: true, name: None };
                Ok(find(hardware).unwrap_or_else(|error| Self::Cpu(Some(why_cpu(&error)))))
            }
        }
    }

    /// Finds the requested device.
    #[cfg(not(feature = "gpu"))]
    pub fn find(args: &RenderArgs) -> Result<Self> {
        match args.device {
            Device::Cpu => Ok(Self::Cpu(None)),
            Device::Auto => Ok(Self::Cpu(Some("this build cannot load graphics drivers".into()))),
            Device::Gpu => bail!(
                "--device gpu: this build cannot load graphics drivers; use the Python wheel, which has the same \
                 command, or a build for glibc with the feature `gpu`, or leave out --device"
            ),
        }
    }

    /// Makes a renderer for this device from one with a prepared scene.
    pub fn drawer<'p>(&self, renderer: &'p mut Renderer) -> Result<Drawer<'p>> {
        match self {
            Self::Cpu(_) => Ok(Drawer::Cpu(renderer)),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let prepared = renderer.prepared();
                Ok(Drawer::Gpu(prepared, Box::new(GpuRenderer::new(gpu, prepared)?)))
            }
        }
    }

    /// Returns the device for reports.
    pub fn report_of(&self, args: &RenderArgs) -> DeviceReport<'_> {
        let requested = args.device.name();
        let by = |way: &'static str| args.settings().shadows.then_some(way);
        match self {
            Self::Cpu(reason) => {
                DeviceReport::Cpu { requested, reason: reason.as_deref(), shadows: by("rays") }
            }
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                DeviceReport::Gpu { requested, adapter: gpu.description(), shadows: by("shader-rays") }
            }
        }
    }

    /// Prints the device and the method for shadows, unless the user chose the CPU.
    #[cfg_attr(not(feature = "gpu"), allow(unused_variables, reason = "only GPUs have shadows to report"))]
    pub fn report(&self, args: &RenderArgs) {
        match self {
            Self::Cpu(None) => {}
            Self::Cpu(Some(reason)) => console::say(&format!("taotie: rendered on the CPU: {reason}")),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let description = gpu.description();
                let AdapterDescription { name, backend, .. } = description;
                let software = if description.is_software() { SLOW } else { "" };
                let shadows = if args.settings().shadows { "; shadows by rays in the shader" } else { "" };
                console::say(&format!("taotie: rendered on {name} via {backend}{software}{shadows}"));
            }
        }
    }
}

/// The device that rendered a picture, for reports.
#[derive(Serialize)]
#[serde(tag = "name", rename_all = "lowercase")]
pub enum DeviceReport<'a> {
    /// The CPU.
    Cpu {
        /// The requested device: `cpu`, `gpu` or `auto`.
        requested: Option<String>,
        /// Why it was chosen; `None` if it was requested.
        reason: Option<&'a str>,
        /// The method for shadows, `rays`; `None` without shadows.
        shadows: Option<&'static str>,
    },
    /// A GPU.
    #[cfg(feature = "gpu")]
    Gpu {
        /// The requested device: `cpu`, `gpu` or `auto`.
        requested: Option<String>,
        /// The card and its driver.
        adapter: &'a AdapterDescription,
        /// The method for shadows, `shader-rays`; `None` without shadows.
        shadows: Option<&'static str>,
    },
}

/// The note on a software GPU. Measured: Mesa's lavapipe takes 44 times as long as the CPU for four pictures with
/// shadows, on two cores.
#[cfg(feature = "gpu")]
const SLOW: &str = ", a software GPU: --device cpu is faster";

/// Returns why `--device auto` uses the CPU, from the failed search for a GPU.
#[cfg(feature = "gpu")]
fn why_cpu(error: &GpuError) -> String {
    match error {
        GpuError::NoAdapter { software, .. } if software.is_empty() => "no GPU was found".into(),
        GpuError::NoAdapter { software, .. } => {
            format!("faster than the only GPU, a software one ({})", software.join(", "))
        }
        _ => error.to_string(),
    }
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
