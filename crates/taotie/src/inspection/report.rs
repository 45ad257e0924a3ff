//! The inspection of a model: counts, extent, meshes, materials and warnings, and hints about content that will not
//! look as intended.

use super::material::{MaterialReport, Materials};
use super::mesh::{self, MeshReport};
use taotie_engine::error::{Warning, Warnings};
use taotie_engine::render::{SurfaceSettings, foreseen_warnings};
use taotie_engine::scene::animation::Animation;
use taotie_engine::scene::{Camera, GreenChannel, Light, LightKind, NormalSpace, Projection, Scene};
use taotie_engine::surface::{GreenVerdict, NormalMapKind};
use taotie_io::{GltfSizes, Loaded, XmpEvent, xmp_history, xmp_rights, xmp_sources};

/// The content and faults of a model.
///
/// ```no_run
/// use taotie::inspection::Inspection;
///
/// let inspection = Inspection::of(&taotie::load_model("statue.glb")?);
/// let broken = inspection.meshes.iter().filter(|mesh| mesh.zero_area_triangles > 0);
/// println!("{} of {} meshes have triangles without area", broken.count(), inspection.counts.meshes);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct Inspection {
    /// `glTF`, `GLB`, `OBJ`, `PLY`, `STL` or `FBX`.
    pub format: String,
    /// The program that wrote the file.
    pub generator: Option<String>,
    /// The rights notice.
    pub copyright: Option<String>,
    /// The rights stated in the XMP metadata of the whole asset.
    pub rights: Option<String>,
    /// The sources that it names, such as the scan of a baked asset.
    pub sources: Vec<String>,
    /// The recorded steps that made the model, oldest first.
    pub history: Vec<XmpEvent>,
    /// The number of objects of each kind.
    pub counts: Counts,
    /// The bytes of a glTF file by content, and its memory on a graphics card: [`GltfSizes::read`]. `None` unless the
    /// caller adds them, since the model's file may be gone.
    pub sizes: Option<GltfSizes>,
    /// World space; `None` if nothing is drawn.
    pub bounds: Option<Extent>,
    /// In the order of the file.
    pub meshes: Vec<MeshReport>,
    /// In the order of the file.
    pub materials: Vec<MaterialReport>,
    /// The file's lights.
    pub lights: Vec<Listed>,
    /// The file's cameras.
    pub cameras: Vec<Listed>,
    /// The file's animations.
    pub animations: Vec<AnimationReport>,
    /// Names of the material variants in the file.
    pub variants: Vec<String>,
    /// Files that the model refers to and that are missing.
    pub missing_files: Vec<String>,
    /// glTF extensions that the file uses.
    pub extensions_used: Vec<String>,
    /// glTF extensions that the file requires.
    pub extensions_required: Vec<String>,
    /// Faults that would be ignored or corrected when the model is rendered.
    pub warnings: Vec<Warning>,
}

/// The number of objects of each kind.
///
/// ```
/// # use taotie::inspection::Inspection;
/// # use taotie::{Loaded, Material, Mesh, Scene, Warnings};
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let counts = Inspection::of(&Loaded::new(ball, Warnings::default(), "glTF")).counts;
/// assert_eq!((counts.meshes, counts.triangles, counts.textures), (1, 960, 0));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Counts {
    /// Meshes; each primitive of glTF and each material of an OBJ file counts as one.
    pub meshes: usize,
    /// Meshes placed in the world.
    pub instances: usize,
    /// Triangles of the meshes.
    pub triangles: usize,
    /// Triangles of the instances.
    pub triangles_drawn: usize,
    /// Vertices of the meshes.
    pub vertices: usize,
    /// Materials.
    pub materials: usize,
    /// Textures that were readable.
    pub textures: usize,
    /// Lights.
    pub lights: usize,
    /// Cameras.
    pub cameras: usize,
    /// Animations.
    pub animations: usize,
}

