//! Animated images: turntables and animations.

use super::models::{Green, TRIANGLE, moving_square, write_relief};
use super::place::Place;
use serde_json::json;
use snapbox::str;
use taotie_engine::image::{Bitmap, Texels};
use taotie_io::read_bitmap;

fn moving() -> Place {
    let place = Place::with("a.gltf", moving_square());
    write_relief(&place.path("normals.png"), Green::Up);
    place
}

fn picture(place: &Place, name: &str) -> Bitmap {
    read_bitmap(&place.path(name)).expect("it is a picture")
}

/// Returns the mean row of all pixels brighter than the background.
fn height_of_what_is_seen(picture: &Bitmap) -> f64 {
    let Texels::U8(texels) = picture.texels() else { panic!("8 bits") };
    let lit = |i: &usize| texels[*i][..3].iter().any(|c| *c > 90);
    let rows: Vec<usize> = (0..texels.len()).filter(lit).map(|i| i / picture.width() as usize).collect();
    assert!(!rows.is_empty(), "nothing is seen");
    rows.iter().sum::<usize>() as f64 / rows.len() as f64
}

#[test]
fn turntables_are_numbered_and_move() {
    let place = Place::with("a.obj", TRIANGLE);
    let line = "render a.obj -o b.png --size 16x16 --turntable 3";
    place.taotie(line).assert().success().stderr_eq("").stdout_eq(str![[r#"
b.000.png
b.001.png
b.002.png
b.png

"#]]);
    assert_eq!(place.files(), ["a.obj", "b.000.png", "b.001.png", "b.002.png", "b.png"]);
    // Readers without animation support get the first picture.
    assert_eq!(picture(&place, "b.png").texels(), picture(&place, "b.000.png").texels());
    assert!(place.read("b.png").windows(4).any(|chunk| chunk == b"acTL"), "the PNG is animated");
}

#[test]
fn an_animation_as_a_gif_with_its_frames() {
    let place = moving();
    let line = "render a.gltf -o b.gif --size 32x32 --frames 2";
    place.taotie(line).assert().success().stdout_eq(str![[r#"
b.000.png
b.001.png
b.gif

"#]]);
    assert_eq!(place.files(), ["a.gltf", "b.000.png", "b.001.png", "b.gif", "normals.png"]);
    assert_eq!(place.read("b.gif")[..6], *b"GIF89a");
}

#[test]
fn a_sequence_in_exr_does_not_move() {
    let place = moving();
    place.taotie("render a.gltf -o b.exr --size 8x8 --frames 2").assert().success();
    assert_eq!(place.files(), ["a.gltf", "b.000.exr", "b.001.exr", "normals.png"]);
}

/// The square rises by twice its size. The camera does not move, so the picture shows it lower at first than at last,
/// and whole at both ends.
#[test]
fn the_camera_frames_the_whole_motion() {
    let place = moving();
    let seen = |time: f64| {
        let line = format!(
            "render a.gltf -o b.png --size 64x64 --orbit 0,0 --ambient 1 --samples 1 --time {time} --material clay"
        );
        place.taotie(&line).assert().success();
        height_of_what_is_seen(&picture(&place, "b.png"))
    };
    let [first, middle, last, after] = [0.0, 1.0, 2.0, 9.0].map(seen);
    assert!(first > 48.0 && (middle - 31.5).abs() < 1.5 && last < 16.0, "{first} {middle} {last}");
    assert_eq!(last, after, "the last pose holds");
}

/// The camera of the file rises, so the square sinks out of its middle.
#[test]
fn a_camera_of_the_file_moves_with_its_node() {
    let mut json: serde_json::Value = serde_json::from_str(&moving_square()).expect("it is JSON");
    json["animations"][0]["channels"][0]["target"]["node"] = 4.into();
    json["nodes"].as_array_mut().expect("a list").push(json!({ "children": [1] }));
    json["scenes"][0]["nodes"] = json!([0, 4]);
    let place = Place::with("a.gltf", json.to_string());
    let seen = |time: f64| {
        let line = format!(
            "render a.gltf -o b.png --size 64x64 --camera front --ambient 1 --material clay --time {time}"
        );
        place.taotie(&line).assert().success();
        height_of_what_is_seen(&picture(&place, "b.png"))
    };
    let [first, later] = [0.0, 0.5].map(seen);
    assert!((first - 31.5).abs() < 1.5 && later > first + 5.0, "{first} {later}");
}

#[test]
fn a_single_time_writes_one_picture() {
    let place = moving();
    place.taotie("render a.gltf -o b.png --size 8x8 --time 0.5").assert().success().stdout_eq("b.png\n");
    assert_eq!(place.files(), ["a.gltf", "b.png", "normals.png"]);
}

#[test]
fn the_report_tells_animation_and_times() {
    let place = moving();
    let report = |options: &str| {
        let report = place.json(&format!("render a.gltf -o b.png --size 8x8 --json {options}"));
        (report["animation"].clone(), report["times"].clone(), report["files"].as_array().unwrap().len())
    };
    assert_eq!(report(""), (json!(null), json!([]), 1));
    assert_eq!(report("--time 0.5"), (json!("rise"), json!([0.5]), 1));
    assert_eq!(report("--animation rise --frames 4"), (json!("rise"), json!([0.0, 0.5, 1.0, 1.5]), 5));
    assert_eq!(report("--animation 1 --fps 1"), (json!("1"), json!([0.0, 1.0]), 3));
    assert_eq!(report("--turntable 2 --time 1"), (json!("rise"), json!([1.0, 1.0]), 3));
}

#[test]
fn threads_change_no_byte_of_an_animated_image() {
    let place = moving();
    let bytes = |name: &str, threads: u32| {
        let line = format!("render a.gltf -o {name} --size 24x24 --frames 3 --threads {threads}");
        place.taotie(&line).assert().success();
        place.read(name)
    };
    for name in ["b.png", "b.gif"] {
        assert!(bytes(name, 1) == bytes(name, 4), "{name}");
    }
}

#[test]
fn animations_are_listed() {
    let place = moving();
    let said = place.taotie("inspect a.gltf").assert().success();
    let text = String::from_utf8_lossy(&said.get_output().stdout).into_owned();
    let start = text.find("Animations\n").expect("a section");
    snapbox::assert_data_eq!(
        text[start..].split("\n\n").next().unwrap(),
        str![[r#"
Animations
  #  name  seconds  channels  keyframes
  0  rise        2         1          2
  1              2         1          2
"#]]
    );
    let report = place.json("inspect a.gltf --json");
    let expected = json!([
        { "name": "rise", "seconds": 2.0, "channels": 1, "keyframes": 2 },
        { "name": "", "seconds": 2.0, "channels": 1, "keyframes": 2 },
    ]);
    assert_eq!(report["animations"], expected);
}

/// Runs a line that must be refused with `stderr`, and checks that no file was created.
fn refused(line: &str, stderr: snapbox::data::Inline) {
    let place = moving();
    place.write("still.obj", TRIANGLE);
    let before = place.files();
    place.taotie(line).assert().code(2).stdout_eq("").stderr_eq(stderr);
    assert_eq!(place.files(), before, "{line}");
}

#[test]
fn unknown_animation() {
    refused(
        "render a.gltf -o b.png --animation fall --time 0",
        str![[r#"
taotie: error: --animation fall: the file has no such animation; it has: rise, 1

"#]],
    );
}

#[test]
fn no_animation() {
    refused(
        "render still.obj -o b.png --frames 3",
        str![[r#"
taotie: error: still.obj: the file has no animation; leave out --animation, --time, --frames and --fps

"#]],
    );
}

#[test]
fn animation_without_a_time() {
    refused(
        "render a.gltf -o b.png --animation rise",
        str![[r#"
taotie: error: --animation: choose a moment with --time SECONDS, or all of it with --frames N or --fps RATE

"#]],
    );
}

#[test]
fn gif_of_a_still() {
    refused(
        "render a.gltf -o b.gif",
        str![[r#"
taotie: error: b.gif: a .gif holds an animation; add --turntable, --frames or --fps, or write a .png

"#]],
    );
}

#[test]
fn rate_of_a_single_picture() {
    refused(
        "render a.gltf -o b.png --time 1 --fps 3",
        str![[r#"
taotie: error: --fps: a single picture at --time has no rate; leave one of the two out

"#]],
    );
}

#[test]
fn rate_of_nothing() {
    refused(
        "render a.gltf -o b.png --fps 0",
        str![[r#"
taotie: error: --fps: the rate must be above 0 and at most 1000

"#]],
    );
}

#[test]
fn too_many_pictures() {
    let mut json: serde_json::Value = serde_json::from_str(&moving_square()).expect("it is JSON");
    // Times 0 and 2 become 0 and 131072.
    let uri = json["buffers"][1]["uri"].as_str().expect("a text").replacen("AAAAAAAAAEA", "AAAAAAAAAEg", 1);
    json["buffers"][1]["uri"] = uri.into();
    let place = Place::with("a.gltf", json.to_string());
    place.taotie("render a.gltf -o b.png --fps 30").assert().code(2).stderr_eq(str![[r#"
taotie: error: --fps 30: the animation lasts 131072 seconds, which is 3932160 pictures; the maximum is 9999

"#]]);
}
