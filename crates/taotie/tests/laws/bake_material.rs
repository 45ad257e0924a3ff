//! How a bake preserves a scan's materials: normal and height maps, textures read at the sample spacing, and each
//! triangle's own factors.

use crate::bake_scan::shown;
use std::ops::Range;
use taotie_engine::Progress;
use taotie_engine::bake::{
    BakeInput, BakeSettings, BakedMaps, Cage, LookupPoint, MapKind, Plane, ProjectionRay, Scan, Target,
    TexturedMesh, UvLookup, Verifier, bake, low_poly_mesh,
};
use taotie_engine::compare::angle_deg;
use taotie_engine::image::{Bitmap, Encoding, Sampler, Texels, Texture, Wrap};
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData, Point};
use taotie_engine::names::Named;
use taotie_engine::normal_map::{Storage, store_unit_vectors};
use taotie_engine::scene::{
    AlphaMode, GreenChannel, HeightMap, Instance, Material, NormalMap, NormalSpace, Scene, SceneData,
    TextureRef, UvTransform,
};
use taotie_engine::surface::with_frames;
use taotie_io::gltf_sampler;

/// Part of the square of side 2 in the plane z = 0, facing up, with matching uvs: the columns of these u.
pub fn strip(columns: Range<f32>) -> Mesh {
    let places = [(columns.start, 1.0), (columns.end, 1.0), (columns.end, 0.0), (columns.start, 0.0)];
    Mesh::new(MeshData {
        positions: places.iter().map(|(u, v)| Vec3::new(2.0 * u - 1.0, 1.0 - 2.0 * v, 0.0)).collect(),
        normals: vec![Vec3::new(0.0, 0.0, 1.0); 4],
        uvs: vec![places.iter().map(|(u, v)| Vec2::new(*u, *v)).collect()],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    })
    .unwrap()
}

pub fn square() -> Mesh {
    strip(0.0..1.0)
}

/// The first texture, on the first uv set, extended beyond its border.
pub fn texture_0() -> TextureRef {
    let sampler = Sampler { wrap_u: Wrap::Clamp, wrap_v: Wrap::Clamp, ..Sampler::default() };
    TextureRef { texture: 0, uv_set: 0, sampler, transform: UvTransform::default() }
}

/// A 16-bit texture with `value` at each place.
fn texture(size: u32, encoding: Encoding, value: impl Fn(Vec2) -> [f32; 4]) -> Texture {
    let place = |i: u32| (i as f32 + 0.5) / size as f32;
    let codes = |v: [f32; 4]| v.map(|v| (v * 65535.0).round() as u16);
    let texels =
        (0..size * size).map(|i| codes(value(Vec2::new(place(i % size), place(i / size))))).collect();
    Texture::new(Bitmap::new(size, size, 4, Texels::U16(texels)).unwrap(), encoding)
}

fn normal_map(space: NormalSpace) -> NormalMap {
    NormalMap { texture: texture_0(), scale: 1.0, space, green: GreenChannel::Up }
}

/// One mesh with one material, moved.
pub fn scene(mesh: Mesh, material: Material, texture: Texture, m: Mat4) -> Scene {
    Scene::new(SceneData {
        meshes: vec![mesh],
        materials: vec![material],
        textures: vec![texture],
        instances: vec![Instance { mesh: 0, material: 0, world_from_object: m }],
        ..SceneData::default()
    })
    .unwrap()
}

/// Unmoved meshes, each with its own material.
pub fn scene_of(parts: Vec<(Mesh, Material)>, textures: Vec<Texture>) -> Scene {
    let instance = |i| Instance { mesh: i, material: i, world_from_object: Mat4::IDENTITY };
    let instances = (0..parts.len()).map(instance).collect();
    let (meshes, materials) = parts.into_iter().unzip();
    Scene::new(SceneData { meshes, materials, textures, instances, ..SceneData::default() }).unwrap()
}

/// Bakes a scan onto its own triangles, with normals in object space.
pub fn baked_onto_itself(scene: &Scene, size: u32, maps: &[MapKind]) -> BakedMaps {
    let low = low_poly_mesh(scene.clone()).unwrap();
    baked_onto(&low, scene, size, maps)
}

