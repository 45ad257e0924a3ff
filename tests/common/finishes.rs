//! Spheres that each show one surface finish, and a sky with a lamp in it.
use crate::scenes::{embossed_sphere, instance, plain, texture};
use crate::skies::equirect;
use std::f64::consts::TAU;
use taotie_engine::image::{Encoding, Image, Texture};
use taotie_engine::math::{Mat4, Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{
    Anisotropy, Clearcoat, GreenChannel, Material, NormalMap, NormalSpace, Scene, SceneData, Sheen, Specular,
};

/// Returns a unit sphere of one material.
pub fn sphere(material: Material, textures: Vec<Texture>) -> Scene {
    Scene::new(SceneData {
        meshes: vec![Mesh::sphere(1.0, 48, 24)],
        materials: vec![material],
        textures,
        instances: vec![instance(0, 0, Mat4::IDENTITY)],
        ..SceneData::default()
    })
    .unwrap()
}

/// Returns a plain metal.
pub fn metal(color: [f32; 3], roughness: f32) -> Material {
    let [r, g, b] = color;
    Material { base_color: [r, g, b, 1.0], metallic: 1.0, roughness, ..Material::default() }
}

/// Returns the embossed sphere with a changed material.
pub fn embossed(change: impl FnOnce(&mut Material)) -> Scene {
    let mut scene = embossed_sphere(NormalSpace::Tangent);
    scene.edit(|scene| change(&mut scene.materials[0])).unwrap();
    scene
}

/// Returns bosses of polished bronze with a map scaled by `scale`.
pub fn polished_bosses(scale: f32, roughness: f32) -> Scene {
    embossed(|material| {
        *material = Material { normal: material.normal, ..metal([0.9, 0.7, 0.45], roughness) };
        if let Some(map) = &mut material.normal {
            map.scale = scale;
        }
    })
}

/// Returns red paint with bosses under a clearcoat with separate waves.
pub fn clearcoat() -> Scene {
    let mut scene = embossed_sphere(NormalSpace::Tangent).into_data();
    let waves = texture(128, Encoding::Normal, |u, v| {
        let slope = 0.12 * scalar::sin(TAU * (6.0 * u + 14.0 * v));
        let n = Vec3::new(slope * 0.5, slope, 1.0).normalize();
        [n.x * 0.5 + 0.5, n.y * 0.5 + 0.5, n.z * 0.5 + 0.5, 1.0]
    });
    let cover = texture(64, Encoding::Linear, |u, v| {
        [f64::from(u < 0.5 || v > 0.35), 0.5 + 0.5 * f64::from(v > 0.6), 0.0, 1.0]
    });
    scene.textures.extend([waves, cover]);
    let base = &mut scene.materials[0];
    let normal =
        NormalMap { texture: plain(4), scale: 1.0, space: NormalSpace::Tangent, green: GreenChannel::Up };
    *base = Material {
        base_color: [0.55, 0.06, 0.04, 1.0],
        roughness: 0.55,
        normal: base.normal,
        clearcoat: Some(Clearcoat {
            factor: 1.0,
            factor_texture: Some(plain(5)),
            roughness: 0.4,
            roughness_texture: Some(plain(5)),
            normal: Some(normal),
        }),
        ..Material::default()
    };
    Scene::new(scene).unwrap()
}

/// Returns blue velvet whose fibres are finer in stripes.
pub fn velvet() -> Scene {
    let stripes = texture(64, Encoding::Srgb, |u, _| {
        let fine = 1.0 - f64::from((u * 8.0) as u32 % 2);
        [1.0, 0.85, 0.7, 0.35 + 0.65 * fine]
    });
    let sheen = Sheen {
        color: [0.9, 0.8, 0.7],
        color_texture: Some(plain(0)),
        roughness: 0.6,
        roughness_texture: Some(plain(0)),
    };
    let material = Material {
        base_color: [0.03, 0.04, 0.25, 1.0],
        roughness: 0.9,
        sheen: Some(sheen),
        ..Material::default()
    };
    sphere(material, vec![stripes])
}

/// Returns brushed steel: along the rings on one half, across them on the other, fading towards a pole.
pub fn brushed() -> Scene {
    let brush = texture(64, Encoding::Linear, |u, v| match u < 0.125 {
        true => [1.0, 0.5, 1.0 - v, 1.0],
        false => [0.5, 1.0, 1.0 - v, 1.0],
    });
    let anisotropy = Anisotropy { strength: 0.8, rotation: 0.3, texture: Some(plain(0)) };
    sphere(Material { anisotropy: Some(anisotropy), ..metal([0.75, 0.76, 0.78], 0.3) }, vec![brush])
}

/// Returns black glass of index 2.2 whose reflection is coloured, and weaker in stripes.
pub fn tinted_glass() -> Scene {
    let stripes = texture(64, Encoding::Linear, |u, _| [1.0, 1.0, 1.0, f64::from((u * 16.0) as u32 % 2)]);
    let specular =
        Specular { factor: 0.9, factor_texture: Some(plain(0)), color: [1.6, 0.7, 0.2], color_texture: None };
    let material = Material {
        base_color: [0.02, 0.02, 0.03, 1.0],
        roughness: 0.35,
        ior: 2.2,
        specular,
        ..Material::default()
    };
    sphere(material, vec![stripes])
}

/// Returns gold with bosses whose valleys are occluded.
pub fn occluded_gold(roughness: f32) -> Scene {
    let mut scene = polished_bosses(1.0, roughness);
    let valleys = texture(128, Encoding::Linear, |u, v| {
        let cell = |x: f64, n: f64| (x * n - (x * n).floor() - 0.5) * 2.0;
        let (x, y) = (cell(u, 12.0), cell(v, 6.0));
        [(1.3 - (x * x + y * y)).clamp(0.0, 1.0), 0.0, 0.0, 1.0]
    });
    scene.add_texture(valleys);
    scene.edit(|scene| scene.materials[0].occlusion_texture = Some(plain(4))).unwrap();
    scene
}

/// Returns a blue sky over a brown earth with one small lamp a hundred times as bright.
pub fn sky() -> Image {
    let lamp = Vec3::new(0.6, 0.6, 0.5292).normalize();
    equirect(128, |d| {
        let up = d.y.clamp(-1.0, 1.0);
        let air = Vec3::new(0.25, 0.4, 0.8) * up.max(0.0) + Vec3::new(0.5, 0.5, 0.45) * (1.0 - up.abs());
        let earth = Vec3::new(0.12, 0.08, 0.05) * (-up).max(0.0);
        if d.dot(lamp) > 0.985 { Vec3::new(70.0, 60.0, 45.0) } else { air + earth }
    })
}
