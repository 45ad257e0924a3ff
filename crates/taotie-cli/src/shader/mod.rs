//! `taotie shader`: the pixel shaders of a model's materials, or of a plain one, and everything needed to bind them.

mod args;
mod description;
mod files;
mod page;
mod subject;

pub use args::ShaderArgs;

use crate::running::in_pool;
use crate::studio::ReflectionReport;
use crate::{console, stop};
use anyhow::{Context, Result};
use args::Target;
use description::Description;
use files::{NamedFile, Names};
use serde::Serialize;
use std::borrow::Cow;
use subject::{Drawn, Model, plain};
use taotie::Warning;
use taotie_engine::Warnings;
use taotie_io::FileSet;

/// Version of the JSON that `--json` prints.
const SCHEMA: u32 = 1;

/// The module that makes three.js materials.
const HOST: &str = include_str!("material.js");

/// Number of textures that every WebGL 2 implementation can bind to a fragment shader.
const MOST_TEXTURES: usize = 16;

/// Everything to write.
struct Bundle {
    shaders: Vec<Description>,
    files: Vec<NamedFile>,
    warnings: Warnings,
}

/// Runs the subcommand.
pub fn run(args: &ShaderArgs) -> Result<()> {
    args.check()?;
    let files = stop::files();
    files.protect(args.sources())?;
    files.claim_folder(&args.output)?;
    let bundle = in_pool(None, || Bundle::new(args, &files))??;
    for NamedFile { name, bytes } in &bundle.files {
        files.write_bytes(&args.output.join(name), bytes)?;
    }
    files.commit()?;
    console::say_warnings(&bundle.warnings);
    match args.json {
        true => console::result(&serde_json::to_string_pretty(&bundle.report(args))?),
        false => bundle.paths(args).try_for_each(|path| console::result(&path)),
    }
}

impl Bundle {
    fn new(args: &ShaderArgs, files: &FileSet) -> Result<Self> {
        let mut warnings = Warnings::default();
        let model =
            args.model.as_deref().map(|path| Model::load(args, path, files, &mut warnings)).transpose()?;
        let all = match (&model, &args.model) {
            (Some(model), Some(path)) => model.drawn(args, path)?,
            _ => vec![plain(args)],
        };
        let mut bundle = Self { shaders: Vec::new(), files: Vec::new(), warnings };
        let mut names = Names::default();
        for drawn in &all {
            bundle.add(args, model.as_ref(), drawn, &names.take(&drawn.name))?;
        }
        bundle.add_tables();
        bundle.add_environment(args)?;
        bundle.add_texts(args)?;
        Ok(bundle)
    }

    /// Adds a shader under its name.
    fn add(&mut self, args: &ShaderArgs, model: Option<&Model>, drawn: &Drawn, name: &str) -> Result<()> {
        let (shader, files) = Description::new(args, model, drawn, name)?;
        let many = args.target == Target::GlslEs && shader.interface.textures.len() > MOST_TEXTURES;
        self.warnings
            .note("shaders with more than the 16 textures that every WebGL 2 can bind", usize::from(many));
        self.files.extend(files);
        self.shaders.push(shader);
        Ok(())
    }

    fn add_tables(&mut self) {
        if self.shaders.iter().any(|shader| shader.tables.is_some()) {
            self.files.push(files::tables_file());
        }
    }

    /// Adds the environment if a shader reads it.
    fn add_environment(&mut self, args: &ShaderArgs) -> Result<()> {
        let is_read = self.shaders.iter().any(Description::reads_environment);
        let unread = args.environment().source.is_some() && !is_read;
        self.warnings.note("--env has no effect: no surface reflects it", usize::from(unread));
        if !is_read {
            return Ok(());
        }
        let limits = args.limits.limits();
        let light = args.environment().load_within(&limits, &mut self.warnings).context("--env")?;
        let Some(light) = light else { return Ok(()) };
        let (description, files) = files::environment(&light);
        for shader in self.shaders.iter_mut().filter(|shader| shader.reads_environment()) {
            shader.environment = Some(description.clone());
        }
        self.files.extend(files);
        Ok(())
    }

    /// Adds the descriptions of the shaders, and the three.js host.
    fn add_texts(&mut self, args: &ShaderArgs) -> Result<()> {
        for shader in &self.shaders {
            let text = serde_json::to_string_pretty(shader)? + "\n";
            self.files.push(NamedFile::new(format!("{}.json", shader.name), text));
        }
        if args.target == Target::GlslEs {
            self.files.push(NamedFile::new("material.js", HOST));
        }
        let names: Vec<&str> = self.files.iter().map(|file| file.name.as_str()).collect();
        let page = taotie_report::html(&page::page(args, &self.shaders, &names));
        self.files.push(NamedFile::new("index.html", page));
        Ok(())
    }

    /// Returns the paths of all files.
    fn paths(&self, args: &ShaderArgs) -> impl Iterator<Item = String> {
        self.files.iter().map(|file| args.output.join(&file.name).display().to_string())
    }

    /// Returns the report as `--json` prints it.
    fn report<'a>(&'a self, args: &'a ShaderArgs) -> Report<'a> {
        Report {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            model: args.model.as_ref().map(|path| path.to_string_lossy()),
            target: args.target.name(),
            reflection: args.reflection.report(),
            environment: args.env.as_deref(),
            files: self.paths(args).collect(),
            shaders: self.shaders.iter().map(Listed::new).collect(),
            warnings: self.warnings.list(),
        }
    }
}

/// The report on written shaders.
#[derive(Serialize)]
struct Report<'a> {
    schema: u32,
    /// Version of the program.
    version: &'static str,
    /// The path of the model, as given; `None` without one.
    model: Option<Cow<'a, str>>,
    /// The language.
    target: &'static str,
    /// The details of reflection.
    reflection: ReflectionReport,
    /// The environment, as given; `None` without one.
    environment: Option<&'a str>,
    /// The paths of the written files.
    files: Vec<String>,
    /// The shaders.
    shaders: Vec<Listed<'a>>,
    /// Problems and corrections.
    warnings: Vec<Warning>,
}

/// A written shader.
#[derive(Serialize)]
struct Listed<'a> {
    /// The name that its files begin with.
    name: &'a str,
    /// The reflectance model.
    shading: &'static str,
    /// The source of shading normals.
    surface: &'static str,
    /// The names of its files.
    files: &'a [String],
    /// The materials of the model that it draws; empty without a model.
    materials: Vec<Drawing<'a>>,
}

/// A material, and the instances on which a shader draws it.
#[derive(Serialize)]
struct Drawing<'a> {
    /// The name of the material; may be empty.
    name: &'a str,
    /// Its number, from 0.
    number: usize,
    /// The instances, from 0.
    instances: &'a [usize],
}

impl<'a> Listed<'a> {
    fn new(shader: &'a Description) -> Self {
        let drawn = shader.surfaces.iter().filter(|surface| !surface.instances.is_empty());
        let materials = drawn.map(|surface| Drawing {
            name: &surface.material,
            number: surface.number,
            instances: &surface.instances,
        });
        Self {
            name: &shader.name,
            shading: shader.shading,
            surface: shader.surface,
            files: &shader.files,
            materials: materials.collect(),
        }
    }
}
