//! The targets: every reader, and the paths behind them.

mod paths;
mod read;

pub use read::Subject;

use crate::corpus::Seed;
use clap::ValueEnum;
use read::Held;
use serde::{Deserialize, Serialize};

/// A reader, or a path that starts with one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// glTF and GLB: scene, animations, inspection.
    Gltf,
    /// OBJ.
    Obj,
    /// MTL, through an OBJ that references it.
    Mtl,
    /// PLY.
    Ply,
    /// STL.
    Stl,
    /// FBX, binary and ASCII.
    Fbx,
    /// PNG, JPEG, WebP, AVIF, OpenEXR, KTX2, Radiance HDR, TGA, TIFF and DDS.
    Picture,
    /// Environments from OpenEXR and Radiance HDR.
    Environment,
    /// Environments as stored in the cache.
    Cache,
    /// Materials in TOML.
    Material,
    /// XMP properties in JSON.
    Provenance,
    /// Options of a bake in JSON.
    Options,
    /// Light specifications, one per line.
    Light,
    /// Read, bake, write, read back, prove.
    Bake,
    /// Read and render.
    Render,
}

impl Target {
    /// Returns `true` if the target reads files such as `seed`.
    pub fn takes(self, seed: &Seed) -> bool {
        let extensions: &[&str] = match self {
            Self::Gltf => &["gltf", "glb"],
            Self::Obj => &["obj"],
            Self::Mtl => &["mtl"],
            Self::Ply => &["ply"],
            Self::Stl => &["stl"],
            Self::Fbx => &["fbx"],
            Self::Picture => {
                &["png", "jpg", "jpeg", "webp", "avif", "exr", "ktx2", "hdr", "tga", "tiff", "dds"]
            }
            Self::Environment => &["exr", "hdr"],
            Self::Cache => &["environment"],
            Self::Material => &["toml"],
            Self::Provenance => &["provenance"],
            Self::Options => &["options"],
            Self::Light => &["light"],
            Self::Bake | Self::Render => &["gltf", "glb", "obj", "ply", "stl", "fbx"],
        };
        extensions.contains(&seed.extension().as_str())
    }

    /// Returns `true` for a path behind the readers, whose runs take milliseconds each.
    pub fn is_path(self) -> bool {
        matches!(self, Self::Bake | Self::Render)
    }

    /// Returns its name, as used on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }

    /// Reads a damaged file and runs the later steps.
    ///
    /// # Errors
    /// The broken promise. Panics are left to the caller.
    pub fn run(self, subject: &Subject<'_>) -> Held {
        match self {
            Self::Gltf | Self::Obj | Self::Ply | Self::Stl | Self::Fbx => read::model(subject.path),
            Self::Mtl => read::materials(subject.path),
            Self::Picture => read::picture(subject.path),
            Self::Environment => read::environment(subject),
            Self::Cache => read::cached(subject.bytes),
            Self::Material => read::material(subject.path),
            Self::Provenance => read::provenance(subject.path),
            Self::Options => read::options(subject.bytes),
            Self::Light => read::lights(subject.bytes),
            Self::Bake => paths::bake(subject),
            Self::Render => paths::render(subject),
        }
    }
}
