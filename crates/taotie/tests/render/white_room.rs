//! In a room that is white everywhere, a white object that conserves energy is invisible.

use crate::finishes;
use crate::scenes;
use std::sync::{Arc, LazyLock};
use taotie_engine::image::Image;
use taotie_engine::render::{EnvironmentLight, Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Clearcoat, Material, Sheen};
use taotie_engine::shade::environment::Environment;
use taotie_engine::shade::{Energy, Shading};

const WHITE: [f32; 3] = [1.0; 3];

static ROOM: LazyLock<Arc<Environment>> =
    LazyLock::new(|| Environment::new(Image::new(32, 16, [1.0; 4]).unwrap()).unwrap().into());

fn room() -> Lighting {
    let light = EnvironmentLight { environment: ROOM.clone(), rotation: 0.0, intensity: 1.0, visible: true };
    Lighting { environment: Some(light), ..Lighting::default() }
}

/// Returns the minimum and maximum channel of a sphere's picture in the room.
fn extremes_with(material: Material, change: impl FnOnce(&mut RenderSettings)) -> [f32; 2] {
    let mut settings = RenderSettings { width: 64, height: 64, samples: 1, ..RenderSettings::default() };
    change(&mut settings);
    let scene = finishes::sphere(material, Vec::new());
    let (camera, room) = (scenes::camera(0.0, 0.0, 3.2), room());
    let shot = Shot { camera: &camera, lighting: &room, settings: &settings };
    let picture = render(&scene, &shot).unwrap().color;
    let channels = || picture.pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]);
    [channels().fold(f32::MAX, f32::min), channels().fold(f32::MIN, f32::max)]
}

fn extremes(material: Material) -> [f32; 2] {
    extremes_with(material, |_| {})
}

fn assert_unseen(what: &str, [least, most]: [f32; 2]) {
    assert!(least > 0.99 && most < 1.01, "{what}: {least} to {most}");
}

fn whites() -> Vec<(String, Material)> {
    let made = |metallic: f32, roughness: f32| {
        let material = Material { metallic, ..finishes::metal(WHITE, roughness) };
        (format!("metallic {metallic}, roughness {roughness}"), material)
    };
    [0.05, 0.3, 0.6, 1.0]
        .into_iter()
        .flat_map(|roughness| [made(0.0, roughness), made(1.0, roughness)])
        .collect()
}

#[test]
fn white_metals_and_dielectrics_are_unseen() {
    for (what, material) in whites() {
        assert_unseen(&what, extremes(material));
    }
}

#[test]
fn single_scattering_darkens_a_rough_metal() {
    let material = finishes::metal(WHITE, 1.0);
    let [least, _] = extremes_with(material, |settings| settings.energy = Energy::Single);
    // In the middle, at n·v = 1, exactly 1 − ln 2 of the light returns.
    assert!((f64::from(least) - (1.0 - std::f64::consts::LN_2)).abs() < 5e-3, "{least}");
}

#[test]
fn clearcoat_over_white_returns_what_arrives() {
    for (what, base) in whites() {
        for (factor, roughness) in [(1.0, 0.0), (1.0, 0.4), (1.0, 1.0), (0.5, 0.3)] {
            let coat =
                Clearcoat { factor, factor_texture: None, roughness, roughness_texture: None, normal: None };
            let coated = Material { clearcoat: Some(coat), ..base.clone() };
            assert_unseen(&format!("{what}, clearcoat of {roughness}"), extremes(coated));
        }
    }
}

#[test]
fn white_sheen_over_white_returns_what_arrives() {
    for (what, base) in whites() {
        for roughness in [0.1, 0.5, 1.0] {
            let sheen = Sheen { color: WHITE, color_texture: None, roughness, roughness_texture: None };
            let sheened = Material { sheen: Some(sheen), ..base.clone() };
            assert_unseen(&format!("{what}, sheen of {roughness}"), extremes(sheened));
        }
    }
}

#[test]
fn cook_torrance_metals_and_lambert_are_unseen_too() {
    for roughness in [0.3, 0.7, 1.0] {
        let cook_torrance = |settings: &mut RenderSettings| settings.shading = Shading::CookTorrance;
        let seen = extremes_with(finishes::metal(WHITE, roughness), cook_torrance);
        assert_unseen(&format!("roughness {roughness}"), seen);
    }
    let lambert = |settings: &mut RenderSettings| settings.shading = Shading::Lambert;
    assert_unseen("lambert", extremes_with(finishes::metal(WHITE, 0.5), lambert));
}

#[test]
fn relief_of_white_metal_is_unseen_but_where_it_mirrors_into_itself() {
    // The horizon takes light from mapped normals; nothing is added anywhere.
    let mut scene = finishes::polished_bosses(1.0, 0.4);
    scene.edit(|scene| scene.materials[0].base_color = [1.0; 4]).unwrap();
    let settings = RenderSettings { width: 96, height: 96, samples: 1, ..RenderSettings::default() };
    let (camera, room) = (scenes::camera(0.0, 0.0, 3.2), room());
    let shot = Shot { camera: &camera, lighting: &room, settings: &settings };
    let picture = render(&scene, &shot).unwrap().color;
    let mut sum = 0.0;
    for [r, ..] in picture.pixels() {
        assert!(*r < 1.01, "{r}");
        sum += f64::from(*r);
    }
    let mean = sum / picture.pixels().len() as f64;
    assert!(mean > 0.97, "{mean}");
}
