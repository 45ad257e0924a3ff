//! The images, samplers and textures that materials ask for.

use crate::image::Sampler;

/// An image to be written: a texture of the scene, its green channel turned where it points down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ImageUse {
    pub texture: usize,
    pub turned: bool,
}

/// The images that materials ask for, in the order of their asking.
#[derive(Debug, Clone, Default)]
pub(super) struct Textures {
    pub images: Vec<ImageUse>,
    pub samplers: Vec<Sampler>,
    /// The sampler and the image of each texture.
    pub textures: Vec<[usize; 2]>,
}
