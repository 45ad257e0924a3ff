//! Khronos' NormalTangentTest: cells of real relief next to cells with the same relief as a normal map, in several
//! orientations. Seen head-on, both must have the same normals; a rotated or mirrored tangent frame would show.

use crate::common::absent;
use crate::files::data_files;
use taotie_engine::image::Image;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::render::{Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::Orbit;

const SIDE: u32 = 768;

/// Returns normals seen head-on, from far enough away that perspective does not separate relief from map.
fn normals(model: &std::path::Path) -> Image {
    let scene = taotie_io::load_model(model).unwrap().scene;
    let bounds = scene.bounds().unwrap();
    let fov_y = 0.02;
    let size = (bounds.max - bounds.min).y.max((bounds.max - bounds.min).x);
    let distance = size / fov_y * 1.1;
    let orbit = Orbit { azimuth: 0.0, elevation: 0.0, distance, target: bounds.center(), fov_y };
    let settings =
        RenderSettings { width: SIDE, height: SIDE, samples: 1, aovs: true, ..RenderSettings::default() };
    let (camera, lighting) = (orbit.camera(size), Lighting::default());
    let shot = Shot { camera: &camera, lighting: &lighting, settings: &settings };
    let frame = render(&scene, &shot).unwrap();
    frame.aovs.unwrap().normals
}

/// Returns the ranges of pixels, first and last, along a line where anything was seen.
fn stretches(seen: impl Fn(u32) -> bool) -> Vec<(u32, u32)> {
    let mut found: Vec<(u32, u32)> = Vec::new();
    for i in (0..SIDE).filter(|i| seen(*i)) {
        match found.last_mut() {
            Some((_, last)) if *last + 1 == i => *last = i,
            _ => found.push((i, i)),
        }
    }
    found
}

/// Returns the angles in degrees between the normals of two square cells, within the disc of their relief.
fn angles(image: &Image, left: (u32, u32), right: (u32, u32), rows: (u32, u32)) -> Vec<f64> {
    let side = (left.1 - left.0).min(right.1 - right.0).min(rows.1 - rows.0);
    let middle = f64::from(side) / 2.0;
    let mut found = Vec::new();
    for i in 0..side * side {
        let (x, y) = (i % side, i / side);
        let (dx, dy) = (f64::from(x) - middle, f64::from(y) - middle);
        if dx * dx + dy * dy < (0.27 * f64::from(side)) * (0.27 * f64::from(side)) {
            let at = |column: u32| {
                let [x, y, z, _] = image.pixel(column + x, rows.0 + y);
                Vec3::new(x, y, z).to_f64()
            };
            let cos = at(left.0).dot(at(right.0)).clamp(-1.0, 1.0);
            found.push(scalar::acos(cos).to_degrees());
        }
    }
    found.sort_by(f64::total_cmp);
    found
}

#[test]
fn mapped_relief_has_the_normals_of_real_relief_in_every_orientation() {
    let mut models = data_files("khronos-gltf-sample-assets", &["gltf", "glb"]);
    models.retain(|path| path.file_stem().is_some_and(|stem| stem == "NormalTangentTest"));
    let Some(model) = models.pop() else {
        return absent("NormalTangentTest is not among the models");
    };
    let image = normals(&model);
    let seen = |x: u32, y: u32| image.pixel(x, y)[3] != 0.0;
    let rows = stretches(|y| (0..SIDE).any(|x| seen(x, y)));
    let mut cells = 0;
    for row in &rows {
        let middle = (row.0 + row.1) / 2;
        let height = row.1 - row.0;
        // Cells are square; the legend below them is not.
        let columns: Vec<(u32, u32)> = stretches(|x| seen(x, middle))
            .into_iter()
            .filter(|c| (c.1 - c.0).abs_diff(height) <= 2)
            .collect();
        for pair in columns.chunks_exact(2) {
            let angles = angles(&image, pair[0], pair[1], *row);
            let (median, most) = (angles[angles.len() / 2], angles[angles.len() * 95 / 100]);
            println!("{pair:?} {row:?}: median {median:.2}°, 95 in 100 below {most:.2}°");
            assert!(median < 2.5 && most < 4.0, "{pair:?} {row:?}: median {median:.2}°, {most:.2}°");
            cells += 1;
        }
    }
    assert!(cells >= 10, "{cells} pairs found in {rows:?}");
}
