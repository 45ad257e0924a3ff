use std::time::Instant;
use taotie::Progress;
use taotie::asset::*;
use taotie::mesh::{Mesh, MeshData};
use taotie::scene::{Material, Scene};
#[test]
#[ignore]
fn timing() {
    let ball = Mesh::sphere(1.0, 1000, 501);
    let mut data = ball.clone().into_data();
    let mut r = crate::random::Random(3);
    data.positions.iter_mut().for_each(|p| *p = *p * (1.0 + 0.0005 * r.next() as f32));
    let noisy = Mesh::new(data.clone()).unwrap();
    data.normals.clear(); data.uvs.clear();
    let bare = Mesh::new(data.clone()).unwrap();
    for (name, mesh) in [("normals", noisy.clone()), ("bare", bare.clone())] {
        for _ in 0..3 {
            let scene = Scene::of_mesh(mesh.clone(), Material::default()).unwrap();
            let file = ScanFile::from_scene(scene).unwrap();
            let t = Instant::now();
            let scan = file.into_scan(Progress::SILENT).unwrap();
            println!("{name} {} into_scan {:?} {}", mesh.triangles().len(), t.elapsed(), scan.warnings().iter().map(|w| w.0.to_owned()).collect::<String>());
        }
        let scene = Scene::of_mesh(mesh.clone(), Material::default()).unwrap();
        let scan = ScanFile::from_scene(scene).unwrap().into_scan(Progress::SILENT).unwrap();
        let t = Instant::now();
        let a = Baker::default().bake(scan, Progress::SILENT).unwrap();
        println!("{name} bake {:?} {:?}", t.elapsed(), a.warnings());
        let t = Instant::now();
        let u = taotie::bake::uncovered(&mesh, a.levels().next().unwrap(), 16384, mesh.diagonal() * 0.01);
        println!("uncovered {} {:?}", u.len(), t.elapsed());
    }
    let _ = MeshData::default();
}
