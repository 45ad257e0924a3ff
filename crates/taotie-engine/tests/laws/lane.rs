//! One formula, many machines: the same bits in `f32` and at every SIMD level, through the same functions.

use fearless_simd::{Level, Simd, dispatch, f32x8, f32x16, prelude::*};
use taotie_engine::math::{Lane, Mask, Pack, SimdLevel, Vec3, scalar};
use taotie_engine::names::Named;
use taotie_engine::shade::fresnel::{f_conductor, f_dielectric};
use taotie_engine::shade::lights::{inverse_square, range_window, spot_cone};
use taotie_engine::shade::{Angles, MaterialSample, Shading, reflect};

/// n, v, l, base colour, f0, f82 drop, diffuse, specular; metallic, roughness, shininess, slope.
const INPUTS: usize = 28;
const ROUGHNESS: usize = 25;
const SHININESS: usize = 26;
/// Nine models of three channels, then the other functions.
const OUTPUTS: usize = 27 + 10;

#[inline(always)]
fn vector<L: Lane>(x: &[L; INPUTS], at: usize) -> Vec3<L> {
    Vec3::new(x[3 * at], x[3 * at + 1], x[3 * at + 2])
}

#[inline(always)]
fn shade<L: Lane>(shading: Shading, x: &[L; INPUTS]) -> Vec3<L> {
    let s = MaterialSample {
        base_color: vector(x, 3),
        metallic: x[24],
        roughness: x[ROUGHNESS],
        f0: vector(x, 4),
        f90: x[24],
        f82_drop: vector(x, 5),
        diffuse: vector(x, 6),
        specular: vector(x, 7),
        shininess: x[SHININESS],
        slope: x[27],
        compensation: None,
    };
    reflect(shading, &s, &Angles::new(vector(x, 0), vector(x, 1), vector(x, 2)))
}

#[inline(always)]
fn evaluate<L: Lane>(x: &[L; INPUTS]) -> [L; OUTPUTS] {
    let mut out = [x[0]; OUTPUTS];
    for (i, (_, shading)) in Shading::NAMES.iter().enumerate() {
        let [r, g, b] = shade(*shading, x).to_array();
        (out[3 * i], out[3 * i + 1], out[3 * i + 2]) = (r, g, b);
    }
    let wide = x[3] * x[0].lit(120.0);
    out[27] = wide.exp();
    out[28] = wide.exp2();
    out[29] = (x[9] * x[SHININESS]).ln();
    out[30] = (x[9] * x[SHININESS]).log2();
    out[31] = x[9].pow(wide);
    out[32] = f_dielectric(x[9], x[10] + x[11]);
    out[33] = f_conductor(x[9], x[10], x[SHININESS]);
    out[34] = inverse_square(x[10]);
    out[35] = range_window(x[10], x[11]);
    out[36] = spot_cone(x[0], x[10], x[11]);
    out
}

/// Pseudorandom numbers in [0, 1) that never change.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn direction(&mut self) -> [f64; 3] {
        let z = 2.0 * self.next() - 1.0;
        let (r, phi) = ((1.0 - z * z).sqrt(), std::f64::consts::TAU * self.next());
        [r * scalar::cos(phi), r * scalar::sin(phi), z]
    }

    /// Inputs of [`evaluate`]: n, v, l on the sphere, everything else in its range; every fourth near a mirror
    /// direction, every sixteenth with values at the ends of their ranges.
    fn inputs(&mut self, i: usize) -> [f64; INPUTS] {
        let mut x = [0.0; INPUTS];
        let (n, v, mut l) = (self.direction(), self.direction(), self.direction());
        if i.is_multiple_of(4) {
            let n_dot_v: f64 = (0..3).map(|k| n[k] * v[k]).sum();
            l = std::array::from_fn(|k| 2.0 * n_dot_v * n[k] - v[k] + 1e-3 * l[k]);
        }
        if i % 64 == 1 {
            l = v.map(|c| -c);
        }
        x[0..3].copy_from_slice(&n);
        x[3..6].copy_from_slice(&v);
        x[6..9].copy_from_slice(&l);
        x[9..26].fill_with(|| self.next());
        (x[SHININESS], x[27]) = (500.0 * self.next(), self.next());
        if i % 16 == 3 {
            x[24..28].fill_with(|| if self.next() < 0.5 { 0.0 } else { 1.0 });
        }
        x
    }
}

const COUNT: usize = 8192;

fn cases() -> Vec<[f32; INPUTS]> {
    let mut random = Random(20_250_615);
    (0..COUNT).map(|i| random.inputs(i).map(|x| x as f32)).collect()
}

#[inline(always)]
fn packs<S: Simd>(simd: S, columns: &[Vec<f32>], results: &mut [[f32; 8]]) {
    for (pack, results) in results.chunks_mut(OUTPUTS).enumerate() {
        let mut x = [SimdBase::splat(simd, 0.0); INPUTS];
        for (x, column) in x.iter_mut().zip(columns) {
            *x = f32x8::from_slice(simd, &column[8 * pack..8 * pack + 8]);
        }
        for (result, value) in results.iter_mut().zip(evaluate(&x)) {
            result.copy_from_slice(value.as_slice());
        }
    }
}

