//! Photographs with chrome and grey balls, drawn by formula: lights found, and normals under near lamps.

use crate::studio::directions;
use std::path::Path;
use taotie_engine::compare::angle_deg;
use taotie_engine::image::{Encoding, Image};
use taotie_engine::math::Vec3;
use taotie_engine::{Progress, Warnings};
use taotie_io::{PngColor, PngImage, PngSamples, write_png, write_text};
use taotie_photometric::{Circle, Estimate, Estimator, PhotographSet, Reading, Samples, Setup, Transfer};

const WIDTH: usize = 240;
const HEIGHT: usize = 200;
/// A matt dome on the board: its centre and the radius of its sphere, of which the upper third shows.
const DOME: Circle = Circle { center: [120.0, 100.0], radius: 60.0 };
const GREY_BALL: Circle = Circle { center: [206.0, 100.0], radius: 20.0 };

fn chrome() -> [Circle; 3] {
    [([30.3, 31.8], 21.4), ([207.6, 32.2], 19.7), ([120.4, 176.1], 18.2)]
        .map(|(center, radius)| Circle { center, radius })
}

/// A lamp: a direction, or a place in pixels from the picture's centre, and its brightness.
#[derive(Clone, Copy)]
struct Lamp {
    at: Vec3<f64>,
    is_near: bool,
    brightness: f64,
}

impl Lamp {
    /// Returns the direction and the brightness at a point.
    fn seen_from(&self, p: Vec3<f64>) -> (Vec3<f64>, f64) {
        if !self.is_near {
            return (self.at, self.brightness);
        }
        let to = self.at - p;
        let distance = to.length();
        (to / distance, self.brightness * 640_000.0 / (distance * distance))
    }
}

/// Returns the normal of a ball at a point of the picture, if the point is on it.
fn on_ball(ball: &Circle, x: f64, y: f64) -> Option<Vec3<f64>> {
    let [u, v] = [(x - ball.center[0]) / ball.radius, (ball.center[1] - y) / ball.radius];
    let square = u * u + v * v;
    (square < 1.0).then(|| Vec3::new(u, v, (1.0 - square).sqrt()))
}

/// The normal of the board or the dome on it, which is cut where its slope is 1.
fn surface(x: f64, y: f64) -> Vec3<f64> {
    on_ball(&DOME, x, y).filter(|n| n.z > 0.6).unwrap_or(Vec3::new(0.0, 0.0, 1.0))
}

/// The light that a point of the picture sends to the camera.
fn radiance(x: f64, y: f64, (lamp, chrome, grey): (&Lamp, &[Circle], bool)) -> f64 {
    let place = Vec3::new(x - 0.5 * WIDTH as f64, 0.5 * HEIGHT as f64 - y, 0.0);
    for ball in chrome {
        if let Some(n) = on_ball(ball, x, y) {
            let point = place + Vec3::new(0.0, 0.0, ball.radius * (1.0 + n.z));
            let mirrored = n * (2.0 * n.z) - Vec3::new(0.0, 0.0, 1.0);
            let (l, brightness) = lamp.seen_from(point);
            // A lamp of 8° across, and a dim room.
            return if mirrored.dot(l) > 0.9975 { 0.9 * brightness } else { 0.02 + 0.02 * mirrored.y.abs() };
        }
    }
    let matt = |n: Vec3<f64>, height: f64| {
        let (l, brightness) = lamp.seen_from(place + Vec3::new(0.0, 0.0, height));
        0.55 * brightness * n.dot(l).max(0.0)
    };
    match on_ball(&GREY_BALL, x, y).filter(|_| grey) {
        Some(n) => matt(n, GREY_BALL.radius * (1.0 + n.z)),
        None => matt(surface(x, y), 0.0),
    }
}

fn draw(folder: &Path, lamps: &[Lamp], chrome: &[Circle], grey: bool) {
    for (k, lamp) in lamps.iter().enumerate() {
        let mut noise = k as u64 + 1;
        let code = |i: usize| {
            let at = |j: usize| {
                let [u, v] = [j % 4, j / 4].map(|v| (v as f64 + 0.5) / 4.0);
                radiance((i % WIDTH) as f64 + u, (i / WIDTH) as f64 + v, (lamp, chrome, grey))
            };
            let mean = (0..16).map(at).sum::<f64>() / 16.0;
            noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let grain = ((noise >> 40) as f64 / (1_u64 << 24) as f64 - 0.5) * 0.003;
            ((mean + grain).clamp(0.0, 1.0) * 65_535.0) as u16
        };
        let codes: Vec<u16> = (0..WIDTH * HEIGHT).map(code).collect();
        write_grey(folder, k, &codes);
    }
}

