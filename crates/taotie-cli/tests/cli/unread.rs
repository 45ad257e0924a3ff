//! Nothing is ignored silently: a table for each subcommand of options without effect, and of files that cannot be
//! written. If the options suffice to know, they are refused; if it depends on the files, there is a warning.

use super::balls::{LOW, SCAN};
use super::models::{Green, TRIANGLE, square_json, write_ball, write_relief};
use super::place::Place;
use serde_json::Value;

/// Runs lines that must be refused, each with its message, before anything is done.
fn refused(place: &Place, command: &str, cases: &[(&str, &str)]) {
    let before = place.files();
    for (line, words) in cases {
        let assert = place.taotie(&format!("{command} {line}")).assert().code(2).stdout_eq("");
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(words) && !said.contains("baking"), "{line}: {said}");
        assert_eq!(place.files(), before, "{line}");
    }
}

/// Runs lines that must succeed with a warning, which is on stderr with and without `--json`.
fn warned(place: &Place, command: &str, cases: &[(&str, &str)]) {
    for (line, words) in cases {
        for json in ["", "--json"] {
            let assert = place.taotie(&format!("{command} {line} {json}")).assert().success();
            let output = assert.get_output();
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(said.contains(&format!("taotie: warning: {words}")), "{line} {json}: {said}");
            let report: Result<Value, _> = serde_json::from_slice(&output.stdout);
            assert_eq!(report.is_ok(), json == "--json", "{line} {json}");
        }
    }
}

/// Runs a line that must succeed without a warning.
fn silent(place: &Place, line: &str) {
    place.taotie(line).assert().success().stderr_eq("");
}

/// Returns a triangle, and a square with a normal map.
fn models() -> Place {
    let place = Place::with("a.obj", TRIANGLE);
    place.write("b.gltf", square_json().to_string());
    write_relief(&place.path("normals.png"), Green::Up);
    write_ball(&place.path("ball.png"));
    place
}

#[test]
fn of_render() {
    let place = models();
    std::fs::create_dir(place.path("c.png")).unwrap();
    let cases = [
        ("a.obj -o o.png --env-rotate-deg 0", "--env-rotate-deg: there is no environment; add --env"),
        ("a.obj -o o.png --env-intensity 1", "--env-intensity: there is no environment; add --env"),
        ("a.obj -o o.png --env none --env-intensity 2", "--env-intensity: there is no environment"),
        ("a.obj -o o.png --show-env", "--show-env: there is no environment; add --env"),
        ("a.obj -o o.png --env studio --show-env --background red", "--background: --show-env shows"),
        ("a.obj -o o.png --normal-space object", "--normal-map <FILE>"),
        ("b.gltf -o o.png --camera front --fov-deg 20", "cannot be used with"),
        ("b.gltf -o o.png --camera front --target 0,0,0", "cannot be used with"),
        (
            "b.gltf -o o.png --surface smooth --normal-map ball.png",
            "--normal-map: --surface smooth does not use it",
        ),
        (
            "b.gltf -o o.png --surface facet --height-map ball.png",
            "--height-map: --surface facet does not use it",
        ),
        (
            "b.gltf -o o.png --surface tangent-normal --bump-scale 2",
            "--bump-scale: --surface tangent-normal does",
        ),
        ("a.obj -o o.png --shading phong --energy single", "--energy: only ggx and cook-torrance use it"),
        (
            "a.obj -o o.png --shading ggx-printed --specular-aa on",
            "--specular-aa: the printed models take no",
        ),
        (
            "a.obj -o o.png --shading ggx-printed --grazing-normals keep",
            "--grazing-normals: the printed models",
        ),
        (
            "a.obj -o o.png --integrator reference --specular-aa on",
            "--specular-aa: --integrator reference averages",
        ),
        ("a.obj -o o.png --slope 0.3", "--slope: the shading does not use it"),
        ("a.obj -o o.png --shininess 9", "--shininess: the shading does not use it"),
        ("a.obj -o o.png --shading lambert --roughness 0", "--roughness: the shading does not use it"),
        ("a.obj -o o.png --roughness 2", "2 is not in [0, 1]"),
        ("a.obj -o o.exr --turntable 2 --fps 8", "--fps has no effect for .exr turntables"),
        ("a.obj -o o.exr --tone aces", "--tone: an .exr stores undeveloped linear light"),
        ("a.obj -o o.exr --exposure 1", "--exposure: an .exr stores undeveloped linear light"),
        ("a.obj -o o.exr --background white", "--background: an .exr stores undeveloped linear light"),
        ("a.obj -o o.exr --bits 16", "--bits: an .exr stores 32-bit floats"),
        ("a.obj -o c.png", "c.png: expected a file, found a folder"),
        ("a.obj -o none/o.png", "none: the folder does not exist; create it first"),
    ];
    refused(&place, "render", &cases);
    let cases = [
        ("a.obj -o o.png --size 8x8 --green down", "--green has no effect: no material has a normal map"),
        (
            "a.obj -o o.png --size 8x8 --bump-scale 2",
            "--bump-scale has no effect: no material has a height map",
        ),
        (
            "a.obj -o o.png --size 8x8 --tangents face",
            "--tangents has no effect: no material has a normal map",
        ),
        (
            "a.obj -o o.png --size 8x8 --base-color-map ball.png",
            "--base-color-map shows one texel everywhere",
        ),
        ("a.obj -o o.png --size 8x8 --occlusion-map ball.png", "--occlusion-map shows one texel everywhere"),
        (
            "b.gltf -o o.png --size 8x8 --surface smooth --tangents face",
            "--tangents has no effect: no normal map is used",
        ),
        (
            "b.gltf -o o.png --size 8x8 --height-map ball.png",
            "heights have no effect: a normal map takes precedence",
        ),
    ];
    warned(&place, "render", &cases);
    silent(
        &place,
        "render a.obj -o o.png --size 8x8 --shading phong --grazing-normals keep --tone aces --bits 16",
    );
    silent(&place, "render a.obj -o o.exr --size 8x8 --tone linear --exposure 0");
}

