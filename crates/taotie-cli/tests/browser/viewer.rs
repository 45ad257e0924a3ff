//! The pages of `taotie view`: what hand and keys do in them, and their pictures held against those of `taotie render`.

use crate::node::Node;
use crate::same_in_threejs::materials;
use crate::{common, empty_folder};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::process::Command;
use taotie::image::{Encoding, Texels};
use taotie::io::{
    GltfAsset, GltfFormat, GltfLevel, GltfMaterial, decode_bitmap, read_bytes, write_gltf, write_png_bitmap,
};
use taotie::names::Named;
use taotie::shade::Shading;
use taotie::surface::{SurfaceMethod, TangentMethod, with_tangents};
use taotie_study::jue;

/// The largest mean difference of a channel of the object, codes of 255.
const MEAN: f64 = 1.0;

/// The difference within which nearly all pixels of the object lie, codes of 255, and how many may lie beyond.
const NEAR: u8 = 4;
const BEYOND: f64 = 0.005;

/// Colour behind the object, which no part of it has.
const BACKGROUND: [u8; 3] = [255, 0, 255];

/// Pixels along a side.
const SIDE: u32 = 384;

/// A picture by the page and by the renderer.
#[derive(Clone, Copy)]
struct Look<'a> {
    shading: &'a str,
    surface: &'a str,
}

/// A model with the options that both take.
struct Subject<'a> {
    model: &'a Path,
    options: &'a [String],
}

fn run(arguments: &[String], folder: &Path) {
    let run = Command::new(env!("CARGO_BIN_EXE_taotie"))
        .args(arguments)
        .env("TAOTIE_CACHE_DIR", folder.join("cache"))
        .output()
        .unwrap();
    assert!(run.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&run.stderr));
}

fn text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

fn words(line: &str) -> Vec<String> {
    line.split(' ').map(str::to_owned).collect()
}

/// Writes the vessel in clay, and returns it with its heights.
fn vessel(folder: &Path) -> (PathBuf, PathBuf) {
    let scene = jue::scene(512);
    let mesh = with_tangents(&scene.meshes()[0], 0, TangentMethod::MikkTSpace).unwrap().mesh;
    let [clay, bronze] = materials(&scene);
    let material = GltfMaterial { normal_map: clay.normal_map, ..bronze };
    let levels = [GltfLevel { mesh: &mesh, coverage: None }];
    let copyright = Some("A museum <b>");
    let asset = GltfAsset { levels: &levels, material, copyright, ..GltfAsset::default() };
    let [model, heights] = ["model.glb", "heights.png"].map(|name| folder.join(name));
    write_gltf(&model, &asset, &GltfFormat::default()).unwrap();
    let height = scene.materials()[0].height.expect("the vessel has relief");
    let bitmap = scene.textures()[height.texture.texture].bitmap();
    write_png_bitmap(&heights, bitmap, Encoding::Linear).unwrap();
    (model, heights)
}

/// The assertions are in the script.
#[test]
fn pages_do_what_hand_and_keys_ask_for() {
    let Some(node) = Node::find() else { return };
    let folder = empty_folder("viewer/page");
    let (model, heights) = vessel(&folder);
    let options = |more: [String; 2]| {
        let own = ["view".into(), text(&model), "--height-map".into(), text(&heights)];
        own.into_iter().chain(words("--bump-scale 0.002")).chain(more).collect::<Vec<_>>()
    };
    run(&options(["-o".into(), text(&folder.join("view.html"))]), &folder);
    run(&options(["--folder".into(), text(&folder.join("site"))]), &folder);
    node.run(&["--test", "--test-reporter=spec", "viewer.test.mjs"], &folder);
}

#[test]
fn the_page_draws_what_the_renderer_draws() {
    let Some(node) = Node::find() else { return };
    let folder = empty_folder("viewer/pictures");
    let (model, heights) = vessel(&folder);
    let mut options = vec!["--height-map".into(), text(&heights)];
    options.extend(words("--bump-scale 0.002 --env studio"));
    let subject = Subject { model: &model, options: &options };
    let look = |shading, surface| Look { shading, surface };
    let looks = [
        look("ggx", "tangent-normal"),
        look("cook-torrance", "bump"),
        look("blinn-phong", "smooth"),
        look("ggx-printed", "bump-printed"),
        look("lambert", "facet"),
    ];
    assert_same(&node, &folder, &subject, &looks);
}

