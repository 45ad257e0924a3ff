//! `taotie bake`: maps of points, materials and objects; textures that pack channels; objects matched by name.

use super::bake::document;
use super::bake_document::{ship, start};
use super::balls::{Ball, LOW, SCAN};
use super::place::Place;
use serde_json::{Value, json};
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_io::read_bitmap;

/// Returns several balls as one OBJ file, each an object with a material of the same name.
pub fn together(balls: &[(&str, Ball)]) -> String {
    let mut text = String::new();
    let mut before = [0; 3];
    for (name, ball) in balls {
        text += &format!("o {name}\nusemtl {}\n", name.split('_').next().unwrap());
        let mut own = [0; 3];
        for line in ball.obj().lines() {
            let kinds = ["v ", "vt ", "vn "];
            match kinds.iter().position(|kind| line.starts_with(kind)) {
                Some(kind) => own[kind] += 1,
                None if line.starts_with("f ") => {
                    let corner = |corner: &str| {
                        let moved = corner.split('/').zip(before).map(|(index, before)| match index {
                            "" => String::new(),
                            index => (index.parse::<usize>().unwrap() + before).to_string(),
                        });
                        moved.collect::<Vec<_>>().join("/")
                    };
                    let corners: Vec<String> = line[2..].split_whitespace().map(corner).collect();
                    text += &format!("f {}\n", corners.join(" "));
                    continue;
                }
                None => continue,
            }
            text += &format!("{line}\n");
        }
        before.iter_mut().zip(own).for_each(|(before, own)| *before += own);
    }
    text
}

/// Returns the note on a map in a report.
fn note<'a>(report: &'a Value, map: &str) -> &'a Value {
    let mut notes = report["maps"].as_array().expect("maps are listed").iter();
    notes.find(|note| note["map"] == map).unwrap_or_else(|| panic!("no {map} in {report}"))
}

