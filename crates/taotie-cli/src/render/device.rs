//! The device to render on: the CPU or a GPU.

use super::integrator::IntegratorArgs;
use anyhow::{Result, bail};
use clap::ValueEnum;

/// A kind of device, by its name on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Device {
    /// CPU: the same bits on every machine
    Cpu,
    /// GPU, or a software implementation such as Mesa's lavapipe: nearly the same image, whose last digits depend on
    /// card and driver
    Gpu,
    /// GPU if there is one, otherwise CPU, which also renders for --aov and --integrator reference
    Auto,
}

impl Device {
    /// Rejects options that a GPU does not support.
    pub fn check(self, integrator: &IntegratorArgs, aovs: &[String]) -> Result<()> {
        if self != Self::Gpu {
            return Ok(());
        }
        if integrator.reference().is_some() {
            bail!("--device gpu: the reference integrator runs on the CPU; leave out --integrator reference");
        }
        if !aovs.is_empty() {
            bail!("--device gpu: output variables are computed on the CPU; leave out --aov");
        }
        Ok(())
    }
}
