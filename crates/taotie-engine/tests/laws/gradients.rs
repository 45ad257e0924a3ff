//! Dual numbers differentiate the code that they pass through: gradients of every model, compared with differences.

use crate::exact::Exact;
use crate::random::Random;
use taotie_engine::math::{Dual, Lane, Vec3, scalar};
use taotie_engine::names::Named;
use taotie_engine::shade::{Angles, MaterialSample, Shading, reflect};

/// n, v, l, base colour, F0, metallic, roughness, shininess, slope, F90.
const INPUTS: usize = 20;
/// The inputs by which a gradient is requested, with their components.
const BY: [(&str, std::ops::Range<usize>); 7] = [
    ("normal", 0..3),
    ("light direction", 6..9),
    ("base colour", 9..12),
    ("F0", 12..15),
    ("roughness", 16..17),
    ("shininess", 17..18),
    ("slope", 18..19),
];

fn shade<L: Lane>(shading: Shading, x: &[L; INPUTS]) -> [L; 3] {
    let vector = |at: usize| Vec3::new(x[at], x[at + 1], x[at + 2]);
    let s = MaterialSample {
        base_color: vector(9),
        metallic: x[15],
        roughness: x[16],
        f0: vector(12),
        f90: x[19],
        f82_drop: Vec3::splat(x[0].lit(0.1)),
        diffuse: vector(9),
        specular: vector(12),
        shininess: x[17],
        slope: x[18],
        compensation: None,
    };
    reflect(shading, &s, &Angles::new(vector(0), vector(3), vector(6))).to_array()
}

/// Returns directions on one side of the surface and a material within its ranges.
fn inputs(random: &mut Random) -> [f64; INPUTS] {
    let n = random.unit();
    let mut above = || {
        let w = random.unit();
        if w.dot(n) < 0.0 { -w } else { w }
    };
    let (v, l) = (above(), above());
    let mut x = [0.0; INPUTS];
    for (at, w) in [(0, n), (3, v), (6, l)] {
        x[at..at + 3].copy_from_slice(&w.to_array());
    }
    x[9..INPUTS].fill_with(|| 0.2 + 0.6 * random.next());
    x[17] *= 50.0;
    x
}

/// Returns the derivative by input `by`, from five points `step` apart.
fn difference(shading: Shading, x: &[f64; INPUTS], by: usize, step: f64) -> [f64; 3] {
    let at = |steps: f64| {
        let mut moved = x.map(Exact);
        moved[by].0 += steps * step;
        shade(shading, &moved).map(|channel| channel.0)
    };
    let [far_below, below, above, far_above] = [-2.0, -1.0, 1.0, 2.0].map(at);
    std::array::from_fn(|i| (far_below[i] - far_above[i] + 8.0 * (above[i] - below[i])) / (12.0 * step))
}

/// The counts of derivatives: all, those at smooth points, and the nonzero ones among them.
#[derive(Default)]
struct Tally {
    points: usize,
    smooth: usize,
    nonzero: usize,
}

fn compare(shading: Shading, x: &[f64; INPUTS], by: usize, tally: &mut Tally) {
    let duals: [_; INPUTS] = std::array::from_fn(|i| Dual::<_, INPUTS>::variable(Exact(x[i]), i));
    let shaded = shade(shading, &duals);
    let [coarse, fine] = [1e-4, 5e-5].map(|step| difference(shading, x, by, step));
    for i in 0..3 {
        let (found, expected) = (shaded[i].partials[by].0, fine[i]);
        let small = 1e-9 * (1.0 + shaded[i].value.0.abs());
        tally.points += 1;
        // A kink between the points: the difference itself depends on the step.
        if (coarse[i] - fine[i]).abs() > 1e-6 * fine[i].abs() + small {
            continue;
        }
        let error = (found - expected).abs();
        let name = shading.name();
        assert!(error <= 1e-5 * expected.abs() + small, "{name}, input {by}: {found}, {expected} at {x:?}");
        tally.smooth += 1;
        tally.nonzero += usize::from(expected.abs() > 1e-3);
    }
}

#[test]
fn duals_have_the_gradients_of_every_model() {
    let mut random = Random(5);
    for (name, shading) in Shading::NAMES.iter().copied() {
        let mut nonzero = 0;
        for (what, range) in BY {
            let mut tally = Tally::default();
            for i in 0..300 {
                let by = range.start + i % range.len();
                compare(shading, &inputs(&mut random), by, &mut tally);
            }
            let Tally { points, smooth, .. } = tally;
            assert!(smooth * 100 >= points * 95, "{name} by {what}: {smooth} of {points} are smooth");
            eprintln!("{name} by {what}: {smooth} of {points} equal, {} not zero", tally.nonzero);
            nonzero += tally.nonzero;
        }
        assert!(nonzero > 600, "{name}: {nonzero} nonzero derivatives");
    }
}

#[test]
fn duals_differentiate_powers_and_logarithms() {
    let x = Dual::<f64, 2>::variable(0.7, 0);
    let y = Dual::variable(2.5, 1);
    let near = |found: [f64; 2], expected: [f64; 2]| {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-7), "{found:?} {expected:?}");
    };
    let power = scalar::pow(0.7, 2.5);
    near(x.pow(y).partials, [2.5 * scalar::pow(0.7, 1.5), power * scalar::ln(0.7)]);
    near(x.exp().partials, [scalar::exp(0.7), 0.0]);
    near(x.exp2().partials, [std::f64::consts::LN_2 * scalar::exp2(0.7), 0.0]);
    near(y.ln().partials, [0.0, 0.4]);
    near(y.log2().partials, [0.0, 0.4 * std::f64::consts::LOG2_E]);
    near((x * x.lit(0.0)).sqrt().partials, [0.0; 2]);
    near((x.lit(0.0) * y).pow(y).partials, [0.0; 2]);
    near((x / y).sqrt().partials, [0.5 / (0.7f64 * 2.5).sqrt(), -0.5 * (0.7f64 / 15.625).sqrt()]);
}
