//! More than a hundred files and folders that are wrong: each gives one clear error.

use std::path::Path;
use taotie_engine::image::Encoding;
use taotie_engine::{Error, Progress, Warnings};
use taotie_io::{Bytes, Limits, PngColor, PngImage, PngSamples, encode_png};
use taotie_photometric::{Estimate, PhotographSet, Reading, Samples, Transfer};

/// The lights of six photographs.
const LIGHTS: [&str; 6] =
    ["0.5 0 0.8", "-0.5 0 0.8", "0 0.5 0.8", "0 -0.5 0.8", "0.4 0.4 0.8", "-0.3 0.3 0.9"];

fn png(side: u32, grey: u8) -> Vec<u8> {
    let samples = vec![grey; (side * side) as usize];
    let samples = PngSamples::U8(&samples);
    encode_png(&PngImage {
        width: side,
        height: side,
        color: PngColor::Grey,
        samples,
        encoding: Encoding::Srgb,
    })
    .unwrap()
}

/// Makes a folder of six photographs, `p1.png` to `p6.png`, without lights.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for i in 1..=6 {
        write(folder.path(), &format!("p{i}.png"), &png(4, 100 + i));
    }
    folder
}

fn write(folder: &Path, name: &str, bytes: &[u8]) {
    std::fs::write(folder.join(name), bytes).unwrap();
}

/// Does everything that the command does, within little memory.
fn read(path: &Path, memory: u64) -> Result<Estimate, Error> {
    let set = PhotographSet::open(path, &mut Warnings::default())?;
    let limits = Limits { memory: Some(Bytes(memory)), ..Limits::default() };
    let reading = Reading { mask: None, transfer: Transfer::Auto, flat: None, limits };
    Estimate::of(&Samples::read(&set, &reading, Progress::SILENT)?, Progress::SILENT)
}

/// Asserts that reading fails with one line that has these words and names a file or folder.
fn assert_refused(path: &Path, words: &str, what: &str) {
    let error = read(path, 1 << 30).map(|_| ()).expect_err(what).to_string();
    let name = path.file_name().unwrap().to_string_lossy();
    assert!(error.contains(words), "{what}: {error}");
    assert!(!error.contains('\n') && error.len() < 400, "{what}: {error}");
    let names_a_file = error.contains(&*name) || error.contains("p1.png") || error.contains(".txt");
    assert!(names_a_file || error.contains("no pixel has a normal"), "{what}: {error}");
}

/// Returns the lines of the valid file.
fn lines() -> Vec<String> {
    LIGHTS.iter().enumerate().map(|(i, light)| format!("p{}.png {light}", i + 1)).collect()
}

/// Returns an `.lp` file with line `i`, from 0, replaced.
fn with_line(i: usize, line: &str) -> String {
    let mut lines = lines();
    lines[i] = line.to_owned();
    format!("6\n{}\n", lines.join("\n"))
}

fn with_count(count: &str) -> String {
    format!("{count}\n{}\n", lines().join("\n"))
}

#[test]
fn the_valid_folder_is_read() {
    let folder = folder();
    write(folder.path(), "dome.lp", with_count("6").as_bytes());
    assert!(read(folder.path(), 1 << 30).is_ok());
    assert!(read(&folder.path().join("dome.lp"), 1 << 30).is_ok());
}

