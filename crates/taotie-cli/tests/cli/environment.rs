//! `--env`: inputs, errors and the cache; and the list of materials.

use super::models::{TRIANGLE, square_json};
use super::place::Place;
use snapbox::cmd::Command;
use std::path::PathBuf;
use taotie_engine::image::Texels;
use taotie_io::{ExrLayer, read_bitmap, write_exr};

/// A square and an environment of one radiance, with its own cache.
struct Room(Place);

impl Room {
    fn new() -> Self {
        let place = Place::with("a.gltf", square_json().to_string());
        let samples: Vec<f32> = [0.5, 0.25, 0.125].into_iter().cycle().take(16 * 8 * 3).collect();
        let layer = ExrLayer { name: "", channels: &["R", "G", "B"], samples: &samples };
        write_exr(&place.path("sky.exr"), (16, 8), &[layer]).unwrap();
        Self(place)
    }

    fn taotie(&self, line: &str) -> Command {
        self.0.taotie(line).env("TAOTIE_CACHE_DIR", self.0.path("cache"))
    }

    fn cached(&self) -> Vec<PathBuf> {
        let entries =
            std::fs::read_dir(self.0.path("cache")).map(|all| all.flatten().map(|e| e.path()).collect());
        entries.unwrap_or_default()
    }

    /// Returns the colour in the corner of a picture, outside the model.
    fn corner(&self, line: &str) -> [u8; 4] {
        self.taotie(&format!("render a.gltf -o b.png --size 24x24 --orbit 0,0,9 --tone linear {line}"))
            .assert()
            .success();
        let picture = read_bitmap(&self.0.path("b.png")).expect("it is a picture");
        let Texels::U8(texels) = picture.texels() else { panic!("8 bits") };
        texels[0]
    }
}

#[test]
fn an_environment_is_seen_where_it_is_asked_for() {
    let room = Room::new();
    // sRGB of 0.5, 0.25 and 0.125.
    assert_eq!(room.corner("--env sky.exr --show-env"), [188, 137, 99, 255]);
    assert_eq!(room.corner("--env sky.exr --show-env --env-intensity 2"), [255, 188, 137, 255]);
    assert_eq!(room.corner("--env sky.exr --background transparent")[3], 0);
}

#[test]
fn what_is_cached_gives_the_same_picture_and_what_is_broken_is_made_anew() {
    let room = Room::new();
    let picture = |room: &Room| {
        room.taotie("render a.gltf --env sky.exr -o b.png --size 24x24").assert().success();
        std::fs::read(room.0.path("b.png")).unwrap()
    };
    let cold = picture(&room);
    let kept = room.cached();
    assert_eq!(kept.len(), 1, "{kept:?}");
    assert_eq!(picture(&room), cold);
    let whole = std::fs::read(&kept[0]).unwrap();
    std::fs::write(&kept[0], &whole[..whole.len() / 2]).unwrap();
    assert_eq!(picture(&room), cold);
    assert_eq!(std::fs::read(&kept[0]).unwrap(), whole, "the broken file is replaced");
}

#[test]
fn what_cannot_be_is_refused_in_one_line() {
    let room = Room::new();
    std::fs::write(room.0.path("tall.hdr"), b"not a picture").unwrap();
    for (options, why) in [
        ("--show-env", "--show-env: there is no environment"),
        ("--env none --show-env", "--show-env: there is no environment"),
        ("--env nowhere.hdr", "nowhere.hdr"),
        ("--env tall.hdr", "tall.hdr"),
        ("--env studio --env-intensity=-1", "--env-intensity"),
        ("--ground --spp 4", "--spp"),
    ] {
        let output = room.taotie(&format!("render a.gltf -o b.png {options}")).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{options}: {said}");
        assert!(said.contains(why) && said.trim().lines().count() <= 4, "{options}: {said}");
    }
}

#[test]
fn shadows_that_nothing_casts_are_told() {
    let room = Room::new();
    room.0.write("a.obj", TRIANGLE);
    let warns = |model: &str| {
        let assert =
            room.taotie(&format!("render {model} -o b.png --size 8x8 --env sky.exr --shadows")).assert();
        let said = String::from_utf8_lossy(&assert.success().get_output().stderr).into_owned();
        said.contains("warning: --shadows has no effect: the environment is the only light")
    };
    assert!(warns("a.obj") && !warns("a.gltf"), "the second has a lamp");
}

#[test]
fn the_materials_are_listed_with_their_colours() {
    let room = Room::new();
    let list = room.0.json("materials --json");
    let bronze = list["materials"].as_array().unwrap().iter().find(|m| m["name"] == "bronze").unwrap();
    assert_eq!(bronze["source"], "Querry 1985");
    assert!((bronze["f0"][0].as_f64().unwrap() - 0.963).abs() < 1e-3);
    room.taotie("materials -o swatches.png --size 16").assert().success();
    let sheet = read_bitmap(&room.0.path("swatches.png")).unwrap();
    assert!(sheet.width() > 4 * 16 && sheet.height() > 2 * 16);
}