fn baked_onto(low: &Mesh, scene: &Scene, size: u32, maps: &[MapKind]) -> BakedMaps {
    let low = with_frames(low, 0, None).unwrap().0.into_owned();
    let scan = Scan::new(scene.clone()).unwrap();
    let cage = Cage::uniform(&low, 0.01).unwrap();
    let maps = maps.iter().copied().collect();
    let settings =
        BakeSettings { size: [size; 2], maps, space: NormalSpace::Object, ..BakeSettings::default() };
    let baked = bake(BakeInput { low: &low, cage: &cage, scan: &scan }, &settings, Progress::SILENT).unwrap();
    assert_eq!((baked.counts.missed, baked.counts.texels), (0, (size * size) as usize));
    baked.maps
}

/// Returns the positions of a map's texels.
pub fn places(size: u32) -> impl Iterator<Item = Vec2> {
    let place = move |i: u32| (i as f32 + 0.5) / size as f32;
    (0..size * size).map(move |i| Vec2::new(place(i % size), place(i / size)))
}

/// A field of normals without steps, tilted by up to 36°, equal at opposite borders.
fn tilted(uv: Vec2) -> Vec3 {
    let hump = |v: f32| 4.0 * v * (1.0 - v);
    Vec3::new(-0.6 * hump(uv.x), -0.4 * hump(uv.y), 1.0).normalize()
}

fn stored(n: Vec3) -> [f32; 4] {
    let [x, y, z] = n.map(|v| v * 0.5 + 0.5).to_array();
    [x, y, z, 1.0]
}

/// The square with the tilted field as its normal map.
fn tilted_square(space: NormalSpace, m: Mat4) -> Scene {
    let material = Material { normal: Some(normal_map(space)), ..Material::default() };
    scene(square(), material, texture(256, Encoding::Normal, |uv| stored(tilted(uv))), m)
}

fn degrees(a: Vec3, b: Vec3) -> f64 {
    angle_deg(a.to_f64(), b.to_f64())
}

fn largest_angle(normals: &[[f32; 3]], size: u32, truth: impl Fn(Vec2) -> Vec3) -> f64 {
    let pairs = normals.iter().zip(places(size));
    pairs.map(|(n, uv)| degrees(Vec3::from_array(*n), truth(uv))).fold(0.0, f64::max)
}

#[test]
fn a_normal_map_of_the_scan_is_baked_and_measured() {
    let scene = tilted_square(NormalSpace::Tangent, Mat4::IDENTITY);
    let maps = baked_onto_itself(&scene, 128, &[MapKind::Normal]);
    let off = largest_angle(maps.vectors(Plane::Normal), 128, tilted);
    assert!(off < 0.1, "{off}°");
    let low = with_frames(&square(), 0, None).unwrap().0.into_owned();
    let (scan, cage) = (Scan::new(scene).unwrap(), Cage::uniform(&low, 0.01).unwrap());
    let mean = |shown: Option<&TexturedMesh>| {
        let verifier = Verifier { mesh: &low, shown, cage: &cage, scan: &scan };
        verifier.normal_error(5000).unwrap().angles.summary().unwrap().mean
    };
    let fine = Storage { bits: 16, dither: false };
    let kept = Texture::new(
        store_unit_vectors([128; 2], maps.vectors(Plane::Normal), fine).unwrap(),
        Encoding::Normal,
    );
    let sampler = texture_0().sampler;
    let kept = mean(Some(&shown(&low, &kept, (NormalSpace::Object, sampler))));
    assert!(kept < 0.1, "an asset that preserves the field: {kept}°");
    let flat = mean(None);
    assert!(flat > 5.0, "an asset that lost it: {flat}°");
}