pub fn picture(place: &Place, name: &str) -> Bitmap {
    read_bitmap(&place.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Returns all codes of a channel, [0, 1].
fn channel(bitmap: &Bitmap, channel: usize) -> Vec<f32> {
    (0..(bitmap.width() * bitmap.height()) as usize).map(|i| bitmap.stored(i)[channel]).collect()
}

#[test]
fn maps_of_points_have_units_and_names() {
    let place = Place::with("scan.obj", Ball { radius: 2.06, waves: 0.0, ..SCAN }.obj());
    place.write("low.obj", Ball { radius: 2.0, rings: 48, meridians: 96, ..LOW }.obj());
    let report = place.json(
        "bake scan.obj --low low.obj -o out.png --size 128 --ao-rays 256 --unit mm --json \
         --maps normal,position,world-normal,thickness,material-id,object-id,wireframe,vertex-color",
    );
    let position = picture(&place, "out.position.png");
    assert_eq!((position.bits(), position.channels()), (16, 3));
    let about = note(&report, "position");
    let [black, white] = ["black", "white"].map(|end| about[end].as_f64().unwrap());
    let origin: Vec<f64> = about["origin"].as_array().unwrap().iter().filter_map(Value::as_f64).collect();
    assert!(about["unit"] == "mm" && black == -white && (2.0..2.2).contains(&white), "{about}");
    for i in 0..128 * 128 {
        let [x, y, z, _] = position.stored(i);
        let at = [x, y, z].map(|code| black + f64::from(code) * (white - black));
        let length = (0..3).map(|k| (at[k] + origin[k]) * (at[k] + origin[k])).sum::<f64>().sqrt();
        assert!((length - 2.06).abs() < 0.02, "{length}: a point of the ball, or a mean of neighbours");
    }
    // 4/3 of the radius, by 256 directions.
    let about = note(&report, "thickness");
    let [black, white] = ["black", "white"].map(|end| about[end].as_f64().unwrap());
    assert!((black / 2.06 - 4.0 / 3.0).abs() < 0.05 && (white / 2.06 - 4.0 / 3.0).abs() < 0.05, "{about}");
    assert_eq!((&about["unit"], &about["bits"]), (&json!("mm"), &json!(16)));
    let legend = note(&report, "material-id")["legend"].as_object().unwrap();
    let [(_, color)] = legend.iter().collect::<Vec<_>>()[..] else { panic!("{legend:?}") };
    let ids = picture(&place, "out.material-id.png");
    let [r, g, b, _] = ids.stored(0).map(|code| (code * 255.0) as u8);
    assert_eq!(color, &json!(format!("#{r:02x}{g:02x}{b:02x}")));
    assert!((0..128 * 128).all(|i| ids.stored(i) == ids.stored(0)), "one material everywhere");
    let lines = channel(&picture(&place, "out.wireframe.png"), 0);
    assert!(lines.contains(&0.0) && lines.contains(&1.0));
    let warnings = report["warnings"].to_string();
    assert!(warnings.contains("the map of vertex colours is black"), "{warnings}");
    assert_eq!(report["bake"]["unproved_maps"], json!(["wireframe map"]));
    // Each in its own unit.
    let error = |map: &str| {
        let error = &note(&report, map)["error"];
        (error["mean"].as_f64().unwrap(), error["unit"].as_str().unwrap().to_owned())
    };
    let bounds = [
        ("position", 0.002, "mm"),
        ("thickness", 0.01, "mm"),
        ("world-normal", 2.0, "°"),
        ("object-id", 0.0, "share"),
    ];
    for (map, most, unit) in bounds {
        let (mean, found) = error(map);
        assert!(mean <= most && found == unit, "{map}: {mean} {found}");
    }
    assert!(note(&report, "wireframe")["error"].is_null());
}

#[test]
fn floats_are_the_numbers_themselves() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let line =
        "bake scan.obj --low low.obj --size 32 --maps normal,position,curvature,gradient,object-id --json";
    let of = |output: &str| place.json(&format!("{line} -o {output}"));
    let (codes, tiff, exr) = (of("out.png"), of("floats.tiff --bits 32"), of("floats.exr"));
    let [black, white] = ["black", "white"].map(|end| note(&codes, "curvature")[end].as_f64().unwrap());
    for report in [&tiff, &exr] {
        let about = note(report, "curvature");
        assert_eq!(
            (&about["bits"], &about["black"], &about["white"]),
            (&json!(32), &json!(0.0), &json!(1.0))
        );
        assert_eq!(note(report, "object-id")["error"]["max"], 0.0);
    }
    let coded = channel(&picture(&place, "out.curvature.png"), 0);
    let [tiff, exr] =
        ["floats.curvature.tiff", "floats.curvature.exr"].map(|name| channel(&picture(&place, name), 0));
    assert_eq!(tiff, exr);
    for (code, number) in coded.iter().zip(&tiff) {
        let clipped = f64::from(*number).clamp(black, white);
        let apart = (black + f64::from(*code) * (white - black) - clipped).abs();
        assert!(apart < 1e-4 * (white - black), "{code} {number}");
    }
    let [tiff, exr] = ["floats.tiff", "floats.exr"].map(|name| picture(&place, name));
    assert_eq!(tiff.texels(), exr.texels());
    let is_unit = |i: usize| {
        let [x, y, z, _] = tiff.stored(i);
        ((x * x + y * y + z * z).sqrt() - 1.0).abs() < 1e-4
    };
    assert!((0..32 * 32).all(is_unit), "vectors, not codes");
    let refused = |output: &str, why: &str| {
        let assert = place.taotie(&format!("{line} -o {output}")).assert().code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(why), "{said}");
    };
    refused("out.png --bits 32", "write a .tiff or .exr, or use 16");
    refused("out.glb --bits 32", "write standalone maps");
}

