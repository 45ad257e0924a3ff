//! The memory estimate of a bake, compared with the memory it takes. The peak is that of the process, so this file
//! has one test.

use taotie::Bytes;
use taotie::asset::{BakeOptions, Baker, ScanFile};
use taotie_engine::Progress;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{
    GreenChannel, Instance, Material, NormalMap, NormalSpace, Scene, SceneData, TextureRef, UvTransform,
};

/// Returns a ball of a million triangles with a normal map, and without tangents.
fn mapped_ball() -> Scene {
    let data = Mesh::sphere(1.0, 1000, 501).into_data();
    let texture =
        TextureRef { texture: 0, uv_set: 0, sampler: Sampler::default(), transform: UvTransform::default() };
    let normal = NormalMap { texture, scale: 1.0, space: NormalSpace::Tangent, green: GreenChannel::Up };
    let bitmap = Bitmap::new(1, 1, 3, Texels::U8(vec![[128, 128, 255, 255]])).unwrap();
    Scene::new(SceneData {
        meshes: vec![Mesh::new(MeshData { tangents: Vec::new(), ..data }).unwrap()],
        materials: vec![Material { normal: Some(normal), ..Material::default() }],
        textures: vec![Texture::new(bitmap, Encoding::Normal)],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }],
        ..SceneData::default()
    })
    .unwrap()
}

/// Returns this process's peak memory so far; `None` if the system does not report it.
fn peak() -> Option<Bytes> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(Bytes(kib << 10))
}

#[test]
fn tangents_of_a_scan_take_what_was_said() {
    let file = ScanFile::from_scene(mapped_ball()).unwrap();
    let options = BakeOptions { triangles: 1000, size: 64, ..BakeOptions::default() };
    let need = Baker::new(options).need(file.size());
    assert!(need.scan.framed_triangles >= 1_000_000, "{need:?}");
    file.into_scan(Progress::SILENT).unwrap();
    let Some(peak) = peak() else { return };
    let said = need.bytes();
    assert!(peak <= said, "{peak} taken, {said} estimated");
    assert!(Bytes(peak.0 * 2) >= said, "{peak} taken, {said} estimated");
}
