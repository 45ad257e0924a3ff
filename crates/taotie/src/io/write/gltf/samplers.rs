//! Samplers of textures as JSON.

use crate::image::{MipFilter, Sampler, TexelFilter, Wrap};
use serde_json::{Value, json};

/// Returns glTF's numbers for the filters and wrapping of a sampler.
pub(super) fn json(sampler: &Sampler) -> Value {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    };
    let texels = |filter| match filter {
        TexelFilter::Nearest => 0,
        TexelFilter::Linear => 1,
    };
    let min = match sampler.mip {
        MipFilter::None => 9728,
        MipFilter::Nearest => 9984,
        MipFilter::Linear => 9986,
    };
    json!({
        "magFilter": 9728 + texels(sampler.magnify), "minFilter": min + texels(sampler.minify),
        "wrapS": wrap(sampler.wrap_u), "wrapT": wrap(sampler.wrap_v),
    })
}