#[test]
fn materials_have_maps_of_their_own_size() {
    let (place, low) = start();
    place.write("low.glb", ship(&low));
    let line = "bake scan.obj --low low.glb -o out.png --size 64 --json";
    let side = |name: &str| picture(&place, &format!("out.{name}.png")).width();
    let report = place.json(&format!("{line} --sizes wood=32,cloth=128"));
    assert_eq!([side("wood"), side("iron"), side("cloth")], [32, 64, 128]);
    assert_eq!(report["parameters"]["sizes"], "cloth=128,wood=32");
    let printed = place.text(&format!("{} --sizes wood=32,cloth=128", line.replace(" --json", "")));
    assert!(printed.contains("maps of 128×128, 64×64 and 32×32\n"), "{printed}");
    let page = String::from_utf8(place.read("out.report.html")).unwrap();
    assert!(page.contains("Maps of 128×128, 64×64 and 32×32 texels."));
    assert!(report["bake"]["uv_use"].as_f64().unwrap() <= 1.0);
    let unknown = place.taotie(&format!("{line} --sizes gold=32")).assert().code(2);
    let said = String::from_utf8_lossy(&unknown.get_output().stderr).into_owned();
    assert!(
        said.contains("the size of gold: the low-poly mesh has no such maps; it has cloth, iron, wood"),
        "{said}"
    );
    let wrong = place.taotie(&format!("{line} --sizes wood=8")).assert().code(2);
    assert!(String::from_utf8_lossy(&wrong.get_output().stderr).contains("16 to 16384"));

    // Two balls, the second half as large on the same uvs: so are its maps.
    let half = Ball { radius: LOW.radius / 2.0, center: [6.0, 0.0, 0.0], ..LOW };
    let small = Ball { radius: SCAN.radius / 2.0, center: [6.0, 0.0, 0.0], ..SCAN };
    let place = Place::with("scan.obj", together(&[("whole", SCAN), ("half", small)]));
    place.write("low.obj", together(&[("whole", LOW), ("half", half)]));
    place.json("bake scan.obj --low low.obj -o out.png --size 64 --sizes even --json");
    let side = |name: &str| picture(&place, &format!("out.{name}.png")).width();
    assert_eq!([side("whole"), side("half")], [64, 32]);

    place.write("low.obj", LOW.obj());
    let single = place.json("bake scan.obj --low low.obj -o one.png --size 64 --sizes even --json");
    let warnings = single["warnings"].to_string();
    assert!(
        warnings.contains("even sizes have no effect: the low-poly mesh has one set of maps"),
        "{warnings}"
    );
}

#[test]
fn points_of_the_same_uv_match_wherever_they_are() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("away.obj", Ball { center: [9.0, 0.0, 0.0], uv: LOW.uv, ..SCAN }.obj());
    place.write("low.obj", LOW.obj());
    let line = "--low low.obj --size 64 --space object --no-verify -q";
    place.taotie(&format!("bake scan.obj {line} -o rays.png --match nearest")).assert().success();
    place.taotie(&format!("bake away.obj {line} -o uvs.png --match uv")).assert().success();
    let [rays, uvs] = ["rays.png", "uvs.png"].map(|name| picture(&place, name));
    let apart =
        |i: usize| rays.stored(i).iter().zip(uvs.stored(i)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let mean = (0..64 * 64).map(apart).sum::<f32>() / 4096.0;
    assert!(mean < 0.02, "{mean}");
    let refused =
        place.taotie("bake away.obj --low low.obj --new-uvs -o out.glb --match uv").assert().code(2);
    assert!(String::from_utf8_lossy(&refused.get_output().stderr).contains("omit new uvs"));
}

