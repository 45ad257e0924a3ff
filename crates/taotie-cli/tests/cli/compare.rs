//! `taotie compare`: its measurements, its files and its errors.

use super::pictures::write_square;
use super::place::Place;
use serde_json::Value;
use taotie_engine::image::Encoding;
use taotie_engine::math::scalar;
use taotie_io::PngSamples;

/// A square of side 2 that faces +z, with upright UVs and the maps of `square.mtl`.
const SQUARE: &str = "mtllib square.mtl\nusemtl square\n\
    v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n\
    f 1/1/1 2/2/1 3/3/1 4/4/1\n";

/// The camera of all tests: head on.
const FRONT: &str = "--orbit 0,0 --size 64x64";

/// Writes a picture of 16-bit texels.
fn write_map(place: &Place, name: &str, side: u32, texel: impl Fn(u32, u32) -> [f64; 3]) {
    let code = |v: f64| (v * 65535.0 + 0.5) as u16;
    let samples: Vec<u16> = (0..side * side).flat_map(|i| texel(i % side, i / side).map(code)).collect();
    write_square(&place.path(name), PngSamples::U16(&samples), Encoding::Linear);
}

/// A square whose normal map tilts all of it by `degrees` towards +x, and a flat one as the truth.
fn tilted(degrees: f64) -> Place {
    let place = Place::with("square.obj", SQUARE);
    let [sin, cos] = [scalar::sin(degrees.to_radians()), scalar::cos(degrees.to_radians())];
    write_map(&place, "tilted.png", 16, |_, _| [sin * 0.5 + 0.5, 0.5, cos * 0.5 + 0.5]);
    place.write("square.mtl", "newmtl square\nKd 0.6 0.6 0.6\nnorm tilted.png\n");
    place.write("flat.obj", SQUARE.replace("mtllib square.mtl\nusemtl square\n", ""));
    place
}

fn compared(place: &Place, line: &str) -> Value {
    place.json(&format!("compare {line} {FRONT} -o out --json"))
}

/// The figures of a method.
fn method<'a>(report: &'a Value, name: &str) -> &'a Value {
    let methods = report["methods"].as_array().expect("a list of methods");
    methods.iter().find(|method| method["method"] == name).unwrap_or_else(|| panic!("{name} in {report}"))
}

fn error(report: &Value, name: &str, part: &str, figure: &str) -> f64 {
    method(report, name)["error"][part][figure].as_f64().expect("a number")
}

#[test]
fn the_angle_of_a_tilted_map_is_its_tilt_in_both_spaces() {
    for how in ["normal", "uv", "pixel"] {
        let place = tilted(20.0);
        let line = "square.obj --reference flat.obj --method smooth,object-normal,tangent-normal --match";
        let report = compared(&place, &format!("{line} {how}"));
        for part in ["all", "inner"] {
            for figure in ["mean", "median", "p95", "max"] {
                assert!(error(&report, "smooth", part, figure) < 0.01, "{how}");
                for name in ["object-normal", "tangent-normal"] {
                    let angle = error(&report, name, part, figure);
                    assert!((angle - 20.0).abs() < 0.01, "{name} by {how}, {part} {figure}: {angle}");
                }
            }
        }
        assert_eq!(report["unmatched"], 0.0);
        let histogram = method(&report, "tangent-normal")["error"]["histogram"].as_array().unwrap();
        let total: u64 = histogram.iter().map(|count| count.as_u64().unwrap()).sum();
        let near = histogram[19].as_u64().unwrap() + histogram[20].as_u64().unwrap();
        assert_eq!((Some(total), near), (method(&report, "smooth")["error"]["all"]["count"].as_u64(), total));
    }
}

#[test]
fn without_a_reference_angles_are_measured_from_the_first_method() {
    let place = tilted(30.0);
    let report = compared(&place, "square.obj --method tangent-normal,smooth");
    assert_eq!(report["against"], "tangent-normal");
    assert!(method(&report, "tangent-normal")["error"].is_null());
    assert!((error(&report, "smooth", "all", "mean") - 30.0).abs() < 0.01);
    let points = report["points"].as_array().unwrap();
    assert_eq!(points.len(), 10);
    for point in points {
        let [first, second] = point["normals"].as_array().unwrap().as_slice() else { panic!("two methods") };
        assert!(first["angle_to_first"].is_null() && first["error"].is_null());
        let [a, b] = [&second["angle_to_first"], &second["error"]].map(|angle| angle.as_f64().unwrap());
        assert!((a - 30.0).abs() < 0.01 && a == b, "{a} {b}");
        let normal: Vec<f64> = first["normal"].as_array().unwrap().iter().filter_map(Value::as_f64).collect();
        assert!((normal[0] - 0.5).abs() < 1e-3 && normal[1].abs() < 1e-3, "{normal:?}");
    }
}

