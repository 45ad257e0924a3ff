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

/// The kinds of errors that are expected.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Io,
    Parse,
    Invalid,
    Unsupported,
    Limit,
}

fn kind_of(error: &Error) -> Option<Kind> {
    Some(match error {
        Error::Io { .. } => Kind::Io,
        Error::Parse { .. } => Kind::Parse,
        Error::Invalid { .. } => Kind::Invalid,
        Error::Unsupported { .. } => Kind::Unsupported,
        Error::Limit { .. } => Kind::Limit,
        _ => return None,
    })
}

/// Asserts that reading fails with an error of this kind, in one line that starts with the file in `folder` and the
/// place in it, as `start`, and has these words.
fn assert_refused(path: &Path, folder: &Path, (kind, start, words): (Kind, &str, &str), what: &str) {
    let error = read(path, 1 << 30).map(|_| ()).expect_err(what);
    assert_eq!(kind_of(&error), Some(kind), "{what}: {error}");
    let shown = error.to_string().replace(&format!("{}/", folder.display()), "");
    let shown = shown.replace(&folder.display().to_string(), "FOLDER");
    assert!(shown.starts_with(start), "{what}: expected `{start}`: {shown}");
    assert!(shown.contains(words), "{what}: {shown}");
    assert!(!shown.contains('\n') && shown.len() < 400, "{what}: {shown}");
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

/// A wrong `.lp` file: its text, and the expected error's kind, start and words.
type Case = (String, (Kind, &'static str, &'static str));

/// Returns files whose count is wrong, or that have no lights.
fn wrong_counts() -> Vec<Case> {
    let mut cases = Vec::new();
    for count in ["5", "7", "0", "1", "600", "99999999", "18446744073709551615"] {
        let words = "lights stated, but 6 follow";
        cases.push((with_count(count), (Kind::Parse, "dome.lp: line 1: ", words)));
    }
    let words = "expected the number of lights";
    for count in
        ["six", "-6", "6.0", "6,0", "0x6", "6a", "١", "NaN", "18446744073709551616", "[6]", "{", "6x"]
    {
        cases.push((with_count(count), (Kind::Parse, "dome.lp: line 1: ", words)));
    }
    cases.push((format!("# dome\n\n{}", with_count("six")), (Kind::Parse, "dome.lp: line 3: ", words)));
    for text in ["", "\n\n", "# nothing", "\u{feff}", "   \t "] {
        cases.push((text.to_owned(), (Kind::Parse, "dome.lp: line 1: ", "no lights")));
    }
    for text in ["6", "6\n\n\n", "0\n", "6\n# none\n"] {
        cases.push((text.to_owned(), (Kind::Parse, "dome.lp: the end: ", "no lights")));
    }
    cases
}

/// Returns files whose third light is wrong.
fn wrong_lines() -> Vec<Case> {
    let mut cases = Vec::new();
    let mut third = |lines: &[&str], words: &'static str| {
        for line in lines {
            cases.push((with_line(2, line), (Kind::Parse, "dome.lp: line 4: ", words)));
        }
    };
    third(&["p3.png", "p3.png 1", "p3.png;1", "p3.png\t0.1"], "expected `NAME X Y Z`");
    let not_numbers = [
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
        "p3.png 0 0.5 'a\u{7}b'",
        "p3.png x 0.5 0.8",
        "p3.png 0 y 0.8",
    ];
    third(&not_numbers, "is not a number");
    let zero = ["p3.png 0 0 0", "p3.png 0,0 0,0 0,0", "p3.png 1e-12 0 0", "p3.png -0 -0 -0"];
    third(&zero, "the vector towards the light is zero");
    let absent = [
        "p9.png 0 0.5 0.8",
        "photo of p3 0 0.5 0.8",
        "../../etc/passwd 0 0.5 0.8",
        "p3.png.bak 0 0.5 0.8",
        "mask.png 0 0.5 0.8",
        "p?.png 0 0.5 0.8",
        "3 0 0.5 0.8",
    ];
    third(&absent, "is not among the 6 photographs");
    let twice = ["p1.png 0 0.5 0.8", "P1.PNG 0 0.5 0.8", "C:\\dome\\p1.png 0 0.5 0.8", "p1.tif 0 0.5 0.8"];
    third(&twice, "is also the photograph of line 2");
    third(&["0 0.5 0.8"], "some lines have a name and others do not");
    third(&[&"x".repeat(5000)], "5000 bytes long");
    cases
}

