//! Reading and writing meshes, glTF and images: valid files, odd files, broken files.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "tests report their findings")]

#[path = "../../../../tests/common/bumpy.rs"]
mod bumpy;
#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../../../../tests/common/damage.rs"]
mod damage;
#[path = "../../../../tests/common/files.rs"]
mod files;
#[path = "../../../../tests/common/glb.rs"]
mod glb;
#[path = "../../../../tests/common/gltf.rs"]
mod gltf;
#[path = "../../../../tests/common/rich.rs"]
mod rich;
#[path = "../../../../tests/common/validator.rs"]
mod validator;

mod animation;
#[cfg(feature = "fbx")]
mod fbx;
mod geometry;
mod gltf_alpha_modes;
mod gltf_levels;
mod gltf_materials;
mod gltf_packed;
mod gltf_packed_write;
mod gltf_packer;
mod gltf_pictures;
mod gltf_read;
mod gltf_scene;
#[cfg(all(feature = "avif", feature = "basis", feature = "webp"))]
mod gltf_sizes;
#[cfg(all(feature = "avif", feature = "basis", feature = "webp"))]
mod gltf_textures;
#[cfg(feature = "webp")]
mod gltf_validator;
mod gltf_visibility;
mod gltf_write;
mod gltf_write_material;
mod limits;
mod mutations;
mod scans;