/// Writes photograph `k` of a folder.
fn write_grey(folder: &Path, k: usize, codes: &[u16]) {
    let (width, height, color) = (WIDTH as u32, HEIGHT as u32, PngColor::Grey);
    let image =
        PngImage { width, height, color, samples: PngSamples::U16(codes), encoding: Encoding::Linear };
    write_png(&folder.join(format!("{k:02}.png")), &image).unwrap();
}

fn lamps(is_near: bool, count: usize) -> Vec<Lamp> {
    let lamp = |(k, at): (usize, Vec3<f64>)| Lamp {
        at: if is_near { at * (800.0 + 2.0 * (k % 5) as f64) } else { at },
        is_near,
        brightness: 1.0,
    };
    directions(count, 60.0).into_iter().enumerate().map(lamp).collect()
}

fn open(path: &Path, setup: &Setup) -> PhotographSet {
    PhotographSet::open_with(path, setup, &mut Warnings::default(), Progress::SILENT).unwrap()
}

/// Returns the mean error of the normals on the dome, degrees.
fn error(set: &PhotographSet, flat: Option<&Path>) -> f64 {
    let reading = Reading { mask: None, transfer: Transfer::Auto, flat, limits: Default::default() };
    let samples = Samples::read(set, &reading, Progress::SILENT).unwrap();
    let estimate = Estimate::of(&samples, Progress::SILENT).unwrap();
    let normals: Image = estimate.normals(Estimator::Robust);
    let (mut sum, mut count) = (0.0, 0.0);
    for (i, [x, y, z, has]) in normals.pixels().iter().enumerate() {
        let [px, py] = [i % WIDTH, i / WIDTH].map(|v| v as f64 + 0.5);
        let [dx, dy] = [px - DOME.center[0], py - DOME.center[1]];
        // Away from the rim of the dome.
        if *has > 0.0 && (dx * dx + dy * dy).sqrt() < 40.0 {
            sum += angle_deg(Vec3::new(*x, *y, *z).to_f64(), surface(px, py));
            count += 1.0;
        }
    }
    assert!(count > 4000.0, "{count}");
    sum / count
}

#[test]
fn chrome_balls_are_found_and_give_the_lights() {
    let folder = tempfile::tempdir().unwrap();
    let lamps = lamps(false, 16);
    draw(folder.path(), &lamps, &chrome()[..2], false);
    let set = open(folder.path(), &Setup::default());
    let found = set.chrome.clone().unwrap();
    assert_eq!(found.outlines.len(), 2, "{found:?}");
    for ball in &chrome()[..2] {
        let near = |c: &Circle| (0..2).all(|axis| (c.center[axis] - ball.center[axis]).abs() < 0.2);
        let same = found.outlines.iter().find(|outline| near(&outline.circle)).expect("the ball");
        assert!((same.circle.radius - ball.radius).abs() < 0.2, "{same:?}");
    }
    for (photograph, lamp) in set.photographs.iter().zip(&lamps) {
        assert_eq!(photograph.light.position, None);
        let angle = angle_deg(photograph.light.direction, lamp.at);
        assert!(angle < 0.8, "{angle}");
    }
    assert!(found.residual_deg.is_some_and(|residual| residual < 0.8), "{found:?}");
    assert!(error(&set, None) < 0.5);
    let one = Setup { balls: vec![chrome()[0]], ..Setup::default() };
    let one = open(folder.path(), &one);
    assert!(one.chrome.is_some_and(|balls| balls.residual_deg.is_none() && balls.outlines.len() == 1));
}

