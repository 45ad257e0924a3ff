//! Scenes from the meshes, materials and images of other packages, and back.

use crate::arrays::{self, MeshArrays, Picture, Taken};
use crate::error::no_json;
use crate::options::Options;
use crate::work;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use taotie_engine::bake::low_poly_mesh;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texture};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{
    AlphaMode, GreenChannel, Instance, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef,
    TextureRole, UvTransform,
};
use taotie_engine::{Error, Result, Warnings};

/// A scene as arrays and images.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Parts<'py> {
    meshes: Vec<MeshArrays<'py>>,
    materials: Vec<PartMaterial>,
    images: Vec<Picture<'py>>,
    instances: Vec<Placement>,
}

/// A material.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct PartMaterial {
    /// [`Factors`].
    factors: Options,
    /// The index of an image by the name of its [`TextureRole`].
    textures: BTreeMap<String, usize>,
}

/// A mesh placed in the world, by indices.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Placement {
    mesh: usize,
    material: usize,
    /// The columns of the transform from object space; `None` for the identity.
    world_from_object: Option<[[f64; 4]; 4]>,
}

/// A scene copied from Python, usable without the interpreter's lock.
pub struct TakenParts {
    meshes: Vec<MeshData>,
    materials: Vec<(Factors, BTreeMap<String, usize>)>,
    images: Vec<Taken>,
    instances: Vec<Placement>,
}

impl Parts<'_> {
    /// Copies arrays and images.
    pub fn taken(self, py: Python<'_>) -> PyResult<TakenParts> {
        let material = |material: PartMaterial| Ok((material.factors.read()?, material.textures));
        Ok(TakenParts {
            meshes: self.meshes.iter().map(MeshArrays::data).collect::<PyResult<_>>()?,
            materials: self.materials.into_iter().map(material).collect::<PyResult<_>>()?,
            images: self.images.iter().map(|image| image.taken(py)).collect::<PyResult<_>>()?,
            instances: self.instances,
        })
    }
}

impl TakenParts {
    /// Returns the scene.
    ///
    /// # Errors
    /// Those of [`Mesh::new`] and [`Scene::new`], of images, and for an unknown role of a texture.
    pub fn scene(self) -> Result<Scene> {
        let images = self.images.into_iter().map(Taken::bitmap).collect::<Result<_>>()?;
        let mut textures = Textures { images, made: Vec::new(), used: Vec::new() };
        let mut materials = Vec::new();
        for (factors, used) in self.materials {
            let normal_scale = factors.normal_scale;
            let mut material = factors.material();
            for (name, image) in used {
                textures.set(&mut material, &name, (image, normal_scale))?;
            }
            materials.push(material);
        }
        let meshes = self.meshes.into_iter().map(Mesh::new).collect::<Result<_>>()?;
        let instances = self.instances.into_iter().map(Placement::instance).collect();
        Scene::new(SceneData {
            meshes,
            materials,
            textures: textures.made,
            instances,
            ..SceneData::default()
        })
    }
}

impl Placement {
    fn instance(self) -> Instance {
        let world_from_object = self.world_from_object.map_or(Mat4::IDENTITY, |columns| Mat4 { columns });
        Instance { mesh: self.mesh, material: self.material, world_from_object }
    }
}

/// The textures of a scene: one for each image and encoding in use.
struct Textures {
    images: Vec<Bitmap>,
    made: Vec<Texture>,
    /// The image and the encoding of each of `made`.
    used: Vec<(usize, Encoding)>,
}

impl Textures {
    /// Gives a material an image, by the name of the role; `scale` is that of normal maps.
    fn set(&mut self, material: &mut Material, role: &str, (image, scale): (usize, f32)) -> Result<()> {
        let unknown = || Error::invalid(format!("texture `{role}`"), "not a texture of this material");
        let known = TextureRole::named(role).ok_or_else(unknown)?;
        let texture = TextureRef {
            texture: self.texture(image, known.encoding())?,
            uv_set: 0,
            sampler: Sampler::default(),
            transform: UvTransform::default(),
        };
        if known == TextureRole::Normal {
            let (space, green) = (NormalSpace::Tangent, GreenChannel::Up);
            material.normal = Some(NormalMap { texture, scale, space, green });
        } else {
            *known.place(material).ok_or_else(unknown)? = Some(texture);
        }
        Ok(())
    }

    fn texture(&mut self, image: usize, encoding: Encoding) -> Result<usize> {
        if let Some(index) = self.used.iter().position(|used| *used == (image, encoding)) {
            return Ok(index);
        }
        let missing = || Error::invalid(format!("image {image}"), format!("there are {}", self.images.len()));
        let bitmap = self.images.get(image).ok_or_else(missing)?;
        self.made.push(Texture::new(bitmap.clone(), encoding));
        self.used.push((image, encoding));
        Ok(self.made.len() - 1)
    }
}

