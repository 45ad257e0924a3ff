//! The sample images of the glTF Asset Generator: every case must look like its own image and not like another's.
//!
//! The images are lossless, but their light is not documented, so it is fitted for each case: the brightness of each
//! channel is fitted by ours and by how ours changes with the normal, which is the effect of a different light. The
//! residual must be small within the area of the case (shape, orientation, textures, relief), smaller than for any
//! other case's image, and relief must be lit from above in all of them. `target/asset-generator/` has a page with
//! ours, theirs and the difference. Points and lines are not drawn, so cases with nothing else are skipped.

use crate::common::absent;
use crate::files::data_files;
use crate::pictures;
use crate::pictures::{Picture, Row};
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;
use taotie_engine::film::{Development, develop8};
use taotie_engine::image::Image;
use taotie_engine::math::Vec3;
use taotie_engine::render::{EnvironmentLight, Lighting, RenderSettings, Shot, render};
use taotie_engine::scene::{Orbit, Scene};
use taotie_engine::shade::environment::Environment;
use taotie_io::load_model;

/// The vertical angle of view of the images, radians: Babylon's default, consistent with the size of the planes.
const FOV: f64 = 0.8;

/// Images that differ by at most this many codes on average show the same.
const SAME: f64 = 1.0;

/// The smallest share of an image's contrast that ours must explain, if it has contrast.
const EXPLAINED: f64 = 0.5;

/// The factor by which another image must fit better to count as closer: some folders show the same colours.
const CLEARLY: f64 = 0.9;

/// The largest contrast, in codes, of an image that shows only the light.
const FLAT: f64 = 12.0;

/// The number of parameters of the light: an offset, ours, and ours times the normal's x and y.
const TERMS: usize = 4;

/// The step between examined pixels; not a divisor of the width.
const STEP: usize = 7;

/// A model with its image.
struct Case {
    name: String,
    eye: [f64; 3],
    ours: Picture,
    normals: Image,
    theirs: Picture,
}

/// The light of an image, per channel.
type Fit = [[f64; TERMS]; 3];

impl Case {
    /// Creates a case; `None` if it has no image, or nothing to draw.
    fn new(folder: &Path, facts: &Value, lighting: &Lighting) -> Option<Self> {
        let name = facts["fileName"].as_str()?.to_owned();
        let theirs = Picture::read(&folder.join(facts["sampleImageName"].as_str()?));
        let scene = match load_model(folder.join(&name)) {
            Ok(loaded) => loaded.scene,
            Err(error) if error.to_string().contains("only points or lines") => {
                println!("skipped: {error}");
                return None;
            }
            Err(error) => panic!("{name}: {error}"),
        };
        let eye = [0, 1, 2].map(|i| facts["camera"]["translation"][i].as_f64().expect("a number"));
        let (ours, normals) = draw(&scene, eye, lighting, [theirs.width, theirs.height]);
        Some(Self { name, eye, ours, normals, theirs })
    }

    /// Returns the terms of a channel and the value to explain, for every pixel that ours covers.
    fn pixels<'a>(&'a self, theirs: &'a Picture, c: usize) -> impl Iterator<Item = ([f64; TERMS], f64)> + 'a {
        let all = self.ours.pixels.iter().zip(self.normals.pixels()).zip(&theirs.pixels);
        all.step_by(STEP).filter(|((ours, _), _)| ours[3] == 255).map(move |((ours, n), theirs)| {
            let shade = f64::from(ours[c]) / 255.0;
            let terms = [1.0, shade, shade * f64::from(n[0]), shade * f64::from(n[1])];
            (terms, f64::from(theirs[c]))
        })
    }

    /// Returns true if normals lean up and down on a surface that faces the camera.
    fn has_relief(&self) -> bool {
        let lean = |n: &[f32; 4]| n[3] != 0.0 && n[1].abs() > 0.3;
        self.eye[1] == 0.0 && self.normals.pixels().iter().filter(|n| lean(n)).count() > 1000
    }

