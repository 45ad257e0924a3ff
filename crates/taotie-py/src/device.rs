//! The device that renders or casts the rays of bakes.

use serde::Deserialize;
use std::sync::Arc;
use taotie::asset::Scan;
use taotie_engine::film::Development;
use taotie_engine::render::{Frame, Prepared, Shot};
use taotie_engine::{Error, Progress, Result};
use taotie_gpu::{AdapterChoice, Gpu, GpuRenderer};

/// The requested device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Device {
    /// The CPU, whose images are the same on every machine.
    #[default]
    Cpu,
    /// A GPU.
    Gpu,
    /// A GPU that is not a software implementation, otherwise the CPU.
    Auto,
}

/// A device that renders or casts rays.
pub enum Machine {
    /// The CPU.
    Cpu,
    /// A GPU.
    Gpu(Box<GpuMachine>),
}

/// A GPU that renders or casts rays.
pub struct GpuMachine {
    gpu: Gpu,
    /// `true` if the CPU renders what the GPU cannot.
    is_optional: bool,
}

impl Device {
    /// Opens the device.
    ///
    /// # Errors
    /// [`Error::Unsupported`] if a GPU is required and none can be used.
    pub fn open(self) -> Result<Machine> {
        let is_optional = self == Self::Auto;
        let found = match self {
            Self::Cpu => return Ok(Machine::Cpu),
            Self::Gpu | Self::Auto => Gpu::find(&AdapterChoice { hardware_only: is_optional, name: None }),
        };
        match found {
            Ok(gpu) => Ok(Machine::Gpu(Box::new(GpuMachine { gpu, is_optional }))),
            Err(_) if is_optional => Ok(Machine::Cpu),
            Err(error) => Err(error.into()),
        }
    }
}

impl Machine {
    /// Returns `cpu`, or the name of the GPU.
    pub fn name(&self) -> String {
        match self {
            Self::Cpu => "cpu".into(),
            Self::Gpu(machine) => machine.gpu.description().name.clone(),
        }
    }

    /// Returns a scan with this device casting the rays of its bakes.
    pub fn casting(&self, scan: Scan) -> Scan {
        match self {
            Self::Cpu => scan,
            Self::Gpu(machine) => scan.cast_by(Arc::new(machine.gpu.clone())),
        }
    }

    /// Returns the GPU if it renders an image; `is_special` if the image is by the path tracer or has output variables.
    pub fn gpu(&self, is_special: bool) -> Option<&GpuMachine> {
        match self {
            Self::Gpu(machine) if !(is_special && machine.is_optional) => Some(machine),
            Self::Cpu | Self::Gpu(_) => None,
        }
    }
}

impl GpuMachine {
    /// Renders an image in linear light.
    ///
    /// # Errors
    /// Those of [`GpuRenderer`].
    pub fn render(&self, prepared: &Prepared, shot: &Shot<'_>, progress: Progress<'_>) -> Result<Frame> {
        let render = || GpuRenderer::new(&self.gpu, prepared)?.render(shot, progress);
        render().map_err(Error::from)
    }

    /// Renders an image and develops it to 8-bit codes.
    ///
    /// # Errors
    /// Those of [`GpuRenderer`] and of the development.
    pub fn develop(
        &self,
        prepared: &Prepared,
        (shot, development): (&Shot<'_>, &Development),
        progress: Progress<'_>,
    ) -> Result<Vec<[u8; 4]>> {
        let mut codes = Vec::new();
        let mut render =
            || GpuRenderer::new(&self.gpu, prepared)?.develop(shot, development, &mut codes, progress);
        render().map_err(Error::from)?;
        Ok(codes)
    }
}
