//! The tracer's light compared with closed forms: furnaces, closed boxes, configuration factors.

use crate::scenes;
use crate::skies;
use crate::views;
use crate::views::{View, environment_of};
use crate::walls::{
    assert_mean, assert_ways_agree, by_each_way, close_up, matt, metal, scene_of, statistics, wall,
    wall_view, white_sky,
};
use std::f64::consts::PI;
use taotie_engine::image::Image;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::mesh::Mesh;
use taotie_engine::names::Named;
use taotie_engine::render::{EnvironmentSampling, NormalMapping, ReferenceSettings};
use taotie_engine::scene::{AlphaMode, Anisotropy, Clearcoat, Material, Orbit, Sheen, Transmission};
use taotie_engine::shade::furnace::Furnace;
use taotie_engine::shade::{Energy, MaterialSample, Shading};

/// Sixteen paths of direct light.
const DIRECT: ReferenceSettings = ReferenceSettings {
    spp: 16,
    bounces: 0,
    seed: 0,
    normal_mapping: NormalMapping::Classic,
    environment: EnvironmentSampling::Combined,
};

#[test]
fn a_white_sphere_is_not_seen_in_a_white_furnace() {
    let scene = scene_of(vec![(taotie_engine::mesh::Mesh::sphere(1.0, 48, 24), matt(1.0))]);
    let mut view = View::under(white_sky(), scene, scenes::camera(20.0, 15.0, 3.4));
    (view.settings.width, view.settings.height) = (80, 60);
    view.settings.shading = Shading::Lambert;
    for (environment, bounces, spp, worst) in [
        (EnvironmentSampling::BySurface, 0, 4, 1e-5),
        (EnvironmentSampling::BySurface, 3, 4, 1e-5),
        (EnvironmentSampling::Combined, 0, 256, 0.03),
        (EnvironmentSampling::ByLight, 0, 256, 0.2),
    ] {
        let tracing = ReferenceSettings { spp, bounces, environment, ..ReferenceSettings::default() };
        let frame = view.traced(&tracing);
        for (i, pixel) in frame.color.pixels().iter().enumerate() {
            assert!((pixel[0] - 1.0).abs() < worst, "{environment:?}, pixel {i}: {}", pixel[0]);
            assert_eq!(pixel[3], 1.0);
        }
    }
}

fn white(roughness: f64) -> MaterialSample<f64> {
    let (white, black) = (Vec3::splat(1.0), Vec3::splat(0.0));
    MaterialSample {
        base_color: white,
        metallic: 1.0,
        roughness,
        f0: white,
        f90: 1.0,
        f82_drop: black,
        diffuse: black,
        specular: white,
        shininess: 20.0,
        slope: 0.3,
        compensation: None,
    }
}

#[test]
fn a_white_metal_in_a_white_furnace_gives_back_its_directional_albedo() {
    let sky = white_sky();
    for roughness in [0.1f32, 0.3, 0.6, 1.0] {
        for n_dot_v in [1.0, 0.6, 0.15] {
            let mut view = wall_view(metal(roughness), n_dot_v, sky.clone());
            view.settings.energy = Energy::Single;
            let tracing = ReferenceSettings { spp: 64, bounces: 0, ..ReferenceSettings::default() };
            let albedo =
                Furnace::default().directional_albedo(Shading::Ggx, &white(f64::from(roughness)), n_dot_v).x;
            let what = format!("roughness {roughness}, n·v {n_dot_v}");
            assert_mean(&what, &view.traced(&tracing).color, albedo, 1e-3);
            view.settings.energy = Energy::Compensated;
            assert_mean(&format!("{what}, compensated"), &view.traced(&tracing).color, 1.0, 0.01);
        }
    }
}

#[test]
fn light_between_the_walls_of_a_closed_box_is_a_geometric_series() {
    let (albedo, emitted) = (0.6f32, 0.5f32);
    let material = Material { emissive: [emitted; 3], double_sided: true, ..matt(albedo) };
    let (x, y, z) = (Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.0, 0.0, 2.0));
    let (low, high) = (Vec3::splat(-1.0), Vec3::splat(1.0));
    let walls = [(low, x, y), (low, y, z), (low, z, x), (high, -x, -y), (high, -y, -z), (high, -z, -x)];
    let parts = walls.map(|(corner, a, b)| (scenes::rectangle(corner, a, b, 1.0), material.clone()));
    let scene = scene_of(parts.into());
    let camera = Orbit { azimuth: 0.4, elevation: 0.3, distance: 0.5, target: Vec3::splat(0.0), fov_y: 1.5 };
    let mut view = View::of(scene, camera.camera(0.1));
    (view.lighting.lights, view.lighting.ambient) = (Vec::new(), Vec3::splat(0.0));
    (view.settings.width, view.settings.height) = (40, 30);
    view.settings.shading = Shading::Lambert;
    for bounces in [0, 1, 2] {
        let tracing = ReferenceSettings { spp: 2, bounces, ..ReferenceSettings::default() };
        let exact = (0..=bounces).fold(emitted, |sum, _| sum * albedo + emitted);
        for pixel in view.traced(&tracing).color.pixels() {
            assert!((pixel[0] - exact).abs() < 1e-5, "{bounces} bounces: {}, exactly {exact}", pixel[0]);
        }
    }
    let tracing = ReferenceSettings { spp: 64, bounces: 200, ..ReferenceSettings::default() };
    assert_mean("all bounces", &view.traced(&tracing).color, f64::from(emitted / (1.0 - albedo)), 1e-4);
}