/// The factors of a material.
#[derive(Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Factors {
    name: String,
    /// Linear RGB and alpha.
    base_color: [f32; 4],
    metallic: f32,
    roughness: f32,
    /// Linear RGB.
    emissive: [f32; 3],
    normal_scale: f32,
    occlusion_strength: f32,
    alpha: Alpha,
    alpha_cutoff: f32,
    double_sided: bool,
}

/// The treatment of alpha, as in glTF.
#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
enum Alpha {
    Opaque,
    Mask,
    Blend,
}

impl Default for Factors {
    fn default() -> Self {
        Self::of(&Material::default())
    }
}

impl Factors {
    fn of(material: &Material) -> Self {
        let (alpha, alpha_cutoff) = match material.alpha {
            AlphaMode::Opaque => (Alpha::Opaque, 0.5),
            AlphaMode::Mask(cutoff) => (Alpha::Mask, cutoff),
            AlphaMode::Blend => (Alpha::Blend, 0.5),
        };
        Self {
            name: material.name.clone(),
            base_color: material.base_color,
            metallic: material.metallic,
            roughness: material.roughness,
            emissive: material.emissive,
            normal_scale: material.normal.map_or(1.0, |normal| normal.scale),
            occlusion_strength: material.occlusion_strength,
            alpha,
            alpha_cutoff,
            double_sided: material.double_sided,
        }
    }

    fn material(self) -> Material {
        let alpha = match self.alpha {
            Alpha::Opaque => AlphaMode::Opaque,
            Alpha::Mask => AlphaMode::Mask(self.alpha_cutoff),
            Alpha::Blend => AlphaMode::Blend,
        };
        Material {
            name: self.name,
            base_color: self.base_color,
            metallic: self.metallic,
            roughness: self.roughness,
            emissive: self.emissive,
            occlusion_strength: self.occlusion_strength,
            alpha,
            double_sided: self.double_sided,
            ..Material::default()
        }
    }
}

/// Returns one mesh in world space for each material in use, and counted omissions. Each is a dictionary: the arrays of
/// [`arrays::of_mesh`], `factors` as JSON, `textures` by role, `is_green_down` of the normal map, and `is_plain` if the
/// material is the default one except for its base colour.
pub fn of_scene<'py>(py: Python<'py>, scene: &Scene) -> PyResult<(Bound<'py, PyList>, Warnings)> {
    let mut warnings = Warnings::default();
    let parts = PyList::empty(py);
    let used: BTreeSet<usize> = scene.instances().iter().map(|instance| instance.material).collect();
    for index in used {
        let mesh = work::detached(py, || low_poly_mesh(with_material(scene, index)?))?;
        let (part, material) = (arrays::of_mesh(py, &mesh)?, &scene.materials()[index]);
        part.set_item("factors", serde_json::to_string(&Factors::of(material)).map_err(no_json)?)?;
        part.set_item("textures", textures(py, (scene, material), &mut warnings)?)?;
        let green = material.normal.map_or(GreenChannel::Up, |normal| normal.green);
        part.set_item("is_green_down", green == GreenChannel::Down)?;
        part.set_item("is_plain", is_plain(material))?;
        parts.append(part)?;
    }
    Ok((parts, warnings))
}

/// Returns the scene with the instances of one material.
fn with_material(scene: &Scene, material: usize) -> Result<Scene> {
    let mut data = scene.clone().into_data();
    data.instances.retain(|instance| instance.material == material);
    Scene::new(data)
}

/// Returns the textures of a material that other packages have too, as stored.
fn textures<'py>(
    py: Python<'py>,
    (scene, material): (&Scene, &Material),
    warnings: &mut Warnings,
) -> PyResult<Bound<'py, PyDict>> {
    let textures = PyDict::new(py);
    for role in TextureRole::ALL {
        let Some(used) = role.of(material) else { continue };
        if role.normal_map(material).is_some_and(|map| map.space == NormalSpace::Object) {
            warnings.note("object-space normal maps were left out", 1);
            continue;
        }
        let is_moved = used.transform != UvTransform::default();
        warnings.note("transforms of textures were left out", usize::from(is_moved));
        warnings.note("textures were assigned to the first set of UVs", usize::from(used.uv_set != 0));
        textures.set_item(role.name(), arrays::of_bitmap(py, scene.textures()[used.texture].bitmap())?)?;
    }
    Ok(textures)
}

fn is_plain(material: &Material) -> bool {
    let Material { name, base_color, double_sided, .. } = material.clone();
    *material == Material { name, base_color, double_sided, ..Material::default() }
}