/// Returns files whose lights are wrong together.
fn wrong_lights() -> Vec<Case> {
    let all = |line: &dyn Fn(usize, &str) -> String| {
        let lines: Vec<String> = LIGHTS.iter().enumerate().map(|(i, light)| line(i, light)).collect();
        lines.join("\n")
    };
    let plane = all(&|i, _| format!("p{}.png {} 0 1", i + 1, i as f64 * 0.2));
    let same = all(&|i, _| format!("p{}.png 0.1 0.2 0.9", i + 1));
    let behind = all(&|i, light| format!("p{}.png {}", i + 1, light.replace(" 0.", " -0.")));
    let numbered = all(&|i, light| format!("{} {light}", 2 * i + 1));
    let too_many = format!("7\n{}\n0 0.1 0.9\n", LIGHTS.join("\n"));
    vec![
        (plane, (Kind::Invalid, "dome.lp: lights nearly in one plane", "add photographs")),
        (
            same,
            (Kind::Invalid, "dome.lp: lights nearly in one plane or from one direction", "add photographs"),
        ),
        (behind, (Kind::Invalid, "dome.lp: lights from behind", "negate z")),
        (lines()[..3].join("\n"), (Kind::Invalid, "dome.lp: 3 lights", "at least 4 are needed")),
        (lines()[..1].join("\n"), (Kind::Invalid, "dome.lp: 1 lights", "at least 4 are needed")),
        (too_many, (Kind::Parse, "dome.lp: line 8: ", "photograph 7 of 6: the folder has too few")),
        (numbered, (Kind::Parse, "dome.lp: line 4: ", "photograph 7 of 6")),
        ("a 0 0 1\n".repeat(5000), (Kind::Limit, "dome.lp", "at most 4096 lights")),
    ]
}

#[test]
fn every_wrong_lp_file_has_one_clear_error() {
    let cases = [wrong_counts(), wrong_lines(), wrong_lights()].concat();
    let texts: std::collections::BTreeSet<&String> = cases.iter().map(|(text, _)| text).collect();
    assert!(texts.len() >= 75 && texts.len() == cases.len(), "{} of {}", texts.len(), cases.len());
    let folder = folder();
    let path = folder.path().join("dome.lp");
    for (text, expected) in &cases {
        write(folder.path(), "dome.lp", text.as_bytes());
        assert_refused(&path, folder.path(), *expected, &text.chars().take(200).collect::<String>());
    }
    for (i, bytes) in [&[0_u8; 2000][..], &png(64, 9), &[0xff; 3000], b"\x80\x81\x82 1", b"\xff\xfe\x00\xd8"]
        .into_iter()
        .enumerate()
    {
        write(folder.path(), "dome.lp", bytes);
        assert_refused(&path, folder.path(), (Kind::Parse, "dome.lp: ", ""), &format!("bytes {i}"));
    }
    write(folder.path(), "dome.lp", &vec![b' '; (1 << 24) + 1]);
    assert_refused(&path, folder.path(), (Kind::Limit, "dome.lp", "at most 16 MiB of text"), "a long file");
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
    let [names, directions, intensities] = files.map(|file| format!("{file}: "));
    let at = |file: &str, place: &str| format!("{file}{place}: ");
    let cases = [
        (replaced(0, 2, "p9.png"), at(&names, "line 3"), "'p9.png' is not among the 6 photographs"),
        (replaced(0, 2, "p1.png"), at(&names, "line 3"), "is also the photograph of line 1"),
        (replaced(0, 2, ""), at(&directions, "the end"), "6 lines, but filenames.txt has 5"),
        ((0, String::new()), at(&directions, "the end"), "6 lines, but filenames.txt has 0"),
        (replaced(1, 2, "0 0.5"), at(&directions, "line 3"), "expected three numbers"),
        (replaced(1, 2, "0 0.5 0.8 1"), at(&directions, "line 3"), "expected three numbers"),
        (replaced(1, 2, "0 0.5 x"), at(&directions, "line 3"), "expected three numbers"),
        (replaced(1, 2, "0 0.5 nan"), at(&directions, "line 3"), "expected three numbers"),
        (replaced(1, 2, "0 0 0"), at(&directions, "line 3"), "the direction is zero"),
        (replaced(1, 2, ""), at(&directions, "the end"), "5 lines"),
        ((1, String::new()), at(&directions, "the end"), "0 lines"),
        ((1, ["0.1 0.1 1"; 6].join("\n")), directions.clone() + "lights nearly", "from one direction"),
        (
            (1, LIGHTS.join("\n").replace(" 0.", " -0.")),
            directions.clone() + "lights from behind",
            "negate z",
        ),
        (replaced(2, 2, "1 1"), at(&intensities, "line 3"), "expected three numbers"),
        (replaced(2, 2, "1 1 one"), at(&intensities, "line 3"), "expected three numbers"),
        (replaced(2, 2, "1 0 1"), at(&intensities, "line 3"), "intensities must be above 0"),
        (replaced(2, 2, "1 -1 1"), at(&intensities, "line 3"), "intensities must be above 0"),
        (replaced(2, 2, ""), at(&intensities, "the end"), "5 lines"),
        ((2, "1 1 1\n".repeat(7)), at(&intensities, "the end"), "7 lines"),
    ];
    let folder = folder();
    for ((which, text), start, words) in &cases {
        for (i, file) in files.iter().enumerate() {
            write(folder.path(), file, if i == *which { text } else { &valid[i] }.as_bytes());
        }
        let kind = if start.contains(": lights ") { Kind::Invalid } else { Kind::Parse };
        assert_refused(folder.path(), folder.path(), (kind, start, words), text);
    }
    for missing in [0, 1] {
        files.iter().zip(&valid).for_each(|(file, text)| write(folder.path(), file, text.as_bytes()));
        std::fs::remove_file(folder.path().join(files[missing])).unwrap();
        let start = format!("FOLDER: {} is missing", files[missing]);
        assert_refused(folder.path(), folder.path(), (Kind::Invalid, &start, "add it"), files[missing]);
    }
}

