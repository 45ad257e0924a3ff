//! Third-party models.

use crate::common::absent;
use crate::compared::{View, gpu};
use crate::files::data_files;
use std::path::{Path, PathBuf};
use taotie_engine::image::{Encoding, Texture};
use taotie_engine::scene::{GreenChannel, NormalMap, NormalSpace, Orbit, Scene};
use taotie_io::{load_model, read_bitmap};

/// A scene that fills the image.
fn view(path: &Path, scene: Scene) -> View {
    let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let bounds = scene.bounds().unwrap();
    let (radius, fov_y) = (bounds.diagonal() / 2.0, 0.6);
    let orbit =
        Orbit { azimuth: 0.4, elevation: 0.25, distance: radius * 3.2, target: bounds.center(), fov_y };
    let camera = orbit.camera(radius);
    let far = crate::scenes::directional(taotie_engine::math::Vec3::new(0.6, -1.0, -0.7), 2.5);
    let mut view = View::new(name, scene, camera);
    view.lighting = crate::compared::lit(vec![far]);
    view
}

/// Khronos' sample models with this name.
fn models(stem: &str) -> Vec<PathBuf> {
    let mut models = data_files("khronos-gltf-sample-assets", &["gltf", "glb"]);
    models.retain(|path| path.file_stem().is_some_and(|found| found == stem));
    models.truncate(1);
    models
}

fn check(stem: &str) {
    let Some(gpu) = gpu() else { return };
    let models = models(stem);
    if models.is_empty() {
        return absent(&format!("{stem} is not among the models"));
    }
    for model in models {
        view(&model, load_model(&model).unwrap().scene).check(&gpu);
        let mut sky = view(&model, load_model(&model).unwrap().scene).under_sky();
        sky.name += " under a sky";
        sky.check(&gpu);
        let mut shadows = view(&model, load_model(&model).unwrap().scene);
        shadows.name += " with shadows";
        shadows.with(|settings| settings.shadows = true).check(&gpu);
    }
}

#[test]
#[ignore = "takes ten seconds"]
fn normal_tangent_test_looks_as_on_the_processor() {
    check("NormalTangentTest");
}

#[test]
fn suzanne_looks_as_on_the_processor() {
    check("Suzanne");
}

#[test]
fn water_bottle_looks_as_on_the_processor() {
    check("WaterBottle");
}

/// Scanned statues with the normal maps in the same folder.
#[test]
fn statues_look_as_on_the_processor() {
    let Some(gpu) = gpu() else { return };
    let mapped = |model: PathBuf| {
        let stem = model.file_stem()?.to_string_lossy().into_owned();
        let map = model.with_file_name(format!("{stem}_normals.png"));
        map.exists().then_some((model, map))
    };
    let statues: Vec<_> =
        data_files("threedscans-keijiro", &["obj"]).into_iter().filter_map(mapped).collect();
    if statues.is_empty() {
        return absent("there is no statue with a normal map");
    }
    for (model, map) in statues {
        view(&model, with_map(&model, &map)).check(&gpu);
    }
}

fn with_map(model: &Path, map: &Path) -> Scene {
    let mut scene = load_model(model).unwrap().scene;
    let normals = scene.add_texture(Texture::new(read_bitmap(map).unwrap(), Encoding::Normal));
    let texture = crate::scenes::plain(normals);
    let map = NormalMap { texture, scale: 1.0, space: NormalSpace::Tangent, green: GreenChannel::Up };
    scene.edit(|scene| scene.materials.iter_mut().for_each(|m| m.normal = Some(map))).unwrap();
    scene
}
