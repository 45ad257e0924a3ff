//! Texture samplers: the one for written meshes, and its JSON.

use crate::image::{MipFilter, Sampler, TexelFilter, Wrap};
use crate::math::Vec2;
use crate::mesh::Mesh;
use serde_json::{Value, json};

/// Returns the sampler of all textures of a [`GltfAsset`](super::GltfAsset) with these meshes: trilinear, and
/// clamped, or repeated if uvs of the first set leave [0, 1].
pub fn gltf_sampler<'a>(meshes: impl IntoIterator<Item = &'a Mesh>) -> Sampler {
    let is_inside = |uv: &Vec2| (0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y);
    let mut sets = meshes.into_iter().filter_map(|mesh| mesh.uvs().first());
    let wrap = if sets.all(|uvs| uvs.iter().all(is_inside)) { Wrap::Clamp } else { Wrap::Repeat };
    Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() }
}

/// Returns glTF's constants for the filters and wrapping of a sampler.
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