/// A map that differs at opposite borders: only lookups that wrap as the viewer's do see the right values.
#[test]
fn the_map_is_read_beyond_its_borders_as_the_viewer_does() {
    let bent = |uv: Vec2| Vec3::new(uv.x - 0.5, 0.0, 1.0).normalize();
    let material = Material { normal: Some(normal_map(NormalSpace::Object)), ..Material::default() };
    let map = texture(8, Encoding::Normal, |uv| stored(bent(uv)));
    let scene = scene(square(), material, map.clone(), Mat4::IDENTITY);
    let low = with_frames(&square(), 0, None).unwrap().0.into_owned();
    let (scan, cage) = (Scan::new(scene).unwrap(), Cage::uniform(&low, 0.01).unwrap());
    let largest = |sampler| {
        let shown = shown(&low, &map, (NormalSpace::Object, sampler));
        let verifier = Verifier { mesh: &low, shown: Some(&shown), cage: &cage, scan: &scan };
        verifier.normal_error(5000).unwrap().angles.summary().unwrap().max
    };
    let clamped = gltf_sampler([&low]);
    assert_eq!((clamped.wrap_u, clamped.wrap_v), (Wrap::Clamp, Wrap::Clamp));
    let [as_shown, repeated] = [clamped, Sampler::default()].map(largest);
    assert!(as_shown < 0.01, "{as_shown}°");
    assert!(repeated > 5.0, "{repeated}°");
}

#[test]
fn maps_turn_with_their_instance() {
    let turn = Mat4::rotation_about(Vec3::new(1.0, 2.0, -0.5).normalize(), 1.1);
    let apart = Mat4::translation(Vec3::new(3.0, -1.0, 0.5));
    let mirror = |x: f64, y: f64, z: f64| apart * turn * Mat4::scale(Vec3::new(x, y, z));
    let turned = |n: Vec3| turn.transform_vector(n.to_f64()).to_f32();
    let mirrored = |uv| {
        let n = tilted(uv);
        turned(Vec3::new(-n.x, n.y, n.z))
    };
    for (space, m) in [
        (NormalSpace::Tangent, mirror(-2.0, 2.0, 2.0)),
        (NormalSpace::Tangent, mirror(-2.0, 3.0, 0.5)),
        (NormalSpace::Object, mirror(-2.0, 2.0, 2.0)),
    ] {
        let scene = tilted_square(space, m);
        let maps = baked_onto_itself(&scene, 64, &[MapKind::Normal]);
        let off = largest_angle(maps.vectors(Plane::Normal), 64, mirrored);
        assert!(off < 0.2, "{space:?}: {off}°");
    }
    let plain = tilted_square(NormalSpace::Object, mirror(2.0, 2.0, 2.0));
    let maps = baked_onto_itself(&plain, 64, &[MapKind::Normal]);
    assert!(largest_angle(maps.vectors(Plane::Normal), 64, |uv| turned(tilted(uv))) < 0.2);
}

#[test]
fn a_scan_without_maps_keeps_its_normals_to_the_bit() {
    let scan = Scan::new(Scene::of_mesh(Mesh::sphere(1.0, 24, 12), Material::default()).unwrap()).unwrap();
    let from = Vec3::new(0.2, 0.3, 0.93);
    let found = scan
        .closest(
            &ProjectionRay {
                point: from,
                direction: from.normalize(),
                distance: 0.0,
                among: None,
                floating: None,
                target: Target::OnRay,
            },
            0.5,
        )
        .unwrap();
    for width in [0.0, 0.1] {
        let mapped = scan.mapped_normal(&found, width);
        assert_eq!((mapped.normal, mapped.variance), (found.normal, 0.0));
    }
}

#[test]
fn a_ramp_of_heights_is_a_tilted_plane() {
    let height = Some(HeightMap { texture: texture_0(), scale: 0.5 });
    let material = Material { height, ..Material::default() };
    let ramp = texture(64, Encoding::Linear, |uv| [uv.x, 0.0, 0.0, 1.0]);
    let scene = scene(square(), material, ramp, Mat4::IDENTITY);
    // The square is 2 wide, so the height grows by 0.25 per unit.
    let truth = Vec3::new(-0.25, 0.0, 1.0);
    for size in [64, 16, 8] {
        let maps = baked_onto_itself(&scene, size, &[MapKind::Normal]);
        let inner =
            maps.vectors(Plane::Normal).iter().zip(places(size)).filter(|(_, uv)| (0.2..0.8).contains(&uv.x));
        let off = inner.map(|(n, _)| degrees(Vec3::from_array(*n), truth)).fold(0.0, f64::max);
        assert!(off < 0.05, "{size}: {off}°");
    }
}

