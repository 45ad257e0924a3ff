//! Environments by others: what is made of them against integrals over all of their texels.
#![allow(clippy::print_stderr)]

mod common;
#[path = "common/random.rs"]
mod random;
#[path = "common/skies.rs"]
mod skies;

use random::Random;
use skies::Texels;
use std::path::Path;
use std::time::Instant;
use taotie::image::Image;
use taotie::shade::environment::Environment;

/// Roughnesses of levels and between them.
const ROUGHNESSES: [f64; 9] = [0.2, 0.204, 0.21, 0.25, 0.303, 0.4, 0.56, 0.78, 1.0];

fn read(path: &Path) -> Image {
    let bitmap = taotie::io::read_bitmap(path).expect("it can be read");
    let mut image = Image::new(bitmap.width(), bitmap.height(), [0.0; 4]).expect("a size");
    image.pixels_mut().iter_mut().enumerate().for_each(|(i, pixel)| *pixel = bitmap.stored(i));
    image
}

/// `TAOTIE_DIRECTIONS` sets how many directions are looked at.
#[test]
fn levels_are_integrals_over_all_texels() {
    let Some(folder) = common::data_folder("environments") else { return };
    let count = std::env::var("TAOTIE_DIRECTIONS").map_or(24, |n| n.parse().expect("a number"));
    for path in common::files_below(&folder, &["hdr", "exr"]) {
        let image = read(&path);
        let start = Instant::now();
        let environment = Environment::new(image.clone()).expect("it is an environment");
        eprintln!("{}: {} ms", path.display(), start.elapsed().as_millis());
        let texels = Texels::new(&image);
        for directions in skies::directions(&environment, count, &mut Random(12)) {
            let errors = skies::specular_errors(&environment, &texels, &directions, &ROUGHNESSES);
            for (roughness, error) in ROUGHNESSES.iter().zip(&errors) {
                eprintln!("  roughness {roughness}: {:.2} %", error * 100.0);
                assert!(*error < 0.01, "{}: roughness {roughness}: {error}", path.display());
            }
        }
    }
}
