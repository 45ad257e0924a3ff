//! Shaders at random points against the pixel program.
#![allow(clippy::print_stderr, reason = "tests say what they found and why they are skipped")]

use super::*;
use taotie::shade::Shading;
use taotie_shader::NormalMethod;

/// The largest relative difference of radiance that any surface may have.
const LARGEST: f64 = 1e-3;

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
        for (name, tally) in [("f32", single), ("WGSL", wgsl), ("GLSL ES", glsl)] {
            assert!(tally.count > run.points, "{case:?}: {} channels are bright enough", tally.count);
            if tally.largest > LARGEST {
                faults.push(format!("{case:?}, {name}: {tally:?}"));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// 2,560 points of a few surfaces.
#[test]
fn shaders_have_the_radiance_of_the_pixel_program() {
    let wanted = |case: &Case| match (case.shading, case.method) {
        (Shading::Ggx, NormalMethod::TangentMap) => case.layers.name == "all",
        (Shading::CookTorrance, NormalMethod::Bump) => true,
        (Shading::BlinnPhong, NormalMethod::ObjectMap) => true,
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
