//! The time for a usual dome.

use std::time::Instant;
use taotie_engine::image::Encoding;
use taotie_engine::math::scalar;
use taotie_engine::{Progress, Warnings};
use taotie_io::{Limits, PngColor, PngImage, PngSamples, write_png, write_text};
use taotie_photometric::{Estimate, PhotographSet, Reading, Samples, Transfer};

use crate::studio::directions;

const SIDE: usize = 512;
const LIGHTS: usize = 96;

#[test]
#[ignore = "takes half a minute without optimisation; prints the time"]
fn a_dome_of_96_photographs_is_fast() {
    let folder = tempfile::tempdir().unwrap();
    let mut lp = format!("{LIGHTS}\n");
    for (k, light) in directions(LIGHTS, 65.0).iter().enumerate() {
        // Waves with attached shadows and a highlight: as much work as a photograph.
        let codes: Vec<u16> = (0..SIDE * SIDE)
            .map(|i| {
                let [x, y] = [i % SIDE, i / SIDE].map(|v| v as f64 / SIDE as f64);
                let [p, q] = [0.8 * scalar::sin(40.0 * x), 0.8 * scalar::sin(30.0 * y)];
                let shaded = (light.z - p * light.x - q * light.y) / (1.0 + p * p + q * q).sqrt();
                let grain = ((i * 7919 + k * 104_729) % 1000) as f64 * 1e-5;
                ((0.6 * shaded.max(0.0) + scalar::pow(shaded.max(0.0), 40.0) * 0.3 + grain) * 65_535.0) as u16
            })
            .collect();
        let name = format!("{k}.png");
        let (width, height) = (SIDE as u32, SIDE as u32);
        let samples = PngSamples::U16(&codes);
        let image = PngImage { width, height, color: PngColor::Grey, samples, encoding: Encoding::Linear };
        write_png(&folder.path().join(&name), &image).unwrap();
        lp += &format!("{name} {} {} {}\n", light.x, light.y, light.z);
    }
    write_text(&folder.path().join("dome.lp"), &lp).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let start = Instant::now();
    let set = PhotographSet::open(folder.path(), &mut Warnings::default()).unwrap();
    let reading = Reading { mask: None, transfer: Transfer::Auto, flat: None, limits: Limits::default() };
    let samples = pool.install(|| Samples::read(&set, &reading, Progress::SILENT)).unwrap();
    println!("read      {:.2} s", start.elapsed().as_secs_f64());
    let start = Instant::now();
    let stage = |name: &'static str, done: f64| {
        if done == 0.0 {
            println!("{name:<16} from {:.2} s", start.elapsed().as_secs_f64());
        }
        true
    };
    let estimate = pool.install(|| Estimate::of(&samples, Progress::new(&stage))).unwrap();
    let fitted = start.elapsed().as_secs_f64();
    let relief = estimate.relief(Progress::SILENT).unwrap();
    println!("depth     {:.2} s, {} pixels", start.elapsed().as_secs_f64() - fitted, relief.heights.len());
    println!("estimate  {:.2} s, mean sigma {:.2}°", fitted, estimate.mean(|p| p.sigma_deg));
}
