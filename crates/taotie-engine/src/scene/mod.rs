//! Scenes: meshes, materials, textures, instances, lights, cameras and animations. Data, and the poses that follow
//! from it.

pub mod animation;
mod bounds;
mod camera;
mod layers;
mod light;
mod material;
mod texture_role;

pub use bounds::{Bounds, Outline};
pub use camera::{Camera, Orbit, Projection, fitting_distance, rigid};
pub use layers::{Factor, FactorValue, LAYERS, Layer};
pub use light::{Falloff, Light, LightKind, from_view, three_point_rig};
pub use material::{
    AlphaMode, Anisotropy, Classic, Clearcoat, Dispersion, GreenChannel, HeightMap, Iridescence, Material,
    NormalMap, NormalSpace, PRESETS, Preset, Sheen, Specular, TextureRef, Transmission, UvTransform, Volume,
    preset,
};
pub use texture_role::TextureRole;

use crate::error::{Error, Result};
use crate::image::Texture;
use crate::math::{Mat4, Vec3};
use crate::mesh::Mesh;

/// The parts of a [`Scene`].
#[derive(Debug, Clone, Default)]
pub struct SceneData {
    /// The meshes, object space.
    pub meshes: Vec<Mesh>,
    /// The materials.
    pub materials: Vec<Material>,
    /// The textures that materials refer to by index.
    pub textures: Vec<Texture>,
    /// Meshes placed in the world.
    pub instances: Vec<Instance>,
    /// The lights of the file, world space.
    pub lights: Vec<Light>,
    /// The cameras of the file, world space.
    pub cameras: Vec<Camera>,
}

/// A mesh placed in the world with a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index into [`SceneData::meshes`].
    pub mesh: usize,
    /// Index into [`SceneData::materials`].
    pub material: usize,
    /// The transform from object space to world space; finite.
    pub world_from_object: Mat4,
}

/// A scene: every index in it is in range, every transform of an instance or camera finite, every factor of a
/// material in range.
///
/// A mesh may lack the uv set that a material refers to: textures are then read at uv (0, 0), and normal and height
/// maps ignored with a warning.
///
/// Cloning is cheap: a clone shares meshes and textures with its original.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    data: SceneData,
}

impl Scene {
    /// Validates `data`.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] naming the first invalid part: an instance whose mesh or material does not exist, a
    /// transform that is infinite or NaN, a material whose texture does not exist or whose factor is out of range.
    pub fn new(data: SceneData) -> Result<Self> {
        data.check()?;
        Ok(Self { data })
    }

    /// Returns a scene of one untransformed mesh with one material.
    ///
    /// # Errors
    /// As [`Self::new`]: a factor of the material is out of range, or it refers to a texture.
    pub fn of_mesh(mesh: Mesh, material: Material) -> Result<Self> {
        let instances = vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }];
        Self::new(SceneData {
            meshes: vec![mesh],
            materials: vec![material],
            instances,
            ..SceneData::default()
        })
    }

    /// Changes parts and validates them again. Meshes are not read, so this is cheap.
    ///
    /// # Errors
    /// As [`Self::new`]; the scene is then unchanged.
    pub fn edit(&mut self, change: impl FnOnce(&mut SceneData)) -> Result<()> {
        let mut data = self.data.clone();
        change(&mut data);
        *self = Self::new(data)?;
        Ok(())
    }

    /// Adds a texture and returns its index, for use by materials.
    pub fn add_texture(&mut self, texture: Texture) -> usize {
        self.data.textures.push(texture);
        self.data.textures.len() - 1
    }

    /// Returns the parts, to change and validate them again.
    pub fn into_data(self) -> SceneData {
        self.data
    }

    /// Returns the parts.
    pub fn data(&self) -> &SceneData {
        &self.data
    }

    /// Returns the meshes, object space.
    pub fn meshes(&self) -> &[Mesh] {
        &self.data.meshes
    }

    /// Returns the materials.
    pub fn materials(&self) -> &[Material] {
        &self.data.materials
    }

    /// Returns the textures that materials refer to by index.
    pub fn textures(&self) -> &[Texture] {
        &self.data.textures
    }

    /// Returns the meshes placed in the world.
    pub fn instances(&self) -> &[Instance] {
        &self.data.instances
    }

    /// Returns the lights of the file, world space.
    pub fn lights(&self) -> &[Light] {
        &self.data.lights
    }

    /// Returns the cameras of the file, world space.
    pub fn cameras(&self) -> &[Camera] {
        &self.data.cameras
    }

    /// Returns the world-space box around every triangle's corners, or `None` if there are no triangles.
    pub fn bounds(&self) -> Option<Bounds> {
        Outline::new(self).bounds()
    }

    /// Returns every corner of every triangle, world space, each as often as it is used.
    pub fn corners(&self) -> impl Iterator<Item = Vec3<f64>> + '_ {
        self.instances().iter().flat_map(|instance| {
            let mesh = &self.meshes()[instance.mesh];
            mesh.triangles().iter().flatten().map(|index| {
                instance.world_from_object.transform_point(mesh.positions()[*index as usize].to_f64())
            })
        })
    }

    /// Returns the number of triangles that the instances draw.
    pub fn triangle_count(&self) -> usize {
        self.instances().iter().map(|i| self.meshes()[i.mesh].triangles().len()).sum()
    }
}

