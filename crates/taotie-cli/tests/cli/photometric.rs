//! `taotie photometric`, on photographs that `taotie render` makes.

use super::place::Place;
use super::schemas;
use serde_json::Value;

const LIGHTS: usize = 12;

/// Returns a wavy sheet as OBJ.
fn waves() -> String {
    const SIDE: usize = 40;
    let mut obj = String::new();
    for i in 0..SIDE * SIDE {
        let [x, y] = [i % SIDE, i / SIDE].map(|v| 2.0 * v as f64 / (SIDE - 1) as f64 - 1.0);
        let z = 0.06 * (libm::sin(5.0 * x) + libm::sin(4.0 * y + 1.0));
        obj += &format!("v {x:.5} {y:.5} {z:.5}\n");
    }
    for (x, y) in (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (x, y))) {
        let corner = y * SIDE + x + 1;
        obj += &format!("f {} {} {} {}\n", corner, corner + 1, corner + SIDE + 1, corner + SIDE);
    }
    obj
}

/// Photographs the sheet from the front, each with its light, and writes `dome.lp` with decimal commas.
fn photographed() -> Place {
    let place = Place::with("waves.obj", waves());
    let mut lp = format!("{LIGHTS}\r\n");
    for k in 0..LIGHTS {
        let (azimuth, elevation) = (60.0 * libm::sin(k as f64 * 2.4), 50.0 * libm::cos(k as f64 * 2.4));
        let [a, e] = [azimuth, elevation].map(f64::to_radians);
        let light = [libm::sin(a) * libm::cos(e), libm::sin(e), libm::cos(a) * libm::cos(e)];
        let light = light.map(|v| format!("{v:.6}").replace('.', ","));
        lp += &format!("D:\\dome\\P{k}.EXR {}\r\n", light.join(" "));
        let direction = format!("directional from={azimuth},{elevation} strength=2");
        let output = format!("p{k}.exr");
        let mut arguments = vec!["render", "waves.obj", "--light", &direction, "-o", &output];
        arguments
            .extend("--shading lambert --env none --orbit 0,0 --fov-deg 3 --size 64 --shadows".split(' '));
        place.taotie_with(&arguments).assert().success();
    }
    place.write("dome.lp", lp);
    let truth = "render waves.obj -o truth.png --aov normals --env none --orbit 0,0 --fov-deg 3 --size 64";
    place.taotie(truth).assert().success();
    std::fs::rename(place.path("truth.normals.exr"), place.path("normals.exr")).expect("it was written");
    for other in ["truth.png", "truth.normals.png"] {
        std::fs::remove_file(place.path(other)).expect("it was written");
    }
    place
}

#[test]
fn normals_are_those_of_the_model() {
    let place = photographed();
    let run = place.taotie("photometric dome.lp -o out --truth normals.exr --json").assert().success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("it is JSON");
    schemas::check("photometric", &report);
    assert_eq!(report["photographs"].as_array().expect("a list").len(), LIGHTS);
    assert_eq!((&report["encoding"], &report["layout"]), (&"linear".into(), &"lp".into()));
    let mean = |which: &str| report["truth"][which]["mean"].as_f64().expect("a number");
    assert!(mean("robust") < 1.0, "{report:#}");
    assert!(mean("best") < 2.0, "{report:#}");
    for name in [
        "normals.png",
        "normals.exr",
        "sigma.png",
        "sigma.exr",
        "albedo.png",
        "base_color.png",
        "roughness.png",
        "residual.exr",
        "mask.png",
        "plane.glb",
        "depth.exr",
        "relief.glb",
    ] {
        assert!(place.path("out").join(name).is_file(), "{name}");
    }
    let page = String::from_utf8(place.read("out/report.html")).expect("it is text");
    for part in
        ["<title>dome.lp</title>", "id=\"taotie-data\"", "\"least squares\"", "\"Worst pixels\"", "p11.exr"]
    {
        assert!(page.contains(part), "{part}");
    }
    let written: Value = serde_json::from_slice(&place.read("out/report.json")).expect("it is JSON");
    assert_eq!(written["sigma"], report["sigma"]);
    place.taotie("diff normals.exr out/normals.exr --metric angle --threshold 2").assert().code(0);
}

