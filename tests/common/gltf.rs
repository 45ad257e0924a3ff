//! Small glTF files made for tests, and the promises of every reader about its results.

use std::path::Path;
use taotie_engine::image::Encoding;
use taotie_engine::math::Vec3;
use taotie_engine::scene::Scene;
use taotie_engine::scene::animation::Rig;
use taotie_io::{Loaded, load_model};

/// Loads a file, or fails with a one-line error that names it.
pub fn load(path: &Path) -> Result<Loaded, String> {
    let loaded = load_model(path).map_err(|error| {
        let text = error.to_string();
        assert!(!text.contains('\n'), "{text}");
        assert!(text.contains(&*path.file_name().unwrap().to_string_lossy()), "{text}");
        text
    })?;
    check_scene(&loaded, path);
    Ok(loaded)
}

/// Checks every reader's promises about a scene.
fn check_scene(loaded: &Loaded, path: &Path) {
    check_meshes(loaded, &loaded.scene, path);
    assert!(loaded.warnings.iter().all(|(what, _)| !what.contains('\n')));
    if let Some(rig) = &loaded.rig {
        check_rig(loaded, rig, path);
    }
}

/// Checks that a rig at rest gives the scene as read, to the last bit; its poses keep the promises or fail in one
/// line.
fn check_rig(loaded: &Loaded, rig: &Rig, path: &Path) {
    let mut scene = loaded.scene.clone();
    for (animation, motion) in rig.animations().iter().enumerate() {
        for part in [0.0, 0.3, 1.0, 2.0] {
            match rig.pose(&mut scene, animation, motion.seconds() * part) {
                Ok(()) => check_meshes(loaded, &scene, path),
                Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
            }
        }
    }
    rig.rest(&mut scene).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    assert_same(&scene, &loaded.scene);
}

/// Asserts that two scenes have the same geometry, cameras and lights to the last bit.
pub fn assert_same(a: &Scene, b: &Scene) {
    for (a, b) in a.meshes().iter().zip(b.meshes()) {
        let bits = |v: &[Vec3]| v.iter().map(|v| v.to_array().map(f32::to_bits)).collect::<Vec<_>>();
        assert_eq!(bits(a.positions()), bits(b.positions()));
        assert_eq!(bits(a.normals()), bits(b.normals()));
        assert_eq!((a.tangents(), a.uvs(), a.colors()), (b.tangents(), b.uvs(), b.colors()));
        assert_eq!(a.triangles(), b.triangles());
    }
    let places = |scene: &Scene| scene.instances().iter().map(|i| i.world_from_object).collect::<Vec<_>>();
    assert_eq!(places(a), places(b));
    assert_eq!((a.cameras(), a.lights()), (b.cameras(), b.lights()));
}

fn check_meshes(loaded: &Loaded, scene: &Scene, path: &Path) {
    assert!(scene.triangle_count() > 0, "{}", path.display());
    assert!(scene.bounds().is_some_and(|b| b.diagonal().is_finite()), "{}", path.display());
    assert_eq!(loaded.texture_names.len(), scene.textures().len());
    assert_eq!(loaded.mesh_names.len(), scene.meshes().len());
    for instance in scene.instances() {
        let (mesh, material) = (&scene.meshes()[instance.mesh], &scene.materials()[instance.material]);
        assert_eq!(mesh.normals().len(), mesh.positions().len());
        assert!(mesh.normals().iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{}", path.display());
        let (normal, coat) = (material.normal.map(|n| n.texture), material.clearcoat);
        let slots = [
            material.base_color_texture,
            material.emissive_texture,
            material.specular.color_texture,
            material.sheen.and_then(|sheen| sheen.color_texture),
        ];
        let linear = [
            material.metallic_roughness_texture,
            material.occlusion_texture,
            material.specular.factor_texture,
            coat.and_then(|coat| coat.factor_texture),
            coat.and_then(|coat| coat.roughness_texture),
            material.anisotropy.and_then(|anisotropy| anisotropy.texture),
            material.sheen.and_then(|sheen| sheen.roughness_texture),
        ];
        let normals = [normal, coat.and_then(|coat| coat.normal).map(|n| n.texture)];
        let used = slots.iter().chain(&linear).chain(&normals).flatten().count();
        assert_eq!(material.textures().len(), used, "{}", path.display());
        let kinds =
            [(&slots[..], Encoding::Srgb), (&linear[..], Encoding::Linear), (&normals[..], Encoding::Normal)];
        for (slots, encoding) in kinds {
            for slot in slots.iter().flatten() {
                assert_eq!(scene.textures()[slot.texture].encoding(), encoding, "{}", path.display());
                assert!(slot.uv_set < mesh.uvs().len(), "{}", path.display());
            }
        }
    }
}

/// A glTF file under construction: JSON with a buffer that is filled piece by piece.
#[derive(Default)]
pub struct Maker {
    pub bytes: Vec<u8>,
    pub views: Vec<String>,
    pub accessors: Vec<String>,
}

impl Maker {
    /// Adds a view and returns its number.
    pub fn view(&mut self, bytes: &[u8], more: &str) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{offset},"byteLength":{length}{more}}}"#));
        self.bytes.extend_from_slice(bytes);
        self.views.len() - 1
    }

    /// Adds an accessor with a separate view and returns its number.
    pub fn accessor(
        &mut self,
        bytes: &[u8],
        (count, component, kind): (usize, u32, &str),
        more: &str,
    ) -> usize {
        let view = self.view(bytes, "");
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"count":{count},"componentType":{component},"type":"{kind}"{more}}}"#
        ));
        self.accessors.len() - 1
    }

    pub fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let width = ["SCALAR", "VEC2", "VEC3", "VEC4"].iter().position(|k| *k == kind).map_or(16, |w| w + 1);
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, (values.len() / width, 5126, kind), "")
    }

    pub fn text(&self, rest: &str) -> String {
        use base64::Engine;
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{},"uri":"data:;base64,{data}"}}],
            "bufferViews":[{}],"accessors":[{}],{rest}}}"#,
            self.bytes.len(),
            self.views.join(","),
            self.accessors.join(",")
        )
    }

    pub fn load(&self, rest: &str) -> Loaded {
        self.try_load(rest).unwrap_or_else(|e| panic!("{e}"))
    }

    pub fn try_load(&self, rest: &str) -> Result<Loaded, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("made.gltf");
        std::fs::write(&path, self.text(rest)).unwrap();
        load(&path)
    }
}

pub const TRIANGLE: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// Returns scene, node and mesh of one primitive with the given attributes and members.
pub fn one_primitive(attributes: &str, more: &str) -> String {
    format!(r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{{attributes}}}{more}}}]}}]"#)
}

/// An image of one texel.
pub const PIXEL: &str = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmMIQAAAABJRU5ErkJggg==";

/// Returns a file with one triangle, whose POSITION is accessor 0.
pub fn triangle() -> Maker {
    let mut maker = Maker::default();
    maker.floats(&TRIANGLE, "VEC3");
    maker
}

pub fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

pub fn warned(loaded: &Loaded, part: &str) -> usize {
    loaded.warnings.iter().filter(|(what, _)| what.contains(part)).map(|(_, count)| count).sum()
}
