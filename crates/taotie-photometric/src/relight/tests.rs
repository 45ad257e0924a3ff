//! Files of all kinds: written and read, in odd variants, and damaged.

use super::fit::Projection;
use super::*;
use std::path::Path;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::Vec3;
use taotie_engine::names::Named;
use taotie_io::encode_jpeg_bitmap;
use taotie_io::{FileBytes, Limits};

/// Makes an image of smooth coefficients.
fn image(basis: Basis, colors: ColorModel) -> Relightable {
    let (width, height) = (24, 16);
    let count = if colors == ColorModel::Lrgb { 3 + basis.terms() } else { 3 * basis.terms() };
    let plane = |k: usize| {
        let group = if colors == ColorModel::Lrgb { k } else { k / 3 };
        let is_color = colors == ColorModel::Lrgb && k < 3;
        let scale = if is_color { 1.0 } else { f64::from(0.5 + 0.1 * group as f32) };
        let zero = if is_color { 0.0 } else { 20.0 * group as f64 };
        let code = |i: usize| (40 + 3 * (i % width) + 5 * (i / width) + 4 * k) as u8;
        Plane { scale, bias: -zero / 255.0 * scale, codes: (0..width * height).map(code).collect() }
    };
    Relightable { width: 24, height: 16, basis, colors, planes: (0..count).map(plane).collect() }
}

/// Writes files into a folder and returns the path of the first.
fn written(files: &[FileBytes]) -> std::path::PathBuf {
    files.iter().for_each(|file| std::fs::write(&file.path, &file.bytes).unwrap());
    files[0].path.clone()
}

/// Returns the largest difference between two images over some lights.
fn difference(a: &Relightable, b: &Relightable) -> f32 {
    let lights = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [-0.3, 0.7, 0.648]].map(Vec3::from_array);
    let pairs = lights.map(|light| (a.relit(light), b.relit(light)));
    let all = pairs.iter().flat_map(|(a, b)| a.iter().flatten().zip(b.iter().flatten()));
    all.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn files_are_read_as_they_were_written() {
    let folder = tempfile::tempdir().unwrap();
    for (format, image, most) in [
        (RelightFormat::Ptm, image(Basis::Ptm, ColorModel::Lrgb), 1e-5),
        (RelightFormat::PtmRgb, image(Basis::Ptm, ColorModel::Rgb), 1e-5),
        (RelightFormat::Rti, image(Basis::Hsh(1), ColorModel::Rgb), 1e-5),
        (RelightFormat::Rti, image(Basis::Hsh(3), ColorModel::Rgb), 1e-5),
        // JPEG changes codes by a few.
        (RelightFormat::Web, image(Basis::Hsh(2), ColorModel::Rgb), 0.06),
        (RelightFormat::Web, image(Basis::Ptm, ColorModel::Lrgb), 0.06),
    ] {
        let name = match format {
            RelightFormat::Rti => "a.rti",
            RelightFormat::Web => "",
            _ => "a.ptm",
        };
        let path = written(&format.files(&image, &folder.path().join(name)).unwrap());
        assert!(Relightable::is_named(&path));
        let read = Relightable::open(&path, &Limits::default()).unwrap();
        assert_eq!((read.basis, read.colors), (image.basis, image.colors), "{}", format.name());
        let found = difference(&image, &read);
        assert!(found <= most, "{}: {found}", format.name());
    }
    assert_eq!(Relightable::of_folder(folder.path()), Some(folder.path().join("info.json")));
}

#[test]
fn a_polynomial_is_evaluated_as_its_authors_define_it() {
    // A pixel of 1 × 2: the lower row comes first, and the terms are x², y², xy, x, y, 1.
    let mut bytes = b"PTM_1.2 \r\nPTM_FORMAT_LRGB\n1 2\n1 2 1 1 0.5 1\n10 20 30 40 50 0\n".to_vec();
    bytes.extend([60, 70, 80, 90, 100, 200, 10, 20, 30, 40, 50, 255]);
    bytes.extend([255, 128, 0, 255, 255, 255]);
    let image = ptm::decode(&bytes, Path::new("a.ptm")).unwrap();
    let (x, y) = (0.6, -0.3);
    let relit = image.relit(Vec3::new(x, y, 0.74));
    let lower = 50.0 * x * x + 100.0 * y * y + 50.0 * x * y + 50.0 * x + 25.0 * y + 200.0;
    for (channel, color) in [255.0, 128.0, 0.0].into_iter().enumerate() {
        let expected = lower * color / (255.0 * 255.0);
        assert!((f64::from(relit[1][channel]) - expected).abs() < 1e-5, "{relit:?}, {expected}");
    }
    assert!(relit[0].iter().all(|v| (v - 1.0).abs() < 1e-5), "{relit:?}");
}