    /// Returns the distance of `theirs` from ours under this light, and the contrast to be explained: root mean
    /// squares in codes.
    fn residual(&self, theirs: &Picture, fit: &Fit) -> (f64, f64) {
        let (mut left, mut contrast) = (0.0, 0.0);
        for (c, factors) in fit.iter().enumerate() {
            let (mut n, mut error, mut sum, mut squares) = (0.0, 0.0, 0.0, 0.0);
            for (terms, value) in self.pixels(theirs, c) {
                let guess: f64 = terms.iter().zip(factors).map(|(t, f)| t * f).sum();
                let apart = value - guess.clamp(0.0, 255.0);
                error += apart * apart;
                (n, sum, squares) = (n + 1.0, sum + value, squares + value * value);
            }
            left += error / n / 3.0;
            contrast += (squares / n - (sum / n) * (sum / n)) / 3.0;
        }
        (left.sqrt(), contrast.sqrt())
    }
}

/// Returns the light that best explains an image as a picture of a case: least squares.
fn fit(case: &Case, theirs: &Picture) -> Fit {
    [0, 1, 2].map(|c| {
        let mut normal = [[0.0; TERMS + 1]; TERMS];
        for (terms, value) in case.pixels(theirs, c) {
            for (row, a) in normal.iter_mut().zip(terms) {
                for (cell, b) in row.iter_mut().zip(terms) {
                    *cell += a * b;
                }
                row[TERMS] += a * value;
            }
        }
        solved(normal)
    })
}

/// Solves by Gauss–Jordan elimination, with a small term on the diagonal: images without relief do not determine all
/// terms.
fn solved(mut rows: [[f64; TERMS + 1]; TERMS]) -> [f64; TERMS] {
    for i in 0..TERMS {
        rows[i][i] += 1e-6 + 1e-9 * rows[0][0];
        let pivot = rows[i];
        for (_, row) in rows.iter_mut().enumerate().filter(|(k, _)| *k != i) {
            let factor = row[i] / pivot[i];
            row.iter_mut().zip(pivot).for_each(|(cell, p)| *cell -= factor * p);
        }
    }
    std::array::from_fn(|i| rows[i][TERMS] / rows[i][i])
}

/// Renders the picture, with the normals of the surface shown.
fn draw(
    scene: &Scene,
    [x, y, z]: [f64; 3],
    lighting: &Lighting,
    [width, height]: [u32; 2],
) -> (Picture, Image) {
    let eye = Vec3::new(x, y, z);
    let flat = (eye.x * eye.x + eye.z * eye.z).sqrt();
    let orbit = Orbit {
        azimuth: taotie_engine::math::scalar::atan2(eye.x, eye.z),
        elevation: taotie_engine::math::scalar::atan2(eye.y, flat),
        distance: eye.length(),
        target: Vec3::default(),
        fov_y: FOV,
    };
    let size = scene.corners().map(|p| p.length()).fold(0.0, f64::max);
    let settings = RenderSettings { width, height, samples: 1, aovs: true, ..RenderSettings::default() };
    let camera = orbit.camera(size);
    let frame = render(scene, &Shot { camera: &camera, lighting, settings: &settings }).unwrap();
    let picture = Picture::new(width, height, develop8(&frame.color, &Development::default()).unwrap());
    (picture, frame.aovs.expect("they were asked for").normals)
}

/// Returns a hall: bright above, darker towards the floor, with a lit wall on one side.
fn hall() -> Image {
    let (width, height) = (64, 32);
    let mut image = Image::new(width, height, [0.0, 0.0, 0.0, 1.0]).unwrap();
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i as u32 % width, i as u32 / width);
        let down = f64::from(y) / f64::from(height);
        let wall = if (8..20).contains(&x) && (8..16).contains(&y) { 1.5 } else { 0.0 };
        let light = (1.3 - down + wall) as f32;
        *pixel = [light, light, light, 1.0];
    }
    image
}