/// Runs `packs` at a SIMD level; returns false for emulated packs.
///
/// [`f32x8`] without vector instructions computes eight numbers per operation: compiling all nine models that way
/// takes more than a minute, so only the operations of which the models are made are compared there.
fn formulas_run(level: Level, columns: &[Vec<f32>], results: &mut [[f32; 8]]) -> bool {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Sse2(simd) => simd.vectorize(
            #[inline(always)]
            || packs(simd, columns, results),
        ),
        #[cfg(target_arch = "x86_64")]
        Level::Sse4_2(simd) => simd.vectorize(
            #[inline(always)]
            || packs(simd, columns, results),
        ),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(simd) => simd.vectorize(
            #[inline(always)]
            || packs(simd, columns, results),
        ),
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(simd) => simd.vectorize(
            #[inline(always)]
            || packs(simd, columns, results),
        ),
        #[cfg(target_arch = "aarch64")]
        Level::Neon(simd) => simd.vectorize(
            #[inline(always)]
            || packs(simd, columns, results),
        ),
        _ => return false,
    }
    true
}

#[test]
fn every_simd_level_has_the_bits_of_one_number_at_a_time() {
    let cases = cases();
    let columns: Vec<Vec<f32>> = (0..INPUTS).map(|k| cases.iter().map(|case| case[k]).collect()).collect();
    for name in SimdLevel::available() {
        let mut results = vec![[0.0; 8]; COUNT / 8 * OUTPUTS];
        if !formulas_run(name.dispatch().unwrap(), &columns, &mut results) {
            eprintln!("{}: operations only", name.name());
            continue;
        }
        for (i, case) in cases.iter().enumerate() {
            for (k, expected) in evaluate(case).iter().enumerate() {
                let found = results[i / 8 * OUTPUTS + k][i % 8];
                let same = expected.to_bits() == found.to_bits();
                assert!(same, "{}: case {i}, output {k}: {found} for {expected}", name.name());
            }
        }
        eprintln!("{}: {} equal numbers", name.name(), COUNT * OUTPUTS);
    }
}

const OPERATIONS: usize = 20;

/// Every operation of [`Lane`]; `a` is above 0 where the operation requires it, `n` is an exponent.
#[inline(always)]
fn operations<L: Lane>(a: L, b: L, n: L) -> [L; OPERATIONS] {
    let (zero, one, positive) = (a.lit(0.0), a.lit(1.0), a.abs());
    let (less, at_most) = (a.lt(b), a.le(b));
    let (mantissa, exponent) = positive.frexp();
    let choose = |mask| L::select(mask, one, zero);
    [
        a + b,
        a - b,
        a * b,
        a / b,
        -a,
        positive.sqrt(),
        positive,
        n.floor(),
        choose(less),
        choose(at_most),
        choose(less.and(at_most)),
        choose(less.or(at_most)),
        choose(less.not()),
        L::select(less, a, b),
        mantissa.ldexp(n.floor()),
        mantissa,
        exponent,
        a.min(b),
        a.max(b),
        a.clamp(-0.5, 0.5),
    ]
}

/// Column k contains operation k of each of the operands.
#[inline(always)]
fn operation_packs<P: Pack>(token: P::Token, [a, b, n]: &[Vec<f32>; 3], results: &mut [Vec<f32>]) {
    for i in (0..COUNT).step_by(P::LANES) {
        let (a, b, n) = (P::load(token, &a[i..]), P::load(token, &b[i..]), P::load(token, &n[i..]));
        for (column, value) in results.iter_mut().zip(operations(a, b, n)) {
            value.store(&mut column[i..]);
        }
    }
}

/// Numbers of every size with both signs, including equal pairs, signed zeros and infinities.
fn operands() -> [Vec<f32>; 3] {
    let mut random = Random(4);
    let mut any = |_| {
        let special = [0.0, -0.0, f32::INFINITY, f32::NEG_INFINITY, 1.0, f32::MIN_POSITIVE];
        match (random.next() * 40.0) as usize {
            i @ 0..6 => special[i],
            6..20 => (random.next() * 4.0 - 2.0) as f32,
            _ => {
                let bits = (random.next() * f64::from(u32::MAX)) as u32;
                Some(f32::from_bits(bits)).filter(|x| !x.is_nan()).unwrap_or(3.0)
            }
        }
    };
    let a: Vec<f32> = (0..COUNT).map(&mut any).collect();
    let b = (0..COUNT).map(|i| if i.is_multiple_of(7) { a[i] } else { -any(i) }).collect();
    let n = (0..COUNT).map(|_| (random.next() * 253.9 - 126.0) as f32).collect();
    [a, b, n]
}

#[test]
fn every_operation_has_the_same_bits_at_every_level() {
    let numbers = operands();
    let levels = SimdLevel::available();
    assert!(levels.contains(&SimdLevel::Scalar));
    for name in levels {
        let level = name.dispatch().unwrap();
        let columns = || vec![vec![0.0; COUNT]; OPERATIONS];
        let (mut eights, mut sixteens) = (columns(), columns());
        dispatch!(level, simd => operation_packs::<f32x8<_>>(simd, &numbers, &mut eights));
        dispatch!(level, simd => operation_packs::<f32x16<_>>(simd, &numbers, &mut sixteens));
        for i in 0..COUNT {
            let [a, b, n] = [numbers[0][i], numbers[1][i], numbers[2][i]];
            for (k, expected) in operations(a, b, n).into_iter().enumerate() {
                for found in [eights[k][i], sixteens[k][i]] {
                    // NaN has many bit patterns, and none of them reaches a pixel.
                    let same = expected.to_bits() == found.to_bits() || expected.is_nan() && found.is_nan();
                    assert!(same, "{}: operation {k} of {a}, {b}, {n}: {found} for {expected}", name.name());
                }
            }
        }
    }
}