#[test]
fn every_wrong_lp_file_has_one_clear_error() {
    let third = |line: &str| with_line(2, line);
    let mut cases: Vec<(String, &str)> = Vec::new();
    for count in ["5", "7", "0", "1", "600", "99999999", "18446744073709551615"] {
        cases.push((with_count(count), "lights stated, but 6 follow"));
    }
    for count in [
        "six",
        "-6",
        "6.0",
        "6,0",
        "0x6",
        "6a",
        "١",
        "NaN",
        "18446744073709551616",
        "[6]",
        "{",
        "#6x".trim_start_matches('#'),
    ] {
        cases.push((with_count(count), "expected the number of lights"));
    }
    for text in ["", "\n\n", "# nothing", "6", "6\n\n\n", "\u{feff}", "0\n", "   \t "] {
        cases.push((text.to_owned(), "no lights"));
    }
    for line in ["p3.png", "p3.png 1", "p3.png;1", "p3.png\t0.1"] {
        cases.push((third(line), "line 4: expected `NAME X Y Z`"));
    }
    for line in [
        "p3.png 0 0.5 x",
        "p3.png 0 0.5 1e",
        "p3.png 0 0.5 --1",
        "p3.png 0 0.5 0..8",
        "p3.png 0 0,5,1 0.8",
        "p3.png 0 0.5 inf",
        "p3.png 0 0.5 NaN",
        "p3.png 0 0.5 1e300",
        "p3.png 0 0.5 1.0.0",
        "p3.png 0 0.5 0x1",
        "p3.png 0 0.5 1,0.5",
        "p3.png 0.5 0.8",
        "p3.png 0 0.5 0.8°",
        "p3.png 0 0.5 0.8 east",
        "p3.png (0 0.5 0.8)",
        "p3.png <0> <1> <2>",
        "p3.png 0 0.5 ½",
        "p3.png 0 0.5 1_000",
        "p3.png 0 0.5 +-1",
        "p3.png 0 0.5 ,",
    ] {
        cases.push((third(line), "is not a number"));
    }
    for line in ["p3.png 0 0 0", "p3.png 0,0 0,0 0,0", "p3.png 1e-12 0 0", "p3.png -0 -0 -0"] {
        cases.push((third(line), "line 4: the vector towards the light is zero"));
    }
    for line in [
        "p9.png 0 0.5 0.8",
        "photo of p3 0 0.5 0.8",
        "../../etc/passwd 0 0.5 0.8",
        "p3.png.bak 0 0.5 0.8",
        "mask.png 0 0.5 0.8",
        "p?.png 0 0.5 0.8",
        "3 0 0.5 0.8",
    ] {
        cases.push((third(line), "line 4: "));
    }
    for line in ["p1.png 0 0.5 0.8", "P1.PNG 0 0.5 0.8", "C:\\dome\\p1.png 0 0.5 0.8", "p1.tif 0 0.5 0.8"] {
        cases.push((third(line), "is also the photograph of line 2"));
    }
    cases.push((third("0 0.5 0.8"), "some lines have a name and others do not"));
    let plane = LIGHTS.iter().enumerate().map(|(i, _)| format!("p{}.png {} 0 1", i + 1, i as f64 * 0.2));
    cases.push((plane.collect::<Vec<_>>().join("\n"), "nearly in one plane"));
    let same = (1..=6).map(|i| format!("p{i}.png 0.1 0.2 0.9"));
    cases.push((same.collect::<Vec<_>>().join("\n"), "from one direction"));
    let behind = LIGHTS
        .iter()
        .enumerate()
        .map(|(i, light)| format!("p{}.png {}", i + 1, light.replace(" 0.", " -0.")));
    cases.push((behind.collect::<Vec<_>>().join("\n"), "from behind"));
    cases.push((lines()[..3].join("\n"), "at least 4 are needed"));
    cases.push((
        format!("7\n{}\n0 0.1 0.9\n", LIGHTS.join("\n")),
        "line 8: photograph 7 of 6: the folder has too few",
    ));
    let numbered = LIGHTS.iter().enumerate().map(|(i, light)| format!("{} {light}", 2 * i + 1));
    cases.push((numbered.collect::<Vec<_>>().join("\n"), "line 4: photograph 7 of 6"));
    cases.push((with_line(2, &"x".repeat(5000)), "5000 bytes long"));
    cases.push(("a 0 0 1\n".repeat(5000), "at most 4096 lights"));
    let folder = folder();
    let path = folder.path().join("dome.lp");
    assert!(cases.len() >= 70, "{}", cases.len());
    for (text, words) in &cases {
        write(folder.path(), "dome.lp", text.as_bytes());
        assert_refused(&path, words, &text.chars().take(200).collect::<String>());
    }
    for bytes in [&[0_u8; 2000][..], &png(64, 9), &[0xff; 3000], b"\x80\x81\x82 1"] {
        write(folder.path(), "dome.lp", bytes);
        assert_refused(&path, "dome.lp", "bytes that are not text");
    }
}