#[test]
fn uv_lookups_show_normal_maps() {
    let lookup = UvLookup::new(&tilted_square(NormalSpace::Tangent, Mat4::IDENTITY)).unwrap();
    let (position, normal) = lookup.at(Vec2::new(0.25, 0.5)).unwrap();
    assert!((position - Vec3::new(-0.5, 0.0, 0.0)).length() < 1e-6);
    assert!(degrees(normal, tilted(Vec2::new(0.25, 0.5))) < 0.05);
}

const MATERIAL: [MapKind; 5] =
    [MapKind::Albedo, MapKind::MetallicRoughness, MapKind::Emission, MapKind::Alpha, MapKind::OcclusionMap];

#[test]
fn each_part_has_its_own_material() {
    let gold = Material {
        base_color: [1.0, 0.75, 0.25, 1.0],
        metallic: 1.0,
        roughness: 0.25,
        ..Material::default()
    };
    let lamp = Material {
        base_color: [0.125, 0.25, 0.5, 0.5],
        metallic: 0.0,
        roughness: 0.75,
        emissive: [8.0, 4.0, 0.0],
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    let scene = scene_of(vec![(strip(0.0..0.5), gold), (strip(0.5..1.0), lamp)], Vec::new());
    let maps = baked_onto_itself(&scene, 32, &MATERIAL);
    for (i, uv) in places(32).enumerate() {
        let all = (
            maps.vectors(Plane::Albedo)[i],
            maps.numbers(Plane::Metallic)[i],
            maps.numbers(Plane::Roughness)[i],
            maps.numbers(Plane::Alpha)[i],
            maps.vectors(Plane::Emission)[i],
        );
        match uv.x < 0.5 {
            true => assert_eq!(all, ([1.0, 0.75, 0.25], 1.0, 0.25, 1.0, [0.0; 3])),
            false => assert_eq!(all, ([0.125, 0.25, 0.5], 0.0, 0.75, 0.5, [8.0, 4.0, 0.0])),
        }
        assert_eq!(maps.numbers(Plane::Occlusion)[i], 1.0);
    }
}

#[test]
fn textures_of_all_values_are_baked() {
    let packed = |uv: Vec2| [1.0 - 0.5 * uv.x, uv.x, uv.y, 1.0];
    let material = Material {
        metallic: 0.5,
        roughness: 0.8,
        metallic_roughness_texture: Some(texture_0()),
        occlusion_texture: Some(texture_0()),
        occlusion_strength: 0.5,
        emissive: [2.0, 1.0, 0.5],
        emissive_texture: Some(texture_0()),
        ..Material::default()
    };
    let texture = texture(64, Encoding::Linear, packed);
    let maps = baked_onto_itself(&scene(square(), material, texture, Mat4::IDENTITY), 32, &MATERIAL);
    let near = |a: f32, b: f32| assert!((a - b).abs() < 1e-3, "{a} is not {b}");
    for (i, uv) in places(32).enumerate() {
        near(maps.numbers(Plane::Roughness)[i], 0.8 * uv.x);
        near(maps.numbers(Plane::Metallic)[i], 0.5 * uv.y);
        near(maps.numbers(Plane::Occlusion)[i], 1.0 - 0.25 * uv.x);
        let emission = [2.0 - uv.x, uv.x, 0.5 * uv.y];
        maps.vectors(Plane::Emission)[i].iter().zip(emission).for_each(|(a, b)| near(*a, b));
    }
}

/// The square with a base colour texture.
fn painted(texture: Texture) -> Scene {
    let material =
        Material { base_color: [1.0; 4], base_color_texture: Some(texture_0()), ..Material::default() };
    scene(square(), material, texture, Mat4::IDENTITY)
}

pub fn bytes(size: u32, value: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
    let texels = (0..size * size).map(|i| value(i % size, i / size)).collect();
    Texture::new(Bitmap::new(size, size, 4, Texels::U8(texels)).unwrap(), Encoding::Srgb)
}

#[test]
fn a_checker_finer_than_the_map_is_its_mean() {
    let checker = bytes(1024, |x, y| [if (x + y) % 2 == 0 { 255 } else { 0 }; 4]);
    let maps = baked_onto_itself(&painted(checker), 16, &[MapKind::Albedo]);
    for color in maps.vectors(Plane::Albedo) {
        assert!(color.iter().all(|v| (v - 0.5).abs() < 0.02), "{color:?}");
    }
}

#[test]
fn an_even_texture_stays_to_the_bit() {
    let even = bytes(256, |_, _| [200, 100, 50, 255]);
    let [r, g, b, _] = even.texel(0, 0, 0);
    for size in [16, 128] {
        let maps = baked_onto_itself(&painted(even.clone()), size, &[MapKind::Albedo]);
        assert!(maps.vectors(Plane::Albedo).iter().all(|color| *color == [r, g, b]), "{size}");
    }
}

/// Four by four squares side by side, each as a separate UV island on the map, with a margin.
fn tiles(margin: f32) -> Mesh {
    let mut data = MeshData { uvs: vec![Vec::new()], ..MeshData::default() };
    for tile in 0..16 {
        let (column, row) = ((tile % 4) as f32, (tile / 4) as f32);
        let first = data.positions.len() as u32;
        for [x, y] in [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0f32]] {
            let inner = |v: f32| margin + v * (1.0 - 2.0 * margin);
            data.uvs[0].push(Vec2::new((column + inner(x)) / 4.0, (row + inner(y)) / 4.0));
            data.positions.push(Vec3::new((column + x) / 2.0 - 1.0, 1.0 - (row + y) / 2.0, 0.0));
            data.normals.push(Vec3::new(0.0, 0.0, 1.0));
        }
        data.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    Mesh::new(data).unwrap()
}

#[test]
fn mip_levels_bleed_no_farther_than_a_texel() {
    // Islands of 120 texels, green, with 4 black ones around each.
    let is_margin = |v: u32| !(4..124).contains(&(v % 128));
    let paint = |x: u32, y: u32| if is_margin(x) || is_margin(y) { [0, 0, 0, 255] } else { [0, 255, 0, 255] };
    let material =
        Material { base_color: [1.0; 4], base_color_texture: Some(texture_0()), ..Material::default() };
    let scene = scene(tiles(4.0 / 128.0), material, bytes(512, paint), Mat4::IDENTITY);
    let maps = baked_onto(&square(), &scene, 64, &[MapKind::Albedo]);
    let is_inner = |v: f32| (1.0..15.0).contains(&((v * 64.0) % 16.0));
    for (color, uv) in maps.vectors(Plane::Albedo).iter().zip(places(64)) {
        let least = if is_inner(uv.x) && is_inner(uv.y) { 0.99 } else { 0.94 };
        assert!(color[1] > least && color[0] == 0.0, "{color:?} at {uv:?}");
    }
}

#[test]
fn contours_of_masks_stay_under_one_cutoff() {
    let cutoffs = [0.25f32, 0.5, 0.75];
    // Alpha grows from left to right in each strip.
    let within = |u: f32| (u * 3.0).fract();
    let texture = texture(192, Encoding::Linear, |uv| [1.0, 1.0, 1.0, within(uv.x)]);
    let parts = (0..3).map(|k| {
        let alpha = AlphaMode::Mask(cutoffs[k]);
        let material = Material {
            base_color: [1.0; 4],
            base_color_texture: Some(texture_0()),
            alpha,
            ..Material::default()
        };
        (strip(k as f32 / 3.0..(k + 1) as f32 / 3.0), material)
    });
    let scene = scene_of(parts.collect(), vec![texture]);
    assert_eq!(TexturedMesh::new(scene.clone()).unwrap().alpha_mode(), AlphaMode::Mask(0.5));
    let maps = baked_onto_itself(&scene, 96, &MATERIAL);
    let mut judged = 0;
    for (alpha, uv) in maps.numbers(Plane::Alpha).iter().zip(places(96)) {
        let (own, cutoff) = (within(uv.x), cutoffs[(uv.x * 3.0) as usize]);
        // A texel is 1/32 of a strip.
        let is_clear = (own - cutoff).abs() > 1.0 / 32.0 && (0.05..0.95).contains(&own);
        if is_clear {
            assert_eq!(*alpha >= 0.5, own >= cutoff, "{alpha} for {own} at {cutoff}");
            judged += 1;
        }
    }
    assert!(judged > 96 * 70, "{judged}");
}

#[test]
fn colours_of_what_is_not_there_do_not_bleed() {
    // Every second column of texels is red and fully transparent.
    let paint = |x: u32, _| if x.is_multiple_of(2) { [255, 0, 0, 0] } else { [0, 255, 0, 255] };
    let material = Material {
        base_color: [1.0; 4],
        base_color_texture: Some(texture_0()),
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    let scene = scene(square(), material, bytes(64, paint), Mat4::IDENTITY);
    let maps = baked_onto_itself(&scene, 32, &[MapKind::Albedo, MapKind::Alpha]);
    for (color, alpha) in maps.vectors(Plane::Albedo).iter().zip(maps.numbers(Plane::Alpha)) {
        assert!(color[0] < 0.01 && color[1] > 0.99 && (alpha - 0.5).abs() < 1e-3, "{color:?} {alpha}");
    }
}

#[test]
fn samples_without_a_hit_darken_nothing() {
    // A narrow ray distance, and a scan of half of the square whose edge cuts texels.
    let half = Material { base_color: [0.5, 0.25, 0.125, 1.0], roughness: 0.25, ..Material::default() };
    let scan = Scan::new(Scene::of_mesh(strip(0.0..0.49), half).unwrap()).unwrap();
    let low = with_frames(&square(), 0, None).unwrap().0.into_owned();
    let cage = Cage::uniform(&low, 1e-4).unwrap();
    let maps = MATERIAL.iter().copied().collect();
    let settings = BakeSettings { size: [32; 2], maps, ..BakeSettings::default() };
    let baked = bake(BakeInput { low: &low, cage: &cage, scan: &scan }, &settings, Progress::SILENT).unwrap();
    assert!(baked.counts.lost > baked.counts.samples / 2, "{:?}", baked.counts);
    assert!(baked.maps.vectors(Plane::Albedo).iter().all(|color| *color == [0.5, 0.25, 0.125]));
    assert!(
        baked.maps.numbers(Plane::Roughness).iter().all(|v| *v == 0.25)
            && baked.maps.numbers(Plane::Alpha).iter().all(|v| *v == 1.0)
    );
}

#[test]
fn textures_follow_their_own_uv_set() {
    let mut data = square().into_data();
    let turned = data.uvs[0].iter().map(|uv| Vec2::new(1.0 - uv.x, uv.y)).collect();
    data.uvs.push(turned);
    let mesh = Mesh::new(data).unwrap();
    let used = TextureRef { uv_set: 1, ..texture_0() };
    let material = Material { base_color: [1.0; 4], base_color_texture: Some(used), ..Material::default() };
    let halves = || bytes(64, |x, _| if x < 32 { [255, 0, 0, 255] } else { [0, 0, 255, 255] });
    // Moved meshes are copied, others are used as they are.
    for m in [Mat4::IDENTITY, Mat4::translation(Vec3::new(1.0, 0.0, 0.0))] {
        let maps =
            baked_onto_itself(&scene(mesh.clone(), material.clone(), halves(), m), 32, &[MapKind::Albedo]);
        for (color, uv) in
            maps.vectors(Plane::Albedo).iter().zip(places(32)).filter(|(_, uv)| (uv.x - 0.5).abs() > 0.05)
        {
            assert_eq!(*color, if uv.x < 0.5 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] });
        }
    }
}

