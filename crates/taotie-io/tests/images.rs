//! Images by others: PngSuite decodes to the right numbers, damaged files end in a one-line error, nothing panics.
//! This is a separate program, since its peak memory is checked.

#[path = "../../../tests/common/mod.rs"]
mod common;
#[path = "../../../tests/common/files.rs"]
mod files;

#[cfg(feature = "exr")]
use common::absent;
use common::data_folder;
#[cfg(feature = "exr")]
use files::all_files_below;
use files::{data_files, files_below};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};
use taotie_engine::image::{Bitmap, Encoding, Texels};
use taotie_engine::names::Named;
use taotie_io::{
    Limits, MapFormat, decode_bitmap, encode_jpeg_bitmap, encode_map, read_bitmap, read_bitmap_within,
    read_photograph_within,
};

const EXTENSIONS: [&str; 11] =
    ["png", "jpg", "jpeg", "webp", "avif", "ktx2", "tga", "tif", "tiff", "hdr", "exr"];

/// Returns the path of a picture in this repository.
fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/pictures").join(name)
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_string_lossy().into_owned()
}

fn pngsuite() -> Vec<PathBuf> {
    data_files("pngsuite", &["png"]).into_iter().filter(|p| stem(p).len() == 8).collect()
}

fn one_line(error: &taotie_engine::Error, path: &Path) {
    let text = error.to_string();
    assert!(!text.contains('\n'), "{text}");
    assert!(text.contains(&*path.file_name().unwrap().to_string_lossy()), "{text}");
}

