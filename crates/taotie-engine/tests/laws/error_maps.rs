//! Error maps are laid out like the maps of the material, whatever uvs a file stores.

use taotie_engine::bake::{self, Cage, ErrorMaps, TexelChecks, TexturedMesh, Verifier};
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture};
use taotie_engine::math::Vec2;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Material, Scene, TextureRef, UvTransform};

/// A ball with a texture in this uv set and transform, whose uv sets are derived from those that cover the map.
fn ball((uv_set, transform): (usize, UvTransform), sets: &[fn(Vec2) -> Vec2]) -> Scene {
    let data = Mesh::sphere(1.0, 24, 12).into_data();
    let uvs = sets.iter().map(|set| data.uvs[0].iter().map(|uv| set(*uv)).collect()).collect();
    let texel = |i: usize| [(i % 8 * 30) as u8, (i / 8 * 30) as u8, 90, 255];
    let bitmap = Bitmap::new(8, 8, 3, Texels::U8((0..64).map(texel).collect())).unwrap();
    let used = TextureRef { texture: 0, uv_set, sampler: Sampler::default(), transform };
    let mut scene =
        Scene::of_mesh(Mesh::new(MeshData { uvs, ..data }).unwrap(), Material::default()).unwrap();
    let material = Material { base_color_texture: Some(used), ..Material::default() };
    let textures = vec![Texture::new(bitmap, Encoding::Srgb)];
    scene.edit(|scene| (scene.textures, scene.materials) = (textures, vec![material])).unwrap();
    scene
}

fn maps(asset: Scene) -> Option<ErrorMaps> {
    let finer = Scene::of_mesh(Mesh::sphere(1.0, 96, 48), Material::default()).unwrap();
    let (scan, shown) = (bake::Scan::new(finer).unwrap(), TexturedMesh::new(asset).unwrap());
    let cage = Cage::automatic(shown.mesh(), &scan);
    let verifier = Verifier { mesh: shown.mesh(), shown: Some(&shown), cage: &cage, scan: &scan };
    let coarser = |_, texel: f32| texel / 0.01;
    let checks = TexelChecks { colors: Some(&shown), coarser: Some((&shown, &coarser)) };
    verifier.error_maps([64, 32], checks).unwrap()
}

fn scaled(scale: f32) -> UvTransform {
    UvTransform { linear: [[scale, 0.0], [0.0, scale]], offset: [0.0; 2] }
}

#[test]
fn stored_uvs_do_not_matter_where_their_transform_makes_up_for_it() {
    let plain = maps(ball((0, UvTransform::default()), &[|uv| uv])).unwrap();
    let measured = plain.angles.summary().unwrap();
    assert!(measured.count > 64 * 32 * 9 / 10, "the ball's uvs cover the map: {measured:?}");
    // As gltfpack stores them, and in the second set.
    let small: fn(Vec2) -> Vec2 = |uv| Vec2::new(uv.x / 16.0, uv.y / 16.0);
    let swap = UvTransform { linear: [[0.0, 1.0], [1.0, 0.0]], offset: [0.0; 2] };
    let twins = [
        ball((0, scaled(16.0)), &[small]),
        ball((1, UvTransform::default()), &[small, |uv| uv]),
        ball((1, swap), &[|_| Vec2::default(), |uv| Vec2::new(uv.y, uv.x)]),
    ];
    let is_same = |a: &f32, b: &f32| a.is_nan() && b.is_nan() || (a - b).abs() < 0.01 * a.abs().max(1.0);
    for twin in twins {
        let found = maps(twin).unwrap();
        let pairs = [
            (&found.angles, &plain.angles),
            (found.colors.as_ref().unwrap(), plain.colors.as_ref().unwrap()),
            (found.coarser.as_ref().unwrap(), plain.coarser.as_ref().unwrap()),
        ];
        for (found, plain) in pairs {
            let mut pairs = found.values().iter().zip(plain.values());
            assert!(pairs.all(|(a, b)| is_same(a, b)));
        }
    }
}

#[test]
fn a_pattern_that_repeats_has_no_map_of_errors() {
    let thin: fn(Vec2) -> Vec2 = |uv| uv;
    assert!(maps(ball((0, scaled(8.0)), &[thin])).is_some());
    assert!(maps(ball((0, scaled(1000.0)), &[thin])).is_none());
}