#[test]
fn grooves_of_a_normal_map_finer_than_a_texel_become_roughness() {
    let slope = 0.5f32.sqrt();
    let groove = |uv: Vec2| {
        let side = if ((uv.x * 512.0) as u32).is_multiple_of(2) { slope } else { -slope };
        stored(Vec3::new(side, 0.0, slope))
    };
    let normal = Some(normal_map(NormalSpace::Tangent));
    let material = Material { normal, roughness: 0.3, ..Material::default() };
    let scene = scene(square(), material, texture(512, Encoding::Normal, groove), Mat4::IDENTITY);
    let coarse = baked_onto_itself(&scene, 16, &[MapKind::Normal, MapKind::Roughness]);
    let middle = 8 * 16 + 8;
    assert!(coarse.numbers(Plane::Roughness)[middle] > 0.6, "{}", coarse.numbers(Plane::Roughness)[middle]);
    assert!(coarse.vectors(Plane::Normal)[middle][2] > 0.99, "the mean normal is upright");
}

/// A sphere whose material has all maps.
fn rich_sphere() -> Scene {
    let waves = |uv: Vec2| {
        let wave = |v: f32| (v * 16.0).fract() - 0.5;
        Vec3::new(0.6 * wave(uv.x), 0.6 * wave(uv.y), 1.0).normalize()
    };
    let material = Material {
        normal: Some(normal_map(NormalSpace::Tangent)),
        base_color_texture: Some(texture_0()),
        metallic_roughness_texture: Some(texture_0()),
        emissive: [1.0; 3],
        emissive_texture: Some(texture_0()),
        ..Material::default()
    };
    let texture = texture(128, Encoding::Normal, |uv| stored(waves(uv)));
    scene(Mesh::sphere(1.0, 48, 24), material, texture, Mat4::IDENTITY)
}

