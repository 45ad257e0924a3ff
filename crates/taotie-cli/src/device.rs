//! The choice of the device that renders or casts the rays of bakes.

use crate::console;
use anyhow::Result;
#[cfg(not(feature = "gpu"))]
use anyhow::bail;
use clap::ValueEnum;
use serde::Serialize;
#[cfg(feature = "gpu")]
use std::sync::Arc;
use taotie::asset::Scan;
#[cfg(feature = "gpu")]
use taotie_gpu::{AdapterChoice, AdapterDescription, Gpu, GpuError};

/// A kind of device, by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Device {
    /// CPU: the same bits on every machine
    Cpu,
    /// GPU, or a software implementation such as Mesa's lavapipe: nearly the same result, whose last digits depend on
    /// card and driver
    Gpu,
    /// GPU if there is one, otherwise CPU. Software GPUs do not count, since the CPU is faster
    Auto,
}

impl Device {
    /// Returns its name on the command line.
    pub fn name(self) -> Option<String> {
        self.to_possible_value().map(|value| value.get_name().to_owned())
    }
}

/// An available device.
pub enum Machine {
    /// The CPU, with the reason if the user left the choice.
    Cpu(Option<String>),
    /// A GPU.
    #[cfg(feature = "gpu")]
    Gpu(Box<Gpu>),
}

impl Machine {
    /// Finds the requested device; the CPU for `needs_cpu`, the reason, if the user left the choice.
    #[cfg(feature = "gpu")]
    pub fn find(device: Device, needs_cpu: Option<&str>) -> Result<Self> {
        let loudly = |choice: &AdapterChoice| Gpu::find(choice).map(Box::new).map(Self::Gpu);
        let find = |choice: &AdapterChoice| console::with_quiet_drivers(|| loudly(choice));
        match device {
            Device::Cpu => Ok(Self::Cpu(None)),
            Device::Gpu => {
                let any = AdapterChoice::default();
                // Messages of the drivers may explain the failure.
                let retry = |error| if console::is_quiet() { Err(error) } else { loudly(&any) };
                Ok(find(&any).or_else(retry)?)
            }
            Device::Auto => match needs_cpu {
                Some(reason) => Ok(Self::Cpu(Some(reason.to_owned()))),
                None => {
                    let hardware = AdapterChoice { hardware_only: true, name: None };
                    Ok(find(&hardware).unwrap_or_else(|error| Self::Cpu(Some(why_cpu(&error)))))
                }
            },
        }
    }

    /// Finds the requested device; the CPU for `needs_cpu`, the reason, if the user left the choice.
    #[cfg(not(feature = "gpu"))]
    pub fn find(device: Device, _: Option<&str>) -> Result<Self> {
        match device {
            Device::Cpu => Ok(Self::Cpu(None)),
            Device::Auto => Ok(Self::Cpu(Some("this build cannot load graphics drivers".into()))),
            Device::Gpu => bail!(
                "--device gpu: this build cannot load graphics drivers; use the Python wheel, which has the same \
                 command, or a build for glibc with the feature `gpu`, or leave out --device"
            ),
        }
    }

    /// Returns true if it is a GPU.
    pub fn is_gpu(&self) -> bool {
        !matches!(self, Self::Cpu(_))
    }

    /// Returns a scan with this device casting the rays of its bakes.
    pub fn casting(&self, scan: Scan) -> Scan {
        match self {
            Self::Cpu(_) => scan,
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => scan.cast_by(Arc::new(Gpu::clone(gpu))),
        }
    }

    /// Returns the device for reports.
    pub fn report_of(&self, device: Device, shadows: bool) -> DeviceReport<'_> {
        let requested = device.name();
        let by = |way: &'static str| shadows.then_some(way);
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

    /// Prints the device, unless the user chose the CPU. `done` is what it did, `how` a remark on how a GPU did it.
    #[cfg_attr(not(feature = "gpu"), allow(unused_variables, reason = "only GPUs have remarks"))]
    pub fn report(&self, done: &str, how: &str) {
        match self {
            Self::Cpu(None) => {}
            Self::Cpu(Some(reason)) => console::say(&format!("taotie: {done} on the CPU: {reason}")),
            #[cfg(feature = "gpu")]
            Self::Gpu(gpu) => {
                let description = gpu.description();
                let AdapterDescription { name, backend, .. } = description;
                let software = if description.is_software() { SLOW } else { "" };
                console::say(&format!("taotie: {done} on {name} via {backend}{software}{how}"));
            }
        }
    }
}

/// The device that rendered a picture or cast the rays of a bake, for reports.
#[derive(Serialize)]
#[serde(tag = "name", rename_all = "lowercase")]
pub enum DeviceReport<'a> {
    /// The CPU.
    Cpu {
        /// The requested device: `cpu`, `gpu` or `auto`.
        requested: Option<String>,
        /// Why it was chosen; `None` if it was requested.
        reason: Option<&'a str>,
        /// The method for shadows, `rays`; `None` without shadows, and for bakes.
        shadows: Option<&'static str>,
    },
    /// A GPU.
    #[cfg(feature = "gpu")]
    Gpu {
        /// The requested device: `cpu`, `gpu` or `auto`.
        requested: Option<String>,
        /// The card and its driver.
        adapter: &'a AdapterDescription,
        /// The method for shadows, `shader-rays`; `None` without shadows, and for bakes.
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