/// Returns a texture map with a JPEG image for each plane. The second plane is stored as a difference from the first, of
/// which one code is stored as a correction.
fn with_jpeg(image: &Relightable) -> Vec<u8> {
    let raw = ptm::encode(image);
    let pixels = image.len();
    let at = raw.len() - 9 * pixels;
    let text = String::from_utf8(raw[..at].to_vec()).unwrap().replace("LRGB", "JPEG_LRGB");
    let mut planes: Vec<Vec<u8>> =
        (0..6).map(|k| raw[at..at + 6 * pixels].iter().skip(k).step_by(6).copied().collect()).collect();
    planes.extend(
        (0..3).map(|k| raw[at + 6 * pixels..].iter().skip(k).step_by(3).copied().collect::<Vec<u8>>()),
    );
    let first = planes[0].clone();
    planes[0][0] = 0;
    planes[1]
        .iter_mut()
        .zip(first)
        .for_each(|(code, first)| *code = code.wrapping_sub(first).wrapping_add(128));
    let files: Vec<Vec<u8>> = planes
        .iter()
        .map(|codes| {
            let texels = codes.iter().map(|code| [*code, *code, *code, 255]).collect();
            let bitmap = Bitmap::new(image.width, image.height, 3, Texels::U8(texels)).unwrap();
            encode_jpeg_bitmap(&bitmap, 100).unwrap()
        })
        .collect();
    let zeros = "0 0 0 0 0 0 0 0 0\n";
    let lengths: Vec<String> = files.iter().map(|file| file.len().to_string()).collect();
    let mut bytes = text.into_bytes();
    let references = "-1 0 -1 -1 -1 -1 -1 -1 -1";
    bytes.extend(format!("100\n{zeros}{zeros}{zeros}0 1 2 3 4 5 6 7 8\n{references}\n").bytes());
    bytes.extend(format!("{}\n5 0 0 0 0 0 0 0 0\n", lengths.join(" ")).bytes());
    for (i, file) in files.iter().enumerate() {
        bytes.extend(file);
        if i == 0 {
            bytes.extend([0, 0, 0, 0, raw[at]]);
        }
    }
    bytes
}

#[test]
fn planes_compressed_with_jpeg_are_read() {
    let mut image = image(Basis::Ptm, ColorModel::Lrgb);
    // x² of the first pixel of the lowest row, the first of the file.
    image.planes[6].codes[15 * 24] = 250;
    let read = ptm::decode(&with_jpeg(&image), Path::new("a.ptm")).unwrap();
    assert_eq!(read.planes[6].codes[15 * 24], 250);
    let found = difference(&image, &read);
    assert!(found < 0.05, "{found}");
}

#[test]
fn damaged_files_are_errors_that_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let lrgb = image(Basis::Ptm, ColorModel::Lrgb);
    let all = [
        ("a.ptm", ptm::encode(&lrgb)),
        ("b.ptm", with_jpeg(&lrgb)),
        ("c.rti", rti::encode(&image(Basis::Hsh(2), ColorModel::Rgb))),
    ];
    for (name, bytes) in &all {
        let path = folder.path().join(name);
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            Relightable::open(&path, &Limits::default())
        };
        read(bytes).unwrap();
        for length in (0..bytes.len()).step_by(if bytes.len() > 3000 { 97 } else { 7 }) {
            let error = read(&bytes[..length]).unwrap_err().to_string();
            assert!(error.contains(name), "{name}, {length} bytes: {error}");
        }
        for at in (0..200).step_by(3) {
            for byte in [0, b' ', b'9', b'-', 255] {
                let mut changed = bytes.clone();
                changed[at] = byte;
                // A changed header may still be valid.
                if let Ok(image) = read(&changed) {
                    assert_eq!(image.relit(Vec3::new(0.0, 0.0, 1.0)).len(), image.len());
                }
            }
        }
    }
}

#[test]
fn other_kinds_are_refused_with_advice() {
    let error = |bytes: &[u8], name: &str| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        Relightable::open(&path, &Limits::default()).unwrap_err().to_string()
    };
    for (text, name, words) in [
        ("PTM_1.2\nPTM_FORMAT_LUM\n1\n1\n", "a.ptm", "convert it to PTM_FORMAT_RGB"),
        ("PTM_1.2\nPTM_FORMAT_RGB\n0\n1\n1 1 1 1 1 1\n0 0 0 0 0 0\n", "a.ptm", "invalid size 0x1"),
        ("PTM_1.2\nPTM_FORMAT_RGB\n99999\n9\n", "a.ptm", "invalid size 99999x9"),
        ("PTM_1.2\nPTM_FORMAT_RGB\n1\n1\n1 1 nan 1 1 1\n0 0 0 0 0 0\n", "a.ptm", "must be finite"),
        ("#HSH1.2\n1\n4 4 3\n6 2 1\n", "a.rti", "kind 1 with 6 terms"),
        ("#HSH1.2\n3\n4 4 3\n5 2 1\n", "a.rti", "of 4, 9 or 16"),
        ("not a file of coefficients", "a.rti", "expected the kind of coefficients"),
        ("{", "info.json", "not a description of coefficients"),
        (
            r#"{"width":2,"height":2,"format":"jpg","type":"rbf","colorspace":"mrgb","materials":[]}"#,
            "info.json",
            "export it as ptm or hsh",
        ),
        (
            r#"{"width":2,"height":2,"format":"jpg","type":"ptm","colorspace":"lrgb","materials":[]}"#,
            "info.json",
            "expected 9 numbers as scale",
        ),
    ] {
        let error = error(text.as_bytes(), name);
        assert!(error.contains(words) && error.contains(name), "{words}: {error}");
    }
}

#[test]
fn brightness_and_colour_are_separated() {
    let lights = lights_of_relit();
    let projection = Projection::new(Basis::Ptm, &lights);
    let color = [0.9, 0.5, 0.1];
    let grey = [0.3, 0.2, -0.1, 0.1, 0.05, -0.1];
    let planes = (0..18).map(|k| vec![(color[k % 3] * grey[k / 3]) as f32; 4]).collect();
    let coefficients = Coefficients { width: 2, height: 2, basis: Basis::Ptm, projection, planes };
    let [rgb, lrgb] = [ColorModel::Rgb, ColorModel::Lrgb].map(|colors| coefficients.stored(colors));
    assert_eq!((rgb.planes.len(), lrgb.planes.len()), (18, 9));
    assert!(difference(&rgb, &lrgb) < 0.01, "{}", difference(&rgb, &lrgb));
    let black = Coefficients { planes: vec![vec![0.0; 4]; 18], ..coefficients };
    assert!(black.stored(ColorModel::Lrgb).relit(lights[0]).iter().flatten().all(|v| *v == 0.0));
}