#[test]
fn bump_by_a_factor_raises_white_by_so_many_texels() {
    // A ramp from black to white over 33 texels has a slope of 1/32 of white a texel: 16 texels of white give 1/2.
    let place = Place::with("square.obj", SQUARE);
    write_map(&place, "ramp.png", 33, |x, _| [f64::from(x) / 32.0; 3]);
    place.write("square.mtl", "newmtl square\nmap_Kd ramp.png\n");
    let report = compared(&place, "square.obj --height-map ramp.png --method smooth,bump:16,bump:-16");
    let slope = scalar::atan2(0.5, 1.0).to_degrees();
    for name in ["bump:16", "bump:-16"] {
        let angle = error(&report, name, "inner", "median");
        assert!((angle - slope).abs() < 0.1, "{name}: {angle} instead of {slope}");
    }
    // Higher to the right leans to the left.
    let x = |name: &str| {
        let point = &report["points"][0]["normals"];
        let of = point.as_array().unwrap().iter().find(|normal| normal["method"] == name).unwrap();
        of["normal"][0].as_f64().unwrap()
    };
    assert!(x("bump:16") < -0.4 && x("bump:-16") > 0.4);
    // Without a height map the grey of the colour is used, with a note.
    let report = compared(&place, "square.obj --method smooth,bump:16,bump");
    assert!((error(&report, "bump:16", "inner", "median") - slope).abs() < 0.5);
    assert!(report["notes"][0].as_str().unwrap().contains("grey of the base colour"));
    assert_eq!(report["skipped"][0]["method"], "bump");
}