impl SceneData {
    /// Adds all parts of `more`, whose indices are shifted to follow those of this scene.
    pub fn append(&mut self, more: Self) {
        let [mesh, material, texture] = [self.meshes.len(), self.materials.len(), self.textures.len()];
        self.meshes.extend(more.meshes);
        self.textures.extend(more.textures);
        self.materials.extend(more.materials.into_iter().map(|mut material| {
            material.retain_textures(|used| {
                used.texture += texture;
                true
            });
            material
        }));
        let placed = more.instances.into_iter();
        self.instances.extend(placed.map(|instance| Instance {
            mesh: instance.mesh + mesh,
            material: instance.material + material,
            ..instance
        }));
        self.lights.extend(more.lights);
        self.cameras.extend(more.cameras);
    }

    /// Checks that it forms a valid scene. Takes time for instances, materials and cameras, but not for the arrays of
    /// meshes, which are already validated.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub fn check(&self) -> Result<()> {
        for (i, instance) in self.instances.iter().enumerate() {
            self.check_instance(&format_args!("instance {i}"), instance)?;
        }
        for (i, material) in self.materials.iter().enumerate() {
            material
                .check(self.textures.len())
                .map_err(|why| Error::invalid(format!("material {i} '{}'", material.name), why))?;
        }
        let unplaced = self.cameras.iter().position(|camera| !camera.world_from_view.is_finite());
        unplaced.map_or(Ok(()), |i| Err(Error::invalid(format!("the transform of camera {i}"), NOT_FINITE)))
    }

    fn check_instance(&self, at: &dyn std::fmt::Display, instance: &Instance) -> Result<()> {
        in_range(at, "mesh", instance.mesh, self.meshes.len())?;
        in_range(at, "material", instance.material, self.materials.len())?;
        match instance.world_from_object.is_finite() {
            true => Ok(()),
            false => Err(Error::invalid(format!("the transform of {at}"), NOT_FINITE)),
        }
    }
}

const NOT_FINITE: &str = "it is infinite or NaN; fix the file";

