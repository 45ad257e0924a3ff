//! A shader and everything its host needs to know: the content of its .json, with the values of a model's surfaces.

use super::args::ShaderArgs;
use super::files::{BinaryTexture, EnvironmentDescription, NamedFile, tables_description};
use super::subject::{Drawn, Model, plain_material};
use anyhow::Result;
use serde::Serialize;
use std::collections::BTreeMap;
use taotie_engine::image::{Encoding, MipFilter, TexelFilter, Wrap};
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_engine::scene::{AlphaMode, Material, TextureRef, TextureRole};
use taotie_shader::{Interface, SurfaceFactors, UniformField, buffer_size};

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
            tables: reads("albedo_tables").then(tables_description),
            environment: None,
            surfaces: match model {
                Some(model) => values(model, &drawn.instances, &interface),
                None => vec![plain_values(&plain_material(args), &interface)],
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

/// Values shared by some surfaces.
#[derive(Serialize)]
pub struct SurfaceValues {
    /// The name of the material; may be empty.
    pub material: String,
    /// Its number, from 0.
    pub number: usize,
    /// The instances drawn with them, from 0; empty without a model.
    pub instances: Vec<usize>,
    /// `true` if back faces are drawn.
    pub double_sided: bool,
    /// `opaque`, `mask` or `blend`.
    pub alpha: &'static str,
    /// The numbers of each field of the uniform `material`.
    pub uniforms: BTreeMap<String, Vec<f32>>,
    /// The textures by the names of their slots.
    pub textures: BTreeMap<&'static str, TextureValue>,
}

/// A texture of the model and how it is read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TextureValue {
    /// Its file or name; may be empty.
    pub name: String,
    /// Its number in the model, from 0.
    pub number: usize,
    /// `srgb`, `linear` or `normal`.
    pub encoding: &'static str,
    /// `repeat`, `mirror` or `clamp` along u and v.
    pub wrap: [&'static str; 2],
    /// `nearest` or `linear`, for texels larger than pixels.
    pub magnify: &'static str,
    /// The same for smaller texels.
    pub minify: &'static str,
    /// `none`, `nearest` or `linear` between levels.
    pub levels: &'static str,
}

/// Returns the values of the instances that a shader draws; instances with the same values share them.
fn values(model: &Model, instances: &[usize], interface: &Interface) -> Vec<SurfaceValues> {
    let surfaces = model.surfaces();
    let mut all: Vec<SurfaceValues> = Vec::new();
    for instance in instances {
        let (scene, surface) = (model.scene(), &surfaces[*instance]);
        let number = scene.instances()[*instance].material;
        let own = of_material(&SurfaceFactors::of_surface(surface, scene), interface);
        match all.iter_mut().find(|known| known.number == number && known.uniforms == own.uniforms) {
            Some(known) => known.instances.push(*instance),
            None => {
                let textures = textures(model, surface.material, interface);
                all.push(SurfaceValues { number, instances: vec![*instance], textures, ..own });
            }
        }
    }
    all
}

/// Returns the values of a material without a model, whose object space is world space.
fn plain_values(material: &Material, interface: &Interface) -> SurfaceValues {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let bump = material.height.map_or(0.0, |map| map.scale);
    let normal_matrix = axes.map(Vec3::from_array);
    of_material(&SurfaceFactors { material, normal_matrix, bump, height_levels: 1 }, interface)
}

/// Returns the values of a surface, except its textures and its place.
fn of_material(factors: &SurfaceFactors<'_>, interface: &Interface) -> SurfaceValues {
    let material = factors.material;
    let bytes = interface.material_bytes(factors);
    let uniforms = interface.material.iter().map(|field| (field.name.clone(), numbers(field, &bytes)));
    SurfaceValues {
        material: material.name.clone(),
        number: 0,
        instances: Vec::new(),
        double_sided: material.double_sided,
        alpha: match material.alpha {
            _ if material.is_blended() => "blend",
            AlphaMode::Mask(_) => "mask",
            _ => "opaque",
        },
        uniforms: uniforms.collect(),
        textures: BTreeMap::new(),
    }
}

fn textures(
    model: &Model,
    material: &Material,
    interface: &Interface,
) -> BTreeMap<&'static str, TextureValue> {
    let used = interface.textures.iter().filter_map(|slot| {
        let texture = TextureRole::named(slot.name)?.of(material)?;
        Some((slot.name, texture_value(model, texture)))
    });
    used.collect()
}

/// Returns the numbers of a field in the bytes of its buffer.
fn numbers(field: &UniformField, bytes: &[u8]) -> Vec<f32> {
    let words = bytes[field.offset..].as_chunks::<4>().0;
    words.iter().take(field.kind.numbers()).map(|word| f32::from_le_bytes(*word)).collect()
}

fn texture_value(model: &Model, texture: &TextureRef) -> TextureValue {
    let sampler = texture.sampler;
    TextureValue {
        name: model.texture_names.get(texture.texture).cloned().unwrap_or_default(),
        number: texture.texture,
        encoding: match model.scene().textures()[texture.texture].encoding() {
            Encoding::Srgb => "srgb",
            Encoding::Linear => "linear",
            Encoding::Normal => "normal",
        },
        wrap: [sampler.wrap_u, sampler.wrap_v].map(|wrap| match wrap {
            Wrap::Repeat => "repeat",
            Wrap::Mirror => "mirror",
            Wrap::Clamp => "clamp",
        }),
        magnify: filter_name(sampler.magnify),
        minify: filter_name(sampler.minify),
        levels: match sampler.mip {
            MipFilter::None => "none",
            MipFilter::Nearest => "nearest",
            MipFilter::Linear => "linear",
        },
    }
}

fn filter_name(filter: TexelFilter) -> &'static str {
    match filter {
        TexelFilter::Nearest => "nearest",
        TexelFilter::Linear => "linear",
    }
}