#[test]
fn of_compare() {
    let place = models();
    place.write("file", "");
    let cases = [
        ("b.gltf -o out --method smooth", "--method smooth: nothing to compare it with; add more methods"),
        ("b.gltf -o out --method smooth,smooth", "--method smooth: nothing to compare it with"),
        ("b.gltf -o out --match uv", "--reference <HIGH>"),
        (
            "b.gltf -o out --method smooth,facet --normal-map ball.png",
            "--normal-map: no method of --method uses it",
        ),
        (
            "b.gltf -o out --method smooth,facet --height-map ball.png",
            "--height-map: no method of --method uses it",
        ),
        (
            "b.gltf -o out --method smooth,bump:5 --bump-scale 2",
            "--bump-scale: no method of --method uses it",
        ),
        ("b.gltf -o out --env-rotate-deg 9", "--env-rotate-deg: there is no environment"),
        (
            "b.gltf -o out --shading phong,lambert --energy single",
            "--energy: only ggx and cook-torrance use it",
        ),
        ("--paper --method smooth", "cannot be used with"),
        ("--paper --size 9x9", "cannot be used with"),
        ("--paper --env studio --threads 2", "cannot be used with"),
        ("b.gltf -o file", "file: expected a folder, found a file"),
        ("b.gltf -o file/out", "file: expected a folder, found a file"),
    ];
    refused(&place, "compare", &cases);
    let cases = [
        (
            "a.obj -o out --size 16x16 --method smooth,facet --green down",
            "--green has no effect: no material",
        ),
        (
            "b.gltf -o out --size 16x16 --method smooth,facet --tangents face",
            "--tangents has no effect: no normal map is used",
        ),
    ];
    warned(&place, "compare", &cases);
}

#[test]
fn of_bake() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    for name in ["a.report.html", "b.report.json", "c.glb"] {
        std::fs::create_dir(place.path(name)).unwrap();
    }
    let cases = [
        (
            "scan.obj -o out.glb --ao-rays 64",
            "--ao-rays: none of ao, bent, thickness and bevel is baked; add one of them to --maps",
        ),
        (
            "scan.obj -o out.glb --ao-distance 1 --maps normal,height",
            "--ao-distance: neither ao nor bent is baked",
        ),
        ("scan.obj -o out.glb --bits 16 --images webp", "--bits 16: WebP stores 8 bits"),
        ("scan.obj -o out.glb --bits 16 --images ktx2", "--bits 16: KTX2 stores 8 bits"),
        ("scan.obj -o out.glb --images ktx2:2 --size 1022", "--size 1022: KTX2 needs multiples of 4"),
        ("scan.obj -o out.glb --size 64 --images webp,png", "--images: these options run no search"),
        ("scan.obj -o out.glb --size 64 --images jpeg", "--images: specify a quality, such as jpeg:85"),
        (
            "scan.obj -o out.glb --size 64 --maps height,bent --images webp",
            "--images: the asset has no textures",
        ),
        (
            "scan.obj -o out.glb --maps normal --space object --images ktx2",
            "--images: the asset has no textures",
        ),
        (
            "scan.obj -o out.glb --maps normal --images jpeg:80",
            "--images jpeg:80: the only textures are normals",
        ),
        ("scan.obj -o out.glb --images jpeg:0", "image format jpeg:0: use 1 to 100"),
        ("scan.obj -o out.glb --images webp:80 --maps normal", "which the quality does not affect; use webp"),
        (
            "scan.obj -o out.glb --images ktx2:2 --maps normal,height",
            "which the quality does not affect; use ktx2",
        ),
        ("scan.obj -o out.glb --images ktx2:65", "image format ktx2:65: use 0 to 64"),
        ("scan.obj -o out.glb --error 1 --images webp:80", "--error chooses the quality of images"),
        ("scan.obj -o out.glb --images webp:85,png", "a list takes names only"),
        ("scan.obj -o out.glb --trials out.report.json", "--trials out.report.json: choose another file"),
        ("scan.obj -o out.glb --preset web --size 64", "cannot be used with"),
        (
            "scan.obj -o out.glb --preset games",
            "unknown preset `games`: expected one of: web, archive, engine",
        ),
        ("scan.obj -o out.glb --max-triangles 100 --maps height", "--max-triangles needs a normal map"),
        ("scan.obj -o a.glb", "a.report.html: expected a file, found a folder"),
        ("scan.obj -o b.glb", "b.report.json: expected a file, found a folder"),
        ("scan.obj -o c.glb", "c.glb: expected a file, found a folder"),
    ];
    refused(&place, "bake", &cases);
    let line = "scan.obj --low low.obj -o out.glb --size 32 --no-verify";
    let cases = [
        (format!("{line} --maps normal --roughness 0.5"), "the roughness has no effect"),
        (format!("{line} --maps height --bits 16"), "16 bits have no effect"),
        (format!("{line} --maps height --space object"), "object space has no effect"),
    ];
    let cases: Vec<(&str, &str)> = cases.iter().map(|(line, words)| (line.as_str(), *words)).collect();
    warned(&place, "bake", &cases);
    let line = format!("bake {line} --space object --bits 16 --images webp");
    let assert = place.taotie(&line).assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(!said.contains("16 bits"), "the map next to the asset has them: {said}");
    place.taotie("bake scan.obj --low low.obj -o a.glb --size 32 --no-verify").assert().success();
    let line = "bake scan.obj -o out.glb --triangles 800 --size 64 --no-verify";
    for options in [
        "--bits 16 --images webp --maps normal,bent",
        "--bits 16 --images webp --green down",
        "--maps normal,alpha --images jpeg:85",
    ] {
        place.taotie(&format!("{line} {options}")).assert().success();
    }
}

