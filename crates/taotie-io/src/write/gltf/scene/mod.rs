//! Writes a whole scene as glTF 2.0: meshes with their placement, materials, textures, lights and cameras. Each
//! instance of a mesh, light (KHR_lights_punctual) and camera is on a separate node.

mod materials;

use super::codec::CodecKind;
use super::draft::{Container, GltfDraft};
use super::edit::short;
use super::format::GltfFormat;
use super::mesh::{self, Grid, MeshPart, PackedMesh};
use crate::write::{FileBytes, FileSet};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Sampler;
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::progress::Progress;
use taotie_engine::scene::{Camera, Falloff, Instance, Light, LightKind, Projection, Scene};

const LIGHTS: &str = "KHR_lights_punctual";

/// Maximum deviation of two axes of a transform from a right angle, as a cosine, for it to count as orthogonal.
const SQUARE: f64 = 1e-4;

/// The files of a written scene, and notes on the content they lack.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct WrittenScene {
    /// The files; [`write_scene`]'s `path` is first.
    pub files: Vec<PathBuf>,
    /// Notes on content that glTF cannot express and that was dropped or changed.
    pub warnings: Warnings,
}

/// Writes a scene, so that [`load_model`](crate::load_model) reads the same one: a GLB if `path` ends in `.glb`;
/// for `.gltf` the JSON, with the data in `NAME.bin` and the textures in files such as `NAME_0.png` next to it.
/// Either all files are written or none, the JSON last. The same scene gives the same bytes.
///
/// Numbers are stored as 32-bit floats: transforms are rounded to them, and light, emission and rotated uvs may
/// differ by one rounding when read. A mesh shown with several materials is read as several meshes. Content that glTF
/// cannot express is dropped with a warning: reflectances (f0, f82), the classic models' parameters, height maps,
/// object-space normal maps, sheared uvs, meshes that are not shown; changed with a warning: lights without distance
/// falloff, float textures.
///
/// ```no_run
/// use std::path::Path;
/// use taotie_io::GltfFormat;
/// let loaded = taotie_io::load_model(Path::new("jug.obj"))?;
/// let written = taotie_io::write_scene(Path::new("jug.glb"), &loaded.scene, &GltfFormat::default())?;
/// for (what, count) in written.warnings.iter() {
///     println!("{what}: {count}");
/// }
/// # Ok::<(), taotie_engine::Error>(())
/// ```
///
/// # Errors
/// [`Error::Unsupported`] for another extension, [`Error::Invalid`] for a scene without triangles and for numbers
/// that do not fit 32-bit floats, [`Error::Limit`] for a GLB of 4 GiB or more, [`Error::Io`] if a file cannot be
/// written.
pub fn write_scene(path: &Path, scene: &Scene, format: &GltfFormat) -> Result<WrittenScene> {
    let container = Container::of(path)?;
    let Begun { mut writer, materials, images } = Begun::of(scene, format)?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    writer.add_textures(&images, (container == Container::Gltf).then_some(&*stem));
    let (draft, warnings) = writer.finish(materials);
    let files = match container {
        Container::Glb => vec![FileBytes { path: path.to_path_buf(), bytes: draft.encode_glb()? }],
        Container::Gltf => draft.into_files(path, separate_files(images, path))?,
    };
    FileSet::one(|set| set.write_files(&files, Progress::SILENT))?;
    Ok(WrittenScene { files: files.into_iter().map(|file| file.path).collect(), warnings })
}

/// Returns the GLB that [`write_scene`] would write, with uncompressed geometry and PNG textures. Meshes and the
/// nodes that show them are named after `names`, one per mesh of the scene; missing names are empty. Adds notes on
/// content that glTF cannot express to `warnings`.
///
/// # Errors
/// As [`write_scene`].
pub fn encode_scene(scene: &Scene, names: &[String], warnings: &mut Warnings) -> Result<Vec<u8>> {
    encode_scene_as(scene, names, &GltfFormat::default(), warnings)
}