#[test]
fn several_balls_place_near_lamps() {
    let folder = tempfile::tempdir().unwrap();
    let lamps = lamps(true, 16);
    draw(folder.path(), &lamps, &chrome(), false);
    let set = open(folder.path(), &Setup::default());
    assert_eq!(set.chrome.as_ref().map(|balls| balls.outlines.len()), Some(3));
    for (photograph, lamp) in set.photographs.iter().zip(&lamps) {
        let position = photograph.light.position.expect("a near lamp");
        let off = (position - lamp.at).length() / lamp.at.length();
        assert!(off < 0.15, "{off} {position:?} {:?}", lamp.at);
    }
    let near = error(&set, None);
    let mut distant = set.clone();
    for photograph in &mut distant.photographs {
        photograph.light.position = None;
        photograph.light.intensity = [1.0; 3];
    }
    let distant = error(&distant, None);
    assert!(near < 1.0 && near < 0.5 * distant, "{near} {distant}");
}

#[test]
fn positions_in_an_lp_file_are_near_lamps_if_the_pixel_size_is_known() {
    let folder = tempfile::tempdir().unwrap();
    let lamps = lamps(true, 16);
    draw(folder.path(), &lamps, &[], false);
    let line = |(k, lamp): (usize, &Lamp)| {
        let [x, y, z] = (lamp.at * 0.25).to_array();
        format!("{k:02}.png {x} {y} {z}\n")
    };
    let lp: String = lamps.iter().enumerate().map(line).collect();
    write_text(&folder.path().join("dome.lp"), &format!("16\n{lp}")).unwrap();
    let setup = Setup { pixel_size: Some(0.25), ..Setup::default() };
    let known = open(folder.path(), &setup);
    let (near, distant) = (error(&known, None), error(&open(folder.path(), &Setup::default()), None));
    assert!(near < 0.4 && near < 0.3 * distant, "{near} {distant}");
    // A grey ball shows the same brightness, though it is closer to the lamps than the plane.
    draw(folder.path(), &lamps, &[], true);
    let measured = open(folder.path(), &Setup { grey_ball: Some(GREY_BALL), ..setup });
    for (one, other) in measured.lights().iter().zip(known.lights()) {
        let ratio = one.intensity[0] / other.intensity[0];
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }
}

#[test]
fn vectors_that_end_within_the_picture_are_directions() {
    let folder = tempfile::tempdir().unwrap();
    (0..16).for_each(|k| write_grey(folder.path(), k, &[0; WIDTH * HEIGHT]));
    // Of one decimal, so that lengths differ by more than 5 %.
    let rounded = |v: f64, scale: f64| (v * 10.0).round() / 10.0 * scale;
    let opened = |scale: f64| {
        let line = |(k, lamp): (usize, &Lamp)| {
            let [x, y, z] = lamp.at.to_array().map(|v| rounded(v, scale));
            format!("{k:02}.png {x} {y} {z}\n")
        };
        let lp: String = lamps(false, 16).iter().enumerate().map(line).collect();
        write_text(&folder.path().join("dome.lp"), &format!("16\n{lp}")).unwrap();
        let mut warnings = Warnings::default();
        let setup = Setup { pixel_size: Some(0.05), ..Setup::default() };
        let set = PhotographSet::open_with(folder.path(), &setup, &mut warnings, Progress::SILENT).unwrap();
        let notes: Vec<String> = warnings.iter().map(|(what, _)| what.to_owned()).collect();
        (set, notes)
    };
    let (short, notes) = opened(1.0);
    assert!(short.lights().iter().all(|light| light.position.is_none() && light.intensity == [1.0; 3]));
    let start = "the vectors of the lights end closer to the centre than the picture's corners (7.810 away";
    assert!(notes.len() == 1 && notes[0].starts_with(start), "{notes:?}");
    let (long, notes) = opened(10.0);
    assert!(long.lights().iter().all(|light| light.position.is_some()) && notes.is_empty(), "{notes:?}");
}