#[test]
fn every_wrong_diligent_folder_has_one_clear_error() {
    let names: Vec<String> = (1..=6).map(|i| format!("p{i}.png")).collect();
    let valid = [names.join("\n"), LIGHTS.join("\n"), ["1 1 1"; 6].join("\n")];
    let files = ["filenames.txt", "light_directions.txt", "light_intensities.txt"];
    let replaced = |which: usize, line: usize, text: &str| {
        let mut lines: Vec<&str> = valid[which].lines().collect();
        lines[line] = text;
        (which, lines.join("\n"))
    };
    let cases = [
        (replaced(0, 2, "p9.png"), "filenames.txt: line 3: 'p9.png' is not among the 6 photographs"),
        (replaced(0, 2, "p1.png"), "is also the photograph of line 1"),
        (replaced(0, 2, ""), "light_directions.txt: the end: 6 lines, but filenames.txt has 5"),
        ((0, String::new()), "6 lines, but filenames.txt has 0"),
        (replaced(1, 2, "0 0.5"), "light_directions.txt: line 3: expected three numbers"),
        (replaced(1, 2, "0 0.5 0.8 1"), "light_directions.txt: line 3: expected three numbers"),
        (replaced(1, 2, "0 0.5 x"), "light_directions.txt: line 3: expected three numbers"),
        (replaced(1, 2, "0 0.5 nan"), "light_directions.txt: line 3: expected three numbers"),
        (replaced(1, 2, "0 0 0"), "light_directions.txt: line 3: the direction is zero"),
        (replaced(1, 2, ""), "light_directions.txt: the end: 5 lines"),
        ((1, String::new()), "light_directions.txt: the end: 0 lines"),
        ((1, ["0.1 0.1 1"; 6].join("\n")), "from one direction"),
        ((1, LIGHTS.join("\n").replace(" 0.", " -0.")), "from behind"),
        (replaced(2, 2, "1 1"), "light_intensities.txt: line 3: expected three numbers"),
        (replaced(2, 2, "1 1 one"), "light_intensities.txt: line 3: expected three numbers"),
        (replaced(2, 2, "1 0 1"), "light_intensities.txt: line 3: intensities must be above 0"),
        (replaced(2, 2, "1 -1 1"), "light_intensities.txt: line 3: intensities must be above 0"),
        (replaced(2, 2, ""), "light_intensities.txt: the end: 5 lines"),
        ((2, "1 1 1\n".repeat(7)), "light_intensities.txt: the end: 7 lines"),
    ];
    let folder = folder();
    for ((which, text), words) in &cases {
        for (i, file) in files.iter().enumerate() {
            write(folder.path(), file, if i == *which { text } else { &valid[i] }.as_bytes());
        }
        assert_refused(folder.path(), words, text);
    }
    for (missing, words) in [(0, "filenames.txt is missing"), (1, "light_directions.txt is missing")] {
        files.iter().zip(&valid).for_each(|(file, text)| write(folder.path(), file, text.as_bytes()));
        std::fs::remove_file(folder.path().join(files[missing])).unwrap();
        assert_refused(folder.path(), words, files[missing]);
    }
}

