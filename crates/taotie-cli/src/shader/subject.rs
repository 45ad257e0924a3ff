//! The surfaces that shaders are written for: those of a model, or a plain one.

use super::ShaderArgs;
use crate::options;
use anyhow::{Context, Result, anyhow, bail};
use std::path::Path;
use taotie_engine::Warnings;
use taotie_engine::image::Sampler;
use taotie_engine::names::Named;
use taotie_engine::render::{PRINTED_BUMP, Prepared, Surface};
use taotie_engine::scene::{
    GreenChannel, HeightMap, Material, NormalMap, NormalSpace, Scene, TextureRef, UvTransform,
};
use taotie_engine::surface::SurfaceMethod;
use taotie_io::FileSet;
use taotie_shader::{Variant, VariantOptions};

/// A variant, and the instances that it draws.
pub struct Drawn {
    /// The preferred name of its files.
    pub name: String,
    /// The variant.
    pub variant: Variant,
    /// The numbers of the instances that it draws; empty without a model.
    pub instances: Vec<usize>,
}

/// A model with prepared surfaces.
pub struct Model {
    prepared: Prepared,
    /// Files or names of its textures.
    pub texture_names: Vec<String>,
}

impl Model {
    /// Reads a model and prepares it as `taotie render` does.
    pub fn load(args: &ShaderArgs, path: &Path, files: &FileSet, warnings: &mut Warnings) -> Result<Self> {
        let loaded = taotie::studio::load(path, &args.materials(), &args.limits.limits())?;
        files.protect(&loaded.files)?;
        warnings.absorb(loaded.warnings);
        let lifted = loaded.scene.materials().iter().any(|material| material.height.is_some());
        let unread = args.surface.bump_scale.is_some() && !lifted;
        warnings.note("--bump-scale has no effect: no material has a height map", usize::from(unread));
        let prepared = Prepared::new(loaded.scene, &args.settings().surface)
            .with_context(|| path.display().to_string())?;
        warnings.absorb(prepared.warnings().clone());
        Ok(Self { prepared, texture_names: loaded.texture_names })
    }

    /// Returns the scene.
    pub fn scene(&self) -> &Scene {
        self.prepared.scene()
    }

    /// Returns its surfaces, one for each instance.
    pub fn surfaces(&self) -> Vec<Surface<'_>> {
        self.prepared.surfaces()
    }

    /// Returns the variants of the requested materials, in the order of the instances that they draw.
    pub fn drawn(&self, args: &ShaderArgs, path: &Path) -> Result<Vec<Drawn>> {
        let chosen = args.material.as_deref().map(|asked| self.choose(asked, path)).transpose()?;
        let instances = self.scene().instances().iter().enumerate();
        let asked_for: Vec<usize> = instances
            .filter(|(_, instance)| chosen.is_none_or(|material| material == instance.material))
            .map(|(number, _)| number)
            .collect();
        match (&args.material, asked_for.is_empty()) {
            (Some(asked), true) => {
                bail!("{}: no mesh uses the material `{asked}`; choose another", path.display())
            }
            _ => Ok(self.grouped(args, &asked_for)),
        }
    }

    /// Returns the variants of these instances.
    fn grouped(&self, args: &ShaderArgs, instances: &[usize]) -> Vec<Drawn> {
        let (settings, environment) = (args.settings(), args.environment().source.is_some());
        let surfaces = self.surfaces();
        let mut all: Vec<Drawn> = Vec::new();
        for number in instances {
            let surface = &surfaces[*number];
            let options = VariantOptions::of_surface(surface, &settings, environment);
            let variant = Variant::new(surface.material, &options);
            match all.iter_mut().find(|drawn| drawn.variant == variant) {
                Some(drawn) => drawn.instances.push(*number),
                None => all.push(Drawn { name: self.name(*number), variant, instances: vec![*number] }),
            }
        }
        all
    }

    /// Returns the name of an instance's material, or its number if it has none.
    fn name(&self, instance: usize) -> String {
        let number = self.scene().instances()[instance].material;
        match self.scene().materials()[number].name.as_str() {
            "" => format!("material-{number}"),
            name => name.to_owned(),
        }
    }

    /// Returns the number of the requested material, by name or number.
    fn choose(&self, asked: &str, path: &Path) -> Result<usize> {
        let names: Vec<&str> =
            self.scene().materials().iter().map(|material| material.name.as_str()).collect();
        let chosen = options::chosen(asked, ["material", "materials"], &names);
        chosen.map_err(|why| anyhow!("{}: {why}", path.display()))
    }
}

/// Returns the variant of a plain material with the map of the surface method.
pub fn plain(args: &ShaderArgs) -> Drawn {
    let (settings, surface) = (args.settings(), args.surface.method.unwrap_or(SurfaceMethod::Smooth));
    let environment = args.environment().source.is_some();
    let options = VariantOptions { method: surface, ..VariantOptions::of_settings(&settings, environment) };
    let name = format!("{}-{}", settings.shading.name(), surface.name());
    Drawn { name, variant: Variant::new(&plain_material(args), &options), instances: Vec::new() }
}

/// Returns the material without a model, with the map that the surface method reads.
pub fn plain_material(args: &ShaderArgs) -> Material {
    let texture =
        TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    let normal = |space| Some(NormalMap { texture, scale: 1.0, space, green: GreenChannel::Up });
    let height = |scale| Some(HeightMap { texture, scale });
    let plain = Material::default();
    match args.surface.method.unwrap_or(SurfaceMethod::Smooth) {
        SurfaceMethod::Facet | SurfaceMethod::Smooth => plain,
        SurfaceMethod::Bump => Material { height: height(1.0), ..plain },
        SurfaceMethod::BumpPrinted => Material { height: height(PRINTED_BUMP), ..plain },
        SurfaceMethod::ObjectNormal => Material { normal: normal(NormalSpace::Object), ..plain },
        SurfaceMethod::TangentNormal => Material { normal: normal(NormalSpace::Tangent), ..plain },
    }
}
