//! Lossy texture packing: savings, cost, and what it leaves untouched.

use crate::bumpy;
use image::ImageReader;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::scene::AlphaMode;
use taotie_io::{GltfAsset, GltfFormat, GltfMaterial, ImageCodec, encode_gltf, load_model};
use tempfile::TempDir;

/// The textures of a model in files.
struct Files {
    folder: TempDir,
}

impl Files {
    fn new(material: GltfMaterial<'_>, format: &GltfFormat) -> Self {
        let (mesh, folder) = (bumpy::sphere(8, 4), tempfile::tempdir().unwrap());
        let levels = [&mesh];
        let asset = GltfAsset { levels: &levels, material, ..GltfAsset::default() };
        for file in encode_gltf(&folder.path().join("m.gltf"), &asset, format).unwrap() {
            std::fs::write(file.path, file.bytes).unwrap();
        }
        Self { folder }
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.folder.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn size(&self, name: &str) -> usize {
        self.bytes(name).len()
    }

    /// The base colour as read by our reader.
    fn color(&self) -> Bitmap {
        let loaded = load_model(self.folder.path().join("m.gltf")).unwrap();
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        let used = loaded.scene.materials()[0].base_color_texture.expect("it exists").texture;
        loaded.scene.textures()[used].bitmap().clone()
    }
}

fn colored(color: &Bitmap) -> GltfMaterial<'_> {
    GltfMaterial { base_color_map: Some(color.into()), ..GltfMaterial::default() }
}

fn codes(bitmap: &Bitmap) -> &[[u8; 4]] {
    let Texels::U8(texels) = bitmap.texels() else { panic!("8 bits") };
    texels
}

/// The mean square difference of red, green and blue, of 255².
fn mean_square(a: &Bitmap, b: &Bitmap) -> f64 {
    let squares = codes(a).iter().zip(codes(b)).flat_map(|(a, b)| {
        [0, 1, 2].map(|c| f64::from(a[c].abs_diff(b[c])) * f64::from(a[c].abs_diff(b[c])))
    });
    squares.sum::<f64>() / (3 * codes(a).len()) as f64
}

/// Pseudo-random numbers below `count`.
fn noise(x: u32, y: u32, channel: u32, count: u32) -> u8 {
    let hash =
        (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(2_246_822_519)).wrapping_add(channel * 374_761_393);
    let hash = (hash ^ hash >> 15).wrapping_mul(2_246_822_519);
    ((hash ^ hash >> 13) % count) as u8
}

/// A ramp with noise of `values` values.
fn ramp(values: u32) -> Bitmap {
    bumpy::bitmap(256, |x, y| {
        let [r, g, b] = [0, 1, 2].map(|channel| noise(x, y, channel, values));
        [(x / 2) as u8 + r, 60 + g, 90 + b]
    })
}

fn webp(quality: u8) -> GltfFormat {
    GltfFormat { images: ImageCodec::LossyWebP(quality).into(), ..GltfFormat::default() }
}

fn ktx2(lambda: u8) -> GltfFormat {
    GltfFormat { images: ImageCodec::Ktx2(lambda).into(), ..GltfFormat::default() }
}

/// A lower quality gives a smaller lossy WebP with a larger error, and another decoder gives the same result as our
/// reader.
#[test]
fn webp_of_a_quality() {
    let color = ramp(9);
    let lossless = GltfFormat { images: ImageCodec::WebP.into(), ..GltfFormat::default() };
    let whole = Files::new(colored(&color), &lossless);
    assert_eq!(whole.color(), color);
    let written = [30, 90].map(|quality| {
        let files = Files::new(colored(&color), &webp(quality));
        let bytes = files.bytes("m_color.webp");
        let reader = ImageReader::with_format(std::io::Cursor::new(&bytes), image::ImageFormat::WebP);
        let other = reader.decode().unwrap().into_rgb8();
        let ours: Vec<u8> = codes(&files.color()).iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        assert!(other.into_raw() == ours, "quality {quality}");
        (bytes.len(), mean_square(&files.color(), &color))
    });
    let [coarse, fine] = written;
    println!("lossless {}, quality 90 {fine:?}, quality 30 {coarse:?}", whole.size("m_color.webp"));
    assert!(coarse.0 < fine.0 && coarse.1 > fine.1);
    // Nearly all bits of the picture are noise, which lossy compression does not keep.
    assert!(2 * fine.0 < whole.size("m_color.webp"));
    // All of the noise would be 20/3; the loss beyond it is one or two codes.
    assert!(fine.1 < 12.0, "{}", fine.1);
}