/// An axis-aligned box in world space, model units.
///
/// ```
/// # use taotie::inspection::Inspection;
/// # use taotie::{Loaded, Material, Mesh, Scene, Warnings};
/// let ball = Scene::of_mesh(Mesh::sphere(2.0, 32, 16), Material::default())?;
/// let bounds = Inspection::of(&Loaded::new(ball, Warnings::default(), "glTF")).bounds;
/// assert_eq!(bounds.map(|bounds| bounds.size), Some([4.0; 3]));
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Extent {
    /// The corner of minimum coordinates.
    pub min: [f64; 3],
    /// The corner of maximum coordinates.
    pub max: [f64; 3],
    /// `max` − `min`.
    pub size: [f64; 3],
}

/// A light or camera.
///
/// ```
/// use taotie::inspection::{Inspection, Listed};
///
/// /// Returns the perspective cameras.
/// fn perspective(inspection: &Inspection) -> impl Iterator<Item = &Listed> {
///     inspection.cameras.iter().filter(|camera| camera.kind == "perspective")
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct Listed {
    /// As in the file; may be empty.
    pub name: String,
    /// Its form, such as `spot` or `perspective`.
    pub kind: String,
}

/// An animation.
///
/// ```
/// use taotie::inspection::{AnimationReport, Inspection};
///
/// /// Returns the longest animation.
/// fn longest(inspection: &Inspection) -> Option<&AnimationReport> {
///     inspection.animations.iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds))
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub struct AnimationReport {
    /// As in the file; may be empty.
    pub name: String,
    /// The time of its last keyframe.
    pub seconds: f64,
    /// Its usable channels.
    pub channels: usize,
    /// The keyframes of all channels.
    pub keyframes: usize,
}

impl Inspection {
    /// Inspects a loaded model.
    pub fn of(loaded: &Loaded) -> Self {
        let (scene, packet) = (&loaded.scene, loaded.xmp.first());
        Self {
            format: loaded.format.into(),
            generator: loaded.generator.clone(),
            copyright: loaded.copyright.clone(),
            rights: packet.and_then(xmp_rights),
            sources: packet.map(xmp_sources).unwrap_or_default(),
            history: packet.map(xmp_history).unwrap_or_default(),
            counts: Counts::new(loaded),
            sizes: None,
            bounds: Extent::of(scene),
            meshes: mesh::reports(loaded),
            materials: Materials::new(loaded).reports(),
            lights: scene.lights().iter().map(named_light).collect(),
            cameras: scene.cameras().iter().map(named_camera).collect(),
            animations: animations(loaded).iter().map(AnimationReport::new).collect(),
            variants: loaded.variants.names().to_vec(),
            missing_files: loaded.missing_files.clone(),
            extensions_used: loaded.extensions_used.clone(),
            extensions_required: loaded.extensions_required.clone(),
            warnings: warnings(loaded),
        }
    }

    /// Returns hints about content that will not look as intended.
    pub fn hints(&self) -> Vec<Hint> {
        hints(&self.materials, &self.meshes)
    }
}

impl Counts {
    fn new(loaded: &Loaded) -> Self {
        let scene = &loaded.scene;
        Self {
            meshes: scene.meshes().len(),
            instances: scene.instances().len(),
            triangles: scene.meshes().iter().map(|mesh| mesh.triangles().len()).sum(),
            triangles_drawn: scene.triangle_count(),
            vertices: scene.meshes().iter().map(|mesh| mesh.positions().len()).sum(),
            materials: scene.materials().len(),
            textures: scene.textures().len(),
            lights: scene.lights().len(),
            cameras: scene.cameras().len(),
            animations: animations(loaded).len(),
        }
    }
}

fn animations(loaded: &Loaded) -> &[Animation] {
    loaded.rig.as_ref().map_or(&[], |rig| rig.animations())
}

impl AnimationReport {
    fn new(animation: &Animation) -> Self {
        let keyframes = animation.channels.iter().map(|c| animation.samplers[c.sampler].times().len());
        Self {
            name: animation.name.clone(),
            seconds: animation.seconds(),
            channels: animation.channels.len(),
            keyframes: keyframes.sum(),
        }
    }
}

impl Extent {
    fn of(scene: &Scene) -> Option<Self> {
        let bounds = scene.bounds()?;
        let size = (bounds.max - bounds.min).to_array();
        Some(Self { min: bounds.min.to_array(), max: bounds.max.to_array(), size })
    }
}

