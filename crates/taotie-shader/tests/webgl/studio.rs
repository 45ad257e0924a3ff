//! A scene drawn by both the renderer and the browser: a curved patch with every texture, under every kind of light.

use std::f64::consts::PI;
use std::sync::Arc;
use taotie_engine::image::{Bitmap, Encoding, Image, Texels, Texture};
use taotie_engine::math::scalar::{cos, sin};
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::render::{EnvironmentLight, Lighting};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, Projection};
use taotie_engine::shade::environment::Environment;

/// Pixels across and down.
pub const SIDE: u32 = 96;
/// Quads along each side of the patch.
const QUADS: u32 = 24;
const FOV: f64 = 0.7;
const DISTANCE: f64 = 3.0;

/// A patch whose height over [−1, 1]² is a wave.
pub fn patch() -> Mesh {
    let mut data = MeshData::default();
    let mut sets = [Vec::new(), Vec::new()];
    for i in 0..=QUADS {
        for j in 0..=QUADS {
            let (u, v) = (f64::from(j) / f64::from(QUADS), f64::from(i) / f64::from(QUADS));
            let (x, y) = (2.0 * u - 1.0, 1.0 - 2.0 * v);
            let (slope_x, slope_y) = (0.4 * cos(2.0 * x), -0.3 * sin(1.5 * y));
            data.positions.push(Vec3::new(x, y, 0.2 * sin(2.0 * x) + 0.2 * cos(1.5 * y)).to_f32());
            data.normals.push(Vec3::new(-slope_x, -slope_y, 1.0).normalize().to_f32());
            let tangent = Vec3::new(1.0, 0.0, slope_x).normalize().to_f32();
            data.tangents.push([tangent.x, tangent.y, tangent.z, 1.0]);
            data.colors.push([0.9, 0.8 + 0.2 * u as f32, 1.0 - 0.3 * v as f32, 1.0]);
            sets[0].push(Vec2::new(u as f32, v as f32));
            sets[1].push(Vec2::new(v as f32 * 0.8, u as f32 * 1.3));
        }
    }
    data.uvs = sets.into();
    for i in 0..QUADS {
        for j in 0..QUADS {
            let at = i * (QUADS + 1) + j;
            let below = at + QUADS + 1;
            data.triangles.extend([[at, below, below + 1], [at, below + 1, at + 1]]);
        }
    }
    Mesh::new(data).expect("the patch is valid")
}

/// One texture for all roles: its colour is a gentle normal map, its alpha small, like a variance of normals.
pub fn texture() -> Texture {
    let side = 64;
    let wave = |x: u32, times: f64| sin(f64::from(x) / f64::from(side) * times * 2.0 * PI);
    let texel = |i: u32| {
        let (x, y) = (i % side, i / side);
        let [r, g] = [0.5 + 0.08 * wave(x, 2.0), 0.5 + 0.06 * wave(y, 1.0)];
        [r as f32, g as f32, 0.92, (0.05 + 0.04 * wave(x + y, 1.0)) as f32]
    };
    let texels = (0..side * side).map(texel).collect();
    let bitmap = Bitmap::new(side, side, 4, Texels::F32(texels)).expect("the size is valid");
    Texture::new(bitmap, Encoding::Linear)
}

/// A lamp of each kind, and a sky.
pub fn lighting() -> Lighting {
    let light = |kind, strength: f32, falloff| Light {
        name: String::new(),
        kind,
        color: Vec3::new(strength, strength * 0.9, strength * 0.7),
        falloff,
    };
    let position = Vec3::new(-1.0, 1.2, 1.5);
    let spot = LightKind::Spot {
        position: Vec3::new(1.2, 0.5, 2.0),
        direction: Vec3::new(-0.5, -0.2, -0.84).normalize(),
        inner: 0.3,
        outer: 0.7,
    };
    let directional = LightKind::Directional { direction: Vec3::new(0.3, -0.5, -0.8).normalize() };
    let lights = vec![
        light(directional, 1.0, Falloff::None),
        light(LightKind::Point { position }, 2.0, Falloff::Windowed(5.0)),
        light(spot, 3.0, Falloff::InverseSquare),
        light(LightKind::Point { position: -position }, 0.1, Falloff::None),
    ];
    Lighting { lights, ambient: Vec3::new(0.02, 0.03, 0.04), environment: Some(sky()) }
}

fn sky() -> EnvironmentLight {
    let mut image = Image::new(128, 64, [1.0; 4]).expect("the size is valid");
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let (u, v) = ((i % 128) as f32 / 128.0, (i / 128) as f32 / 64.0);
        let (across, down) = (u - 0.7, v - 0.3);
        let sun = 6.0 / (1.0 + 80.0 * (across * across + down * down));
        *pixel = [0.3 + sun, 0.4 + 0.3 * (1.0 - v) + sun, 0.5 + 0.5 * (1.0 - v) + sun, 1.0];
    }
    let environment = Arc::new(Environment::new(image).expect("the image is valid"));
    EnvironmentLight { environment, rotation: 0.6, intensity: 0.8, visible: false }
}

pub fn camera() -> Camera {
    Camera {
        name: String::new(),
        world_from_view: Mat4::translation(Vec3::new(0.0, 0.0, DISTANCE)),
        projection: Projection::Perspective { fov_y: FOV, aspect: None, near: 0.1, far: Some(10.0) },
    }
}

/// The transform to the clip space of WebGL.
pub fn clip_from_world() -> [[f32; 4]; 4] {
    let f = (cos(FOV / 2.0) / sin(FOV / 2.0)) as f32;
    let (near, far) = (0.1f32, 10.0f32);
    let (z, w) = ((far + near) / (near - far), 2.0 * far * near / (near - far));
    let distance = DISTANCE as f32;
    [[f, 0.0, 0.0, 0.0], [0.0, f, 0.0, 0.0], [0.0, 0.0, z, -1.0], [0.0, 0.0, w - z * distance, distance]]
}

/// The position of the camera.
pub fn eye() -> [f32; 4] {
    [0.0, 0.0, DISTANCE as f32, 1.0]
}
