//! The images, samplers and textures requested by materials.

use crate::image::Sampler;

/// An image to be written: a texture of the scene, with its green channel flipped if it points down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ImageUse {
    pub texture: usize,
    pub turned: bool,
}

/// The images requested by materials, in the order of the requests.
#[derive(Debug, Clone, Default)]
pub(super) struct Textures {
    pub images: Vec<ImageUse>,
    pub samplers: Vec<Sampler>,
    /// The sampler and the image of each texture.
    pub textures: Vec<[usize; 2]>,
}
