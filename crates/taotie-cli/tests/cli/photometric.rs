//! `taotie photometric`, on photographs that `taotie render` makes.

use super::photographs::{LIGHTS, photograph, waves};
use super::place::Place;
use super::schemas;
use serde_json::Value;

/// Photographs the sheet from the front, and writes its true normals.
fn photographed() -> Place {
    let place = Place::new();
    photograph(&place.path(""));
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

/// Photographs of a wavy sheet from several sides, as EXR, with `transforms.json`.
fn from_all_sides() -> Place {
    const SIDE: usize = 24;
    const COUNT: usize = 16;
    let mut obj = String::from("mtllib sheet.mtl\nusemtl paint\n");
    for i in 0..SIDE * SIDE {
        let [u, v] = [i % SIDE, i / SIDE].map(|v| v as f64 / (SIDE - 1) as f64);
        let z = 0.03 * (libm::sin(10.0 * u) + libm::sin(8.0 * v));
        obj += &format!("v {:.5} {:.5} {z:.5}\nvt {u:.5} {v:.5}\n", 2.0 * u - 1.0, 2.0 * v - 1.0);
    }
    for (x, y) in (0..SIDE - 1).flat_map(|y| (0..SIDE - 1).map(move |x| (x, y))) {
        let a = y * SIDE + x + 1;
        let corners = [a, a + 1, a + SIDE + 1, a + SIDE].map(|v| format!("{v}/{v}"));
        obj += &format!("f {}\n", corners.join(" "));
    }
    let place = Place::with("sheet.obj", obj);
    place.write("sheet.mtl", "newmtl paint\nKd 0.5 0.2 0.1\nPr 0.4\nPm 0\n");
    let mut frames = Vec::new();
    for k in 0..COUNT {
        let [azimuth, elevation] = [35.0 * libm::sin(2.4 * k as f64), 30.0 * libm::cos(1.7 * k as f64)];
        let from = [40.0 * libm::cos(1.1 * k as f64), 30.0 * libm::sin(1.3 * k as f64)];
        let (orbit, light) = (
            format!("{azimuth},{elevation},6"),
            format!("directional from={},{} strength=2", from[0], from[1]),
        );
        let output = format!("side{k}.exr");
        let mut arguments = vec!["render", "sheet.obj", "--light", &light, "-o", &output, "--orbit", &orbit];
        arguments
            .extend("--target 0,0,0 --fov-deg 25 --env none --size 64 --shadows --shading ggx".split(' '));
        place.taotie_with(&arguments).assert().success();
        let [(sa, ca), (se, ce)] =
            [azimuth, elevation].map(|v: f64| (libm::sin(v.to_radians()), libm::cos(v.to_radians())));
        let (right, up, back) = ([ca, 0.0, -sa], [-se * sa, ce, -se * ca], [ce * sa, se, ce * ca]);
        let row = |i: usize| format!("[{}, {}, {}, {}]", right[i], up[i], back[i], 6.0 * back[i]);
        let [a, e] = from.map(f64::to_radians);
        let light = [libm::sin(a) * libm::cos(e), libm::sin(e), libm::cos(a) * libm::cos(e)];
        frames.push(format!(
            "{{\"file_path\": \"side{k}.exr\", \"transform_matrix\": [{}, {}, {}, [0, 0, 0, 1]], \"light\": \
             {{\"direction\": {light:?}, \"space\": \"camera\", \"intensity\": 2}}}}",
            row(0),
            row(1),
            row(2)
        ));
    }
    let angle = 25_f64.to_radians();
    let text = format!(
        "{{\"camera_angle_y\": {angle}, \"w\": 64, \"h\": 64, \"frames\": [{}]}}",
        frames.join(",\n")
    );
    place.write("transforms.json", text);
    place
}

#[test]
fn materials_are_those_of_the_model() {
    let place = from_all_sides();
    let command = "photometric transforms.json --model sheet.obj -o out --json --threads 2";
    let run = place.taotie(command).assert().success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("it is JSON");
    schemas::check("photometric-materials", &report);
    let material = &report["materials"][0];
    let number = |name: &str| material[name].as_f64().expect("a number");
    assert!((number("roughness") - 0.4).abs() < 0.05, "{report:#}");
    assert!(number("metallic") < 0.1 && number("samples") > 10.0, "{report:#}");
    assert_eq!((&report["side"], &material["keeps_metallic"]), (&64.into(), &false.into()));
    place.taotie("photometric transforms.json --model sheet.obj -o again --threads 1").assert().success();
    for name in [
        "base_color.png",
        "roughness.png",
        "metallic.png",
        "mask.png",
        "base_color_sigma.exr",
        "sigma.exr",
        "model.glb",
    ] {
        assert_eq!(place.read(&format!("out/{name}")), place.read(&format!("again/{name}")), "{name}");
    }
    place.taotie("render out/model.glb -o picture.png --size 32").assert().success();
}

#[test]
fn cameras_that_do_not_fit_are_errors() {
    let place = from_all_sides();
    let text = String::from_utf8(place.read("transforms.json")).expect("it is text");
    let why = |text: String, model: &str| {
        place.write("other.json", text);
        let run = place.taotie(&format!("photometric other.json --model {model} -o out")).assert().failure();
        String::from_utf8_lossy(&run.get_output().stderr).into_owned()
    };
    assert!(why(text.replace("side3.exr", "side33.exr"), "sheet.obj").contains("side33.exr' does not exist"));
    let error = why(text.replace("\"w\": 64", "\"w\": 80"), "sheet.obj");
    assert!(error.contains("64x64 pixels") && error.contains("80x64"), "{error}");
    let away = text.replace("\"direction\": [", "\"direction\": [0, 0, -1], \"x\": [");
    assert!(why(away, "sheet.obj").contains("unknown field"));
    let behind = text.replace("\"space\": \"camera\", \"intensity\": 2", "\"intensity\": 2");
    let behind = behind.split("\"direction\": [").enumerate().map(|(i, part)| match i {
        0 => part.to_owned(),
        _ => format!("\"direction\": [0, 0, -1{}", &part[part.find(']').expect("a vector")..]),
    });
    assert!(why(behind.collect(), "sheet.obj").contains("no photograph shows a lit part"));
    place.write("bare.obj", waves());
    assert!(why(text, "bare.obj").contains("texture coordinates"));
}

#[test]
fn large_shapes_of_the_depth_follow_a_scan() {
    let place = photographed();
    // The camera of `--orbit 0,0 --fov-deg 3`, which fills the picture with the sheet.
    let inspect = place.taotie("photometric dome.lp -o plain --json").assert().success();
    let plain: Value = serde_json::from_slice(&inspect.get_output().stdout).expect("it is JSON");
    assert_eq!(plain["scan"], Value::Null);
    let pose = |z: f64| {
        format!(
            "{{\"camera_angle_y\": {}, \"w\": 64, \"h\": 64, \"transform_matrix\": \
             [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, {z}], [0, 0, 0, 1]]}}",
            3_f64.to_radians()
        )
    };
    place.write("camera.json", pose(40.0));
    let command = "photometric dome.lp -o out --scan waves.obj --pose camera.json --json";
    let run = place.taotie(command).assert().success();
    let report: Value = serde_json::from_slice(&run.get_output().stdout).expect("it is JSON");
    schemas::check("photometric", &report);
    let number = |name: &str| report["scan"][name].as_f64().expect("a number");
    assert!(number("scanned") > 2000.0 && number("residual") < 0.8, "{report:#}");
    assert!(place.path("out/depth_anchored.png").is_file());
    place.write("camera.json", pose(-40.0));
    let run =
        place.taotie("photometric dome.lp -o out --scan waves.obj --pose camera.json").assert().failure();
    assert!(String::from_utf8_lossy(&run.get_output().stderr).contains("does not see the scan"));
    let run = place.taotie("photometric dome.lp -o out --scan waves.obj").assert().failure();
    assert!(String::from_utf8_lossy(&run.get_output().stderr).contains("--pose"));
}
