//! Coarse meshes of sound scans are valid assets: a low number of triangles does not fail a bake.

use crate::cart::cart;
use crate::files::data_files;
use taotie::Limits;
use taotie::asset::{BakeOptions, Baker, Scan};
use taotie_engine::Progress;

fn bake(name: &str, scan: &Scan, triangles: u32) {
    let options = BakeOptions { triangles, size: 256, ..BakeOptions::default() };
    let asset = Baker::new(options).bake(scan, Progress::SILENT);
    let asset = asset.unwrap_or_else(|error| panic!("{name} with {triangles} triangles: {error}"));
    let found = asset.levels().next().map_or(0, |mesh| mesh.triangles().len());
    println!("{name} with {triangles} triangles: {found}");
}

#[test]
fn coarse_meshes_of_thin_parts_are_not_refused() {
    let scan = Scan::from_mesh(cart(), Progress::SILENT).unwrap();
    [300, 1_000].into_iter().for_each(|triangles| bake("cart", &scan, triangles));
}

#[test]
fn coarse_meshes_of_scans_by_others_are_not_refused() {
    let scans =
        data_files("odedstein-meshes", &["obj"]).into_iter().chain(data_files("polyhaven-models", &["gltf"]));
    for path in scans {
        let scan = Scan::read(&path, &Limits::default(), Progress::SILENT).unwrap();
        let name = path.file_name().expect("a name").to_string_lossy();
        bake(&name, &scan, 100);
    }
}