#[test]
fn channels_hold_what_their_maps_hold() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let line = "bake scan.obj --low low.obj --size 64 --ao-rays 16 --roughness 0.3 --json \
                --maps normal,ao,roughness,metallic-roughness,height --channels unity-mask \
                --channels dirt:R=1-ao,G=height,B=0.5,A=normal.g --channels orm";
    let report = place.json(&format!("{line} -o out.png"));
    let [mask, dirt, orm, height, normal] =
        ["unity-mask", "dirt", "orm", "height", ""].map(|name| match name {
            "" => picture(&place, "out.png"),
            name => picture(&place, &format!("out.{name}.png")),
        });
    assert_eq!([mask.channels(), dirt.channels()], [4, 4]);
    let [occlusion, roughness, metallic] = [0, 1, 2].map(|k| channel(&orm, k));
    let inverted = |codes: &[f32]| codes.iter().map(|code| 1.0 - code).collect::<Vec<f32>>();
    let same = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
    assert!(channel(&mask, 0) == metallic && channel(&mask, 1) == occlusion);
    assert!(channel(&mask, 2).iter().all(|code| *code == 1.0));
    assert!(same(&channel(&mask, 3), &inverted(&roughness)), "smoothness");
    // Heights need 16 bits; the other channels lose nothing.
    assert_eq!([mask.bits(), dirt.bits()], [8, 16]);
    assert!(same(&channel(&dirt, 0), &inverted(&occlusion)) && channel(&dirt, 1) == channel(&height, 0));
    assert!(channel(&dirt, 2).iter().all(|code| (code - 0.5).abs() < 1e-4));
    assert!(same(&channel(&dirt, 3), &channel(&normal, 1)));
    let notes = report["maps"].as_array().unwrap().iter();
    let packed: Vec<String> = notes
        .filter(|note| note["channel"].is_string())
        .map(|note| format!("{} {} {}", note["file"], note["channel"], note["content"]).replace('"', ""))
        .collect();
    let wanted = [
        "out.unity-mask.png R metallic",
        "out.unity-mask.png G ao",
        "out.unity-mask.png A 1-roughness",
        "out.dirt.png R 1-ao",
        "out.dirt.png G height",
        "out.dirt.png A normal.g",
        "out.orm.png R ao",
        "out.orm.png G roughness",
        "out.orm.png B metallic",
    ];
    assert_eq!(packed, wanted);
    for note in report["maps"].as_array().unwrap().iter().filter(|note| note["channel"].is_string()) {
        let mean = note["error"]["mean"].as_f64().unwrap_or_else(|| panic!("no error: {note}"));
        assert!(mean < 0.05, "{note}");
    }
    assert_eq!(report["bake"]["unproved_maps"], json!([]));
    let printed = place.text(&format!("{} -o out.png", line.replace(" --json", "")));
    for row in
        ["error of unity-mask A (1-roughness)", "error of dirt G (height)", "error of dirt A (normal.g)"]
    {
        assert!(printed.contains(row), "{row}: {printed}");
    }
    let of_asset = place.json(&format!("{line} -o out.glb"));
    assert!(place.files().contains(&"out.dirt.png".to_owned()), "{of_asset}");
    let asset = document(&place, "out.glb");
    let about = &asset["asset"]["extras"]["maps"]["dirt"];
    assert_eq!((&about["file"], &about["G"]["map"]), (&json!("out.dirt.png"), &json!("height")));
    assert_eq!((&about["R"]["black"], &about["R"]["white"]), (&json!(1.0), &json!(0.0)), "open is black");
    assert_eq!(about["G"]["black"], note(&of_asset, "height")["black"]);
}

#[test]
fn a_bake_without_normals_says_what_it_baked() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let line = "bake scan.obj --low low.obj -o out.png --size 32 --ao-rays 16 --maps ao,height";
    let printed = place.text(&format!("{line} --channels x:R=ao,G=height,B=0"));
    let wanted = "ao, height, x R (ao), x G (height); no normal map: normal errors are those of the mesh";
    assert!(printed.contains(wanted), "{printed}");
    let at = |text: &str| printed.find(text).unwrap_or_else(|| panic!("no {text}: {printed}"));
    assert!(at("error of x G (height)") < at("normal error as seen"), "{printed}");
    let with = place.text(&line.replace("ao,height", "normal,ao"));
    assert!(!with.contains("no normal map"), "{with}");
}

#[test]
fn channels_without_their_maps_are_refused() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    let cases = [
        ("--channels orm", "ao is not baked; add it to the maps"),
        ("--maps auto,ao --channels R=height,G=ao,B=0", "height is not baked"),
        (
            "--maps auto,ao --channels R=ao,G=ao,B=0 --channels R=0,G=0,B=0",
            "two textures of channels named channels",
        ),
        ("--channels R=shine,G=0,B=0", "unknown map `shine`"),
    ];
    for (options, why) in cases {
        let assert =
            place.taotie(&format!("bake scan.obj --low low.obj -o out.glb {options}")).assert().code(2);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(why), "{options}: {said}");
    }
}