#[test]
fn the_text_states_what_was_assumed() {
    let place = photographed();
    std::fs::create_dir(place.path("masks")).expect("it is new");
    place.taotie("photometric dome.lp -o masks").assert().success();
    let run = place.taotie("photometric . -o out --threads 1 --mask masks/mask.png").assert().success();
    let text = String::from_utf8_lossy(&run.get_output().stdout).into_owned();
    let first = "read       12 photographs of 64x64, 32 bits, linear; lights from ./dome.lp\n";
    assert!(text.replace(".\\dome", "./dome").starts_with(first), "{text}");
    for line in [
        "\nmask       masks/mask.png\n",
        "\nsigma      mean ",
        "\nrejection  mean ",
        "\nworst      p",
        "\nwrote normals.png, ",
    ] {
        assert!(text.contains(line), "{line:?}: {text}");
    }
    place.taotie("photometric dome.lp -o again --threads 2 --mask masks/mask.png").assert().success();
    for name in [
        "normals.exr",
        "roughness.png",
        "base_color.png",
        "sigma.exr",
        "residual.exr",
        "depth.exr",
        "relief.glb",
    ] {
        assert_eq!(place.read(&format!("out/{name}")), place.read(&format!("again/{name}")), "{name}");
    }
}

#[test]
fn relightable_images_are_written_and_give_normals_again() {
    let place = photographed();
    let command = "photometric dome.lp -o out --relight ptm,ptm-rgb,rti,openlime --json";
    let run = place.taotie(command).assert().success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("it is JSON");
    schemas::check("photometric", &report);
    let relit = report["relight"].as_array().expect("a list");
    assert_eq!(relit.len(), 4);
    for (relit, file) in
        relit.iter().zip(["relight.ptm", "relight_rgb.ptm", "relight.rti", "openlime/info.json"])
    {
        assert_eq!(relit["file"], file);
        assert!(relit["psnr"].as_f64().expect("a number") > 25.0, "{relit}");
        let again = format!("photometric out/{file} -o again --truth normals.exr --json");
        let run = place.taotie(&again).assert().success();
        let warning = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert!(warning.contains("relit from an image") && !warning.contains("--encoding"), "{warning}");
        let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("it is JSON");
        schemas::check("photometric", &report);
        assert_eq!(report["layout"], "relightable");
        let mean = report["truth"]["best"]["mean"].as_f64().expect("a number");
        assert!(mean < 6.0, "{file}: {mean}");
    }
    // A folder with the description is the same as the description.
    place.taotie("photometric out/openlime -o web").assert().success();
    assert_eq!(place.read("web/normals.exr"), place.read("again/normals.exr"));
    let run = place.taotie("photometric out/relight.ptm -o x --relight rti").assert().code(2);
    let error = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
    assert!(error.contains("out/relight.ptm is relightable already"), "{error}");
}

#[test]
fn errors_are_errors_and_leave_nothing_behind() {
    let place = photographed();
    place.write("short.lp", "3\np0.exr 0 0 1\n");
    for (line, words) in [
        ("photometric short.lp -o out", "short.lp: line 1: 3 lights stated, but 1 follow"),
        ("photometric dome.lp -o out --mask dome.lp", "dome.lp"),
        ("photometric dome.lp -o out --memory-limit 1M", "--memory-limit"),
        ("photometric dome.lp -o out --encoding gamma", "unknown encoding of photographs `gamma`"),
        ("photometric . -o out", "several files of lights"),
        ("photometric dome.lp -o out --relight jpg", "unknown relightable format `jpg`"),
        ("photometric dome.lp -o .", "-o .: the folder of the photographs"),
    ] {
        let run = place.taotie(line).assert().code(2).stdout_eq("");
        let error = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert!(error.contains(words), "{line}: {error}");
        assert!(!place.path("out").exists(), "{line}");
    }
}