/// Returns width and height from the file's header.
fn header_size(bytes: &[u8]) -> [u32; 2] {
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

/// PngSuite's names end in colour type, its letter and the bits per sample, such as `2c16`; names with `x` are
/// damaged.
#[test]
fn pngsuite_by_its_naming_rule() {
    for path in pngsuite() {
        let name = stem(&path);
        let read = read_bitmap(&path);
        if name.starts_with('x') {
            one_line(&read.expect_err(&name), &path);
            continue;
        }
        let bitmap = read.unwrap_or_else(|e| panic!("{e}"));
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!([bitmap.width(), bitmap.height()], header_size(&bytes), "{name}");
        assert_eq!(bitmap.bits(), if name.ends_with("16") { 16 } else { 8 }, "{name}");
        let transparent = bytes.windows(4).any(|w| w == b"tRNS");
        let stored = match &name[4..5] {
            "0" => 1,
            "4" => 2,
            "2" | "3" => 3,
            _ => 4,
        };
        assert_eq!(bitmap.channels(), stored + u8::from(transparent), "{name}");
    }
}

/// Returns texels of 8 bits, as an 8-bit program would show them.
fn as_u8(bitmap: &Bitmap) -> Vec<u8> {
    match bitmap.texels() {
        Texels::U8(t) => t.as_flattened().to_vec(),
        Texels::U16(t) => t.as_flattened().iter().map(|v| (v >> 8) as u8).collect(),
        Texels::F32(_) => panic!("a PNG has no floats"),
    }
}

/// The dumps next to PngSuite were made by another program.
#[test]
fn pngsuite_texels_equal_the_dumps() {
    let Some(folder) = data_folder("pngsuite") else { return };
    let dumps = files_below(&folder, &["json"]);
    for dump in &dumps {
        let expected: Vec<u8> = serde_json::from_slice(&std::fs::read(dump).unwrap()).unwrap();
        let path = folder.join("png").join(dump.file_stem().unwrap()).with_extension("png");
        assert_eq!(as_u8(&read_bitmap(&path).unwrap()), expected, "{}", path.display());
    }
    assert!(!dumps.is_empty());
}

/// Returns a name without the letter for how the picture is stored: interlaced or not (`basi`, `basn`, `s05i`,
/// `s05n`), in how many chunks (`oi1` …), at which compression level (`z00` …).
fn picture_of(name: &str) -> String {
    let letter = match &name[..2] {
        "ba" | "s0" | "s3" | "s4" => 3,
        "oi" | "z0" => 2,
        _ => return name.to_owned(),
    };
    format!("{}{}", &name[..letter], &name[letter + 1..])
}

#[test]
fn pngsuite_variants_of_a_picture_are_equal() {
    let mut seen = BTreeMap::new();
    let mut compared = 0;
    for path in pngsuite().iter().filter(|p| !stem(p).starts_with('x')) {
        let bitmap = read_bitmap(path).unwrap();
        match seen.entry(picture_of(&stem(path))) {
            Entry::Occupied(first) => {
                assert_eq!(first.get(), &bitmap, "{}", path.display());
                compared += 1;
            }
            Entry::Vacant(place) => drop(place.insert(bitmap)),
        }
    }
    assert!(seen.is_empty() || compared > 0, "{compared}");
}

/// The TIFF files were made from the PNG by tifffile 2026: LZW with a predictor; 16 bits, big-endian, in tiles; floats.
#[test]
fn tiff_is_the_picture_it_was_made_from() {
    let png = read_bitmap(&own("waves.png")).unwrap();
    let [lzw, tiles, float] = ["waves-lzw.tif", "waves-16-tiles.tif", "waves-float.tif"]
        .map(|name| read_bitmap(&own(name)).unwrap());
    assert_eq!(lzw, png);
    assert_eq!((tiles.bits(), tiles.channels()), (16, 4));
    assert_eq!(as_u8(&tiles), as_u8(&png));
    let Texels::F32(texels) = float.texels() else { panic!("it has floats") };
    assert_eq!((float.width(), float.height(), float.channels()), (40, 12, 3));
    let codes = texels.iter().flat_map(|[r, g, b, _]| [r, g, b].map(|v| (v * 255.0).round() as u8));
    let wanted = as_u8(&png);
    let wanted = wanted.chunks(4).take(40 * 12).flat_map(|texel| texel[..3].to_vec());
    assert!(codes.eq(wanted));
}

/// Writes and reads back every format, depth and number of channels of maps.
#[test]
fn maps_come_back_in_every_format() {
    let texel = |i: u32| [i * 7 % 251, i * 13 % 241, i * 31 % 239, 255 - i % 200];
    for (format, extension) in [("png", "png"), ("tiff", "tif"), ("tga", "tga"), ("webp", "webp")] {
        let format = MapFormat::from_name(format).unwrap();
        if cfg!(not(feature = "webp")) && format == MapFormat::WebP {
            continue;
        }
        for (channels, bits) in [(1, 8), (3, 8), (4, 8), (1, 16), (3, 16), (4, 16)] {
            let shown = |[r, g, b, a]: [u32; 4], one: u32| match channels {
                1 => [r, r, r, one],
                3 => [r, g, b, one],
                _ => [r, g, b, a],
            };
            let texels = (0..37 * 21).map(texel);
            let texels = match bits {
                8 => Texels::U8(texels.map(|texel| shown(texel, 255).map(|v| v as u8)).collect()),
                _ => Texels::U16(
                    texels
                        .map(|texel| shown(texel.map(|v| v * 256 + v / 3), 65_535).map(|v| v as u16))
                        .collect(),
                ),
            };
            let bitmap = Bitmap::new(37, 21, channels, texels).unwrap();
            let encoded = encode_map(&bitmap, Encoding::Linear, format);
            if bits > format.bits() {
                let error = encoded.expect_err("it stores 8 bits").to_string();
                assert!(error.contains("16 bits per channel") && error.contains("write a .png"), "{error}");
                continue;
            }
            let name = format!("map.{extension}");
            let read = decode_bitmap(&encoded.unwrap(), &name, Path::new(&name)).unwrap();
            // WebP has no grey.
            let same = read == bitmap || format == MapFormat::WebP && read.texels() == bitmap.texels();
            assert!(same, "{extension}, {channels} channels of {bits} bits");
        }
    }
}

/// Writes smooth pictures in the block formats of GPUs, of sides that do not divide by 4, and reads them back.
#[test]
fn dds_is_close_to_the_picture_it_was_made_from() {
    let (width, height) = (38u32, 21u32);
    let wave = |i: u32, scale: f64| {
        let (x, y) = (f64::from(i % width), f64::from(i / width));
        127.5 + 100.0 * (libm::sin(x * scale) * libm::cos(y * scale * 0.7))
    };
    let plain = |i: u32| [0.11, 0.17, 0.23, 0.05].map(|scale| wave(i, scale) as u8);
    let normal = |i: u32| {
        let [x, y] = [0.11, 0.17].map(|scale| (wave(i, scale) / 127.5 - 1.0) * 0.8);
        let z = libm::sqrt(1.0 - x * x - y * y);
        let [r, g, b] = [x, y, z].map(|v| ((v + 1.0) * 127.5 + 0.5) as u8);
        [r, g, b, 255]
    };
    let texels = |channels: u8, encoding: Encoding| {
        let texel = |i: u32| match (channels, plain(i)) {
            _ if encoding == Encoding::Normal => normal(i),
            (1, [v, ..]) => [v, v, v, 255],
            (3, [r, g, b, _]) => [r, g, b, 255],
            (_, texel) => texel,
        };
        Texels::U8((0..width * height).map(texel).collect())
    };
    // The mean difference in codes, and bytes per texel of the finest level.
    for (channels, encoding, most, blocks) in [
        (1, Encoding::Linear, 0.6, 8),
        (3, Encoding::Normal, 0.5, 16),
        (3, Encoding::Srgb, 1.3, 16),
        (4, Encoding::Linear, 2.0, 16),
    ] {
        let bitmap = Bitmap::new(width, height, channels, texels(channels, encoding)).unwrap();
        let bytes = encode_map(&bitmap, encoding, MapFormat::Dds).unwrap();
        let read = decode_bitmap(&bytes, "a.dds", Path::new("a.dds")).unwrap();
        assert_eq!((read.width(), read.height()), (width, height));
        let [own, read] = [&bitmap, &read].map(as_u8);
        let off = own.iter().zip(&read).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>();
        let mean = off / own.len() as f64;
        assert!(mean < most, "{channels} channels as {encoding:?}: {mean}");
        // 38 × 21, 19 × 10, 9 × 5, 4 × 2, 2 × 1 and 1 × 1 texels.
        assert_eq!(bytes.len(), 148 + blocks * (60 + 15 + 6 + 1 + 1 + 1));
        for end in [4, 100, 147, 148, 148 + blocks * 59] {
            assert!(decode_bitmap(&bytes[..end], "a.dds", Path::new("a.dds")).is_err(), "{end}");
        }
    }
    let deep = Bitmap::new(1, 1, 1, Texels::U16(vec![[1; 4]])).unwrap();
    assert!(encode_map(&deep, Encoding::Linear, MapFormat::Dds).unwrap_err().to_string().contains("16 bits"));
}

#[cfg(feature = "webp")]
#[test]
fn lossless_webp_is_the_picture_it_was_made_from() {
    let [webp, png] = ["lossless.webp", "waves.png"].map(|name| read_bitmap(&own(name)).unwrap());
    assert_eq!(webp, png);
}

/// Compares with libwebp's own decoder.
#[cfg(feature = "webp")]
#[test]
fn lossy_webp_is_what_libwebp_makes_of_it() {
    let [webp, png] = ["lossy.webp", "lossy.png"].map(|name| read_bitmap(&own(name)).unwrap());
    assert_eq!((webp.width(), webp.height(), webp.channels()), (40, 24, 3));
    assert_eq!(as_u8(&webp), as_u8(&png));
}

/// Compares with libavif, which computes colours in integers, and takes the upper 8 of 10 bits.
#[cfg(feature = "avif")]
#[test]
fn avif_is_what_libavif_makes_of_it() {
    let cases = [
        ("rgb", 3, 0),
        ("deep", 3, 3),
        ("444", 3, 1),
        ("limited", 3, 2),
        ("alpha", 4, 1),
        ("grey", 1, 1),
        ("422", 3, 2),
        ("420", 3, 2),
    ];
    for (name, channels, most) in cases {
        let [avif, png] =
            ["avif", "png"].map(|kind| read_bitmap(&own(&format!("avif-{name}.{kind}"))).unwrap());
        assert_eq!((avif.width(), avif.height(), avif.channels()), (40, 24, channels), "{name}");
        let worst = as_u8(&avif).into_iter().zip(as_u8(&png)).map(|(a, b)| a.abs_diff(b)).max().unwrap();
        assert!(worst <= most, "{name}: {worst}");
    }
}

/// Damaged files end in an error or in an image.
#[cfg(feature = "avif")]
#[test]
fn damaged_avif_does_not_panic() {
    let seed = std::fs::read(own("avif-alpha.avif")).unwrap();
    let read = |bytes: &[u8]| decode_bitmap(bytes, "a.avif", Path::new("a.avif"));
    assert!((0..seed.len()).all(|length| read(&seed[..length]).is_err()));
    let refused = (0..seed.len()).filter(|at| {
        let mut changed = seed.clone();
        changed[*at] ^= 0x5a;
        read(&changed).is_err()
    });
    assert!(refused.count() > seed.len() / 8);
}

/// Compares with Basis Universal's own transcoder: ETC1S with and without alpha, UASTC plain and with Zstandard.
#[cfg(feature = "basis")]
#[test]
fn ktx2_is_what_basis_universal_makes_of_it() {
    for (name, channels) in [("etc1s", 3), ("etc1s-alpha", 4), ("uastc-alpha", 4), ("uastc-zstd", 3)] {
        let [ktx2, png] = ["ktx2", "png"].map(|kind| read_bitmap(&own(&format!("{name}.{kind}"))).unwrap());
        assert_eq!((ktx2.width(), ktx2.height(), ktx2.channels()), (40, 24, channels), "{name}");
        assert!(as_u8(&ktx2) == as_u8(&png), "{name}");
        // It is the compressed picture, up to the compression loss.
        let waves = as_u8(&read_bitmap(&own("waves.png")).unwrap());
        let colors = as_u8(&ktx2).into_iter().zip(waves).enumerate().filter(|(i, _)| i % 4 < channels.into());
        let squares: Vec<f64> =
            colors.map(|(_, (a, b))| f64::from(a.abs_diff(b)) * f64::from(a.abs_diff(b))).collect();
        let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
        assert!(rms < if name.starts_with("uastc") { 5.0 } else { 20.0 }, "{name}: {rms}");
    }
}

/// A header may claim anything; nothing is allocated before the claim can be true.
#[cfg(feature = "basis")]
#[test]
fn ktx2_headers_that_cannot_be_true() {
    let seed = std::fs::read(own("uastc-zstd.ktx2")).unwrap();
    let error = |at: usize, bytes: &[u8]| {
        let mut changed = seed.clone();
        changed[at..at + bytes.len()].copy_from_slice(bytes);
        decode_bitmap(&changed, "a.ktx2", Path::new("a.ktx2")).unwrap_err().to_string()
    };
    assert!(error(96, &u64::MAX.to_le_bytes()).contains("bytes for 60 blocks"));
    assert!(error(20, &60_000u32.to_le_bytes()).contains("at most"));
    assert!(error(20, &16_384u32.to_le_bytes().repeat(2)).contains("cannot hold"));
    assert!(error(12, &37u32.to_le_bytes()).contains("Basis Universal"));
    assert!(error(36, &6u32.to_le_bytes()).contains("several layers"));
    assert!(!error(48, &u32::MAX.to_le_bytes()).is_empty());
    assert!(!error(80, &u64::MAX.to_le_bytes()).is_empty());
    for length in 0..seed.len() {
        assert!(decode_bitmap(&seed[..length], "a.ktx2", Path::new("a.ktx2")).is_err(), "{length}");
    }
}

/// A picture of a single colour takes few bytes at any size: it is read up to 4096 × 4096 and refused beyond.
#[cfg(feature = "webp")]
#[test]
fn plain_webp_is_read_and_a_bomb_is_not() {
    let plain = |side: u32| {
        // RIFF, VP8L, its signature, width and height minus one in 14 bits each, no transform, no cache, no groups,
        // and five codes of a single symbol, so that texels take no bits.
        let size = (side - 1) | (side - 1) << 14;
        let mut data = vec![0x2f];
        data.extend(size.to_le_bytes());
        data.extend([0x88, 0x88, 0x08, 0x00]);
        data.resize(data.len() + 6, 0);
        let length = data.len() as u32 + data.len() as u32 % 2;
        data.resize(length as usize, 0);
        let mut file = b"RIFF".to_vec();
        file.extend((length + 12).to_le_bytes());
        file.extend(b"WEBPVP8L");
        file.extend(length.to_le_bytes());
        file.extend(data);
        decode_bitmap(&file, "plain.webp", Path::new("plain.webp"))
    };
    let picture = plain(4096).unwrap();
    assert_eq!((picture.width(), picture.height()), (4096, 4096));
    let error = plain(4097).unwrap_err().to_string();
    assert!(error.contains("cannot hold 4097×4097"), "{error}");
}

#[test]
fn images_of_every_folder_load_or_say_why() {
    for sub in ["malformed-and-odd-inputs", "environments", "smithsonian-bronze-gong-textures"] {
        for path in data_files(sub, &EXTENSIONS) {
            if let Err(error) = read_bitmap(&path) {
                one_line(&error, &path);
            }
        }
    }
    memory_stayed_small();
}

/// Damaged OpenEXR files have no extension; they are recognised by their first bytes.
#[cfg(feature = "exr")]
#[test]
fn damaged_exr_files_end_in_one_line() {
    let Some(folder) = data_folder("malformed-and-odd-inputs") else { return };
    let mut seen = 0;
    for path in all_files_below(&folder) {
        let bytes = std::fs::read(&path).unwrap();
        if !bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
            continue;
        }
        seen += 1;
        if let Err(error) = read_bitmap(&path) {
            one_line(&error, &path);
        }
    }
    if seen == 0 {
        absent("no damaged file is OpenEXR");
    }
    memory_stayed_small();
}