/// Like [`encode_scene`], but packed according to `format`.
///
/// # Errors
/// As [`write_scene`]; [`Error::Invalid`] for a number of the format that is out of range.
pub fn encode_scene_as(
    scene: &Scene,
    names: &[String],
    format: &GltfFormat,
    warnings: &mut Warnings,
) -> Result<Vec<u8>> {
    let Begun { mut writer, materials, images } = Begun::of(scene, format)?;
    writer.name_meshes(names);
    writer.add_textures(&images, None);
    let (draft, notes) = writer.finish(materials);
    warnings.absorb(notes);
    draft.encode_glb()
}

/// A scene that is written except for its textures.
struct Begun<'a> {
    writer: Writer<'a>,
    materials: Vec<Value>,
    images: Vec<Image>,
}

impl<'a> Begun<'a> {
    fn of(scene: &'a Scene, format: &GltfFormat) -> Result<Self> {
        if scene.triangle_count() == 0 {
            return Err(Error::invalid("scene to write", "it shows no triangles"));
        }
        let mut writer = Writer::new(scene, *format);
        writer.meshes()?;
        writer.lights()?;
        writer.cameras()?;
        let materials = scene.materials().iter().map(|material| writer.material(material)).collect();
        let images = writer.encoded_images()?;
        Ok(Self { writer, materials, images })
    }
}

/// A scene being written: its document, and the warnings about content that glTF lacks.
struct Writer<'a> {
    scene: &'a Scene,
    format: GltfFormat,
    draft: GltfDraft,
    textures: Textures,
    warnings: Warnings,
    nodes: Vec<Value>,
    /// The nodes listed by the scene.
    shown: Vec<usize>,
}

impl<'a> Writer<'a> {
    fn new(scene: &'a Scene, format: GltfFormat) -> Self {
        let generator = concat!("taotie ", env!("CARGO_PKG_VERSION"));
        let json = json!({ "asset": { "version": "2.0", "generator": generator }, "scene": 0 });
        Self {
            scene,
            format,
            draft: GltfDraft::begun(json, format.codecs),
            textures: Textures::default(),
            warnings: Warnings::default(),
            nodes: Vec::new(),
            shown: Vec::new(),
        }
    }

    /// Notes that `count` parts differ from the scene in some way.
    fn note(&mut self, what: &str, count: usize) {
        self.warnings.note(what, count);
    }

    /// Adds a node to the scene.
    fn show(&mut self, node: Value) {
        self.shown.push(self.nodes.len());
        self.nodes.push(node);
    }

    fn finish(mut self, materials: Vec<Value>) -> (GltfDraft, Warnings) {
        self.draft.json["scenes"] = json!([{ "nodes": self.shown }]);
        self.draft.json["nodes"] = self.nodes.into();
        if !materials.is_empty() {
            self.draft.json["materials"] = materials.into();
        }
        (self.draft, self.warnings)
    }
}

/// An image to be written: a texture of the scene, with its green channel flipped if it points down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ImageUse {
    texture: usize,
    turned: bool,
}

/// The images requested by materials, in the order of the requests.
#[derive(Debug, Clone, Default)]
struct Textures {
    images: Vec<ImageUse>,
    samplers: Vec<Sampler>,
    /// The sampler and the image of each texture.
    textures: Vec<[usize; 2]>,
}

/// An image as encoded.
struct Image {
    bytes: Vec<u8>,
    kind: CodecKind,
    /// `true` if floats were rounded.
    rounded: bool,
    /// `true` if another format was requested but not supported.
    refused: bool,
}

/// Returns the images as files next to the model `path`.
fn separate_files(images: Vec<Image>, path: &Path) -> Vec<FileBytes> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let file = |(i, image): (usize, Image)| {
        let path = path.with_file_name(file_name(&stem, i, &image));
        FileBytes { path, bytes: image.bytes }
    };
    images.into_iter().enumerate().map(file).collect()
}

fn file_name(stem: &str, index: usize, image: &Image) -> String {
    format!("{stem}_{index}.{}", image.kind.file_extension())
}

/// The written parts of a mesh of the scene.
struct Shape {
    primitives: Vec<Value>,
    grid: Option<Grid>,
}

