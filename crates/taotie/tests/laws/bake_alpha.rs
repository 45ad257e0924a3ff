//! Alpha in a bake: each triangle has the mode of the surface it represents, and colours of transparent places are
//! not visible anywhere.

use crate::bake_material::{baked_onto_itself, bytes, places, scene, scene_of, square, strip, texture_0};
use crate::pairs::first_texture;
use std::path::Path;
use taotie::asset::{Asset, BakeOptions, Baker, Lod, Packing, Scan, VerifyOptions};
use taotie_engine::Progress;
use taotie_engine::bake::{self, Cage, MapKind, Plane, TexturedMesh, low_poly_mesh};
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::math::Mat4;
use taotie_engine::mesh::Mesh;
use taotie_engine::scene::{AlphaMode, Instance, Material, Scene, SceneData};
use taotie_io::{load_levels, load_model};

const GREEN: [u8; 4] = [20, 200, 40, 255];

/// Stripes of a leaf, a quarter of the surface, on fully transparent black.
fn leaf(x: u32, _: u32) -> [u8; 4] {
    if x % 16 < 4 { GREEN } else { [0; 4] }
}

fn painted(alpha: AlphaMode) -> Material {
    Material { base_color: [1.0; 4], base_color_texture: Some(texture_0()), alpha, ..Material::default() }
}

fn of_mode(alpha: AlphaMode) -> Material {
    Material { alpha, ..Material::default() }
}

#[test]
fn a_leaf_on_black_that_is_not_there_stays_green() {
    let texture = bytes(1024, leaf);
    let [r, g, b, _] = texture.texel(0, 0, 0);
    // Lookups as wide as 32, 8, 2.6 and 1.3 texels; for the last two, whole texels of the map are transparent.
    for (size, alpha) in [16, 64, 200, 400]
        .into_iter()
        .flat_map(|size| [AlphaMode::Mask(0.5), AlphaMode::Blend].map(|alpha| (size, alpha)))
    {
        let scene = scene(square(), painted(alpha), texture.clone(), Mat4::IDENTITY);
        let maps = baked_onto_itself(&scene, size, &[MapKind::Albedo, MapKind::Alpha]);
        for (color, uv) in maps.vectors(Plane::Albedo).iter().zip(places(size)) {
            let off = color.iter().zip([r, g, b]).map(|(v, wanted)| (v - wanted).abs()).fold(0.0, f32::max);
            assert!(off < 0.01, "{size}, {alpha:?}: {color:?} at {uv:?} is not {:?}", [r, g, b]);
        }
        let mean = maps.numbers(Plane::Alpha).iter().sum::<f32>() / (size * size) as f32;
        assert!((mean - 0.25).abs() < 0.01, "{size}, {alpha:?}: alpha {mean}");
    }
}

#[test]
fn an_opaque_material_shows_all_its_colours() {
    let with_alpha = bytes(256, leaf);
    let texels = match with_alpha.bitmap().texels() {
        Texels::U8(texels) => texels.iter().map(|[r, g, b, _]| [*r, *g, *b, 255]).collect(),
        _ => panic!("bytes"),
    };
    let without = Texture::new(Bitmap::new(256, 256, 3, Texels::U8(texels)).unwrap(), Encoding::Srgb);
    let albedo = |texture: Texture| {
        let scene = scene(square(), painted(AlphaMode::Opaque), texture, Mat4::IDENTITY);
        baked_onto_itself(&scene, 16, &[MapKind::Albedo]).vectors(Plane::Albedo).to_vec()
    };
    let (a, b) = (albedo(with_alpha.clone()), albedo(without));
    assert!(a == b, "alpha does not change maps that ignore it");
    let wanted = with_alpha.texel(0, 0, 0)[1] * 0.25;
    assert!(a.iter().all(|color| (color[1] - wanted).abs() < 0.02), "the black is part of its colours");
}

#[test]
fn each_triangle_has_the_mode_of_what_it_stands_for() {
    let [mask, blend] = [AlphaMode::Mask(0.5), AlphaMode::Blend];
    // Two masks with different cutoffs.
    let modes = [AlphaMode::Opaque, AlphaMode::Mask(0.25), AlphaMode::Mask(0.75), blend];
    let quarter = |i: usize| strip(i as f32 / 4.0..(i + 1) as f32 / 4.0);
    let parts = (0..4).map(|i| (quarter(i), of_mode(modes[i]))).collect();
    let scene = scene_of(parts, Vec::new());
    let found = |low: &Mesh, scene: Scene| {
        let scan = bake::Scan::new(scene).unwrap();
        scan.alpha_modes(low, &Cage::uniform(low, 0.01).unwrap())
    };
    let low = low_poly_mesh(scene.clone()).unwrap();
    let opaque = AlphaMode::Opaque;
    assert_eq!(found(&low, scene), [opaque, opaque, mask, mask, mask, mask, blend, blend]);
    // Most points of the right triangle are in the right part, hardly any of the left one's.
    for (right, wanted) in [(blend, [blend, opaque]), (mask, [mask, opaque]), (opaque, [opaque; 2])] {
        let parts = [(strip(0.0..0.62), of_mode(opaque)), (strip(0.62..1.0), of_mode(right))];
        assert_eq!(found(&square(), scene_of(parts.into(), Vec::new())), wanted);
    }
    // Far from the scan nothing is see-through.
    let beyond = Mat4::translation(taotie_engine::math::Vec3::new(50.0, 0.0, 0.0));
    let parts = [(strip(0.0..0.5), of_mode(blend)), (strip(0.5..1.0), of_mode(opaque))];
    let mut data = scene_of(parts.into(), Vec::new()).into_data();
    data.instances.iter_mut().for_each(|instance| instance.world_from_object = beyond);
    assert_eq!(found(&square(), Scene::new(data).unwrap()), [opaque; 2]);
}

