//! Procedural scenes: every surface method, every model, every layer, every kind of alpha.

use crate::compared::{View, gpu};
use crate::{finishes, scenes};
use taotie_engine::names::Named;
use taotie_engine::render::{GrazingNormals, RenderSettings, SurfaceSettings};
use taotie_engine::scene::{Material, NormalSpace, Projection, Scene, preset};
use taotie_engine::shade::{Energy, Shading};
use taotie_engine::surface::SurfaceMethod;

fn near(name: &str, scene: Scene) -> View {
    View::new(name, scene, scenes::camera(20.0, 15.0, 3.4))
}

/// Makes a scene.
type Finish = fn() -> Scene;

#[test]
fn every_model_looks_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    for (name, shading) in Shading::NAMES {
        let scene = scenes::embossed_sphere(NormalSpace::Tangent);
        near(name, scene).with(|settings| settings.shading = *shading).check(&gpu);
        let scene = finishes::sphere(preset("bronze").unwrap(), Vec::new());
        let sky = near(&format!("{name} under a sky"), scene).under_sky();
        sky.with(|settings| settings.shading = *shading).check(&gpu);
    }
}

#[test]
fn every_surface_method_looks_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    for (name, method) in SurfaceMethod::NAMES {
        let is_object = *method == SurfaceMethod::ObjectNormal;
        let space = if is_object { NormalSpace::Object } else { NormalSpace::Tangent };
        let surface = SurfaceSettings { method: Some(*method), ..SurfaceSettings::default() };
        let view = |name: &str| {
            near(name, scenes::embossed_sphere(space)).with(|settings| settings.surface = surface)
        };
        view(name).check(&gpu);
        view(&format!("{name} under a sky")).under_sky().check(&gpu);
    }
}

#[test]
fn every_layer_looks_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    let finishes: [(&str, Finish); 5] = [
        ("clearcoat", finishes::clearcoat),
        ("sheen", finishes::velvet),
        ("anisotropy", finishes::brushed),
        ("specular", finishes::tinted_glass),
        ("occlusion", || finishes::occluded_gold(0.3)),
    ];
    for (name, scene) in finishes {
        near(name, scene()).check(&gpu);
        near(&format!("{name} under a sky"), scene()).under_sky().check(&gpu);
    }
}

#[test]
fn every_option_of_reflection_looks_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    let bosses = |name| near(name, finishes::polished_bosses(2.0, 0.2)).under_sky();
    bosses("single scattering").with(|settings| settings.energy = Energy::Single).check(&gpu);
    bosses("sparkling").with(|settings| settings.specular_aa = false).check(&gpu);
    bosses("kept normals").with(|settings| settings.grazing_normals = GrazingNormals::Keep).check(&gpu);
    let glowing = Material { emissive: [0.4, 0.1, 0.0], ..Material::default() };
    near("emission", finishes::sphere(glowing, Vec::new())).check(&gpu);
    let unlit = Material { unlit: true, ..Material::default() };
    near("unlit", finishes::sphere(unlit, Vec::new())).check(&gpu);
}

#[test]
fn masks_and_panes_look_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    near("panes", scenes::panes()).check(&gpu);
    near("panes under a sky", scenes::panes()).under_sky().check(&gpu);
    near("glass", scenes::glass()).check(&gpu);
    near("glass under a sky", scenes::glass()).under_sky().check(&gpu);
}

#[test]
fn mirrored_instances_and_far_textures_look_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    let floor = || scenes::floor_and_mirrored_spheres();
    View::new("floor", floor(), scenes::camera(30.0, 8.0, 4.0)).check(&gpu);
    let mut parallel = View::new("in parallel", floor(), scenes::camera(30.0, 20.0, 4.0));
    parallel.camera.projection =
        Projection::Orthographic { half_width: 2.0, half_height: 1.5, near: 0.1, far: 20.0 };
    parallel.check(&gpu);
}

fn shadowed(view: View) -> View {
    view.with(|settings| settings.shadows = true)
}

#[test]
fn shadows_fall_where_the_processor_has_them() {
    let Some(gpu) = gpu() else { return };
    shadowed(near("shadows on bosses", scenes::embossed_sphere(NormalSpace::Tangent))).check(&gpu);
    let floor = || {
        View::new("shadows on a floor", scenes::floor_and_mirrored_spheres(), scenes::camera(30.0, 20.0, 5.0))
    };
    shadowed(floor()).check(&gpu);
    shadowed(near("shadows on clearcoat", finishes::clearcoat())).under_sky().check(&gpu);
}

#[test]
fn the_ground_is_the_processors() {
    let Some(gpu) = gpu() else { return };
    near("on the ground", scenes::embossed_sphere(NormalSpace::Tangent)).with(ground).check(&gpu);
}

#[test]
#[ignore = "takes ten seconds"]
fn the_ground_under_a_sky_is_the_processors() {
    let Some(gpu) = gpu() else { return };
    near("on the ground under a sky", scenes::panes()).under_sky().with(ground).check(&gpu);
}

fn ground(settings: &mut RenderSettings) {
    (settings.shadows, settings.ground) = (true, true);
}

#[test]
fn four_samples_lie_where_the_processor_has_them() {
    let Some(gpu) = gpu() else { return };
    let four = |view: View| view.with(|settings| settings.samples = 4);
    four(near("four samples", scenes::embossed_sphere(NormalSpace::Tangent))).check(&gpu);
    four(near("four samples of panes", scenes::panes())).check(&gpu);
    four(near("four samples under a sky", finishes::polished_bosses(1.0, 0.15)).under_sky()).check(&gpu);
}
