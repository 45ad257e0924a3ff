//! Scenes: meshes, materials, textures, instances, lights, cameras, and how they move. Data, and the poses that follow
//! from it.

pub mod animation;
mod bounds;
mod camera;
mod data;
mod light;
mod material;
mod material_check;
mod material_textures;
mod outline;
mod presets;

pub use bounds::Bounds;
pub use camera::{Camera, Orbit, Projection, fitting_distance, rigid};
pub use data::{Instance, SceneData};
pub use light::{Falloff, Light, LightKind, from_view, three_point_rig};
pub use material::{
    AlphaMode, Anisotropy, Classic, Clearcoat, GreenChannel, HeightMap, Material, NormalMap, NormalSpace,
    Sheen, Specular, TextureRef, UvTransform,
};
pub use outline::Outline;
pub use presets::{PRESETS, Preset, preset};

use crate::error::Result;
use crate::image::Texture;
use crate::math::{Mat4, Vec3};
use crate::mesh::Mesh;

/// A scene: every index in it is in range, every transform of an instance or camera finite, every factor of a material
/// within its range.
///
/// A mesh may lack the uv set that a material names: textures are then read at uv (0, 0), and maps of normals and
/// heights left out with a warning.
///
/// A copy is cheap: it shares meshes and textures with its original.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    data: SceneData,
}

impl Scene {
    /// Checks `data`.
    ///
    /// # Errors
    /// [`crate::Error::Invalid`] naming the first part that does not fit: an instance whose mesh or material is not
    /// there, a transform that is infinite or NaN, a material whose texture is not there or whose factor is out of
    /// range.
    pub fn new(data: SceneData) -> Result<Self> {
        data.check()?;
        Ok(Self { data })
    }

    /// Returns a scene of one mesh of one material that stands where it is.
    ///
    /// # Errors
    /// As [`Self::new`]: a factor of the material is out of range, or it names a texture.
    pub fn of_mesh(mesh: Mesh, material: Material) -> Result<Self> {
        let instances = vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }];
        Self::new(SceneData {
            meshes: vec![mesh],
            materials: vec![material],
            instances,
            ..SceneData::default()
        })
    }

    /// Changes parts and checks them again. Meshes are not read, so this costs little.
    ///
    /// # Errors
    /// As [`Self::new`]; the scene is then unchanged.
    pub fn edit(&mut self, change: impl FnOnce(&mut SceneData)) -> Result<()> {
        let mut data = self.data.clone();
        change(&mut data);
        *self = Self::new(data)?;
        Ok(())
    }

    /// Adds a texture and returns its index, for materials to name.
    pub fn add_texture(&mut self, texture: Texture) -> usize {
        self.data.textures.push(texture);
        self.data.textures.len() - 1
    }

    /// Gives the parts back, to change them and check them again.
    pub fn into_data(self) -> SceneData {
        self.data
    }

    /// The parts.
    pub fn data(&self) -> &SceneData {
        &self.data
    }

    /// The meshes, object space.
    pub fn meshes(&self) -> &[Mesh] {
        &self.data.meshes
    }

    /// The materials.
    pub fn materials(&self) -> &[Material] {
        &self.data.materials
    }

    /// The textures that materials name by index.
    pub fn textures(&self) -> &[Texture] {
        &self.data.textures
    }

    /// Meshes placed in the world.
    pub fn instances(&self) -> &[Instance] {
        &self.data.instances
    }

    /// The lights of the file, world space.
    pub fn lights(&self) -> &[Light] {
        &self.data.lights
    }

    /// The cameras of the file, world space.
    pub fn cameras(&self) -> &[Camera] {
        &self.data.cameras
    }

    /// The world-space box around every triangle's corners, or `None` where there is no triangle.
    pub fn bounds(&self) -> Option<Bounds> {
        Outline::new(self).bounds()
    }

    /// Every corner of every triangle, world space, as often as it is used.
    pub fn corners(&self) -> impl Iterator<Item = Vec3<f64>> + '_ {
        self.instances().iter().flat_map(|instance| {
            let mesh = &self.meshes()[instance.mesh];
            mesh.triangles().iter().flatten().map(|index| {
                instance.world_from_object.transform_point(mesh.positions()[*index as usize].to_f64())
            })
        })
    }

    /// The number of triangles that the instances draw.
    pub fn triangle_count(&self) -> usize {
        self.instances().iter().map(|i| self.meshes()[i.mesh].triangles().len()).sum()
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
            why(|scene| scene.instances[0].mesh = 1).contains("instance 0: it names mesh 1, but there are 1")
        );
        assert!(why(|scene| scene.instances[0].material = 7).contains("material 7"));
        assert!(why(|scene| scene.textures.clear()).contains("it names texture 0, but there are 0"));
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
    fn copies_share_meshes_and_textures() {
        let scene = Scene::new(sound()).unwrap();
        let copy = scene.clone();
        assert!(std::ptr::eq(scene.meshes()[0].positions(), copy.meshes()[0].positions()));
        assert!(std::ptr::eq(scene.textures()[0].bitmap(), copy.textures()[0].bitmap()));
    }
}
