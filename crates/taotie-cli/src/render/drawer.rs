//! Renderers for a device.

use crate::device::Machine;
use anyhow::Result;
use taotie_engine::Progress;
use taotie_engine::film::Development;
use taotie_engine::render::{Frame, Prepared, Renderer, Shot};
#[cfg(feature = "gpu")]
use taotie_gpu::GpuRenderer;

/// A renderer for a device, with a prepared scene.
pub enum Drawer<'p> {
    /// For the CPU.
    Cpu(&'p mut Renderer),
    /// For a GPU.
    #[cfg(feature = "gpu")]
    Gpu(&'p Prepared, Box<GpuRenderer<'p>>),
}

impl<'p> Drawer<'p> {
    /// Makes a renderer for a device from one with a prepared scene.
    pub fn of(machine: &Machine, renderer: &'p mut Renderer) -> Result<Self> {
        match machine {
            Machine::Cpu(_) => Ok(Self::Cpu(renderer)),
            #[cfg(feature = "gpu")]
            Machine::Gpu(gpu) => {
                let prepared = renderer.prepared();
                Ok(Self::Gpu(prepared, Box::new(GpuRenderer::new(gpu, prepared)?)))
            }
        }
    }

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