/// Two shells, one inside the other: the facets of the inner one reach through the outer one's scan, and back.
#[test]
fn objects_show_their_namesakes_and_nothing_else() {
    let (inner, outer) =
        (Ball { waves: 0.0, ..SCAN }, Ball { radius: SCAN.radius * 1.01, waves: 0.0, ..SCAN });
    let place = Place::with("scan.obj", together(&[("core_high", inner), ("shell_HIGH", outer)]));
    let coarse = |ball: &Ball| Ball { radius: ball.radius, rings: 12, meridians: 24, ..LOW };
    place.write("low.obj", together(&[("core_low", coarse(&inner)), ("shell_low.001", coarse(&outer))]));
    // Shares of texels with the colour of the other object.
    let strangers = |options: &str| {
        let line = "bake scan.obj --low low.obj -o out.png --size 64 --maps normal,object-id --json";
        let report = place.json(&format!("{line} {options}"));
        let share = |own: &str, other: &str| {
            let ids = picture(&place, &format!("out.{own}.object-id.png"));
            let legends =
                report["maps"].as_array().unwrap().iter().filter_map(|note| note["legend"].as_object());
            let color = legends.into_iter().find_map(|legend| legend.get(other).cloned());
            let Some(Value::String(color)) = color else { return 0.0 };
            let is_other = |i: &usize| {
                let [r, g, b, _] = ids.stored(*i).map(|code| (code * 255.0).round() as u8);
                format!("#{r:02x}{g:02x}{b:02x}") == color
            };
            (0..64 * 64).filter(is_other).count() as f64 / 4096.0
        };
        ([share("core", "shell_HIGH"), share("shell", "core_high")], report)
    };
    let (matched, report) = strangers("");
    assert_eq!(matched, [0.0; 2]);
    assert_eq!(report["origin"]["groups"], json!(["core", "shell"]));
    let (nearest, report) = strangers("--match nearest");
    assert!(nearest.iter().any(|share| *share > 0.2), "{nearest:?}: they were hard to distinguish");
    assert!(report["origin"]["groups"].is_null());
}