fn named_light(light: &Light) -> Listed {
    let kind = match light.kind {
        LightKind::Point { .. } => "point",
        LightKind::Directional { .. } => "directional",
        LightKind::Spot { .. } => "spot",
    };
    Listed { name: light.name.clone(), kind: kind.into() }
}

fn named_camera(camera: &Camera) -> Listed {
    let kind = match camera.projection {
        Projection::Perspective { .. } => "perspective",
        Projection::Orthographic { .. } => "orthographic",
    };
    Listed { name: camera.name.clone(), kind: kind.into() }
}

/// Returns all warnings from reading and rendering.
fn warnings(loaded: &Loaded) -> Vec<Warning> {
    let mut all: Warnings = loaded.warnings.clone();
    match foreseen_warnings(&loaded.scene, &SurfaceSettings::default()) {
        Ok(found) => all.absorb(found),
        Err(error) => all.note(format!("it cannot be rendered: {error}"), 1),
    }
    all.list()
}

/// The mean angle from MikkTSpace's tangents that is worth a hint, in degrees.
const FAR_FROM_MIKKTSPACE: f64 = 5.0;

/// Content that will not look as intended.
///
/// ```
/// use taotie::inspection::Hint;
///
/// /// Returns a short explanation.
/// fn advice(hint: &Hint) -> String {
///     match hint {
///         Hint::OtherGreen { material, by_pixels, .. } => format!("{material}: green points {by_pixels:?}"),
///         Hint::OtherSpace { material, by_pixels, .. } => format!("{material}: a map in {by_pixels:?} space"),
///         other => format!("{other:?}"),
///     }
/// }
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Hint {
    /// The normal map of a material does not look like one.
    NoNormalMap {
        /// The material's name.
        material: String,
    },
    /// A normal map is drawn in a different space from the one that its pixels suggest.
    OtherSpace {
        /// The material's name.
        material: String,
        /// The space in which it is drawn.
        drawn: NormalSpace,
        /// The space that its pixels suggest.
        by_pixels: NormalSpace,
    },
    /// A normal map is drawn with a different green direction from the one that its pixels suggest.
    OtherGreen {
        /// The material's name.
        material: String,
        /// The direction with which it is drawn.
        drawn: GreenChannel,
        /// The direction that its pixels suggest.
        by_pixels: GreenChannel,
    },
    /// The tangents of a mesh are far from MikkTSpace's.
    FarFromMikkTSpace {
        /// The mesh's name.
        mesh: String,
        /// Mean angle, degrees.
        mean_degrees: f64,
    },
}

/// Returns hints about normal maps and tangents.
fn hints(materials: &[MaterialReport], meshes: &[MeshReport]) -> Vec<Hint> {
    materials.iter().filter_map(about_map).chain(meshes.iter().filter_map(about_tangents)).collect()
}

fn about_map(material: &MaterialReport) -> Option<Hint> {
    let map = material.normal_map.as_ref()?;
    let material = material.name.clone();
    let by_pixels = match map.pixels.kind_by_pixels {
        NormalMapKind::No => return Some(Hint::NoNormalMap { material }),
        NormalMapKind::Tangent => NormalSpace::Tangent,
        NormalMapKind::Object => NormalSpace::Object,
    };
    if by_pixels != map.space {
        return Some(Hint::OtherSpace { material, drawn: map.space, by_pixels });
    }
    let by_pixels = match map.pixels.green_by_pixels? {
        GreenVerdict::Up => GreenChannel::Up,
        GreenVerdict::Down => GreenChannel::Down,
        GreenVerdict::Unclear => return None,
    };
    (by_pixels != map.green).then_some(Hint::OtherGreen { material, drawn: map.green, by_pixels })
}

fn about_tangents(mesh: &MeshReport) -> Option<Hint> {
    let mean_degrees = mesh.tangents.as_ref()?.mikktspace.as_ref()?.mean_degrees;
    let mesh = mesh.name.clone();
    (mean_degrees > FAR_FROM_MIKKTSPACE).then_some(Hint::FarFromMikkTSpace { mesh, mean_degrees })
}