/// Truncated or with bytes changed, small images load or fail; they never panic.
#[test]
fn damaged_variants_never_panic() {
    let folders = ["malformed-and-odd-inputs", "pngsuite"];
    for path in folders.iter().flat_map(|sub| data_files(sub, &EXTENSIONS)) {
        let bytes = std::fs::read(&path).unwrap();
        if bytes.len() > 20_000 {
            continue;
        }
        let name = path.file_name().unwrap().to_string_lossy();
        for cut in [0, 1, 7, 18, 33, bytes.len() / 2, bytes.len().saturating_sub(1)] {
            let _ = decode_bitmap(&bytes[..cut.min(bytes.len())], &name, &path);
        }
        let mut random = Random(bytes.len() as u64);
        for _ in 0..60 {
            let mut changed = bytes.clone();
            for _ in 0..3 {
                if let Some(byte) = changed.get_mut(random.below(bytes.len())) {
                    *byte = random.below(256) as u8;
                }
            }
            let _ = decode_bitmap(&changed, &name, &path);
        }
    }
    memory_stayed_small();
}

/// Photographs are turned as their metadata state, and textures are not.
#[test]
fn photographs_are_upright() {
    let texel = |i: u32| if i % 64 < 32 && i < 16 * 64 { [250, 250, 250, 255] } else { [0, 0, 0, 255] };
    let texels = Texels::U8((0..64 * 32).map(texel).collect());
    let plain = encode_jpeg_bitmap(&Bitmap::new(64, 32, 3, texels).unwrap(), 90).unwrap();
    // A TIFF of one entry: orientation 6, which is shown turned clockwise.
    let exif = b"\xff\xe1\0\x22Exif\0\0MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.jpg");
    let read = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        let limits = Limits::default();
        [read_photograph_within(&path, &limits), read_bitmap_within(&path, &limits)].map(Result::unwrap)
    };
    let [photograph, texture] = read(&plain);
    assert_eq!(photograph, texture);
    let [photograph, texture] = read(&[&plain[..2], exif, &plain[2..]].concat());
    assert_eq!(
        [texture.width(), texture.height(), photograph.width(), photograph.height()],
        [64, 32, 32, 64]
    );
    let is_bright = |x: u32, y: u32| photograph.stored((y * 32 + x) as usize)[0] > 0.5;
    // The left becomes the top, and the top the right.
    assert!(is_bright(28, 8) && !is_bright(4, 8) && !is_bright(28, 56) && !is_bright(4, 56));
}

/// A linear congruential generator (Knuth): the same numbers on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % bound.max(1)
    }
}

/// Checks that this process's peak memory stayed under 3 GiB, if the system reports it.
fn memory_stayed_small() {
    let Ok(status) = std::fs::read_to_string("/proc/self/status") else { return };
    let peak =
        status.lines().find_map(|l| l.strip_prefix("VmHWM:")).and_then(|l| l.split_whitespace().next());
    let kib: u64 = peak.and_then(|p| p.parse().ok()).unwrap_or(0);
    assert!(kib < 3 << 20, "{kib} KiB");
}