#[test]
fn one_mode_is_the_mode_of_all() {
    for mode in [AlphaMode::Opaque, AlphaMode::Mask(0.25), AlphaMode::Blend] {
        let scan = bake::Scan::new(Scene::of_mesh(square(), of_mode(mode)).unwrap()).unwrap();
        let low = Mesh::sphere(1.0, 8, 4);
        let modes = scan.alpha_modes(&low, &Cage::uniform(&low, 1e-3).unwrap());
        assert!(modes.len() == low.triangles().len() && modes.iter().all(|found| *found == mode));
        assert_eq!(scan.surface().alpha_modes(), [mode]);
    }
}

/// Positions along x of three balls: opaque, with its lower half cut away, and of glass.
const PLACES: [f64; 3] = [-3.0, 0.0, 3.0];

fn balls(modes: [AlphaMode; 3]) -> Scan {
    let texels = (0..64 * 64).map(|i| if i < 32 * 64 { [200, 100, 50, 255] } else { [0; 4] }).collect();
    let half = Texture::new(Bitmap::new(64, 64, 4, Texels::U8(texels)).unwrap(), Encoding::Srgb);
    let material = |alpha: AlphaMode| match alpha {
        AlphaMode::Opaque => Material { base_color: [0.2, 0.4, 0.6, 1.0], ..of_mode(alpha) },
        AlphaMode::Mask(_) => {
            let used = Some(first_texture());
            Material { base_color: [1.0; 4], base_color_texture: used, ..of_mode(alpha) }
        }
        AlphaMode::Blend => Material { base_color: [0.9, 0.9, 0.9, 0.5], ..of_mode(alpha) },
    };
    let place = |x: f64| Mat4::translation(taotie_engine::math::Vec3::new(x, 0.0, 0.0));
    let instance = |i: usize| Instance { mesh: 0, material: i, world_from_object: place(PLACES[i]) };
    let scene = SceneData {
        meshes: vec![Mesh::sphere(1.0, 64, 32)],
        materials: modes.map(material).into(),
        textures: vec![half],
        instances: (0..3).map(instance).collect(),
        ..SceneData::default()
    };
    Scan::from_scene(Scene::new(scene).unwrap(), Progress::SILENT).unwrap()
}

const MODES: [AlphaMode; 3] = [AlphaMode::Opaque, AlphaMode::Mask(0.4), AlphaMode::Blend];

fn baked(scan: &Scan) -> Asset {
    let options =
        BakeOptions { triangles: 1500, lods: vec![Lod::Triangles(400)], size: 256, ..BakeOptions::default() };
    Baker::new(options).bake(scan, Progress::SILENT).unwrap()
}

/// Asserts that a level has a part for each ball, with its mode.
fn assert_parts(path: &Path, level: usize, triangles: usize) {
    let scene = load_levels(path).unwrap().swap_remove(level).scene;
    assert_eq!((scene.instances().len(), scene.triangle_count()), (3, triangles));
    for ((instance, mode), x) in scene.instances().iter().zip(MODES).zip(PLACES) {
        assert_eq!(scene.materials()[instance.material].alpha, mode);
        let mesh = &scene.meshes()[instance.mesh];
        let world =
            |v: u32| instance.world_from_object.transform_point(mesh.positions()[v as usize].to_f64());
        let mut corners = mesh.triangles().as_flattened().iter().map(|v| world(*v));
        assert!(corners.all(|corner| (corner.x - x).abs() < 1.1), "{mode:?}, level {level}");
    }
}

#[test]
fn an_asset_has_a_part_for_each_mode_in_every_level() {
    let (folder, scan) = (tempfile::tempdir().unwrap(), balls(MODES));
    let asset = baked(&scan);
    let said: String = asset.warnings().iter().map(|(what, _)| format!("{what}\n")).collect();
    assert!(!said.contains("blended"), "{said}");
    let counts: Vec<usize> = asset.levels().map(|mesh| mesh.triangles().len()).collect();
    for (name, meshopt) in [("plain.glb", false), ("packed.glb", true)] {
        let path = folder.path().join(name);
        let packing = Packing { meshopt, ..Packing::default() };
        let written = asset.write(&path, &packing, Progress::SILENT).unwrap();
        counts.iter().enumerate().for_each(|(level, count)| assert_parts(&path, level, *count));
        let options = VerifyOptions { points: 20_000, map: 64, view: 96, ..VerifyOptions::default() };
        let proof = written.verify(&scan, &options, Progress::SILENT).unwrap();
        for level in &proof.figures.levels {
            let alpha = level.material.alpha.unwrap().mean;
            let angle = level.surface_angles.unwrap().mean;
            println!("{name}, {} triangles: alpha {alpha:.4}, {angle:.2}°", level.triangles);
            // The rim of the cut, and places at which a level shows a little of its surroundings.
            assert!(alpha < 0.02, "{name}, {} triangles: {alpha}", level.triangles);
        }
        let flip = proof.figures.finest().unwrap().full_views.iter().map(|view| view.flip).sum::<f64>() / 8.0;
        println!("{name}: FLIP {flip:.4}");
        assert!(flip < 0.03, "{name}: {flip}");
    }
}

#[test]
fn an_asset_of_one_mode_is_one_part() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.glb");
    for mode in MODES {
        baked(&balls([mode; 3])).write(&path, &Packing::default(), Progress::SILENT).unwrap();
        let scene = load_model(&path).unwrap().scene;
        assert_eq!(
            (scene.instances().len(), scene.materials().len()),
            (1, 2),
            "the level has its own normal map"
        );
        assert_eq!(TexturedMesh::new(scene).unwrap().alpha_modes(), [mode]);
    }
}