/// Quality settings apply only to colours.
#[test]
fn numbers_are_lossless() {
    let color = bumpy::colors(16);
    let numbers = bumpy::bitmap(256, |x, y| {
        [200 + noise(x, y, 0, 9), (x / 2) as u8 + noise(x, y, 1, 9), 20 + noise(x, y, 2, 9)]
    });
    let normal = bumpy::normals(256, 8);
    let material = GltfMaterial {
        metallic_roughness_map: Some((&numbers).into()),
        normal_map: Some((&normal).into()),
        ..colored(&color)
    };
    let read = |files: &Files, name: &str| {
        let bytes = files.bytes(name);
        let reader = ImageReader::with_format(std::io::Cursor::new(&bytes), image::ImageFormat::WebP);
        let raw = reader.decode().unwrap().into_rgb8().into_raw();
        (bytes.len(), raw)
    };
    let raw =
        |bitmap: &Bitmap| codes(bitmap).iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect::<Vec<u8>>();
    let lossless = GltfFormat { images: ImageCodec::WebP.into(), ..GltfFormat::default() };
    let (exact, lossy) = (Files::new(material, &lossless), Files::new(material, &webp(50)));
    let [exact_numbers, same_numbers] =
        [&exact, &lossy].map(|files| read(files, "m_metallic_roughness.webp"));
    assert!(exact_numbers.1 == raw(&numbers));
    assert!(same_numbers == exact_numbers, "numbers are unchanged");
    let [exact_normals, same_normals] = [&exact, &lossy].map(|files| read(files, "m_normal.webp"));
    assert!(same_normals.1 == raw(&normal) && same_normals.0 == exact_normals.0, "normals are unchanged");
}

#[test]
fn alpha_of_lossy_webp_is_exact() {
    let opaque = ramp(3);
    let texels = codes(&opaque).iter().enumerate().map(|(i, [r, g, b, _])| [*r, *g, *b, (i % 251) as u8]);
    let color = Bitmap::new(256, 256, 4, Texels::U8(texels.collect())).unwrap();
    let files = Files::new(GltfMaterial { alpha: AlphaMode::Blend, ..colored(&color) }, &webp(60));
    let back = files.color();
    assert!(codes(&back).iter().zip(codes(&color)).all(|(a, b)| a[3] == b[3]));
    assert!(mean_square(&back, &color) > 0.0);
}

/// The levels of a KTX2 file: packed bytes and unpacked size.
fn levels(bytes: &[u8]) -> Vec<(&[u8], usize)> {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(word(44), 2, "Zstandard");
    (0..word(40))
        .map(|level| {
            let [offset, length, unpacked] = [0, 8, 16].map(|at| word(80 + 24 * level + at));
            (&bytes[offset..offset + length], unpacked)
        })
        .collect()
}

/// Each level is a separate frame for Zstandard's reference decoder.
#[test]
fn levels_are_under_zstandard() {
    let bytes = Files::new(colored(&ramp(3)), &ktx2(0)).bytes("m_color.ktx2");
    let levels = levels(&bytes);
    assert_eq!(levels.len(), 9);
    for (level, (packed, unpacked)) in levels.iter().enumerate() {
        let blocks = (256usize >> level).div_ceil(4);
        assert_eq!(*unpacked, 16 * blocks * blocks);
        assert_eq!(zstd::bulk::decompress(packed, *unpacked).unwrap().len(), *unpacked);
    }
    let last = levels[0].0.as_ptr() as usize + levels[0].0.len();
    assert_eq!(last, bytes.as_ptr() as usize + bytes.len(), "the largest level is at the end");
    let sums = levels.iter().fold([0, 0], |[a, b], (packed, unpacked)| [a + packed.len(), b + unpacked]);
    assert!(sums[0] < sums[1], "{sums:?}");
}

/// The mean square error rises at most by the square of the RDO value, and the size falls.
#[test]
fn rdo_saves_within_its_bound() {
    let color = ramp(3);
    let written = |rdo: u8| {
        let files = Files::new(colored(&color), &ktx2(rdo));
        (files.size("m_color.ktx2"), mean_square(&files.color(), &color))
    };
    let (plain, two, eight) = (written(0), written(2), written(8));
    println!("none {plain:?}, 2 {two:?}, 8 {eight:?}");
    // A column of blocks differs only by its noise, a mean square of 4/3 compared with the allowed 4: most blocks
    // repeat.
    assert!(10 * two.0 < 6 * plain.0);
    assert!(eight.0 < two.0);
    assert!(plain.1 < two.1 && two.1 <= plain.1 + 4.0 && eight.1 <= plain.1 + 64.0);
}

#[test]
fn rdo_leaves_normals_alone() {
    let normal = bumpy::normals(128, 8);
    let color = bumpy::colors(16);
    let material = GltfMaterial { normal_map: Some((&normal).into()), ..colored(&color) };
    let [plain, much] = [0, 64].map(|rdo| Files::new(material, &ktx2(rdo)).bytes("m_normal.ktx2"));
    assert!(plain == much);
}

#[test]
fn numbers_that_are_not_read_are_refused() {
    let color = bumpy::colors(16);
    let mesh = bumpy::sphere(8, 4);
    let levels = [&mesh];
    let asset = GltfAsset { levels: &levels, material: colored(&color), ..GltfAsset::default() };
    for (format, said) in [
        (webp(0), "image format webp:0: use 1 to 100"),
        (webp(101), "image format webp:101: use 1 to 100"),
        (ktx2(65), "image format ktx2:65: use 0 to 64"),
    ] {
        let error = encode_gltf("m.glb".as_ref(), &asset, &format).unwrap_err().to_string();
        assert_eq!(error, said);
    }
}