impl Writer<'_> {
    /// Writes the instances, and each mesh once per material used with it; its data is shared.
    fn meshes(&mut self) -> Result<()> {
        let scene = self.scene;
        let mut shapes: HashMap<usize, Shape> = HashMap::new();
        let mut numbers: HashMap<(usize, usize), usize> = HashMap::new();
        let mut meshes = Vec::new();
        let seen = |instance: &&Instance| !scene.meshes()[instance.mesh].triangles().is_empty();
        for instance in scene.instances().iter().filter(seen) {
            let shape = match shapes.entry(instance.mesh) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(place) => place.insert(self.shape(&scene.meshes()[instance.mesh])?),
            };
            let number = *numbers.entry((instance.mesh, instance.material)).or_insert_with(|| {
                let mut primitives = shape.primitives.clone();
                primitives.iter_mut().for_each(|p| p["material"] = instance.material.into());
                meshes.push(json!({ "primitives": primitives }));
                meshes.len() - 1
            });
            self.instance(number, shape.grid.as_ref(), &instance.world_from_object)?;
        }
        self.draft.json["meshes"] = meshes.into();
        self.note("dropped meshes without triangles or instances", scene.meshes().len() - shapes.len());
        Ok(())
    }

    /// Names meshes, and the nodes that show them, after the scene's meshes.
    fn name_meshes(&mut self, names: &[String]) {
        let scene = self.scene;
        let seen = |instance: &&Instance| !scene.meshes()[instance.mesh].triangles().is_empty();
        let nodes = self.nodes.iter_mut().filter(|node| node.get("mesh").is_some());
        for (node, instance) in nodes.zip(scene.instances().iter().filter(seen)) {
            let Some(name) = names.get(instance.mesh).filter(|name| !name.is_empty()) else { continue };
            node["name"] = name.as_str().into();
            let mesh = node["mesh"].as_u64().unwrap_or_default();
            if let Some(mesh) = self.draft.json.pointer_mut(&format!("/meshes/{mesh}")) {
                mesh["name"] = name.as_str().into();
            }
        }
    }

    fn shape(&mut self, mesh: &Mesh) -> Result<Shape> {
        self.note("meshes without normals, which glTF shows faceted", usize::from(mesh.normals().is_empty()));
        let lost = mesh.normals().is_empty() && !mesh.tangents().is_empty();
        self.note("dropped tangents of meshes without normals", usize::from(lost));
        let grid =
            self.format.meshopt.then(|| Grid::around(std::iter::once(mesh), self.format.bits.positions));
        let parts = [MeshPart::whole(mesh)];
        let primitives = match &grid {
            Some(grid) => mesh::add_packed(
                &mut self.draft,
                PackedMesh { mesh, parts: &parts, grid, bits: self.format.bits },
            )?,
            None => mesh::add(&mut self.draft, mesh, &parts),
        };
        Ok(Shape { primitives, grid })
    }

    /// Adds a node that shows a mesh, with a separate node below it if the mesh is packed and the node is
    /// transformed.
    fn instance(&mut self, mesh: usize, grid: Option<&Grid>, world: &Mat4) -> Result<()> {
        self.note(
            "sheared transforms, which not every program reads correctly",
            usize::from(is_sheared(world)),
        );
        let mut shown = json!({ "mesh": mesh });
        if let Some(grid) = grid {
            grid.place(&mut shown);
            if *world != Mat4::IDENTITY {
                self.nodes.push(shown);
                shown = json!({ "children": [self.nodes.len() - 1] });
            }
        }
        self.show(placed(shown, world)?);
        Ok(())
    }

    /// Writes the lights.
    fn lights(&mut self) -> Result<()> {
        let lights = self.scene.lights();
        if lights.is_empty() {
            return Ok(());
        }
        let constant =
            |l: &&Light| l.falloff == Falloff::None && !matches!(l.kind, LightKind::Directional { .. });
        let what = "lights without distance falloff, which glTF lights always have";
        self.note(what, lights.iter().filter(constant).count());
        self.draft.uses(LIGHTS);
        let described: Vec<Value> = lights.iter().map(light).collect();
        self.draft.json["extensions"] = json!({ LIGHTS: { "lights": described } });
        for (i, light) in lights.iter().enumerate() {
            let node = json!({ "extensions": { LIGHTS: { "light": i } } });
            self.show(placed(node, &place(&light.kind))?);
        }
        Ok(())
    }

    /// Writes the cameras.
    fn cameras(&mut self) -> Result<()> {
        let cameras = self.scene.cameras();
        if cameras.is_empty() {
            return Ok(());
        }
        self.draft.json["cameras"] = cameras.iter().map(camera).collect();
        for (i, camera) in cameras.iter().enumerate() {
            self.show(placed(json!({ "camera": i }), &camera.world_from_view)?);
        }
        Ok(())
    }
}

