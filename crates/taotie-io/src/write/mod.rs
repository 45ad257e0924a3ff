//! Writes models, images and sets of files.

mod animated_image;
#[cfg(feature = "exr")]
mod exr;
mod file_set;
mod gltf;
mod maps;
mod staging;
mod still_image;

pub use animated_image::{AnimatedImage, AnimationFormat, AnimationSpec};
#[cfg(feature = "exr")]
pub use exr::{ExrLayer, encode_exr, write_exr};
pub use file_set::{FileBytes, FileSet, Stopper, write_bytes, write_text};
pub use gltf::{
    CodecKind, CodecSet, EncodedModel, GltfAsset, GltfDraft, GltfFormat, GltfGraft, GltfImage, GltfMaterial,
    GltfPacker, GraftedMaterial, ImageCodec, LossyTexture, PackedGeometry, PackedImage, TextureCodecs,
    VertexBits, WrittenScene, encode_glb, encode_gltf, encode_graft, encode_jpeg_bitmap, encode_scene,
    encode_scene_as, encode_webp_bitmap, gltf_files, gltf_sampler, join_levels, sampler_constants,
    write_gltf, write_scene,
};
pub use maps::{MapFormat, encode_map, encode_tiff_floats};
pub use still_image::{
    ImageFormat, PngColor, PngImage, PngSamples, encode_png, encode_png_bitmap, write_image, write_png,
    write_png_bitmap,
};
