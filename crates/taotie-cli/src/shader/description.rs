//! A shader and everything its host needs to know: the content of its .json.

use super::ShaderArgs;
use super::file::NamedFile;
use super::subject::{Drawn, Model, plain_material};
use super::tables::{self, BinaryTexture, EnvironmentDescription};
use super::values::{SurfaceValues, plain, values};
use anyhow::Result;
use serde::Serialize;
use taotie_engine::names::Named;
use taotie_shader::{Interface, buffer_size};

/// Version of the JSON of a shader.
const SCHEMA: u32 = 1;

/// A shader and everything its host needs to know.
#[derive(Serialize)]
pub struct Description {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The name that its files begin with.
    pub name: String,
    /// The language.
    pub target: &'static str,
    /// The files of the shader itself.
    pub files: Vec<String>,
    /// The reflectance model.
    pub shading: &'static str,
    /// The source of shading normals.
    pub surface: &'static str,
    /// The inputs that the host binds.
    pub interface: Interface,
    /// The size of the uniform buffer `frame`, bytes.
    pub frame_bytes: usize,
    /// The size of the uniform buffer `material`, bytes.
    pub material_bytes: usize,
    /// The texture `albedo_tables`, if the shader reads it.
    pub tables: Option<BinaryTexture>,
    /// The environment, if the shader reads one.
    pub environment: Option<EnvironmentDescription>,
    /// The values of a model's surfaces that are drawn by the shader, or of the plain material.
    pub surfaces: Vec<SurfaceValues>,
}

impl Description {
    /// Writes the shader of a variant under a name; returns its description and its files.
    pub fn new(
        args: &ShaderArgs,
        model: Option<&Model>,
        drawn: &Drawn,
        name: &str,
    ) -> Result<(Self, Vec<NamedFile>)> {
        let written = args.target.write(&drawn.variant, name)?;
        let (interface, files) = (written.shader.interface, written.files);
        let reads = |texture: &str| interface.textures.iter().any(|slot| slot.name == texture);
        let description = Self {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            name: name.into(),
            target: args.target.name(),
            files: files.iter().map(|file| file.name.clone()).collect(),
            shading: drawn.variant.shading().name(),
            surface: drawn.variant.method().name(),
            frame_bytes: buffer_size(&interface.frame),
            material_bytes: buffer_size(&interface.material),
            tables: reads("albedo_tables").then(tables::description),
            environment: None,
            surfaces: match model {
                Some(model) => values(model, &drawn.instances, &interface),
                None => vec![plain(&plain_material(args), &interface)],
            },
            interface,
        };
        Ok((description, files))
    }

    /// Returns true if the shader reads the light of an environment.
    pub fn reads_environment(&self) -> bool {
        self.interface.textures.iter().any(|slot| slot.name == "environment_maps")
    }
}
