//! Light through holes.

use crate::compared::{View, gpu};
use crate::scenes::{camera, instance, panes, plain, rectangle, texture};
use taotie_engine::image::{Encoding, Sampler, TexelFilter, Wrap};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::mesh::Mesh;
use taotie_engine::render::RenderSettings;
use taotie_engine::scene::{AlphaMode, Material, Scene, SceneData, TextureRef, UvTransform};

/// A floor under a lattice whose vertices also have opacities, with the texture of its holes mapped by `holed`.
fn lattice_over_floor(holed: TextureRef) -> Scene {
    let holes = texture(16, Encoding::Srgb, |u, v| {
        let (x, y) = (u - 0.3, v - 0.5);
        [0.8, 0.7, 0.2, f64::from(x * x + y * y > 0.06)]
    });
    let vector = Vec3::new;
    let floor = rectangle(vector(-3.0, -1.0, 3.0), vector(6.0, 0.0, 0.0), vector(0.0, 0.0, -6.0), 1.0);
    let tilted = rectangle(vector(-1.0, 0.0, 1.0), vector(2.0, 0.0, 0.0), vector(0.0, 0.6, -2.0), 1.0);
    let mut lattice = tilted.into_data();
    lattice.colors = [0.3, 1.0, 1.0, 0.6].map(|opacity| [1.0, 1.0, 1.0, opacity]).to_vec();
    let material = Material {
        alpha: AlphaMode::Mask(0.4),
        base_color: [1.0, 1.0, 1.0, 0.95],
        base_color_texture: Some(holed),
        double_sided: true,
        ..Material::default()
    };
    Scene::new(SceneData {
        meshes: vec![floor, Mesh::new(lattice).expect("it is a valid mesh")],
        materials: vec![Material::default(), material],
        textures: vec![holes],
        instances: vec![instance(0, 0, Mat4::IDENTITY), instance(1, 1, Mat4::IDENTITY)],
        ..SceneData::default()
    })
    .unwrap()
}

fn shadows(settings: &mut RenderSettings) {
    settings.shadows = true;
}

#[test]
fn panes_let_light_through_and_lattices_where_they_have_holes() {
    let Some(gpu) = gpu() else { return };
    View::new("shadows of panes", panes(), camera(20.0, 15.0, 3.4)).with(shadows).check(&gpu);
}

#[test]
fn holes_have_the_modes_of_their_texture() {
    let Some(gpu) = gpu() else { return };
    let transform = UvTransform { linear: [[3.0, 0.5], [0.0, 2.0]], offset: [0.2, -0.7] };
    let mirrored = Sampler { wrap_u: Wrap::Mirror, magnify: TexelFilter::Nearest, ..Sampler::default() };
    let clamped = Sampler { wrap_v: Wrap::Clamp, ..Sampler::default() };
    for (name, sampler) in [("a lattice", mirrored), ("a clamped lattice", clamped)] {
        let scene = lattice_over_floor(TextureRef { sampler, transform, ..plain(0) });
        View::new(name, scene, camera(30.0, 50.0, 5.0)).with(shadows).check(&gpu);
    }
}