#[test]
fn threads_change_no_bit_of_a_textured_scan() {
    let low = with_frames(&Mesh::sphere(1.01, 16, 8), 0, None).unwrap().0.into_owned();
    let of = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let scan = Scan::new(rich_sphere()).unwrap();
            let cage = Cage::automatic(&low, &scan);
            let maps = MapKind::NAMES.iter().map(|(_, kind)| *kind).collect();
            let settings = BakeSettings { size: [64; 2], maps, sky_rays: 8, ..BakeSettings::default() };
            bake(BakeInput { low: &low, cage: &cage, scan: &scan }, &settings, Progress::SILENT).unwrap().maps
        })
    };
    let (one, three) = (of(1), of(3));
    assert!(one.planes().eq(three.planes()) && one.texels == three.texels);
}

#[test]
fn a_scene_comes_back_with_all_its_parts() {
    let half = tilted_square(NormalSpace::Tangent, Mat4::IDENTITY).into_data();
    let moved = Mat4::translation(Vec3::new(0.0, 3.0, 0.0)) * Mat4::scale(Vec3::new(-1.0, 1.0, 1.0));
    let plain = Material { roughness: 0.25, ..Material::default() };
    let object = Material { normal: Some(normal_map(NormalSpace::Object)), ..Material::default() };
    let place = |mesh, material, m| Instance { mesh, material, world_from_object: m };
    let scene = Scene::new(SceneData {
        meshes: vec![square(), Mesh::sphere(1.0, 8, 4)],
        materials: vec![half.materials[0].clone(), plain, object],
        textures: half.textures,
        instances: vec![place(0, 0, moved), place(1, 1, Mat4::IDENTITY), place(0, 2, moved)],
        ..SceneData::default()
    })
    .unwrap();
    let surface = TexturedMesh::new(scene.clone()).unwrap();
    let back = surface.clone().into_scene().unwrap();
    assert_eq!((back.instances().len(), back.triangle_count()), (3, scene.triangle_count()));
    assert_eq!(back.instances()[2].world_from_object, moved, "the space of its normal map");
    let again = TexturedMesh::new(back).unwrap();
    assert_eq!(again.mesh().triangles().len(), surface.mesh().triangles().len());
    for triangle in 0..surface.mesh().triangles().len() as u32 {
        let at = LookupPoint::finest(Point { triangle, weights: [0.5, 0.3, 0.2] });
        let normal = |of: &TexturedMesh| of.normal(at, at.point.normal(of.mesh())).normal;
        assert!((normal(&surface) - normal(&again)).length() < 1e-5, "{triangle}");
        assert_eq!(surface.sample(at), again.sample(at));
    }
}
