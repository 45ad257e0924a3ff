//! The wrap and filter modes of textures.

use crate::gpu::Gpu;
use taotie::image::{MipFilter, Sampler, TexelFilter, Wrap};
use wgpu::{AddressMode, FilterMode, MipmapFilterMode, SamplerDescriptor};

/// Samplers that are there already.
#[derive(Default)]
pub(crate) struct Samplers {
    made: Vec<(Sampler, wgpu::Sampler)>,
}

impl Samplers {
    /// The sampler of these modes.
    pub(crate) fn get(&mut self, gpu: &Gpu, sampler: &Sampler) -> wgpu::Sampler {
        if let Some((_, made)) = self.made.iter().find(|(modes, _)| modes == sampler) {
            return made.clone();
        }
        let made = gpu.device.create_sampler(&descriptor(sampler));
        self.made.push((*sampler, made.clone()));
        made
    }
}

/// The most of the level of detail that still reads the finest level, and tells minified from magnified.
const FINEST_ALONE: f32 = 0.25;

fn descriptor(sampler: &Sampler) -> SamplerDescriptor<'static> {
    let (mipmap_filter, lod_max_clamp) = match sampler.mip {
        MipFilter::None => (MipmapFilterMode::Nearest, FINEST_ALONE),
        MipFilter::Nearest => (MipmapFilterMode::Nearest, 32.0),
        MipFilter::Linear => (MipmapFilterMode::Linear, 32.0),
    };
    SamplerDescriptor {
        address_mode_u: address(sampler.wrap_u),
        address_mode_v: address(sampler.wrap_v),
        mag_filter: filter(sampler.magnify),
        min_filter: filter(sampler.minify),
        mipmap_filter,
        lod_max_clamp,
        ..SamplerDescriptor::default()
    }
}

fn address(wrap: Wrap) -> AddressMode {
    match wrap {
        Wrap::Repeat => AddressMode::Repeat,
        Wrap::Mirror => AddressMode::MirrorRepeat,
        Wrap::Clamp => AddressMode::ClampToEdge,
    }
}

fn filter(filter: TexelFilter) -> FilterMode {
    match filter {
        TexelFilter::Nearest => FilterMode::Nearest,
        TexelFilter::Linear => FilterMode::Linear,
    }
}
