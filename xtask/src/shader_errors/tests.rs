//! Compares shaders with the pixel program at random points.
#![allow(clippy::print_stderr, reason = "tests report their findings and why they are skipped")]

use super::*;
use taotie_engine::shade::Shading;
use taotie_engine::surface::SurfaceMethod;

/// The largest allowed relative difference of radiance for shaders, or 1.5 times that of `f32` if this is larger.
const LARGEST: f64 = 1e-3;
const OF_SINGLE: f64 = 1.5;
/// The largest allowed difference for `f32`.
const LARGEST_OF_SINGLE: f64 = 5e-3;
/// The share of channels that may differ by more than 1e-3.
const BEYOND: f64 = 6e-4;

fn check(cases: &[Case], rows: usize) {
    let run = match run(&crate::root(), cases, rows) {
        Ok(run) => run,
        Err(why) => {
            assert!(!std::env::var("CI").is_ok_and(|ci| ci == "true"), "{why:#}");
            let missing = why.to_string().starts_with("no ");
            assert!(missing, "{why:#}");
            eprintln!("skipped: {why:#}");
            return;
        }
    };
    let mut faults = Vec::new();
    for measured in &run.measured {
        eprint!("{}", measured.row());
        let Measured { case, single, wgsl, glsl } = measured;
        let of_shaders = LARGEST.max(OF_SINGLE * single.largest);
        let sides =
            [("f32", single, LARGEST_OF_SINGLE), ("WGSL", wgsl, of_shaders), ("GLSL ES", glsl, of_shaders)];
        for (name, tally, largest) in sides {
            assert!(tally.count > run.points, "{case:?}: {} channels are bright enough", tally.count);
            if tally.largest > largest || tally.beyond as f64 > BEYOND * tally.count as f64 {
                faults.push(format!("{case:?}, {name}: {tally:?}"));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// Uses 2,560 points of a few surfaces.
#[test]
fn shaders_have_the_radiance_of_the_pixel_program() {
    let wanted = |case: &Case| match (case.shading, case.method) {
        (Shading::Ggx, SurfaceMethod::TangentNormal) => case.layers.name == "all",
        (Shading::CookTorrance, SurfaceMethod::Bump) => true,
        (Shading::BlinnPhong, SurfaceMethod::ObjectNormal) => true,
        _ => false,
    };
    let cases: Vec<Case> = cases::all().into_iter().filter(wanted).collect();
    assert_eq!(cases.len(), 3);
    check(&cases, 2);
}

#[test]
#[ignore = "takes minutes"]
fn all_shaders_have_the_radiance_of_the_pixel_program() {
    check(&cases::all(), ROWS);
}
