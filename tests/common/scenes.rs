//! Small scenes built by code, each showing one part of the renderer.

use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
use taotie_engine::math::{Mat4, Vec2, Vec3, scalar};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{
    AlphaMode, Camera, Falloff, GreenChannel, HeightMap, Instance, Light, LightKind, Material, NormalMap,
    NormalSpace, Orbit, Scene, SceneData, TextureRef, Transmission, UvTransform,
};

/// Returns a rectangle from its corner along two edges, visible from the side of their cross product, UV from 0 to
/// `repeat`.
pub fn rectangle(corner: Vec3, right: Vec3, up: Vec3, repeat: f32) -> Mesh {
    let n = right.cross(up).normalize();
    let uv = |u: f32, v: f32| Vec2::new(u * repeat, v * repeat);
    Mesh::new(MeshData {
        positions: vec![corner, corner + right, corner + right + up, corner + up],
        normals: vec![n; 4],
        uvs: vec![vec![uv(0.0, 1.0), uv(1.0, 1.0), uv(1.0, 0.0), uv(0.0, 0.0)]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    })
    .expect("a rectangle is a mesh")
}

/// Returns a texture of `size` × `size` texels from a function of UV.
pub fn texture(size: u32, encoding: Encoding, texel: impl Fn(f64, f64) -> [f64; 4]) -> Texture {
    let at = |i: u32| (f64::from(i % size) + 0.5, f64::from(i / size) + 0.5);
    let byte = |v: f64| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
    let texels = (0..size * size)
        .map(|i| {
            let (x, y) = at(i);
            texel(x / f64::from(size), y / f64::from(size)).map(byte)
        })
        .collect();
    Texture::new(Bitmap::new(size, size, 4, Texels::U8(texels)).expect("a valid size"), encoding)
}

/// Returns a plain reference to a texture.
pub fn plain(texture: usize) -> TextureRef {
    TextureRef { texture, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() }
}

/// Returns round bosses, as a height in [0, 1] over UV.
fn bosses(u: f64, v: f64) -> f64 {
    let cell = |x: f64, n: f64| (x * n - (x * n).floor() - 0.5) * 2.0;
    let (x, y) = (cell(u, 12.0), cell(v, 6.0));
    (1.0 - (x * x + y * y)).max(0.0)
}

/// Vertical extent of the bosses in model units.
const BOSS: f64 = 0.05;

/// Returns a unit sphere with bosses as height map, tangent-space or object-space normal map.
pub fn embossed_sphere(space: NormalSpace) -> Scene {
    embossed_sphere_with(space, 256, 64)
}

/// Returns the embossed sphere with its relief in `relief`² and its colours in `color`² texels.
pub fn embossed_sphere_with(space: NormalSpace, relief: u32, color: u32) -> Scene {
    let slope = |u: f64, v: f64| {
        let h = 1e-4;
        let du = (bosses(u + h, v) - bosses(u - h, v)) / (2.0 * h) * BOSS;
        let dv = (bosses(u, v + h) - bosses(u, v - h)) / (2.0 * h) * BOSS;
        (du, dv)
    };
    let normals = texture(relief, Encoding::Normal, |u, v| {
        let (theta, phi) = (std::f64::consts::PI * v, std::f64::consts::TAU * u);
        let (du, dv) = slope(u, v);
        // Slopes over arc length; green points up, against v.
        let (sx, sy) =
            (du / (std::f64::consts::TAU * scalar::sin(theta).max(0.05)), -dv / std::f64::consts::PI);
        let local = Vec3::new(-sx, -sy, 1.0).normalize();
        let n = match space {
            NormalSpace::Tangent => local,
            NormalSpace::Object => {
                let t = Vec3::new(scalar::cos(phi), 0.0, -scalar::sin(phi));
                let ring = scalar::sin(theta);
                let n = Vec3::new(ring * scalar::sin(phi), scalar::cos(theta), ring * scalar::cos(phi));
                t * local.x + n.cross(t) * local.y + n * local.z
            }
        };
        [n.x * 0.5 + 0.5, n.y * 0.5 + 0.5, n.z * 0.5 + 0.5, 1.0]
    });
    let heights = texture(relief, Encoding::Linear, |u, v| [bosses(u, v), 0.0, 0.0, 1.0]);
    let colors = texture(color, Encoding::Srgb, |u, v| match ((u * 8.0) as u32 + (v * 4.0) as u32) % 2 {
        0 => [0.85, 0.55, 0.3, 1.0],
        _ => [0.35, 0.5, 0.45, 1.0],
    });
    let orm =
        texture(color, Encoding::Linear, |u, v| [1.0 - 0.5 * v, 0.25 + 0.5 * v, f64::from(u > 0.5), 1.0]);
    let material = Material {
        base_color: [1.0; 4],
        base_color_texture: Some(plain(2)),
        metallic: 1.0,
        roughness: 1.0,
        metallic_roughness_texture: Some(plain(3)),
        occlusion_texture: Some(plain(3)),
        normal: Some(NormalMap { texture: plain(0), scale: 1.0, space, green: GreenChannel::Up }),
        height: Some(HeightMap { texture: plain(1), scale: BOSS as f32 }),
        ..Material::default()
    };
    Scene::new(SceneData {
        meshes: vec![Mesh::sphere(1.0, 32, 16)],
        materials: vec![material],
        textures: vec![normals, heights, colors, orm],
        instances: vec![instance(0, 0, Mat4::IDENTITY)],
        ..SceneData::default()
    })
    .unwrap()
}

/// Returns a checkered floor from below the camera to the horizon, with a mirrored and a squeezed sphere on it.
pub fn floor_and_mirrored_spheres() -> Scene {
    let mut scene = embossed_sphere(NormalSpace::Tangent).into_data();
    let checker = texture(32, Encoding::Srgb, |u, v| match (u > 0.5) ^ (v > 0.5) {
        true => [0.9, 0.9, 0.88, 1.0],
        false => [0.1, 0.12, 0.2, 1.0],
    });
    scene.textures.push(checker);
    let floor = Material {
        base_color: [1.0; 4],
        base_color_texture: Some(plain(4)),
        roughness: 0.9,
        ..Material::default()
    };
    scene.materials.push(floor);
    let (x, z) = (Vec3::new(200.0, 0.0, 0.0), Vec3::new(0.0, 0.0, -200.0));
    scene.meshes.push(rectangle(Vec3::new(-100.0, -1.0, 100.0), x, z, 100.0));
    let place = |x: f64, scale: Vec3<f64>| Mat4::translation(Vec3::new(x, 0.0, 0.0)) * Mat4::scale(scale);
    scene.instances = vec![
        instance(1, 1, Mat4::IDENTITY),
        instance(0, 0, place(-1.2, Vec3::new(-1.0, 1.0, 1.0))),
        instance(0, 0, place(1.2, Vec3::new(0.6, 1.0, 1.4))),
    ];
    Scene::new(scene).unwrap()
}

/// Returns panes in front of a sphere: two blended, one with holes, one seen from behind.
pub fn panes() -> Scene {
    let mut scene = embossed_sphere(NormalSpace::Tangent).into_data();
    let holes = texture(64, Encoding::Srgb, |u, v| {
        let (x, y) = (u * 6.0 - (u * 6.0).floor() - 0.5, v * 6.0 - (v * 6.0).floor() - 0.5);
        [0.8, 0.7, 0.2, 1.0 - f64::from(x * x + y * y < 0.1)]
    });
    scene.textures.push(holes);
    let pane = |color: [f32; 4], alpha| Material {
        base_color: color,
        alpha,
        double_sided: true,
        ..Material::default()
    };
    scene.materials.push(pane([0.9, 0.1, 0.1, 0.4], AlphaMode::Blend));
    scene.materials.push(pane([0.1, 0.2, 0.9, 0.6], AlphaMode::Blend));
    let mut lattice = pane([1.0; 4], AlphaMode::Mask(0.5));
    lattice.base_color_texture = Some(plain(4));
    scene.materials.push(lattice);
    let (right, up) = (Vec3::new(1.4, 0.0, 0.0), Vec3::new(0.0, 1.4, 0.0));
    scene.meshes.push(rectangle(Vec3::new(-1.6, -0.2, 1.2), right, up, 1.0));
    scene.meshes.push(rectangle(Vec3::new(-0.9, -0.9, 1.4), right, up, 1.0));
    scene.meshes.push(rectangle(Vec3::new(1.6, -1.3, 1.3), -right, up, 1.0));
    scene.instances.extend([
        instance(1, 1, Mat4::IDENTITY),
        instance(2, 2, Mat4::IDENTITY),
        instance(3, 3, Mat4::IDENTITY),
    ]);
    Scene::new(scene).unwrap()
}

/// Returns [`panes`] of glass, the lattice with a texture of transmission, without the pane that overlaps it: GPUs draw
/// blended triangles in the order of their centres.
pub fn glass() -> Scene {
    let mut scene = panes().into_data();
    scene.instances.remove(2);
    let holes = scene.materials.last().and_then(|lattice| lattice.base_color_texture);
    for material in scene.materials.iter_mut().filter(|material| material.alpha != AlphaMode::Opaque) {
        let texture = holes.filter(|_| material.alpha != AlphaMode::Blend);
        material.transmission = Some(Transmission { factor: 0.7, texture });
        material.roughness = 0.2;
        if material.alpha == AlphaMode::Blend {
            material.alpha = AlphaMode::Opaque;
        }
    }
    Scene::new(scene).unwrap()
}

/// Places a mesh.
pub fn instance(mesh: usize, material: usize, world_from_object: Mat4) -> Instance {
    Instance { mesh, material, world_from_object }
}

/// Returns a camera on an orbit about the origin; angles in degrees.
pub fn camera(azimuth: f64, elevation: f64, distance: f64) -> Camera {
    let [azimuth, elevation] = [azimuth, elevation].map(f64::to_radians);
    Orbit { azimuth, elevation, distance, target: Vec3::splat(0.0), fov_y: 0.7 }.camera(2.0)
}

/// Returns light along a direction.
pub fn directional(direction: Vec3, strength: f32) -> Light {
    light(LightKind::Directional { direction: direction.normalize() }, Vec3::splat(strength), Falloff::None)
}

/// Returns one light of every kind.
pub fn every_light() -> Vec<Light> {
    let spot = |position: Vec3| LightKind::Spot {
        position,
        direction: (-position).normalize(),
        inner: 0.15,
        outer: 0.3,
    };
    vec![
        directional(Vec3::new(0.6, -1.0, -0.7), 1.2),
        light(
            LightKind::Point { position: Vec3::new(-2.0, 2.0, 2.0) },
            Vec3::new(9.0, 6.0, 3.0),
            Falloff::InverseSquare,
        ),
        light(
            LightKind::Point { position: Vec3::new(2.5, 1.0, 1.5) },
            Vec3::new(2.0, 4.0, 9.0),
            Falloff::Windowed(4.0),
        ),
        light(spot(Vec3::new(0.0, 4.0, 3.0)), Vec3::new(30.0, 30.0, 20.0), Falloff::InverseSquare),
        light(LightKind::Point { position: Vec3::new(0.0, -3.0, 4.0) }, Vec3::splat(0.3), Falloff::None),
    ]
}

fn light(kind: LightKind, color: Vec3, falloff: Falloff) -> Light {
    Light { name: String::new(), kind, color, falloff }
}
