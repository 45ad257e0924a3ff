//! Pictures by others next to ours, on a page.
use std::fmt::Write;
use std::path::{Path, PathBuf};
use taotie_engine::image::{Encoding, Image, Texels};
use taotie_io::{PngColor, PngImage, PngSamples, read_bitmap, write_png, write_text};

/// 8-bit sRGB with straight alpha.
pub struct Picture {
    pub width: u32,
    pub height: u32,
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    pub fn new(width: u32, height: u32, pixels: Vec<[u8; 4]>) -> Self {
        assert_eq!(pixels.len(), (width * height) as usize);
        Self { width, height, pixels }
    }

    /// Reads a file with 8 bits per channel.
    pub fn read(path: &Path) -> Self {
        let bitmap = read_bitmap(path).unwrap();
        let Texels::U8(pixels) = bitmap.texels() else { panic!("{}: not 8 bits", path.display()) };
        Self::new(bitmap.width(), bitmap.height(), pixels.clone())
    }

    /// Returns it smaller, by the mean of the codes over each pixel's area, as browsers and web tools scale.
    pub fn reduced(&self, [width, height]: [u32; 2]) -> Self {
        let columns = spans(width, self.width);
        let rows = spans(height, self.height);
        let pixels = rows
            .iter()
            .flat_map(|rows| columns.iter().map(|columns| self.mean(columns, rows)).collect::<Vec<_>>());
        let pixels = pixels.collect();
        Self::new(width, height, pixels)
    }

    fn mean(&self, columns: &[(u32, f64)], rows: &[(u32, f64)]) -> [u8; 4] {
        let mut sum = [0.0; 4];
        for ((x, across), (y, down)) in
            rows.iter().flat_map(|row| columns.iter().map(move |column| (column, row)))
        {
            let [r, g, b, a] = self.pixels[(y * self.width + x) as usize].map(f64::from);
            let weight = across * down;
            for (sum, value) in sum.iter_mut().zip([r * a, g * a, b * a, a]) {
                *sum += value * weight;
            }
        }
        let [r, g, b, a] = sum;
        let straight = |v: f64| if a > 0.0 { (v / a).round() as u8 } else { 0 };
        [straight(r), straight(g), straight(b), a.round() as u8]
    }

    fn write(&self, path: &Path) {
        let image = PngImage {
            width: self.width,
            height: self.height,
            color: PngColor::Rgba,
            samples: PngSamples::U8(self.pixels.as_flattened()),
            encoding: Encoding::Srgb,
        };
        write_png(path, &image).unwrap();
    }
}

/// Returns, for each of `to` pixels of a row, the pixels of `from` that it covers, with weights that sum to one.
fn spans(to: u32, from: u32) -> Vec<Vec<(u32, f64)>> {
    let size = f64::from(from) / f64::from(to);
    let span = |i: u32| {
        let (start, end) = (f64::from(i) * size, f64::from(i + 1) * size);
        let share = |x: u32| (end.min(f64::from(x) + 1.0) - start.max(f64::from(x))) / size;
        (start.floor() as u32..(end.ceil() as u32).min(from)).map(|x| (x, share(x))).collect()
    };
    (0..to).map(span).collect()
}

/// Ours and theirs, with a note.
pub struct Row {
    pub note: String,
    pub pictures: [Picture; 2],
}

/// Returns the mean absolute difference of the channels of two pixels over a grey, in codes.
pub fn difference(a: &[u8; 4], b: &[u8; 4], grey: f64) -> f64 {
    let over = |p: &[u8; 4], c: usize| {
        let alpha = f64::from(p[3]) / 255.0;
        f64::from(p[c]) * alpha + grey * (1.0 - alpha)
    };
    (0..3).map(|c| (over(a, c) - over(b, c)).abs()).sum::<f64>() / 3.0
}

/// Reads a linear float picture.
pub fn linear(path: &Path) -> Image {
    let bitmap = read_bitmap(path).unwrap();
    let mut image = Image::new(bitmap.width(), bitmap.height(), [0.0; 4]).unwrap();
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        *pixel = bitmap.stored(i);
    }
    image
}

/// Writes `target/NAME/index.html` with a row of pictures for each of `rows`.
pub fn write_page(name: &str, title: &str, rows: &[Row]) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let mut page = format!("<!doctype html><meta charset=utf-8><title>{title}</title>");
    page += "<style>body{background:#808080;font-family:sans-serif}img{width:32%}</style>";
    let _ = write!(page, "<h1>{title}</h1>");
    for (i, Row { note, pictures: [ours, theirs] }) in rows.iter().enumerate() {
        let _ = write!(page, "<h2>{note}</h2>");
        let apart = |(a, b): (&[u8; 4], &[u8; 4])| {
            let code = (difference(a, b, 128.0) * 4.0).min(255.0) as u8;
            [code, code, code, 255]
        };
        let apart = ours.pixels.iter().zip(&theirs.pixels).map(apart).collect();
        let apart = Picture::new(ours.width, ours.height, apart);
        for (kind, picture) in [("ours", ours), ("theirs", theirs), ("difference", &apart)] {
            let file = format!("{i}-{kind}.png");
            picture.write(&folder.join(&file));
            let _ = write!(page, "<img src=\"{file}\" title=\"{kind}\"> ");
        }
    }
    let path = folder.join("index.html");
    write_text(&path, &page).unwrap();
    path
}