#[test]
fn every_wrong_folder_has_one_clear_error() {
    type Damage = fn(&Path);
    let cases: [(&str, Damage); 14] = [
        ("no lights", |folder| std::fs::remove_file(folder.join("dome.lp")).unwrap()),
        ("several files of lights", |folder| write(folder, "other.lp", b"6")),
        ("several files of lights", |folder| write(folder, "light_directions.txt", b"0 0 1")),
        ("p3.png: 5x5 pixels of 8 bits: p1.png has 4x4", |folder| write(folder, "p3.png", &png(5, 9))),
        ("p3.png", |folder| write(folder, "p3.png", b"")),
        ("p3.png", |folder| write(folder, "p3.png", b"GIF89a....")),
        ("p3.png", |folder| write(folder, "p3.png", &png(4, 9)[..40])),
        ("mask.png: a mask of 5x5", |folder| write(folder, "mask.png", &png(5, 255))),
        ("mask.png: an empty mask", |folder| write(folder, "mask.png", &png(4, 0))),
        ("mask.png", |folder| write(folder, "mask.png", b"not an image")),
        ("'p3.png' is not among the 5 photographs", |folder| {
            std::fs::remove_file(folder.join("p3.png")).unwrap()
        }),
        ("the image format 'dng' is not supported: convert", |folder| {
            std::fs::rename(folder.join("p3.png"), folder.join("p3.dng")).unwrap();
        }),
        ("the image format 'dng' is not supported: convert", |folder| {
            std::fs::rename(folder.join("p3.png"), folder.join("p3.DNG")).unwrap();
        }),
        ("no pixel has a normal", |folder| {
            (1..=6).for_each(|i| write(folder, &format!("p{i}.png"), &png(4, 0)))
        }),
    ];
    for (words, damage) in cases {
        let folder = folder();
        write(folder.path(), "dome.lp", with_count("6").as_bytes());
        damage(folder.path());
        let error = read(folder.path(), 1 << 30).map(|_| ()).expect_err(words).to_string();
        let shown = error.replace(&format!("{}/", folder.path().display()), "");
        assert!(shown.contains(words) && !shown.contains('\n'), "{words}: {shown}");
    }
    let folder = folder();
    write(folder.path(), "dome.lp", with_count("6").as_bytes());
    let error = read(folder.path(), 1 << 20).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("6 photographs of 4x4") && error.contains("--memory-limit"), "{error}");
    let error = read(&folder.path().join("none.lp"), 1 << 30).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("none.lp"), "{error}");
}

#[test]
fn the_smallest_and_oddest_sets_do_not_panic() {
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    let mut estimated = 0;
    for side in [1_u32, 2, 3, 9] {
        for count in 4..=10 {
            // Random greys, only black and white, one grey everywhere, and one lit photograph.
            for kind in 0..4 {
                let folder = tempfile::tempdir().unwrap();
                let mut lp = String::new();
                for (k, light) in crate::studio::directions(count, 60.0).iter().enumerate() {
                    let grey = |_| match kind {
                        0 => random(),
                        1 => random() / 128 * 255,
                        2 => 77,
                        _ => u8::from(k == 0) * 200,
                    };
                    let codes: Vec<u8> = (0..side * side).map(grey).collect();
                    let samples = PngSamples::U8(&codes);
                    let color = PngColor::Grey;
                    let image =
                        PngImage { width: side, height: side, color, samples, encoding: Encoding::Srgb };
                    write(folder.path(), &format!("{k}.png"), &encode_png(&image).unwrap());
                    lp += &format!("{} {} {}\n", light.x, light.y, light.z);
                }
                write(folder.path(), "a.lp", lp.as_bytes());
                let Ok(estimate) = read(folder.path(), 1 << 30) else { continue };
                estimated += 1;
                for best in estimate.best.iter().flatten() {
                    let numbers = [best.sigma_deg, best.albedo, best.residual, best.normal.length()];
                    assert!(
                        numbers.iter().all(|v| v.is_finite() && *v >= 0.0),
                        "{side} {count} {kind}: {best:?}"
                    );
                }
                estimate.plane().unwrap();
            }
        }
    }
    assert!(estimated > 20, "{estimated}");
}