#[test]
fn of_normals() {
    let place = models();
    let cases = [
        ("normals.png -o o.png --uv-set 1", "--mesh <MODEL>"),
        ("normals.png -o o.png --tangents face", "--mesh <MODEL>"),
        ("normals.png -o o.png --dilation 3", "--mesh <MODEL>"),
        ("normals.png -o none/o.png", "none: the folder does not exist; create it first"),
    ];
    refused(&place, "normals", &cases);
    let tangent = "normals.png --from tangent --green-in up -o o.png";
    let object = "ball.png --from object -o o.png";
    let cases = [
        (
            format!("{object} --green-in up"),
            "--green-in has no effect: the input is not a tangent-space normal map",
        ),
        (format!("{object} --green up"), "--green has no effect: object-space normals have no green"),
        (format!("{tangent} --height-scale 2"), "--height-scale has no effect: the input holds no heights"),
        (format!("{tangent} --border clamp"), "--border has no effect: the input holds no heights"),
        (format!("{tangent} --mesh b.gltf"), "--mesh has no effect: the normals stay in their space"),
    ];
    let cases: Vec<(&str, &str)> = cases.iter().map(|(line, words)| (line.as_str(), *words)).collect();
    warned(&place, "normals", &cases);
    silent(&place, &format!("normals {tangent} --green down"));
}

#[test]
fn of_diff() {
    let place = models();
    let cases = [
        (
            "ball.png normals.png --metric rmse --pixels-per-degree 30",
            "--pixels-per-degree: only FLIP uses it",
        ),
        ("ball.png normals.png --heat-top 1", "--heat <OUT>"),
        ("ball.png normals.png --threshold 1", "--metric <METRIC>"),
        ("ball.png normals.png --heat none/o.png", "none: the folder does not exist; create it first"),
    ];
    refused(&place, "diff", &cases);
    let line = "normals.png normals.png --encoding unit";
    let cases = [
        (format!("{line} --background white"), "--background has no effect: normals are compared by angle"),
        (format!("{line} --pixels-per-degree 30"), "--pixels-per-degree has no effect: normals are compared"),
    ];
    let cases: Vec<(&str, &str)> = cases.iter().map(|(line, words)| (line.as_str(), *words)).collect();
    warned(&place, "diff", &cases);
    silent(&place, "diff normals.png ball.png --encoding color --background white --pixels-per-degree 30");
}

#[test]
fn of_materials_and_demo() {
    let place = Place::with("file", "");
    let cases = [
        ("materials --size 32", "--output <FILE.png>"),
        ("materials -o none/swatches.png", "none: the folder does not exist; create it first"),
        ("demo --out file", "file: expected a folder, found a file"),
    ];
    refused(&place, "", &cases);
}

/// Nobody can create a file in `/proc`, not even root.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_refuses_is_told_before_the_work() {
    let place = Place::with("scan.obj", SCAN.obj());
    write_relief(&place.path("normals.png"), Green::Up);
    let lines = [
        "render scan.obj -o /proc/o.png",
        "bake scan.obj -o /proc/o.glb",
        "normals normals.png -o /proc/o.png",
        "diff normals.png normals.png --heat /proc/o.png",
        "materials -o /proc/o.png",
    ];
    lines.iter().for_each(|line| refused(&place, line, &[("", "/proc/o.")]));
    let lines = ["compare scan.obj -o /proc/o", "demo --out /proc/o"];
    lines.iter().for_each(|line| refused(&place, line, &[("", "/proc/o")]));
}