/// Returns a rectangle above the origin that shines down and that cameras above look through, since they see its
/// back.
fn lamp(half: [f32; 2], height: f32) -> Mesh {
    let corner = Vec3::new(-half[0], -half[1], height);
    scenes::rectangle(corner, Vec3::new(0.0, 2.0 * half[1], 0.0), Vec3::new(2.0 * half[0], 0.0, 0.0), 1.0)
}

#[test]
fn a_lamp_lights_the_wall_by_its_configuration_factor() {
    let (half, height) = ([0.7f32, 0.4f32], 0.9f32);
    let shining = Material { emissive: [2.0; 3], ..matt(0.0) };
    let scene = scene_of(vec![(wall(), matt(0.8)), (lamp(half, height), shining)]);
    let mut view = View::of(scene, close_up(0.3));
    (view.lighting.lights, view.lighting.ambient) = (Vec::new(), Vec3::splat(0.0));
    (view.settings.width, view.settings.height) = (32, 32);
    view.settings.shading = Shading::Lambert;
    // Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3, four times.
    let [a, b] = half.map(|h| f64::from(h / height));
    let part = |p: f64, q: f64| {
        let root = (1.0 + p * p).sqrt();
        p / root * scalar::atan2(q, root)
    };
    let factor = 4.0 * (part(a, b) + part(b, a)) / (2.0 * PI);
    let tracing = ReferenceSettings { spp: 256, bounces: 0, ..ReferenceSettings::default() };
    assert_mean("wall under a lamp", &view.traced(&tracing).color, 0.8 * 2.0 * factor, 1e-3);
}

#[test]
fn panes_let_through_what_they_lack() {
    let pane = Material {
        base_color: [0.0, 0.0, 0.0, 0.4],
        alpha: AlphaMode::Blend,
        double_sided: false,
        ..Material::default()
    };
    let lit = |alpha: Option<Material>| {
        let mut parts = vec![(wall(), matt(0.5))];
        parts.extend(alpha.map(|pane| (lamp([50.0, 50.0], 1.0), pane)));
        let mut view = View::of(scene_of(parts), close_up(0.3));
        view.lighting.lights = vec![scenes::directional(Vec3::new(0.3, 0.2, -1.0), 2.0)];
        view.lighting.ambient = Vec3::splat(0.0);
        (view.settings.width, view.settings.height) = (32, 32);
        view.settings.shading = Shading::Lambert;
        view.traced(&ReferenceSettings { spp: 64, bounces: 0, ..ReferenceSettings::default() })
    };
    let [open, _] = statistics(&lit(None).color);
    assert_mean("behind a pane", &lit(Some(pane)).color, 0.6 * open, 1e-3);
    let glass = Material {
        base_color: [0.8, 1.0, 0.6, 1.0],
        transmission: Some(Transmission { factor: 0.5, texture: None }),
        ..Material::default()
    };
    // Half of what is not reflected passes, and 0.8 of that on average over the channels.
    assert_mean("behind glass", &lit(Some(glass)).color, 0.5 * 0.96 * 0.8 * open, 2e-3);
}

#[test]
fn one_bright_texel_lights_as_a_light_from_its_direction() {
    let (width, at) = (256u32, [40usize, 30usize]);
    let mut sky = Image::new(width, width / 2, [0.0, 0.0, 0.0, 1.0]).unwrap();
    let strength = 3.0;
    let angle = skies::solid_angle(width as usize, at[1]);
    let radiance = (strength / angle) as f32;
    sky.pixels_mut()[at[1] * width as usize + at[0]] = [radiance, radiance, radiance, 1.0];
    let toward = skies::direction(
        (at[0] as f64 + 0.5) / f64::from(width),
        (at[1] as f64 + 0.5) / f64::from(width / 2),
    );
    let mut floor = scenes::floor_and_mirrored_spheres();
    floor.edit(|scene| scene.materials[1].base_color_texture = None).unwrap();
    let camera = scenes::camera(-15.0, 25.0, 6.0);
    let mut by_sky = View::under(environment_of(sky), floor.clone(), camera.clone());
    let mut by_light = View::of(floor, camera);
    by_light.lighting.lights = vec![scenes::directional(-toward.to_f32(), strength as f32)];
    by_light.lighting.ambient = Vec3::splat(0.0);
    if let Some(environment) = &mut by_sky.lighting.environment {
        environment.visible = false;
    }
    for view in [&mut by_sky, &mut by_light] {
        (view.settings.width, view.settings.height) = (80, 56);
    }
    let tracing = ReferenceSettings { spp: 256, bounces: 0, ..ReferenceSettings::default() };
    let [a, b] = [&by_sky, &by_light].map(|view| view.traced(&tracing).color);
    views::keep_to_look_at("texel", &a);
    views::keep_to_look_at("texel-light", &b);
    let difference = views::difference(&views::coarse(&a, 8), &views::coarse(&b, 8));
    eprintln!("texel against light: {difference:.3} of 255");
    assert!(difference <= 0.5, "{difference}");
    let [sky, light] = [&a, &b].map(|image| statistics(image)[0]);
    assert!((sky / light - 1.0).abs() < 0.01, "{sky} {light}");
}

