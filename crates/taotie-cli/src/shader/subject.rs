//! The surfaces that shaders are written for: those of a model, or a plain one.

use super::ShaderArgs;
use anyhow::{Context, Result, bail};
use std::path::Path;
use taotie::Warnings;
use taotie::image::Sampler;
use taotie::io::FileSet;
use taotie::names::Named;
use taotie::render::{GrazingNormals, Prepared, Surface};
use taotie::scene::{
    GreenChannel, HeightMap, Material, NormalMap, NormalSpace, Scene, TextureRef, UvTransform,
};
use taotie::shade::Energy;
use taotie::surface::SurfaceMethod;
use taotie_shader::{NormalMethod, Variant, VariantOptions};

/// A variant, and what is drawn by it.
pub struct Drawn {
    /// The name wanted for its files.
    pub name: String,
    /// The variant.
    pub variant: Variant,
    /// The numbers of the instances that it draws; none where there is no model.
    pub instances: Vec<usize>,
}

/// A model whose surfaces are ready.
pub struct Model {
    prepared: Prepared,
    /// Files or names of its textures.
    pub texture_names: Vec<String>,
}

impl Model {
    /// Reads a model and prepares it as `taotie render` does.
    pub fn load(args: &ShaderArgs, path: &Path, files: &FileSet, warnings: &mut Warnings) -> Result<Self> {
        let loaded = taotie::studio::load_within(path, &args.materials(), &args.limits.limits())?;
        files.protect(&loaded.files)?;
        warnings.absorb(loaded.warnings);
        let lifted = loaded.scene.materials().iter().any(|material| material.height.is_some());
        let unread = args.bump_scale.is_some() && !lifted;
        warnings.note("--bump-scale is not read: no material has a height map", usize::from(unread));
        let prepared = Prepared::new(loaded.scene, &args.settings().surface)
            .with_context(|| path.display().to_string())?;
        warnings.absorb(prepared.warnings().clone());
        Ok(Self { prepared, texture_names: loaded.texture_names })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        self.prepared.scene()
    }

    /// Its surfaces, one for each instance.
    pub fn surfaces(&self) -> Vec<Surface<'_>> {
        self.prepared.surfaces()
    }

    /// The variants of the materials asked for, in the order of the instances that they draw.
    pub fn drawn(&self, args: &ShaderArgs, path: &Path) -> Result<Vec<Drawn>> {
        let chosen = args.material.as_deref().map(|asked| self.choose(asked, path)).transpose()?;
        let (settings, environment) = (args.settings(), args.environment().source.is_some());
        let mut all: Vec<Drawn> = Vec::new();
        let instances = self.scene().instances();
        for (number, (instance, surface)) in instances.iter().zip(self.surfaces()).enumerate() {
            if chosen.is_some_and(|material| material != instance.material) {
                continue;
            }
            let options = VariantOptions::of_surface(&surface, &settings, environment);
            let variant = Variant::new(surface.material, &options);
            match all.iter_mut().find(|drawn| drawn.variant == variant) {
                Some(drawn) => drawn.instances.push(number),
                None => {
                    let name = match surface.material.name.as_str() {
                        "" => format!("material-{}", instance.material),
                        name => name.to_owned(),
                    };
                    all.push(Drawn { name, variant, instances: vec![number] });
                }
            }
        }
        match (&args.material, all.is_empty()) {
            (Some(asked), true) => {
                bail!("{}: no mesh has the material `{asked}`; choose another", path.display())
            }
            _ => Ok(all),
        }
    }

    /// The number of the material asked for, by name or number.
    fn choose(&self, asked: &str, path: &Path) -> Result<usize> {
        let materials = self.scene().materials();
        let named: Vec<usize> = (0..materials.len()).filter(|i| materials[*i].name == asked).collect();
        let number = asked.parse().ok().filter(|i| *i < materials.len());
        let list = || {
            let each =
                |(i, material): (usize, &Material)| format!("{i} {}", material.name).trim_end().to_owned();
            materials.iter().enumerate().map(each).collect::<Vec<_>>().join(", ")
        };
        match (named.as_slice(), number) {
            ([i], _) => Ok(*i),
            ([], Some(i)) => Ok(i),
            ([], None) => {
                bail!("{}: there is no material `{asked}`; choose from: {}", path.display(), list())
            }
            _ => bail!(
                "{}: several materials are named `{asked}`; give the number: {}",
                path.display(),
                list()
            ),
        }
    }
}

/// The variant of a plain material that has the map of the surface method.
pub fn plain(args: &ShaderArgs) -> Drawn {
    let (settings, surface) = (args.settings(), args.surface.unwrap_or(SurfaceMethod::Smooth));
    let options = VariantOptions {
        shading: settings.shading,
        method: method(surface),
        compensated: settings.energy == Energy::Compensated,
        softened: settings.grazing_normals == GrazingNormals::Soften,
        specular_aa: settings.specular_aa,
        environment: args.environment().source.is_some(),
        ..VariantOptions::default()
    };
    let name = format!("{}-{}", settings.shading.name(), surface.name());
    Drawn { name, variant: Variant::new(&mapped(surface), &options), instances: Vec::new() }
}

/// The material that lacks a name, with the map that a method reads.
fn mapped(surface: SurfaceMethod) -> Material {
    let texture =
        TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    let normal = |space| Some(NormalMap { texture, scale: 1.0, space, green: GreenChannel::Up });
    let plain = Material::default();
    match surface {
        SurfaceMethod::Facet | SurfaceMethod::Smooth => plain,
        SurfaceMethod::Bump | SurfaceMethod::BumpPrinted => {
            Material { height: Some(HeightMap { texture, scale: 1.0 }), ..plain }
        }
        SurfaceMethod::ObjectNormal => Material { normal: normal(NormalSpace::Object), ..plain },
        SurfaceMethod::TangentNormal => Material { normal: normal(NormalSpace::Tangent), ..plain },
    }
}

fn method(surface: SurfaceMethod) -> NormalMethod {
    match surface {
        SurfaceMethod::Facet => NormalMethod::Facet,
        SurfaceMethod::Smooth => NormalMethod::Smooth,
        SurfaceMethod::Bump => NormalMethod::Bump,
        SurfaceMethod::BumpPrinted => NormalMethod::BumpPrinted,
        SurfaceMethod::ObjectNormal => NormalMethod::ObjectMap,
        SurfaceMethod::TangentNormal => NormalMethod::TangentMap,
    }
}

/// The name on the command line.
pub fn surface_name(method: NormalMethod) -> &'static str {
    match method {
        NormalMethod::Facet => SurfaceMethod::Facet.name(),
        NormalMethod::Smooth => SurfaceMethod::Smooth.name(),
        NormalMethod::Bump => SurfaceMethod::Bump.name(),
        NormalMethod::BumpPrinted => SurfaceMethod::BumpPrinted.name(),
        NormalMethod::ObjectMap => SurfaceMethod::ObjectNormal.name(),
        NormalMethod::TangentMap => SurfaceMethod::TangentNormal.name(),
    }
}