#[test]
fn every_wrong_folder_has_one_clear_error() {
    type Damage = fn(&Path);
    let cases: [(Kind, &str, &str, Damage); 18] = [
        (Kind::Invalid, "FOLDER: no lights", "", |folder| {
            std::fs::remove_file(folder.join("dome.lp")).unwrap()
        }),
        (Kind::Invalid, "FOLDER: several files of lights", "other.lp", |folder| {
            write(folder, "other.lp", b"6")
        }),
        (Kind::Invalid, "FOLDER: several files of lights", "light_directions.txt", |folder| {
            write(folder, "light_directions.txt", b"0 0 1");
        }),
        (Kind::Invalid, "p3.png: 5x5 pixels of 8 bits", "p1.png has 4x4", |folder| {
            write(folder, "p3.png", &png(5, 9));
        }),
        (Kind::Parse, "p3.png: ", "the image is empty", |folder| write(folder, "p3.png", b"")),
        (Kind::Unsupported, "p3.png: ", "", |folder| write(folder, "p3.png", b"GIF89a....")),
        (Kind::Parse, "p3.png: ", "", |folder| write(folder, "p3.png", b"\x89PNG\r\n\x1a\n")),
        (Kind::Parse, "p3.png: ", "", |folder| write(folder, "p3.png", &png(4, 9)[..40])),
        (Kind::Invalid, "mask.png: a mask of 5x5", "4x4", |folder| write(folder, "mask.png", &png(5, 255))),
        (Kind::Invalid, "mask.png: an empty mask", "white", |folder| write(folder, "mask.png", &png(4, 0))),
        (Kind::Parse, "mask.png: ", "the image is empty", |folder| write(folder, "mask.png", b"")),
        (Kind::Parse, "dome.lp: line 4: ", "'p3.png' is not among the 5 photographs", |folder| {
            std::fs::remove_file(folder.join("p3.png")).unwrap();
        }),
        (Kind::Parse, "dome.lp: line 4: ", "'p3.png' is not among the 5 photographs", |folder| {
            std::fs::remove_file(folder.join("p3.png")).unwrap();
            std::fs::create_dir(folder.join("p3.png")).unwrap();
        }),
        (Kind::Unsupported, "p3.dng: the image format 'dng'", "convert", |folder| {
            std::fs::rename(folder.join("p3.png"), folder.join("p3.dng")).unwrap();
        }),
        (Kind::Unsupported, "p3.DNG: the image format 'dng'", "convert", |folder| {
            std::fs::rename(folder.join("p3.png"), folder.join("p3.DNG")).unwrap();
        }),
        (Kind::Unsupported, "p6.cr2: the image format 'cr2'", "convert", |folder| {
            std::fs::rename(folder.join("p6.png"), folder.join("p6.cr2")).unwrap();
        }),
        (Kind::Invalid, "no pixel has a normal", "black", |folder| {
            (1..=6).for_each(|i| write(folder, &format!("p{i}.png"), &png(4, 0)));
        }),
        (
            Kind::Invalid,
            "no pixel has a normal",
            "96 of 96 samples within the mask are saturated",
            |folder| {
                (1..=6).for_each(|i| write(folder, &format!("p{i}.png"), &png(4, 255)));
            },
        ),
    ];
    for (kind, start, words, damage) in cases {
        let folder = folder();
        write(folder.path(), "dome.lp", with_count("6").as_bytes());
        damage(folder.path());
        assert_refused(folder.path(), folder.path(), (kind, start, words), start);
    }
    let folder = folder();
    write(folder.path(), "dome.lp", with_count("6").as_bytes());
    let error = read(folder.path(), 1 << 20).map(|_| ()).unwrap_err();
    assert_eq!(kind_of(&error), Some(Kind::Limit), "{error}");
    let error = error.to_string();
    assert!(error.contains("6 photographs of 4x4") && error.contains("--memory-limit"), "{error}");
    let none = folder.path().join("none.lp");
    assert_refused(&none, folder.path(), (Kind::Io, "none.lp: ", ""), "a file that does not exist");
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
                estimate.plane(1.0).unwrap();
            }
        }
    }
    assert!(estimated > 20, "{estimated}");
}