fn mean_difference(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.pixels.iter().zip(&b.pixels).step_by(STEP);
    let sum: f64 = pairs.map(|(a, b)| pictures::difference(a, b, 128.0)).sum();
    sum * STEP as f64 / a.pixels.len() as f64
}

/// Returns the fault of a case, compared with those drawn from the same place.
fn judge(case: &Case, all: &[&Case]) -> Option<String> {
    let light = fit(case, &case.theirs);
    let (own, contrast) = case.residual(&case.theirs, &light);
    println!("{}: {own:.1} of {contrast:.1} left", case.name);
    if contrast > FLAT && own * own > (1.0 - EXPLAINED) * contrast * contrast {
        return Some(format!("{}: {own:.1} of {contrast:.1} codes of contrast are not explained", case.name));
    }
    if case.has_relief() && light[1][3] <= 0.0 {
        return Some(format!("{}: its relief is lit from below", case.name));
    }
    let differing = all.iter().filter(|other| mean_difference(&other.theirs, &case.theirs) > SAME);
    let residuals = differing.map(|other| (case.residual(&other.theirs, &fit(case, &other.theirs)), other));
    // An image without contrast is explained by anything.
    let unexplained =
        |(left, contrast): (f64, f64)| if contrast > FLAT { left / contrast } else { f64::INFINITY };
    let own = unexplained((own, contrast));
    let mut nearer = residuals.filter(|(residual, _)| unexplained(*residual) < CLEARLY * own);
    let (residual, other) = nearer.next().filter(|_| own.is_finite())?;
    let other_share = unexplained(residual);
    Some(format!("{}: nearer to {} ({other_share:.2} left against {own:.2})", case.name, other.name))
}

#[test]
fn every_third_case_looks_like_its_own_sample_image() {
    look_alike(3);
}

#[test]
#[ignore = "takes half a minute"]
fn every_case_looks_like_its_own_sample_image() {
    look_alike(1);
}

/// Judges every `step`-th case.
fn look_alike(step: usize) {
    let mut manifests = data_files("gltf-asset-generator", &["json"]);
    manifests.retain(|path| path.file_name().is_some_and(|n| n == "Manifest.json"));
    if manifests.is_empty() {
        return absent("no Manifest.json in gltf-asset-generator");
    }
    let environment = Arc::new(Environment::new(hall()).unwrap());
    let light = EnvironmentLight { environment, rotation: 0.0, intensity: 1.0, visible: false };
    let lighting = Lighting { environment: Some(light), ..Lighting::default() };
    let mut cases = Vec::new();
    for manifest in &manifests {
        let facts: Value = serde_json::from_slice(&std::fs::read(manifest).unwrap()).unwrap();
        let folder = manifest.parent().expect("a file lies in a folder");
        let models = facts["models"].as_array().expect("a manifest lists models");
        cases.extend(models.iter().step_by(step).filter_map(|m| Case::new(folder, m, &lighting)));
    }
    assert!(!cases.is_empty(), "there is no case with an image");
    let mut wrong = Vec::new();
    for case in &cases {
        let size = (case.theirs.width, case.theirs.height);
        let alike =
            |other: &&Case| other.eye == case.eye && (other.theirs.width, other.theirs.height) == size;
        let all: Vec<&Case> = cases.iter().filter(alike).collect();
        wrong.extend(judge(case, &all));
    }
    let row = |Case { name, ours, theirs, .. }| Row { note: name, pictures: [ours, theirs] };
    let rows: Vec<Row> = cases.into_iter().map(row).collect();
    let page = pictures::write_page(
        &format!("asset-generator-{step}"),
        "Ours, the sample image, difference ×4",
        &rows,
    );
    assert!(wrong.is_empty(), "{}\nsee {}", wrong.join("\n"), page.display());
}
