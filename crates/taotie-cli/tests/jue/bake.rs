//! The bronze jue at a million triangles, simplified and baked: its relief is recovered.

use taotie_engine::Progress;
use taotie_engine::bake::{
    BakeInput, BakeSettings, Cage, Plane, Scan, SimplifyOptions, TexturedMesh, UnwrapOptions, Verifier, bake,
    simplify, unwrap,
};
use taotie_engine::image::{Encoding, Texture};
use taotie_engine::mesh::Mesh;
use taotie_engine::normal_map::{Storage, store_unit_vectors};
use taotie_engine::scene::{GreenChannel, Material, NormalMap, NormalSpace, Scene, TextureRef, UvTransform};
use taotie_engine::surface::with_frames;
use taotie_io::gltf_sampler;
use taotie_study::jue;

fn scan(mesh: Mesh) -> Scan {
    Scan::new(Scene::of_mesh(mesh, Material::default()).unwrap()).unwrap()
}

/// The relief's lines are two tenths of a millimetre wide; on a map of half this size each is only a texel.
const SIZE: u32 = 4096;

#[test]
#[ignore = "bakes a million triangles at 4096², which takes half a minute"]
fn a_million_triangles_on_two_thousand_show_the_relief_that_the_formulas_say() {
    // The normals of the displaced mesh come from the relief's formulas, not from its facets.
    let truth = jue::displaced_mesh(jue::FINEST);
    assert!(truth.triangles().len() > 1_000_000, "{}", truth.triangles().len());
    let scanned = scan(truth);
    let options = SimplifyOptions { triangles: 2000, ..SimplifyOptions::default() };
    let low = simplify(scanned.mesh(), &options, Progress::SILENT).unwrap();
    assert!(low.reached, "{:?}", low.method);
    let low = unwrap(&low.mesh, &UnwrapOptions { size: SIZE, padding: 4 }, Progress::SILENT).unwrap().mesh;
    let low = with_frames(&low, 0, None).unwrap().0.into_owned();
    let cage = Cage::automatic(&low, &scanned);
    let settings = BakeSettings { size: [SIZE; 2], side: 1, ..BakeSettings::default() };
    let baked =
        bake(BakeInput { low: &low, cage: &cage, scan: &scanned }, &settings, Progress::SILENT).unwrap();
    let storage = Storage { bits: 8, dither: true };
    let bitmap = store_unit_vectors(baked.maps.size(), baked.maps.vectors(Plane::Normal), storage).unwrap();
    let texture = Texture::new(bitmap, Encoding::Normal);

    let texture_0 = TextureRef {
        texture: 0,
        uv_set: 0,
        sampler: gltf_sampler([&low]),
        transform: UvTransform::default(),
    };
    let (space, green) = (NormalSpace::Tangent, GreenChannel::Up);
    let normal = Some(NormalMap { texture: texture_0, scale: 1.0, space, green });
    let mut scene = Scene::of_mesh(low.clone(), Material::default()).unwrap();
    let material = Material { normal, ..Material::default() };
    scene.edit(|scene| (scene.textures, scene.materials) = (vec![texture], vec![material])).unwrap();
    let shown = TexturedMesh::new(scene).unwrap();
    let verifier = Verifier { mesh: &low, shown: Some(&shown), cage: &cage, scan: &scanned };
    let angles = verifier.normal_error(100_000).unwrap().angles.summary().unwrap();
    assert!(angles.mean < 1.0, "{angles:?}");
}