#[test]
#[ignore = "draws 162 pictures"]
fn the_page_draws_every_model_by_every_method() {
    let Some(node) = Node::find() else { return };
    let Some(data) = common::data_folder("khronos-gltf-sample-assets") else { return };
    let Some(koala) = common::data_folder("odedstein-meshes/koala") else { return };
    let folder = empty_folder("viewer/all");
    let (vessel, heights) = vessel(&folder);
    let heights = ["--height-map".to_owned(), text(&heights)];
    let baked = folder.join("koala.glb");
    let mut bake = vec!["bake".into(), text(&koala.join("koala.obj")), "-o".into(), text(&baked)];
    bake.extend(words("--triangles 5000 --size 512 --space object --no-verify"));
    run(&bake, &folder);
    let helmet = data.join("DamagedHelmet/glTF-Binary/DamagedHelmet.glb");
    let names: Vec<Look> = Shading::NAMES
        .iter()
        .flat_map(|(shading, _)| {
            SurfaceMethod::NAMES.iter().map(|(surface, _)| Look { shading: *shading, surface: *surface })
        })
        .collect();
    for (name, model) in [("vessel", &vessel), ("helmet", &helmet), ("koala", &baked)] {
        let folder = empty_folder(&format!("viewer/all-{name}"));
        let mut options = heights.to_vec();
        options.extend(words("--bump-scale 0.002"));
        assert_same(&node, &folder, &Subject { model, options: &options }, &names);
    }
}

/// Fails where the page's pictures of a model differ from the renderer's.
fn assert_same(node: &Node, folder: &Path, subject: &Subject<'_>, looks: &[Look<'_>]) {
    // Three digits after the point: as many as a link has.
    let light = "directional from=-60,25 strength=3";
    let shared = [
        subject.options,
        &words("--orbit 30,20 --samples 4 --background #ff00ff"),
        &["--light".into(), light.into()],
    ]
    .concat();
    let own = |command: &str, output: &Path| {
        let mut all = vec![command.to_owned(), text(subject.model), "-o".into(), text(output)];
        all.extend(shared.clone());
        all
    };
    run(&own("view", &folder.join("view.html")), folder);
    let cases: Vec<_> = looks.iter().map(|look| {
        json!({
            "page": "view.html",
            "fragment": format!("shading={}&surface={}&light=raking&from=-60,25&strength=3&fill=0", look.shading, look.surface),
            "size": [SIDE, SIDE],
            "picture": format!("page-{}-{}.png", look.shading, look.surface),
        })
    });
    let cases = cases.collect::<Vec<_>>();
    std::fs::write(folder.join("cases.json"), json!(cases).to_string()).unwrap();
    node.run(&["viewer_pictures.mjs"], folder);
    for look in looks {
        let name = |by: &str| folder.join(format!("{by}-{}-{}.png", look.shading, look.surface));
        let mut render = own("render", &name("render"));
        let Look { shading, surface } = look;
        render.extend(words(&format!("--shading {shading} --surface {surface} --size {SIDE}")));
        run(&render, folder);
        let difference = Difference::of(&pixels(&name("page")), &pixels(&name("render")));
        println!("{shading} {surface}: {difference:?}");
        let Difference { mean, beyond, seen } = difference;
        assert!(seen > 1000, "{shading} {surface}: {seen} pixels of the object");
        assert!(
            mean <= MEAN && beyond <= BEYOND,
            "{shading} {surface}: {difference:?}, {}",
            folder.display()
        );
    }
}

fn pixels(path: &Path) -> Vec<[u8; 4]> {
    let bitmap = decode_bitmap(&read_bytes(path).unwrap(), "a picture", path).unwrap();
    let Texels::U8(texels) = bitmap.texels() else { panic!("{}: not of 8 bits", path.display()) };
    texels.clone()
}

/// The difference of two pictures of an object, codes of 255.
#[derive(Debug)]
struct Difference {
    /// Of a channel, over the object.
    mean: f64,
    /// The share of the object's pixels that differ by more than [`NEAR`] in some channel.
    beyond: f64,
    /// The number of the object's pixels.
    seen: usize,
}

impl Difference {
    fn of(page: &[[u8; 4]], render: &[[u8; 4]]) -> Self {
        assert_eq!(page.len(), render.len());
        let object: Vec<[u8; 3]> = page
            .iter()
            .zip(render)
            .filter(|(_, render)| render[..3] != BACKGROUND)
            .map(|(a, b)| [0, 1, 2].map(|i| a[i].abs_diff(b[i])))
            .collect();
        let sum: f64 = object.as_flattened().iter().map(|code| f64::from(*code)).sum();
        let beyond = object.iter().filter(|codes| codes.iter().any(|code| *code > NEAR)).count();
        let seen = object.len();
        Self { mean: sum / (3 * seen) as f64, beyond: beyond as f64 / seen as f64, seen }
    }
}