fn in_range(at: &dyn std::fmt::Display, what: &str, index: usize, count: usize) -> Result<()> {
    match index < count {
        true => Ok(()),
        false => {
            Err(Error::invalid(at.to_string(), format!("it refers to {what} {index}, but there are {count}")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Bitmap, Encoding, Sampler, Texels};

    /// A sphere with a texture.
    fn sound() -> SceneData {
        let texel = Bitmap::new(1, 1, 3, Texels::U8(vec![[9; 4]])).unwrap();
        let (sampler, transform) = (Sampler::default(), UvTransform::default());
        let map = TextureRef { texture: 0, uv_set: 0, sampler, transform };
        SceneData {
            meshes: vec![Mesh::sphere(1.0, 8, 4)],
            materials: vec![Material { base_color_texture: Some(map), ..Material::default() }],
            textures: vec![Texture::new(texel, Encoding::Srgb)],
            instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
            ..SceneData::default()
        }
    }

    fn why(change: impl FnOnce(&mut SceneData)) -> String {
        let mut scene = Scene::new(sound()).unwrap();
        let error = scene.edit(change).unwrap_err().to_string();
        assert_eq!((scene.instances(), scene.materials()), (&sound().instances[..], &sound().materials[..]));
        error
    }

    #[test]
    fn what_does_not_exist_is_refused() {
        assert!(
            why(|scene| scene.instances[0].mesh = 1)
                .contains("instance 0: it refers to mesh 1, but there are 1")
        );
        assert!(why(|scene| scene.instances[0].material = 7).contains("material 7"));
        assert!(why(|scene| scene.textures.clear()).contains("it refers to texture 0, but there are 0"));
        assert!(why(|scene| scene.meshes.clear()).contains("mesh 0, but there are 0"));
        let nowhere = Mat4::scale(Vec3::splat(f64::NAN));
        assert!(
            why(|scene| scene.instances[0].world_from_object = nowhere).contains("transform of instance 0")
        );
        let orbit =
            Orbit { azimuth: f64::NAN, elevation: 0.0, distance: 1.0, target: Vec3::default(), fov_y: 1.0 };
        assert!(why(|scene| scene.cameras.push(orbit.camera(1.0))).contains("transform of camera 0"));
    }

    #[test]
    fn factors_outside_their_ranges_are_refused() {
        let factor = |change: fn(&mut Material)| why(|scene| change(&mut scene.materials[0]));
        assert!(factor(|m| m.roughness = 1.5).contains("roughness is 1.5; it must be between 0 and 1"));
        assert!(factor(|m| m.metallic = f32::NAN).contains("metallic"));
        assert!(factor(|m| m.emissive[1] = -1.0).contains("emissive is -1; it must be between 0 and 1e12"));
        assert!(factor(|m| m.base_color[3] = f32::INFINITY).contains("base colour"));
        assert!(
            factor(|m| m.ior = 0.5).contains("ior")
                && factor(|m| m.classic.slope = Some(0.0)).contains("slope")
        );
        assert!(factor(|m| m.alpha = AlphaMode::Mask(-0.1)).contains("alpha cutoff"));
        let mut scene = Scene::new(sound()).unwrap();
        assert!(scene.edit(|scene| scene.materials[0].ior = 0.0).is_ok() && scene.materials()[0].ior == 0.0);
    }

    #[test]
    fn appended_parts_refer_to_their_own() {
        let mut scene = sound();
        scene.append(SceneData { materials: vec![Material::default(); 2], ..SceneData::default() });
        scene.append(SceneData {
            textures: vec![Texture::new(
                Bitmap::new(1, 1, 3, Texels::U8(vec![[7; 4]])).unwrap(),
                Encoding::Linear,
            )],
            ..sound()
        });
        let scene = Scene::new(scene).unwrap();
        let [first, second] = scene.instances() else { panic!("two instances") };
        assert_eq!([first.mesh, first.material], [0, 0]);
        assert_eq!([second.mesh, second.material], [1, 3]);
        let map = scene.materials()[3].base_color_texture.unwrap();
        assert_eq!(scene.textures()[map.texture].encoding(), Encoding::Linear, "its own texture");
    }

    #[test]
    fn copies_share_meshes_and_textures() {
        let scene = Scene::new(sound()).unwrap();
        let copy = scene.clone();
        assert!(std::ptr::eq(scene.meshes()[0].positions(), copy.meshes()[0].positions()));
        assert!(std::ptr::eq(scene.textures()[0].bitmap(), copy.textures()[0].bitmap()));
    }
}
