//! The wrap and filter modes of textures.

use crate::gpu::Gpu;
use taotie_engine::image::{MipFilter, Sampler, TexelFilter, Wrap};
use wgpu::{AddressMode, FilterMode, MipmapFilterMode, SamplerDescriptor};

/// The samplers created so far.
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

/// The maximum level of detail that still reads only the finest level while distinguishing minification from
/// magnification.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_those_of_the_texture() {
        let sampler = Sampler {
            wrap_u: Wrap::Mirror,
            wrap_v: Wrap::Clamp,
            minify: TexelFilter::Nearest,
            mip: MipFilter::None,
            ..Sampler::default()
        };
        let made = descriptor(&sampler);
        assert_eq!(made.address_mode_u, AddressMode::MirrorRepeat);
        assert_eq!(made.address_mode_v, AddressMode::ClampToEdge);
        assert_eq!((made.mag_filter, made.min_filter), (FilterMode::Linear, FilterMode::Nearest));
        // Only the finest level is read, though minification and magnification are distinguished.
        assert!(made.lod_max_clamp > 0.0 && made.lod_max_clamp < 0.5);
        let levels = descriptor(&Sampler::default());
        assert_eq!((levels.mipmap_filter, levels.lod_max_clamp), (MipmapFilterMode::Linear, 32.0));
    }
}