#[test]
fn each_udim_tile_gets_the_maps_of_its_triangles() {
    let apart = |x: f64| Ball { center: [x, 0.0, 0.0], ..LOW };
    let place = Place::with(
        "scan.obj",
        together(&[
            ("a", Ball { center: [0.0; 3], ..SCAN }),
            ("b", Ball { center: [6.0, 0.0, 0.0], ..SCAN }),
        ]),
    );
    place.write("a.obj", together(&[("one", apart(0.0))]));
    place.write("b.obj", together(&[("one", apart(6.0))]));
    // Both balls as one file with one material, the second on the tile above and to the right.
    let second = Ball { uv: Some(|u, v| [u + 1.0, v + 1.0]), ..apart(6.0) };
    place.write("both.obj", together(&[("one", apart(0.0)), ("one", second)]));

    let line = "--size 64 --maps normal,height --channels x:R=normal.r,G=height,B=0 --json";
    let report = place.json(&format!("bake scan.obj --low both.obj -o out.<UDIM>.png {line}"));
    place.json(&format!("bake scan.obj --low a.obj -o a.png {line}"));
    place.json(&format!("bake scan.obj --low b.obj -o b.png {line}"));
    assert!(place.read("out.1001.png") == place.read("a.png"));
    // The cage is that of both tiles, so that heights may round differently.
    let [tile, own] = ["out.1001.x.png", "a.x.png"].map(|name| picture(&place, name));
    let off = |i: usize| (tile.stored(i)[1] - own.stored(i)[1]).abs();
    let farthest = (0..64 * 64).map(off).fold(0.0, f32::max);
    assert!(farthest < 1.5 / 255.0, "{farthest}");
    // Its uvs were rounded on their way to another tile.
    let [tile, own] = ["out.1012.png", "b.png"].map(|name| picture(&place, name));
    let different = (0..64 * 64).filter(|i| tile.stored(*i) != own.stored(*i)).count();
    assert!(different < 64 * 64 / 50, "{different} texels differ");
    let files: Vec<&str> = report["files"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert_eq!(files.iter().filter(|file| file.ends_with(".height.png")).count(), 2, "{files:?}");
    assert!(
        files.iter().all(|file| file.contains(".1001") || file.contains(".1012") || file.contains("report"))
    );
    let triangles = report["triangles"][0].as_u64().expect("they are counted");
    let own = |name: &str| {
        place.read(name).split(|byte| *byte == b'\n').filter(|line| line.starts_with(b"f ")).count()
    };
    assert_eq!(triangles as usize, own("both.obj"));
    assert!(!report["warnings"].to_string().contains("lacks parts"), "{}", report["warnings"]);

    // A model has no tiles, and below the first there are none.
    place.taotie("bake scan.obj --low both.obj -o out.<UDIM>.glb").assert().code(2);
    let below = Ball { uv: Some(|u, v| [u, v - 1.0]), ..apart(0.0) };
    place.write("below.obj", together(&[("one", below)]));
    let refused = place.taotie("bake scan.obj --low below.obj -o out.<UDIM>.png").assert().code(2);
    let stderr = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(stderr.contains("outside all UDIM tiles"), "{stderr}");
}

#[test]
fn a_textured_model_gets_a_new_atlas_with_its_appearance() {
    // Its uvs repeat the texture twice, and both balls overlap.
    let ball = |x: f64| Ball { center: [x, 0.0, 0.0], uv: Some(|u, v| [2.0 * u, 2.0 * v]), ..LOW };
    let balls = together(&[("red", ball(0.0)), ("green", ball(6.0))]);
    let place = Place::with("scan.obj", format!("mtllib scan.mtl\n{balls}"));
    place.write(
        "scan.mtl",
        "newmtl red\nKd 1 0.2 0.2\nmap_Kd paint.png\nnewmtl green\nKd 0.2 1 0.2\nmap_Kd paint.png\n",
    );
    let texels = (0..16 * 16).map(|i| if (i / 4 + i / 64) % 2 == 0 { [255; 4] } else { [90, 90, 90, 255] });
    let paint = Bitmap::new(16, 16, 3, Texels::U8(texels.collect())).unwrap();
    let bytes = taotie_io::encode_map(&paint, Encoding::Srgb, taotie_io::MapFormat::Png).unwrap();
    place.write("paint.png", bytes);
    let report = place.json("bake scan.obj --low scan.obj --new-uvs -o out.glb --size 1024 --json");
    let level = &report["proof"]["levels"][0];
    let mean = level["material"]["color"]["mean"].as_f64().expect("colours are compared");
    let angle = level["surface_angles"]["mean"].as_f64().expect("angles are compared");
    assert!(mean < 0.5 && angle < 0.3, "ΔE {mean}, {angle}°");
    assert!(report["origin"]["islands"].as_u64().is_some_and(|islands| islands > 1), "{}", report["origin"]);
    assert_eq!(document(&place, "out.glb")["materials"].as_array().map(Vec::len), Some(1));
}

#[test]
fn a_mask_or_colours_of_vertices_steer_the_rays() {
    let place = Place::with("scan.obj", SCAN.obj());
    place.write("low.obj", LOW.obj());
    for (name, code) in [("black.png", 0), ("white.png", 255)] {
        let mask = Bitmap::new(2, 2, 1, Texels::U8(vec![[code; 4]; 4])).unwrap();
        place.write(name, taotie_io::encode_map(&mask, Encoding::Linear, taotie_io::MapFormat::Png).unwrap());
    }
    let normals = |skew: &str| {
        place.json(&format!("bake scan.obj --low low.obj -o out.png --size 64 --maps normal --json {skew}"));
        place.read("out.png")
    };
    let kept = normals("--skew keep");
    assert!(normals("--skew black.png") == kept, "averaged normals");
    assert!(normals("--skew white.png") != kept, "normals of triangles");
    let refused = |options: &str| {
        let done =
            place.taotie(&format!("bake scan.obj --low low.obj -o out.png {options}")).assert().code(2);
        String::from_utf8_lossy(&done.get_output().stderr).into_owned()
    };
    assert!(refused("--ray-colors").contains("vertex colours"));
    assert!(refused("--skew none.png").contains("none.png"));

    // Colours of 1 change nothing; with 0, no ray has any length.
    let painted = |grey: f64| {
        let line = |line: &str| match line.starts_with("v ") {
            true => format!("{line} {grey} {grey} {grey}\n"),
            false => format!("{line}\n"),
        };
        LOW.obj().lines().map(line).collect::<String>()
    };
    let plain = normals("");
    place.write("painted.obj", painted(1.0));
    place.json("bake scan.obj --low painted.obj --ray-colors -o out.png --size 64 --maps normal --json");
    assert!(place.read("out.png") == plain);
    place.write("low.obj", painted(0.0));
    assert!(refused("--ray-colors").contains("none of its"));
}
