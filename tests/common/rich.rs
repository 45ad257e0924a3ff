//! A scene with every feature that glTF can express.
#![allow(dead_code, reason = "each test uses a part")]

use crate::bumpy;
use taotie_engine::image::{Bitmap, Encoding, MipFilter, Sampler, TexelFilter, Texels, Texture, Wrap};
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{
    AlphaMode, Anisotropy, Camera, Clearcoat, Falloff, GreenChannel, Instance, Light, LightKind, Material,
    NormalMap, NormalSpace, Orbit, Projection, Scene, SceneData, Sheen, Specular, TextureRef, UvTransform,
};

/// Returns two balls, one shown three times, in two materials with every layer and map, under four lights, with two
/// cameras.
pub fn scene() -> Scene {
    let ball = full(Mesh::sphere(1.0, 16, 8));
    let place = |x: f64, scale: Vec3<f64>| {
        let turn = Mat4::rotation_about(Vec3::new(0.6, 0.0, 0.8), 0.7);
        Mat4::translation(Vec3::new(x, 0.5, -0.25)) * turn * Mat4::scale(scale)
    };
    let instance = |mesh, material, world_from_object| Instance { mesh, material, world_from_object };
    let data = SceneData {
        meshes: vec![ball, full(bumpy::sphere(12, 6))],
        materials: vec![covered(), plain()],
        textures: textures(),
        instances: vec![
            instance(0, 0, Mat4::IDENTITY),
            instance(0, 0, place(3.0, Vec3::new(1.0, 2.0, 0.5))),
            instance(0, 1, place(-3.0, Vec3::new(-1.0, 1.0, 1.0))),
            instance(1, 1, place(6.0, Vec3::splat(0.1))),
        ],
        lights: lights(),
        cameras: cameras(),
    };
    Scene::new(data).unwrap()
}

/// Returns a mesh with two UV sets, tangents and colours.
fn full(mesh: Mesh) -> Mesh {
    let data = mesh.into_data();
    let count = data.positions.len();
    let normals = data.positions.iter().map(|p| p.normalize_or(Vec3::new(0.0, 1.0, 0.0))).collect();
    let part = |i: usize| i as f32 / count as f32;
    let first = (0..count).map(|i| Vec2::new(part(i), 1.0 - 2.0 * part(i))).collect();
    let second = (0..count).map(|i| Vec2::new(0.25, part(i))).collect();
    let tangents = (0..count).map(|i| [0.6, 0.0, 0.8, if i % 2 == 0 { 1.0 } else { -1.0 }]).collect();
    let colors = (0..count).map(|i| [part(i), 1.0, 0.5, 1.0 - part(i)]).collect();
    Mesh::new(MeshData { normals, uvs: vec![first, second], tangents, colors, ..data }).unwrap()
}

/// Returns colour with alpha, packed factors, normals of 16 bits, colour of 16 bits (kept as floats).
fn textures() -> Vec<Texture> {
    let wide = |i: u32| [(i * 509) as u16, (i * 1021) as u16, (i * 97) as u16, 65535 - (i * 250) as u16];
    let deep = Texels::U16((0..256).map(wide).collect());
    let alpha = Texels::U8((0..=255u8).map(|i| [i, 255 - i, i / 2, 255 - i / 3]).collect());
    vec![
        Texture::new(Bitmap::new(16, 16, 4, alpha).unwrap(), Encoding::Srgb),
        Texture::new(bumpy::orm(16), Encoding::Linear),
        Texture::new(bumpy::deep_normals(16, 2), Encoding::Normal),
        Texture::new(Bitmap::new(16, 16, 4, deep).unwrap(), Encoding::Srgb),
        Texture::new(bumpy::normals(16, 2), Encoding::Normal),
    ]
}

fn used(texture: usize) -> TextureRef {
    TextureRef { texture, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() }
}

/// Returns a reference on the second UV set, rotated, mirrored and without filtering.
fn turned(texture: usize) -> TextureRef {
    let sampler = Sampler {
        wrap_u: Wrap::Mirror,
        wrap_v: Wrap::Clamp,
        magnify: TexelFilter::Nearest,
        minify: TexelFilter::Linear,
        mip: MipFilter::Nearest,
    };
    let linear = [[0.6 * 2.0, 0.8 * -0.5], [-0.8 * 2.0, 0.6 * -0.5]];
    TextureRef { texture, uv_set: 1, sampler, transform: UvTransform { linear, offset: [0.25, -1.5] } }
}

/// Returns a material with every layer.
fn covered() -> Material {
    let (scale, space) = (0.75, NormalSpace::Tangent);
    let normal = |texture, green| Some(NormalMap { texture, scale, space, green });
    Material {
        name: "every \"layer\" \u{e4}".into(),
        base_color: [0.1, 0.7, 1.0, 0.6],
        base_color_texture: Some(used(0)),
        metallic: 0.3,
        roughness: 0.85,
        metallic_roughness_texture: Some(turned(1)),
        ior: 1.33,
        specular: Specular {
            factor: 0.9,
            factor_texture: Some(used(1)),
            color: [1.5, 0.5, 0.25],
            color_texture: Some(used(0)),
        },
        clearcoat: Some(Clearcoat {
            factor: 0.7,
            factor_texture: Some(used(1)),
            roughness: 0.2,
            roughness_texture: Some(turned(1)),
            normal: normal(turned(4), GreenChannel::Up),
        }),
        anisotropy: Some(Anisotropy { strength: 0.5, rotation: 0.25, texture: Some(turned(1)) }),
        sheen: Some(Sheen {
            color: [0.2, 0.4, 1.0],
            color_texture: Some(used(3)),
            roughness: 0.35,
            roughness_texture: Some(used(1)),
        }),
        normal: normal(turned(2), GreenChannel::Down),
        occlusion_texture: Some(used(1)),
        occlusion_strength: 0.4,
        emissive: [7.0, 0.3, 1.1],
        emissive_texture: Some(used(3)),
        alpha: AlphaMode::Mask(0.3),
        double_sided: true,
        ..Material::default()
    }
}

fn plain() -> Material {
    Material {
        name: "plain".into(),
        base_color_texture: Some(turned(3)),
        emissive: [0.3, 0.2, 0.1],
        alpha: AlphaMode::Blend,
        unlit: true,
        ..Material::default()
    }
}

fn lights() -> Vec<Light> {
    let (position, direction) = (Vec3::new(1.0, -2.0, 3.0), Vec3::new(0.48, -0.6, 0.64));
    let light = |name: &str, kind, falloff| Light {
        name: name.into(),
        kind,
        color: Vec3::new(30.0, 20.0, 0.7),
        falloff,
    };
    let spot = LightKind::Spot { position, direction, inner: 0.25, outer: 0.5 };
    vec![
        light("sun", LightKind::Directional { direction }, Falloff::InverseSquare),
        light("bulb", LightKind::Point { position }, Falloff::Windowed(12.5)),
        light("", spot, Falloff::InverseSquare),
        Light {
            color: Vec3::splat(0.0),
            ..light("off", LightKind::Point { position }, Falloff::InverseSquare)
        },
    ]
}

fn cameras() -> Vec<Camera> {
    let orbit = Orbit { azimuth: 0.4, elevation: 0.3, distance: 9.0, target: Vec3::default(), fov_y: 0.7 };
    let near = orbit.camera(2.0);
    let view = Projection::Orthographic { half_width: 4.0, half_height: 3.0, near: 0.1, far: 50.0 };
    vec![Camera { name: "plan".into(), projection: view, ..near.clone() }, near]
}
