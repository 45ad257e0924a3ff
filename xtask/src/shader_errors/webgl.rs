//! Evaluates points with GLSL ES in Chromium, which emulates a GPU with SwiftShader.

use super::cases::Case;
use super::harness::{VERTEX_GLSL, glsl};
use super::inputs::{Draw, Inputs, Picture, bytes, numbers, picture_of};
use anyhow::{Context, Result, bail};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Common names of the browser.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Node with its packages, and a browser.
pub struct WebGl {
    scripts: PathBuf,
    browser: PathBuf,
}

impl WebGl {
    /// Finds node, its packages and a browser, below the repository's `root`.
    ///
    /// # Errors
    /// If one of them is missing.
    pub fn find(root: &Path) -> Result<Self> {
        let scripts = root.join("tests/browser");
        let node = Command::new("node").arg("--version").output().is_ok_and(|output| output.status.success());
        if !node || !scripts.join("node_modules/playwright-core").is_dir() {
            bail!("no node, or no packages in {}; `make tools` installs them", scripts.display());
        }
        let named = std::env::var_os("BROWSER").map(PathBuf::from);
        let path = std::env::var_os("PATH").unwrap_or_default();
        let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
        let in_path = folders.iter().flat_map(|folder| NAMES.map(|name| folder.join(name)));
        let browser = named.into_iter().chain(in_path).find(|path| path.is_file());
        let browser = browser.context("no Chromium in PATH or BROWSER; `make tools` installs it")?;
        Ok(Self { scripts, browser })
    }

    /// Returns the name and version of the browser.
    ///
    /// # Errors
    /// If it does not start.
    pub fn name(&self) -> Result<String> {
        let output = Command::new(&self.browser).arg("--version").output()?;
        let version = String::from_utf8_lossy(&output.stdout);
        Ok(version.split_whitespace().take(2).collect::<Vec<_>>().join(" "))
    }

    /// Returns the radiance of all points of each surface, draw by draw.
    ///
    /// # Errors
    /// If a file cannot be written, or the browser rejects a shader.
    pub fn radiance(&self, cases: &[Case], inputs: &Inputs) -> Result<Drawn> {
        let folder = tempfile::tempdir()?;
        let written = Written { folder: folder.path(), inputs };
        let scene = written.scene(cases)?;
        std::fs::write(folder.path().join("points.json"), scene.to_string())?;
        let mut node = Command::new("node");
        node.arg("shader_points.mjs").current_dir(&self.scripts);
        let output = node.env("BROWSER", &self.browser).env("FOLDER", folder.path()).output()?;
        if !output.status.success() {
            let [out, err] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
            bail!("shader_points.mjs: {out}{err}");
        }
        Ok(Drawn { folder })
    }
}

/// The radiance drawn by the browser, with a file for each surface.
pub struct Drawn {
    folder: tempfile::TempDir,
}

impl Drawn {
    /// Returns the radiance of surface number `case`.
    ///
    /// # Errors
    /// If its file cannot be read.
    pub fn radiance(&self, case: usize) -> Result<Vec<[f32; 4]>> {
        let path = self.folder.path().join(format!("{case}.bin"));
        Ok(numbers(&std::fs::read(&path).with_context(|| path.display().to_string())?))
    }
}

/// The folder that the script reads, and its inputs.
struct Written<'i> {
    folder: &'i Path,
    inputs: &'i Inputs,
}

impl Written<'_> {
    fn scene(&self, cases: &[Case]) -> Result<Value> {
        let mut shared = Map::new();
        for name in ["albedo_tables", "environment_maps", "environment_picture"] {
            if let Some(Picture { size, texels }) = self.inputs.shared(name) {
                shared.insert(name.into(), self.picture(name.into(), *size, texels)?);
            }
        }
        let draws: Result<Vec<Value>> =
            self.inputs.draws.iter().enumerate().map(|(number, draw)| self.draw(number, draw)).collect();
        let shaders: Vec<Value> = cases.iter().map(|case| self.shader(case)).collect();
        let size = self.inputs.draws.first().map(Draw::size);
        Ok(
            json!({ "size": size, "shared": shared, "draws": draws?, "vertex": VERTEX_GLSL, "shaders": shaders }),
        )
    }

    fn picture(&self, name: String, size: [usize; 2], texels: &[[f32; 4]]) -> Result<Value> {
        let file = format!("{name}.floats");
        std::fs::write(self.folder.join(&file), bytes(texels.as_flattened()))?;
        Ok(json!({ "size": size, "file": file }))
    }

    fn draw(&self, number: usize, draw: &Draw) -> Result<Value> {
        let mut textures = Map::new();
        let size = draw.size();
        for (name, texels) in &draw.points.textures {
            textures.insert((*name).into(), self.picture(format!("{name}-{number}"), size, texels)?);
        }
        let inputs = &draw.points.inputs;
        let size = [size[0], inputs.len() / size[0]];
        textures.insert("point_inputs".into(), self.picture(format!("points-{number}"), size, inputs)?);
        let block = |name| json!(draw.buffer(name, self.inputs));
        let blocks = json!({
            "FrameBlock": block("frame"),
            "LightBlock": block("lights"),
            "EnvironmentBlock": block("environment_levels"),
        });
        Ok(json!({ "textures": textures, "blocks": blocks }))
    }

    fn shader(&self, case: &Case) -> Value {
        let shader = glsl(case);
        let materials = self.inputs.materials(case);
        let blocks =
            materials.iter().map(|material| shader.interface.material_bytes(&case.factors(material)));
        let pictures = shader.interface.textures.iter().map(|slot| (slot.name, picture_of(case, slot.name)));
        let pictures: Map<String, Value> =
            pictures.map(|(name, picture)| (name.to_owned(), json!(picture))).collect();
        json!({ "fragment": shader.text, "blocks": blocks.collect::<Vec<_>>(), "pictures": pictures })
    }
}
