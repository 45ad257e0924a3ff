//! Mapped normals in the tracer: classic and as grooves of two facets.

use crate::scenes;
use crate::skies;
use crate::views::{View, environment_of};
use crate::walls::{assert_mean, assert_ways_agree, matt, metal, statistics, wall_view, white_sky};
use taotie_engine::image::Encoding;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::names::Named;
use taotie_engine::render::{
    EnvironmentLight, EnvironmentSampling, GrazingNormals, NormalMapping, ReferenceSettings, render,
};
use taotie_engine::scene::{Clearcoat, GreenChannel, Material, NormalMap, NormalSpace};
use taotie_engine::shade::Shading;

const GROOVED: ReferenceSettings = ReferenceSettings {
    spp: 64,
    bounces: 0,
    seed: 0,
    normal_mapping: NormalMapping::Microfacet,
    environment: EnvironmentSampling::Combined,
};

/// Returns a wall whose map leans by `tilt_deg` to the left, away from the camera, with the cosine of the map's tilt.
fn leaning_wall(material: Material, tilt_deg: f64, n_dot_v: f64, sky: EnvironmentLight) -> (View, f64) {
    let tilt = tilt_deg.to_radians();
    let mut view = wall_view(material, n_dot_v, sky);
    let stored = [-scalar::sin(tilt) * 0.5 + 0.5, 0.5, scalar::cos(tilt) * 0.5 + 0.5, 1.0];
    view.scene.add_texture(scenes::texture(4, Encoding::Linear, |_, _| stored));
    let (space, green) = (NormalSpace::Tangent, GreenChannel::Up);
    let map = NormalMap { texture: scenes::plain(0), scale: 1.0, space, green };
    view.scene.edit(|scene| scene.materials[0].normal = Some(map)).unwrap();
    let [x, y, z] = [0, 1, 2].map(|c| (stored[c] * 255.0 + 0.5).floor() / 255.0 * 2.0 - 1.0);
    (view, z / (x * x + y * y + z * z).sqrt())
}

#[test]
fn a_white_matt_map_in_a_furnace_reflects_the_cosine_of_its_tilt() {
    let sky = white_sky();
    for tilt in [0.0, 20.0, 50.0] {
        for n_dot_v in [0.9, 0.2] {
            let (mut view, cosine) = leaning_wall(matt(1.0), tilt, n_dot_v, sky.clone());
            view.settings.shading = Shading::Lambert;
            let what = format!("grooves of {tilt}° seen at {n_dot_v}");
            assert_mean(&what, &view.traced(&GROOVED).color, cosine, 1e-3);
            // Part of the hemisphere about the mapped normal is below the wall, which occludes it.
            view.settings.grazing_normals = GrazingNormals::Keep;
            let classic = ReferenceSettings { normal_mapping: NormalMapping::Classic, ..GROOVED };
            let what = format!("a classic map of {tilt}° seen at {n_dot_v}");
            assert_mean(&what, &view.traced(&classic).color, (1.0 + cosine) / 2.0, 1e-3);
        }
    }
}

/// In a white room a mapped surface returns no more than arrives, with the default treatment of grazing normals.
#[test]
fn no_bent_normal_makes_light() {
    let classic = ReferenceSettings { normal_mapping: NormalMapping::Classic, ..GROOVED };
    for (name, material) in [("matt", matt(1.0)), ("metal", metal(0.4))] {
        for tilt in [0.0, 30.0, 60.0, 80.0] {
            for n_dot_v in [0.9, 0.4, 0.1] {
                let (view, _) = leaning_wall(material.clone(), tilt, n_dot_v, white_sky());
                let [traced, _] = statistics(&view.traced(&classic).color);
                let [drawn, _] = statistics(&render(&view.scene, &view.shot()).unwrap().color);
                eprintln!("{name}, a map of {tilt}° seen at {n_dot_v}: {traced} traced, {drawn} drawn");
                assert!(traced < 1.002 && drawn < 1.002, "{name}, a map of {tilt}° seen at {n_dot_v}");
            }
        }
    }
}

#[test]
fn maps_that_turn_away_from_the_viewer_are_not_black_in_grooves() {
    let (mut view, cosine) = leaning_wall(metal(0.3), 40.0, 0.25, white_sky());
    assert!(cosine < 0.8);
    view.settings.grazing_normals = GrazingNormals::Keep;
    let [grooved, _] = statistics(&view.traced(&GROOVED).color);
    let classic = ReferenceSettings { normal_mapping: NormalMapping::Classic, ..GROOVED };
    let [classic, _] = statistics(&view.traced(&classic).color);
    eprintln!("{grooved} grooved, {classic} classic");
    assert!(grooved > 0.6 && grooved <= 1.0, "{grooved}");
    assert!(classic < 0.5 * grooved, "{classic}");
}

#[test]
fn grooves_send_paths_as_their_density_says() {
    let coat = Clearcoat {
        factor: 0.8,
        factor_texture: None,
        roughness: 0.3,
        roughness_texture: None,
        normal: None,
    };
    let named = Shading::NAMES
        .iter()
        .map(|(name, shading)| (*name, Material { metallic: 0.3, roughness: 0.5, ..matt(0.5) }, *shading));
    let coated = [("clearcoat on metal", Material { clearcoat: Some(coat), ..metal(0.4) }, Shading::Ggx)];
    let sky = environment_of(skies::equirect(64, |d| Vec3::splat(1.0 + 0.8 * d.x + 0.5 * d.y * d.z)));
    for (name, material, shading) in named.chain(coated) {
        for n_dot_v in [0.9, 0.3] {
            let (mut view, _) = leaning_wall(material.clone(), 30.0, n_dot_v, sky.clone());
            view.settings.shading = shading;
            assert_ways_agree(&format!("{name} at {n_dot_v}"), &view, &GROOVED);
        }
    }
}

#[test]
fn a_flat_map_is_the_same_in_both_ways() {
    let (view, _) = leaning_wall(metal(0.5), 0.0, 0.7, environment_of(skies::speckled(16)));
    let classic = ReferenceSettings { normal_mapping: NormalMapping::Classic, ..GROOVED };
    let [grooved, classic] = [GROOVED, classic].map(|tracing| statistics(&view.traced(&tracing).color));
    let error = ((grooved[1] + classic[1]) / (32.0 * 32.0)).sqrt();
    assert!((grooved[0] - classic[0]).abs() < 4.0 * error, "{grooved:?} {classic:?}");
}