#[test]
fn mirrors_show_the_environment_where_it_lies() {
    let sky = |d: Vec3<f64>| d * 0.4 + Vec3::splat(0.5);
    let mut view = wall_view(metal(0.0), scalar::cos(0.6), environment_of(skies::equirect(256, sky)));
    for rotation in [0.0, 0.8, -2.0] {
        let environment = view.lighting.environment.as_mut().unwrap();
        environment.rotation = rotation;
        environment.intensity = 2.0;
        // Seen from 0.6 radians to the right of +z, the wall mirrors what is as far to the left.
        let mirrored = Vec3::new(-scalar::sin(0.6), 0.0, scalar::cos(0.6));
        let (sin, cos) = (scalar::sin(-rotation), scalar::cos(-rotation));
        let turned = Vec3::new(mirrored.x * cos + mirrored.z * sin, 0.0, mirrored.z * cos - mirrored.x * sin);
        let exact = sky(turned) * 2.0;
        let frame = view.traced(&ReferenceSettings { spp: 64, bounces: 0, ..ReferenceSettings::default() });
        let [r, g, b, _] = views::coarse(&frame.color, 32).pixel(0, 0).map(f64::from);
        assert!((Vec3::new(r, g, b) - exact).length() < 0.01, "{rotation}: {r} {g} {b}, exactly {exact:?}");
    }
}

#[test]
fn all_ways_to_find_the_environment_agree_and_both_together_are_the_best() {
    let sun = |sharpness: f64, peak: f64| {
        skies::equirect(256, move |d| {
            let cosine = d.dot(Vec3::new(-0.5, 0.3, 0.8).normalize());
            Vec3::splat(0.3 + peak * scalar::exp(sharpness * (cosine - 1.0)))
        })
    };
    for (what, roughness, sky) in [
        ("a rough wall under a small sun", 0.9, sun(2000.0, 300.0)),
        ("a smooth wall under a broad glow", 0.15, sun(20.0, 20.0)),
        ("a half-rough wall under something between", 0.4, sun(60.0, 20.0)),
    ] {
        let [both, light, surface] =
            by_each_way(&wall_view(metal(roughness), 0.8, environment_of(sky)), &DIRECT);
        eprintln!("{what}: {both:?} together, {light:?} by light, {surface:?} by surface");
        for other in [light, surface] {
            let error = ((both[1] + other[1]) / (32.0 * 32.0)).sqrt();
            assert!((both[0] - other[0]).abs() < 4.0 * error + 1e-4, "{what}: {both:?} {other:?}");
            assert!(both[1] < other[1], "{what}: {both:?} {other:?}");
        }
    }
}

#[test]
fn every_kind_of_surface_sends_paths_as_its_density_says() {
    let coat = Clearcoat {
        factor: 0.8,
        factor_texture: None,
        roughness: 0.3,
        roughness_texture: None,
        normal: None,
    };
    let sheen = Sheen { color: [0.9; 3], color_texture: None, roughness: 0.4, roughness_texture: None };
    let anisotropy = Anisotropy { strength: 0.8, rotation: 0.5, texture: None };
    let half_rough = metal(0.4);
    let materials = [
        ("clearcoat", Material { clearcoat: Some(coat), ..matt(0.1) }),
        ("clearcoat on metal", Material { clearcoat: Some(coat), ..half_rough.clone() }),
        ("sheen", Material { sheen: Some(sheen), ..matt(0.2) }),
        ("sheen on metal", Material { sheen: Some(sheen), ..half_rough.clone() }),
        ("anisotropic metal", Material { anisotropy: Some(anisotropy), ..half_rough.clone() }),
        (
            "everything",
            Material {
                clearcoat: Some(coat),
                sheen: Some(sheen),
                anisotropy: Some(anisotropy),
                ..metal(0.5)
            },
        ),
    ];
    let layered = materials.map(|(name, material)| (name, material, Shading::Ggx));
    let named = Shading::NAMES.iter().map(|(name, shading)| {
        let material = Material { metallic: 0.3, roughness: 0.5, ..matt(0.5) };
        (*name, material, *shading)
    });
    let sky = environment_of(skies::equirect(64, |d| Vec3::splat(1.0 + 0.8 * d.x + 0.5 * d.y * d.z)));
    for (name, material, shading) in layered.into_iter().chain(named) {
        for n_dot_v in [0.9, 0.3] {
            let mut view = wall_view(material.clone(), n_dot_v, sky.clone());
            view.settings.shading = shading;
            assert_ways_agree(&format!("{name} at {n_dot_v}"), &view, &DIRECT);
        }
    }
}