#[test]
fn every_file_is_there_and_named_in_the_report() {
    let place = tilted(20.0);
    let line =
        "square.obj --reference flat.obj --method smooth,tangent-normal --shading ggx,cook-torrance-printed";
    let report = compared(&place, line);
    let files = ["sheet.png", "report.json", "report.html", "angles.csv", "pictures.csv", "points.csv"];
    let mut named = files.map(str::to_owned).to_vec();
    let name = |value: &Value| value.as_str().expect("a name").to_string();
    for method in report["methods"].as_array().unwrap() {
        named.push(name(&method["normals"]));
        if !method["error"].is_null() {
            named.push(name(&method["error"]["heat"]));
        }
        for picture in method["pictures"].as_array().unwrap() {
            named.push(name(&picture["file"]));
            if !picture["difference"].is_null() {
                named.push(name(&picture["difference"]["flip_map"]));
            }
        }
    }
    named.sort();
    let mut found: Vec<String> = std::fs::read_dir(place.path("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    found.sort();
    assert_eq!(found, named);
    let written: Value = serde_json::from_slice(&place.read("out/report.json")).unwrap();
    assert_eq!(written, report);
    let page = String::from_utf8(place.read("out/report.html")).unwrap();
    assert!(page.contains("square.obj") && page.contains("data:image/png;base64,"));
    assert!(
        page.contains("Closest to reference: smooth, with a mean error of 0.00°"),
        "the page opens with a verdict"
    );
}

#[test]
fn pictures_of_equal_surfaces_are_equal() {
    let place = tilted(0.0);
    let report =
        compared(&place, "square.obj --reference flat.obj --material clay --method smooth,tangent-normal");
    for name in ["smooth", "tangent-normal"] {
        let figures = &method(&report, name)["pictures"][0]["difference"];
        assert!(
            figures["rmse"].as_f64().unwrap() < 1e-3 && figures["ssim"].as_f64().unwrap() > 0.999,
            "{figures}"
        );
        assert!(figures["flip"]["mean"].as_f64().unwrap() < 1e-3, "{figures}");
    }
    assert!(method(&report, "smooth")["pictures"][0]["difference"]["psnr"].is_null(), "equal, so infinite");
}

#[test]
fn says_in_a_table_what_was_measured() {
    let place = tilted(20.0);
    let line =
        format!("compare square.obj --reference flat.obj --method smooth,tangent-normal {FRONT} -o out");
    let assert = place.taotie(&line).assert().success().stderr_eq("");
    let text = String::from_utf8(assert.get_output().stdout.clone()).unwrap();
    let row = |name: &str| text.lines().find(|line| line.starts_with(name)).unwrap().to_string();
    assert!(text.starts_with("Angular error against reference, degrees\n"), "{text}");
    assert!(row("tangent-normal").contains("20.00"), "{text}");
    assert!(row("smooth").contains(" 0.00"), "{text}");
    assert!(text.contains("wrote out/report.html"), "{text}");
}

#[test]
fn models_far_apart_are_warned_about() {
    let place = tilted(0.0);
    place.write("far.obj", SQUARE.replace("mtllib square.mtl\nusemtl square\n", "").replace(" 0\n", " 9\n"));
    let assert = place
        .taotie(&format!("compare square.obj --reference far.obj --method smooth {FRONT} -o out"))
        .assert()
        .success();
    let talk = String::from_utf8(assert.get_output().stderr.clone()).unwrap();
    assert!(talk.contains("far.obj: position or size differs from the model's"), "{talk}");
}

#[test]
fn shading_models_are_measured_against_a_baseline_on_the_same_surface() {
    let place = tilted(20.0);
    let line = "square.obj --method tangent-normal --shading lambert,ggx --baseline ggx";
    let report = compared(&place, line);
    let [model] = method(&report, "tangent-normal")["models"].as_array().unwrap().as_slice() else {
        panic!("one model in addition to the baseline: {report}")
    };
    assert_eq!((&model["shading"], &model["baseline"]), (&"lambert".into(), &"ggx".into()));
    let figures = &model["difference"];
    // The same as `taotie diff` measures between the two pictures.
    let pictures = ["ggx", "lambert"].map(|shading| format!("out/tangent-normal.{shading}.png"));
    let apart = place.json(&format!("diff {} {} --encoding color --json", pictures[0], pictures[1]));
    let [reported, measured] = [figures, &apart["metrics"]].map(|of| of["rmse"].as_f64().expect("a number"));
    // That counts the background, which is equal in both.
    let pixels = figures["pixels"].as_f64().expect("a number");
    assert!((500.0..64.0 * 64.0).contains(&pixels), "{pixels}");
    let measured = measured * (64.0 * 64.0 / pixels).sqrt();
    assert!(reported > 1e-3 && (reported - measured).abs() < 1e-6, "{reported} against {measured}");
    place.read("out/tangent-normal.lambert-ggx.flip.png");
    let text = place.taotie(&format!("compare {line} {FRONT} -o out")).assert().success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.contains("Pictures of each surface compared with its picture under ggx"), "{text}");
}

#[test]
fn a_baseline_that_no_one_named_is_added() {
    let place = tilted(20.0);
    let report = compared(&place, "square.obj --method smooth --baseline lambert");
    assert_eq!(report["parameters"]["shadings"], serde_json::json!(["lambert", "ggx"]));
    assert_eq!(method(&report, "smooth")["models"][0]["shading"], "ggx");
}

/// The texels of an OpenEXR file.
fn exact(place: &Place, name: &str) -> Vec<[f32; 4]> {
    let bitmap = taotie_io::read_bitmap(&place.path(name)).expect("it is a picture");
    let taotie_engine::image::Texels::F32(texels) = bitmap.texels() else { panic!("{name}: floats") };
    texels.clone()
}

#[test]
fn normals_and_angles_are_written_as_numbers() {
    let place = tilted(20.0);
    compared(&place, "square.obj --reference flat.obj --method tangent-normal --exr");
    let inside = |texel: &&[f32; 4]| texel[3] == 1.0;
    let [x, z] = [scalar::sin(20f64.to_radians()), scalar::cos(20f64.to_radians())];
    let normals = exact(&place, "out/tangent-normal.normals.exr");
    assert!(normals.iter().filter(inside).count() > 500);
    for [nx, ny, nz, _] in normals.iter().filter(inside) {
        let off = [f64::from(*nx) - x, f64::from(*ny), f64::from(*nz) - z];
        assert!(off.iter().all(|part| part.abs() < 1e-3), "{off:?}");
    }
    let angles = exact(&place, "out/tangent-normal.error.exr");
    assert_eq!(angles.len(), 64 * 64);
    for [a, b, c, covered] in angles {
        match covered == 1.0 {
            true => assert!((a - 20.0).abs() < 0.01 && a == b && b == c, "{a}"),
            false => assert_eq!([a, b, c, covered], [0.0; 4]),
        }
    }
    assert!(!place.path("out/reference.error.exr").exists(), "it has no error");
    assert_eq!(exact(&place, "out/reference.normals.exr").len(), 64 * 64);
}

#[test]
fn tables_are_written_as_csv() {
    let place = tilted(20.0);
    let line = "square.obj --reference flat.obj --method smooth,bump:5,tangent-normal --baseline phong";
    let report = compared(&place, line);
    let table = |name: &str| -> Vec<Vec<String>> {
        let text = String::from_utf8(place.read(name)).unwrap();
        text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let angles = table("out/angles.csv");
    assert_eq!(angles[0][..5], ["method", "against", "pixels", "count", "mean_deg"]);
    let row = angles.iter().find(|row| row[0] == "tangent-normal" && row[2] == "inner").unwrap();
    assert_eq!(row[1], "reference");
    let is = |written: &str, reported: f64| {
        let written: f64 = written.parse().expect("a number");
        assert!((written - reported).abs() < 1e-12, "{written} {reported}");
    };
    is(&row[4], error(&report, "tangent-normal", "inner", "mean"));
    let pictures = table("out/pictures.csv");
    let row = |sides: [&str; 4]| pictures.iter().find(|row| row[..4] == sides).expect("it is listed").clone();
    let reported = &method(&report, "smooth")["pictures"][1]["difference"]["rmse"];
    is(&row(["smooth", "ggx", "reference", "ggx"])[4], reported.as_f64().unwrap());
    let reported = &method(&report, "reference")["models"][0]["difference"]["ssim"];
    is(&row(["reference", "ggx", "reference", "phong"])[6], reported.as_f64().unwrap());
    let points = table("out/points.csv");
    let methods = report["methods"].as_array().unwrap().len();
    assert_eq!(points.len(), 1 + 10 * methods);
    assert!(points.iter().all(|row| row.len() == points[0].len()));
}

#[test]
fn refuses_in_one_line() {
    let place = tilted(0.0);
    let refused = |line: &str| {
        let assert = place.taotie(line).assert().code(2).stdout_eq("");
        String::from_utf8(assert.get_output().stderr.clone()).unwrap()
    };
    let wrong = [
        ("compare square.obj -o out --baseline ggx", "add another model to --shading"),
        ("compare square.obj -o out --baseline gxx", "cook-torrance"),
        ("compare --paper --exr -o out", "cannot be used with"),
        ("compare square.obj -o out --method smooth", "a --reference or a --baseline"),
        ("compare square.obj -o out --points 64,0 --size 64x64", "pixel 64,0 is outside the 64×64 picture"),
        ("compare square.obj -o out --background transparent", "give a colour"),
        ("compare square.obj -o out --heat-top-deg 0", "above 0 and at most 180"),
        ("compare square.obj -o out --method smooth:5", "only bump and bump-printed"),
        ("compare square.obj -o out --method bmup", "tangent-normal"),
        ("compare square.obj -o out --reference flat.obj --match touch", "normal, uv, pixel"),
        (
            "compare square.obj -o out --method bump,bump:5",
            "none of the methods can be rendered: bump: no material",
        ),
        ("compare square.obj -o out --reference gone.ply", "gone.ply"),
        ("compare square.obj", "--output"),
        ("compare -o out", "<MODEL>"),
        ("compare --paper square.obj", "cannot be used with"),
        ("compare square.obj -o square.obj", "square.obj: expected a folder, found a file"),
    ];
    for (line, words) in wrong {
        let talk = refused(line);
        assert!(talk.contains(words), "{line}: {talk}");
    }
}

#[test]
fn one_surface_is_enough_for_shading_models() {
    let place = tilted(20.0);
    let line = format!("compare square.obj --method smooth --baseline lambert {FRONT} -o out");
    let assert = place.taotie(&line).assert().success().stderr_eq("");
    let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(text.starts_with("Pictures of each surface compared with its picture under lambert\n"), "{text}");
    let page = String::from_utf8(place.read("out/report.html")).unwrap();
    assert!(page.contains("Shading models on smooth") && page.contains("shading models: FLIP"));
    assert!(!page.contains("angular error\""), "nothing is measured against another surface");
    let angles = String::from_utf8(place.read("out/angles.csv")).unwrap();
    assert_eq!(angles.lines().count(), 1, "{angles}");
}