#[test]
fn a_grey_ball_or_a_board_shows_how_bright_each_light_is() {
    let folder = tempfile::tempdir().unwrap();
    let mut lamps = lamps(false, 16);
    for (k, lamp) in lamps.iter_mut().enumerate() {
        lamp.brightness = 0.6 + 0.05 * ((k * 7) % 16) as f64;
    }
    draw(folder.path(), &lamps, &[], true);
    let line = |(k, lamp): (usize, &Lamp)| format!("{k:02}.png {} {} {}\n", lamp.at.x, lamp.at.y, lamp.at.z);
    let lp: String = lamps.iter().enumerate().map(line).collect();
    write_text(&folder.path().join("dome.lp"), &format!("16\n{lp}")).unwrap();
    let uneven = error(&open(folder.path(), &Setup::default()), None);
    let set = open(folder.path(), &Setup { grey_ball: Some(GREY_BALL), ..Setup::default() });
    let even = error(&set, None);
    assert!(even < 0.5 && even < 0.3 * uneven, "{even} {uneven}");
    let mean = lamps.iter().map(|lamp| lamp.brightness).sum::<f64>() / 16.0;
    for (photograph, lamp) in set.photographs.iter().zip(&lamps) {
        let ratio = photograph.light.intensity[0] * mean / lamp.brightness;
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }
    // A board without the object, under the same lights.
    let flat = tempfile::tempdir().unwrap();
    for (k, lamp) in lamps.iter().enumerate() {
        let code = (0.8 * lamp.brightness * lamp.at.z.max(0.0) * 65_535.0).min(65_535.0) as u16;
        let codes = vec![code; WIDTH * HEIGHT];
        write_grey(flat.path(), k, &codes);
    }
    let with_board = error(&open(folder.path(), &Setup::default()), Some(flat.path()));
    assert!(with_board < 0.5, "{with_board}");
    // Known intensities count once.
    let both = error(&set, Some(flat.path()));
    assert!(both < 0.5, "{both}");
    // Neither the board nor the side of the dome is shaded like a ball.
    for center in [[30.0, 30.0], [145.0, 100.0]] {
        let circle = Circle { center, radius: 20.0 };
        let setup = Setup { grey_ball: Some(circle), ..Setup::default() };
        let found =
            PhotographSet::open_with(folder.path(), &setup, &mut Warnings::default(), Progress::SILENT);
        let error = found.map(|_| ()).unwrap_err().to_string();
        assert!(error.starts_with("grey ball ") && error.contains("of a matt ball"), "{error}");
    }
    // A board that is too bright.
    write_grey(flat.path(), 3, &vec![u16::MAX; WIDTH * HEIGHT]);
    let reading =
        Reading { mask: None, transfer: Transfer::Auto, flat: Some(flat.path()), limits: Default::default() };
    let error = Samples::read(&set, &reading, Progress::SILENT).map(|_| ()).unwrap_err().to_string();
    assert!(
        error.contains("03.png: ") && error.contains("pixels of the white board are saturated"),
        "{error}"
    );
}

#[test]
fn a_folder_without_lights_or_balls_has_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    draw(folder.path(), &lamps(false, 6), &[], false);
    let why = |setup: &Setup| {
        PhotographSet::open_with(folder.path(), setup, &mut Warnings::default(), Progress::SILENT)
            .map(|_| ())
            .unwrap_err()
            .to_string()
    };
    assert!(why(&Setup::default()).contains("no chrome ball was found"), "{}", why(&Setup::default()));
    let outside = Circle { center: [5.0, 5.0], radius: 30.0 };
    let outside = why(&Setup { balls: vec![outside], ..Setup::default() });
    assert!(outside.contains("must be within the photographs of 240x200"), "{outside}");
    let dome = why(&Setup { balls: vec![DOME], ..Setup::default() });
    assert!(dome.contains("00.png: no highlight"), "{dome}");
}

#[test]
fn photographs_that_are_not_linear_are_noticed() {
    let folder = tempfile::tempdir().unwrap();
    let lamps = lamps(false, 24);
    draw(folder.path(), &lamps, &[], false);
    let line = |(k, lamp): (usize, &Lamp)| format!("{k:02}.png {} {} {}\n", lamp.at.x, lamp.at.y, lamp.at.z);
    let lp: String = lamps.iter().enumerate().map(line).collect();
    write_text(&folder.path().join("dome.lp"), &format!("24\n{lp}")).unwrap();
    let set = open(folder.path(), &Setup::default());
    let exponent = |transfer| {
        let reading = Reading { mask: None, transfer, flat: None, limits: Default::default() };
        let samples = Samples::read(&set, &reading, Progress::SILENT).unwrap();
        Estimate::of(&samples, Progress::SILENT).unwrap().exponent.unwrap()
    };
    let (linear, curved) = (exponent(Transfer::Linear), exponent(Transfer::Srgb));
    assert!((linear - 1.0).abs() < 0.02, "{linear}");
    assert!((curved - 1.0).abs() > 0.1, "{curved}");
}
