//! Images: linear float images, stored texel arrays, mip chains and filtered lookup.

mod bitmap;
mod codec;
mod decode;
mod encoding;
mod filter;
mod linear;
mod lookup;
mod mips;
mod sampler;
mod texture;

pub use bitmap::{Bitmap, Texels};
pub use encoding::Encoding;
pub use linear::Image;
pub(crate) use lookup::{Lookup, LookupPoints};
pub use sampler::{MipFilter, Sampler, TexelFilter, Wrap};
pub use texture::Texture;
