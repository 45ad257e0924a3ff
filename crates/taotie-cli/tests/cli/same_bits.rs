//! Every file that a command writes has the same bytes with any number of threads and at every SIMD level. Only times
//! differ: a document has one list of them, and a page one table.

use super::balls::{Ball, SCAN};
use super::glb::Glb;
use super::pictures::write_square;
use super::place::Place;
use std::collections::BTreeMap;
use taotie_engine::image::Encoding;
use taotie_engine::math::SimdLevel;
use taotie_engine::names::Named;
use taotie_io::PngSamples;

/// Numbers of threads: one, fewer than parts of the work, one not a power of two, more than most machines have.
const THREADS: [usize; 4] = [1, 2, 3, 7];

/// Texels along a side of the scan's textures.
const SIDE: u32 = 24;

/// Returns a folder with a ball that has colours, normals and roughness in textures.
fn textured() -> Place {
    let ball = Ball { rings: 24, meridians: 48, uv: Some(|u, v| [u, v]), ..SCAN };
    let place = Place::with("scan.obj", format!("mtllib scan.mtl\nusemtl clay\n{}", ball.obj()));
    place.write("scan.mtl", "newmtl clay\nKd 1 1 1\nmap_Kd color.png\nmap_Pr rough.png\nnorm normal.png\n");
    place.write("high.obj", Ball { rings: 36, meridians: 72, ..SCAN }.obj());
    write_texture(&place, "color.png", |x, y| [(x * 10) as u8, (y * 10) as u8, (x * y % 256) as u8]);
    write_texture(&place, "rough.png", |x, y| [(60 + x * 3 + y) as u8; 3]);
    write_texture(&place, "normal.png", |x, y| [(118 + x % 20) as u8, (118 + y % 20) as u8, 250]);
    place
}

fn write_texture(place: &Place, name: &str, texel: impl Fn(u32, u32) -> [u8; 3]) {
    let samples: Vec<u8> = (0..SIDE * SIDE).flat_map(|i| texel(i % SIDE, i / SIDE)).collect();
    write_square(&place.path(name), PngSamples::U8(&samples), Encoding::Linear);
}

/// Runs commands in a new folder and returns all files in it, without times.
fn files(lines: &[String]) -> BTreeMap<String, Vec<u8>> {
    let place = textured();
    for line in lines {
        place.taotie(line).assert().success();
    }
    let mut files = BTreeMap::new();
    let mut folders = vec![String::new()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(place.path(&folder)).expect("it is readable").flatten() {
            let name = format!("{folder}{}", entry.file_name().to_string_lossy());
            match entry.path().is_dir() {
                true => folders.push(format!("{name}/")),
                false => drop(files.insert(name.clone(), without_times(&name, place.read(&name)))),
            }
        }
    }
    files
}

/// Returns a file without the times in it.
fn without_times(name: &str, bytes: Vec<u8>) -> Vec<u8> {
    match name.rsplit('.').next() {
        Some("json") => without_list(&text(bytes)).into_bytes(),
        Some("html") => without_table(&text(bytes)).into_bytes(),
        _ => bytes,
    }
}

fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).expect("it is text")
}

/// Returns a document without its list of times: `stages` of a bake, `times` of a comparison.
fn without_list(document: &str) -> String {
    let lists = ["\n  \"stages\": [\n", "\n  \"times\": [\n"];
    let parts = lists.iter().find_map(|list| document.split_once(list));
    let (before, rest) = parts.unwrap_or_else(|| panic!("no list of times: {document}"));
    let (times, after) = rest.split_once("\n  ]").expect("the list ends");
    let is_timed = |part: &str| part.contains("milliseconds");
    assert!(is_timed(times) && !is_timed(before) && !is_timed(after), "{document}");
    format!("{before}{after}")
}

/// Returns a page without the rows of its table of times, if it has one.
fn without_table(page: &str) -> String {
    let Some((before, rest)) = page.split_once("\"title\":\"Time\"") else { return page.to_owned() };
    let (times, rest) = rest.split_once("]]").expect("its rows end");
    assert!(times.contains("\"rows\":[[") && !rest.contains("\"title\":\"Time\""), "{times}");
    format!("{before}{rest}")
}