/// Returns `true` if the axes are not at right angles. Source: glTF 2.0, 3.5.3, which requires decomposable matrices.
fn is_sheared(m: &Mat4) -> bool {
    let pair = |a: usize, b: usize| {
        let (a, b) = (m.axis(a), m.axis(b));
        a.dot(b).abs() > SQUARE * a.length() * b.length()
    };
    pair(0, 1) || pair(1, 2) || pair(2, 0)
}

fn light(light: &Light) -> Value {
    let color = light.color.to_array();
    let intensity = color.into_iter().fold(0.0, f32::max);
    let hue = if intensity > 0.0 { color.map(|v| v / intensity) } else { [1.0; 3] };
    let mut json = json!({ "color": hue.map(short), "intensity": short(intensity) });
    json["type"] = match light.kind {
        LightKind::Point { .. } => "point".into(),
        LightKind::Directional { .. } => "directional".into(),
        LightKind::Spot { inner, outer, .. } => {
            json["spot"] = json!({ "innerConeAngle": inner, "outerConeAngle": outer });
            "spot".into()
        }
    };
    if let (Falloff::Windowed(range), false) =
        (light.falloff, matches!(light.kind, LightKind::Directional { .. }))
    {
        json["range"] = short(range).into();
    }
    named(json, &light.name)
}

/// Returns the transform from −z to the light's direction. Source: KHR_lights_punctual.
fn place(kind: &LightKind) -> Mat4 {
    let (position, direction) = match kind {
        LightKind::Point { position } => return Mat4::translation(position.to_f64()),
        LightKind::Directional { direction } => (Vec3::splat(0.0), direction),
        LightKind::Spot { position, direction, .. } => (position.to_f64(), direction),
    };
    let z = (-direction.to_f64()).normalize_or(Vec3::new(0.0, 0.0, 1.0));
    let up = if z.y.abs() < 0.9 { Vec3::new(0.0, 1.0, 0.0) } else { Vec3::new(1.0, 0.0, 0.0) };
    let x = up.cross(z).normalize_or(Vec3::new(1.0, 0.0, 0.0));
    Mat4::from_axes(x, z.cross(x), z, position)
}

fn camera(camera: &Camera) -> Value {
    let json = match camera.projection {
        Projection::Perspective { fov_y, aspect, near, far } => {
            let mut view = json!({ "yfov": fov_y, "znear": near });
            if let Some(aspect) = aspect {
                view["aspectRatio"] = aspect.into();
            }
            if let Some(far) = far {
                view["zfar"] = far.into();
            }
            json!({ "type": "perspective", "perspective": view })
        }
        Projection::Orthographic { half_width, half_height, near, far } => {
            let view = json!({ "xmag": half_width, "ymag": half_height, "znear": near, "zfar": far });
            json!({ "type": "orthographic", "orthographic": view })
        }
    };
    named(json, &camera.name)
}

fn named(mut json: Value, name: &str) -> Value {
    if !name.is_empty() {
        json["name"] = name.into();
    }
    json
}

/// Returns a node with a transform; the identity has no matrix.
///
/// # Errors
/// [`Error::Invalid`] if the matrix does not fit 32-bit floats.
fn placed(mut node: Value, world: &Mat4) -> Result<Value> {
    let rounded = world.columns.as_flattened().iter().map(|v| *v as f32);
    let rounded: Vec<f32> = rounded.collect();
    if !rounded.iter().all(|v| v.is_finite()) {
        return Err(Error::invalid("transform in the scene to write", "it does not fit 32-bit floats"));
    }
    if *world != Mat4::IDENTITY {
        node["matrix"] = rounded.into_iter().map(short).collect::<Vec<_>>().into();
    }
    Ok(node)
}
