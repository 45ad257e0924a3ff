//! The wrapping and filtering of textures.

use crate::image::{MipFilter, Sampler, TexelFilter, Wrap};
use gltf::json::texture::{MagFilter, MinFilter, WrappingMode};
use gltf::json::validation::Checked;

/// Reads a sampler of the file; missing values default to repeat and smooth.
pub(super) fn sampler_from(json: &gltf::json::texture::Sampler) -> Sampler {
    let wrap = |mode: &Checked<WrappingMode>| match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    let magnify = match json.mag_filter {
        Some(Checked::Valid(MagFilter::Nearest)) => TexelFilter::Nearest,
        _ => TexelFilter::Linear,
    };
    let (minify, mip) = match json.min_filter {
        Some(Checked::Valid(filter)) => minification(filter),
        _ => (TexelFilter::Linear, MipFilter::Linear),
    };
    Sampler { wrap_u: wrap(&json.wrap_s), wrap_v: wrap(&json.wrap_t), magnify, minify, mip }
}

fn minification(filter: MinFilter) -> (TexelFilter, MipFilter) {
    match filter {
        MinFilter::Nearest => (TexelFilter::Nearest, MipFilter::None),
        MinFilter::Linear => (TexelFilter::Linear, MipFilter::None),
        MinFilter::NearestMipmapNearest => (TexelFilter::Nearest, MipFilter::Nearest),
        MinFilter::LinearMipmapNearest => (TexelFilter::Linear, MipFilter::Nearest),
        MinFilter::NearestMipmapLinear => (TexelFilter::Nearest, MipFilter::Linear),
        MinFilter::LinearMipmapLinear => (TexelFilter::Linear, MipFilter::Linear),
    }
}