/// Fails with the names of the files that differ.
fn assert_same(how: &str, files: &BTreeMap<String, Vec<u8>>, first: &BTreeMap<String, Vec<u8>>) {
    assert_eq!(files.keys().collect::<Vec<_>>(), first.keys().collect::<Vec<_>>(), "{how}");
    let differ: Vec<&String> = files.keys().filter(|name| files[*name] != first[*name]).collect();
    assert!(differ.is_empty(), "{how}: these files differ: {differ:?}");
}

/// Returns the SIMD levels of this machine, each with each number of threads.
fn ways() -> Vec<String> {
    let levels: Vec<&str> = SimdLevel::available().into_iter().map(Named::name).collect();
    let with = |threads: &usize| {
        let threads = *threads;
        levels.iter().map(move |level| format!("--threads {threads} --simd {level}"))
    };
    THREADS.iter().flat_map(with).collect()
}

#[test]
fn an_asset_has_the_same_bytes_under_another_name() {
    let place = textured();
    let [a, b] = ["a.glb", "b.glb"].map(|name| {
        place.taotie(&format!("bake scan.obj -o {name} --triangles 200 --size 32")).assert().success();
        place.read(name)
    });
    assert!(a == b);
    assert_eq!(Glb::read(&a).json["meshes"][0]["name"], "scan", "it is named after its scan");
}

/// A bake uses the fastest SIMD level of the machine, whose results have the same bits as at any other: a law of
/// rays, and tests of vertex normals and mip levels. Compares levels of detail, maps, page and JSON.
#[test]
fn a_bake_writes_the_same_bytes_with_three_threads() {
    bake_alike(&[3]);
}

#[test]
#[ignore = "takes half a minute"]
fn a_bake_writes_the_same_bytes_with_any_number_of_threads() {
    bake_alike(&THREADS[1..]);
}

/// Compares bakes with these numbers of threads with a single-threaded one.
fn bake_alike(threads: &[usize]) {
    let bake = "bake scan.obj -o out.gltf --triangles 600 --lods 200 --size 64 --maps auto,ao,height,bent";
    let run = |threads: usize| files(&[format!("{bake} --threads {threads}")]);
    let first = run(1);
    for name in
        ["out.gltf", "out.bin", "out.height.png", "out.bent.png", "out.report.html", "out.report.json"]
    {
        assert!(first.contains_key(name), "{name}: {:?}", first.keys());
    }
    for threads in threads {
        assert_same(&format!("{threads} threads"), &run(*threads), &first);
    }
}

#[test]
fn renders_are_the_same_bytes_at_every_level_with_any_number_of_threads() {
    let lines = |how: &str| {
        [
            format!("render scan.obj -o plain.png --size 48 --shadows --ground {how}"),
            format!("render scan.obj -o linear.exr --size 40x32 --samples 1 --aov normals,depth {how}"),
            format!("render scan.obj -o turn.gif --size 24 --turntable 3 {how}"),
        ]
    };
    let ways = ways();
    let first = files(&lines(&ways[0]));
    assert!(["plain.png", "linear.exr", "turn.gif"].iter().all(|name| first.contains_key(*name)));
    ways[1..].iter().for_each(|how| assert_same(how, &files(&lines(how)), &first));
}

/// A selection of SIMD levels and numbers of threads.
#[test]
fn comparisons_are_the_same_bytes_at_every_level_with_any_number_of_threads() {
    let line = "compare scan.obj --reference high.obj -o out --size 48 --samples 1";
    let ways = ways();
    let first = files(&[format!("{line} {}", ways[0])]);
    assert!(
        first.keys().any(|name| name.starts_with("out/") && name.ends_with(".html")),
        "{:?}",
        first.keys()
    );
    let each = ways.iter().step_by(ways.len() / THREADS.len() + 1).skip(1);
    each.for_each(|how| assert_same(how, &files(&[format!("{line} {how}")]), &first));
}
