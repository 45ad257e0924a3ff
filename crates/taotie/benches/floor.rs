//! Compares a frame with the limits of this machine: `cargo bench -p taotie --bench floor`.
//!
//! The lower bound is measured in two parts. *Arithmetic*: the formulas of one pixel of `cook-torrance` with a colour
//! map, a normal map and one light, from barycentric weights to the 8-bit code, over packs whose inputs are in the L1
//! cache; the operations are counted by a counting number type. *Texels*: only the loads of the texels around each
//! pixel, tile by tile, from maps as large as the frame's. A frame cannot take less than the longer of the two; it
//! would take their sum if nothing overlapped. They are compared with a frame, all on one thread.

#![allow(missing_docs, clippy::print_stdout, reason = "a program that prints")]

#[path = "../../../tests/common/scenes.rs"]
#[allow(dead_code, reason = "the golden images use the rest")]
mod scenes;

use fearless_simd::{Level, Simd, f32x8, f32x16, prelude::*};
use std::cell::Cell;
use std::hint::black_box;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::time::Instant;
use taotie_engine::Progress;
use taotie_engine::film::{Development, ToneCurve};
use taotie_engine::math::{Lane, Vec3, poly};
use taotie_engine::mesh::Mesh;
use taotie_engine::raster::PerspectiveTriangle;
use taotie_engine::render::{Lighting, RenderSettings, Renderer, Shot};
use taotie_engine::scene::{Camera, Falloff, Light, LightKind, NormalSpace, Scene};
use taotie_engine::shade::dfg::Dfg;
use taotie_engine::shade::{
    Angles, MaterialSample, Shading, SubPixelVariance, compensation, curvature_variance, lights, reflect,
};
use taotie_engine::surface::tangent_normal;

/// Side length of each map, in texels.
const TEXTURE_SIZE: usize = 2048;
/// Pixels of the timed kernel: few enough for the L1 cache.
const PIXELS: usize = 64;
/// Inputs of a pixel that come from elsewhere.
const INPUTS: usize = 12;
/// Rounds that interleave all measurements, and runs of each; the fastest counts.
const ROUNDS: usize = 5;
const RUNS: usize = 10;
/// Width and height of the image, in pixels.
const SIDE: u32 = 1024;

/// The values shared by all pixels of a triangle.
struct Constants<L> {
    planes: [[L; 3]; 3],
    /// Positions, normals, tangents: those of the first corner, and the differences to the others.
    corners: [[Vec3<L>; 3]; 3],
    uvs: [[L; 3]; 2],
    /// The codes of four colours and four vectors, from two levels.
    texels: [[L; 8]; 2],
}

/// The formulas of a pixel. `at` contains its position, and numbers in place of table lookups.
#[inline(always)]
fn pixel<L: Lane>(at: [L; INPUTS], constants: &Constants<L>) -> Vec3<L> {
    let [x, y, ..] = at;
    let (zero, one) = (x.lit(0.0), x.lit(1.0));
    let bary = PerspectiveTriangle { planes: constants.planes }.at(x, y);
    let [positions, normals, tangents] = constants.corners;
    let (position, normal) = (mix(positions, bary.weights), mix(normals, bary.weights));
    let tangent = mix(tangents, bary.weights);
    let curvature = curvature_variance(change(normals, bary.d_x), change(normals, bary.d_y));
    let facet = positions[1].cross(positions[2]).normalize_or(normal);
    let v = (Vec3::new(zero, zero, x.lit(3.0)) - position).normalize_or(facet);

    // The level of detail, and the positions in two levels.
    let [us, vs] = constants.uvs;
    let uv = [us[0] + along(us, bary.weights), vs[0] + along(vs, bary.weights)];
    let size = x.lit(TEXTURE_SIZE as f64);
    let (du_dx, dv_dx) = (along(us, bary.d_x) * size, along(vs, bary.d_x) * size);
    let (du_dy, dv_dy) = (along(us, bary.d_y) * size, along(vs, bary.d_y) * size);
    let texels = (du_dx.squared() + dv_dx.squared()).max(du_dy.squared() + dv_dy.squared());
    let lod = poly::log2(texels.clamp(1e-30, 1e30)) * x.lit(0.5);
    let kept = lod.clamp(0.0, 11.0);
    let share = kept - kept.floor();
    let mut color = Vec3::splat(zero);
    let mut stored = [zero; 4];
    for level in 0..2 {
        let size = size * x.lit(if level == 0 { 1.0 } else { 0.5 });
        let place = [fraction(uv[0], size), fraction(uv[1], size)];
        let [a, b, c, d, e, f, g, h] = constants.texels[level];
        let (reds, greens, blues) = (at[2], at[3], at[4]);
        let red = between([linear(a + reds), linear(b + reds), linear(c + reds), linear(d + reds)], place);
        let green =
            between([linear(a + greens), linear(b + greens), linear(c + greens), linear(d + greens)], place);
        let blue =
            between([linear(a + blues), linear(b + blues), linear(c + blues), linear(d + blues)], place);
        let vector = [
            between([e + at[5], f + at[5], g + at[5], h + at[5]], place) * x.lit(1.0 / 255.0),
            between([e + at[6], f + at[6], g + at[6], h + at[6]], place) * x.lit(1.0 / 255.0),
            between([e + at[7], f + at[7], g + at[7], h + at[7]], place) * x.lit(1.0 / 255.0),
            between([e + at[8], f + at[8], g + at[8], h + at[8]], place) * x.lit(1.0 / 255.0),
        ];
        let coarse = Vec3::new(red, green, blue);
        if level == 0 {
            (color, stored) = (coarse, vector);
            continue;
        }
        color = color + (coarse - color) * share;
        for (stored, vector) in stored.iter_mut().zip(vector) {
            *stored = *stored + (vector - *stored) * share;
        }
    }

    let [sx, sy, sz, relief] = stored;
    let map = Vec3::new(sx + sx - one, sy + sy - one, sz + sz - one);
    let n = tangent_normal(normal, tangent, one, map);
    let roughness = SubPixelVariance { curvature, normal_variance: relief }.widened(x.lit(0.5));
    let dfg = Dfg { scale: at[9], bias: at[10], edge: zero, diffuse_edge: zero };
    let sample = MaterialSample {
        base_color: color,
        metallic: one,
        roughness,
        f0: color,
        f90: one,
        f82_drop: Vec3::splat(zero),
        diffuse: Vec3::splat(zero),
        specular: Vec3::splat(one),
        shininess: one,
        slope: roughness.squared(),
        compensation: Some(compensation(&dfg, color, one, Vec3::splat(zero))),
    };
    let to_light = Vec3::new(one, one, one) - position;
    let squared = to_light.dot(to_light).max(x.lit(1e-12));
    let l = to_light * (one / squared.sqrt());
    let reflected = reflect(Shading::CookTorrance, &sample, &Angles::new(n, v, l));
    let radiance = reflected * lights::inverse_square(squared) + color * x.lit(0.04);
    // The film: clamped to [0, 1], and the position in the table of codes.
    Vec3::new(code(radiance.x), code(radiance.y), code(radiance.z))
}

// Functions, not closures passed to others: code that is not inlined loses the SIMD level.

/// The interpolated corner values at a point.
#[inline(always)]
fn mix<L: Lane>([a, b, c]: [Vec3<L>; 3], w: [L; 3]) -> Vec3<L> {
    a + b * w[1] + c * w[2]
}

/// The change of the value for changes of the weights.
#[inline(always)]
fn change<L: Lane>([_, b, c]: [Vec3<L>; 3], w: [L; 3]) -> Vec3<L> {
    b * w[1] + c * w[2]
}

#[inline(always)]
fn along<L: Lane>([_, b, c]: [L; 3], w: [L; 3]) -> L {
    b * w[1] + c * w[2]
}

/// The fraction of the way from the texel before a coordinate to the next.
#[inline(always)]
fn fraction<L: Lane>(u: L, size: L) -> L {
    let place = (u - u.floor()) * size - u.lit(0.5);
    // The index costs as much again.
    let first = place.floor();
    (place - first) + (first.max(u.lit(0.0)).min(size) - first) * u.lit(0.0)
}

#[inline(always)]
fn between<L: Lane>([a, b, c, d]: [L; 4], [across, down]: [L; 2]) -> L {
    let (top, bottom) = (a + (b - a) * across, c + (d - c) * across);
    top + (bottom - top) * down
}

#[inline(always)]
fn code<L: Lane>(light: L) -> L {
    light.clamp(0.0, 1.0) * light.lit(4096.0)
}

/// A polynomial with as many terms as the renderer's.
#[inline(always)]
fn linear<L: Lane>(code: L) -> L {
    let mut sum = code * code.lit(-2.96e-16) + code.lit(2.845e-13);
    for term in [-1.241e-10, 4.61e-8, 7.686e-6, 1.347e-4, 8.766e-4] {
        sum = sum * code + code.lit(term);
    }
    L::select(code.lt(code.lit(10.5)), code * code.lit(3.035e-4), sum)
}

fn constants<L: Lane>(lift: impl Fn(f32) -> L) -> Constants<L> {
    let number = |i: usize| lift(0.1 + 0.07 * (i % 11) as f32);
    let vector = |i: usize| Vec3::new(number(i), number(i + 3), number(i + 5));
    let plane = |a: f32, b: f32, c: f32| [lift(a), lift(b), lift(c)];
    Constants {
        planes: [plane(0.3, 0.001, 0.002), plane(0.4, -0.003, 0.001), plane(0.5, 0.002, -0.003)],
        corners: [0, 1, 2].map(|k| [vector(k), vector(k + 1), vector(k + 4)]),
        uvs: [0, 1].map(|k| [number(k), number(k + 2), number(k + 7)]),
        texels: [0, 8].map(|first| std::array::from_fn(|i| lift(20.0 + 13.0 * (first + i) as f32))),
    }
}

/// Positions of pixels, and numbers for the remaining inputs.
fn inputs() -> Vec<[f32; PIXELS]> {
    (0..INPUTS)
        .map(|k| std::array::from_fn(|i| if k < 2 { i as f32 } else { ((i * (k + 3)) % 17) as f32 / 17.0 }))
        .collect()
}

macro_rules! kernel {
    ($name:ident, $pack:ident, $lanes:literal) => {
        /// Draws all pixels once.
        #[inline(always)]
        fn $name<S: Simd>(simd: S, inputs: &[[f32; PIXELS]], out: &mut [[f32; PIXELS]; 3]) {
            let constants = constants(|value| $pack::splat(simd, value));
            for i in (0..PIXELS).step_by($lanes) {
                let mut at = [$pack::splat(simd, 0.0); INPUTS];
                for (at, input) in at.iter_mut().zip(inputs) {
                    *at = $pack::from_slice(simd, &input[i..i + $lanes]);
                }
                let Vec3 { x, y, z } = pixel(at, &constants);
                for (out, value) in out.iter_mut().zip([x, y, z]) {
                    value.store_slice(&mut out[i..i + $lanes]);
                }
            }
        }
    };
}

kernel!(draw_eights, f32x8, 8);
kernel!(draw_sixteens, f32x16, 16);

/// Nanoseconds per pixel of the formulas only.
fn arithmetic() -> f64 {
    const TIMES: usize = 2000;
    let (inputs, mut out) = (inputs(), [[0.0; PIXELS]; 3]);
    let mut draw = || match Level::new() {
        #[cfg(target_arch = "x86_64")]
        Level::Avx512(simd) => simd.vectorize(
            #[inline(always)]
            || draw_sixteens(simd, black_box(&inputs), &mut out),
        ),
        level => fearless_simd::dispatch!(level, simd => draw_eights(simd, black_box(&inputs), &mut out)),
    };
    fastest(TIMES * PIXELS, || (0..TIMES).for_each(|_| draw()))
}

/// Two levels of two maps.
fn maps() -> [Vec<[u8; 4]>; 4] {
    let map = |size: usize| (0..size * size).map(|i| (i as u32).to_le_bytes()).collect();
    [map(TEXTURE_SIZE), map(TEXTURE_SIZE / 2), map(TEXTURE_SIZE), map(TEXTURE_SIZE / 2)]
}

/// Nanoseconds per pixel of loading the texels around it: in each map two neighbours in two rows.
fn texels(maps: &[Vec<[u8; 4]>; 4]) -> f64 {
    let side = SIDE as usize;
    fastest(side * side, || {
        let mut sum = 0u64;
        for tile in 0..(side / 64) * (side / 64) {
            let (left, top) = (tile % (side / 64) * 64, tile / (side / 64) * 64);
            for (i, map) in maps.iter().enumerate() {
                // Halfway between two levels, a pixel is √2 texels of the finer level wide; in 256ths.
                let (size, step) = [(TEXTURE_SIZE, 362), (TEXTURE_SIZE / 2, 181)][i % 2];
                for y in top..top + 64 {
                    let row = ((y * step) >> 8) * size;
                    for x in left..left + 64 {
                        let first = row + ((x * step) >> 8);
                        sum = sum.wrapping_add(pair(map, first)).wrapping_add(pair(map, first + size));
                    }
                }
            }
        }
        black_box(sum);
    })
}

/// Two neighbours; zero beyond the last.
#[inline(always)]
fn pair(map: &[[u8; 4]], first: usize) -> u64 {
    let bytes = map.as_flattened().get(4 * first..).and_then(|bytes| bytes.first_chunk());
    bytes.map_or(0, |bytes| u64::from_le_bytes(*bytes))
}

fn lamp() -> Light {
    let mut lamp = scenes::directional(Vec3::new(0.0, -1.0, 0.0), 20.0);
    (lamp.kind, lamp.falloff) =
        (LightKind::Point { position: Vec3::new(2.0, 3.0, 2.0) }, Falloff::InverseSquare);
    lamp
}

/// The embossed sphere in bronze.
fn sphere() -> Scene {
    let size = TEXTURE_SIZE as u32;
    let mut scene = scenes::embossed_sphere_with(NormalSpace::Tangent, size, size);
    let bronze = scene.edit(|scene| {
        scene.meshes = vec![Mesh::sphere(1.0, 32, 32)];
        let material = &mut scene.materials[0];
        (material.metallic_roughness_texture, material.occlusion_texture) = (None, None);
        material.roughness = 0.5;
    });
    bronze.expect("the sphere is valid");
    scene
}

/// A whole image, rendered repeatedly.
struct Studio {
    renderer: Renderer,
    camera: Camera,
    lighting: Lighting,
    settings: RenderSettings,
    codes: Vec<[u8; 4]>,
}

impl Studio {
    fn new(scene: Scene) -> Self {
        let shading = Shading::CookTorrance;
        let settings =
            RenderSettings { width: SIDE, height: SIDE, samples: 1, shading, ..RenderSettings::default() };
        let renderer = Renderer::new(scene, &settings.surface).expect("the scene is valid");
        let lighting = Lighting { lights: vec![lamp()], ambient: Vec3::splat(0.04), environment: None };
        Self { renderer, camera: scenes::camera(25.0, 20.0, 3.29), lighting, settings, codes: Vec::new() }
    }

    /// Renders it; returns the number of pixels that show the sphere.
    fn draw(&mut self) -> usize {
        let development = Development { tone: ToneCurve::Linear, ..Development::default() };
        let shot = Shot { camera: &self.camera, lighting: &self.lighting, settings: &self.settings };
        let drawn = self.renderer.develop(&shot, &development, &mut self.codes, Progress::SILENT);
        drawn.expect("the settings are valid");
        self.codes.iter().filter(|code| code[3] > 0).count()
    }
}

/// Nanoseconds per pixel of a run over `count` pixels.
fn fastest(count: usize, mut run: impl FnMut()) -> f64 {
    let times = (0..RUNS).map(|_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64() * 1e9 / count as f64
    });
    times.fold(f64::INFINITY, f64::min)
}

thread_local! {
    /// Additions and multiplications, divisions and roots, and all other operations.
    static COUNTS: Cell<[u64; 3]> = const { Cell::new([0; 3]) };
}

fn count(kind: usize) {
    COUNTS.with(|counts| {
        let mut now = counts.get();
        now[kind] += 1;
        counts.set(now);
    });
}

/// A number that counts the operations on it.
#[derive(Debug, Clone, Copy)]
struct Counted(f32);

macro_rules! counted {
    ($trait:ident, $method:ident, $kind:literal) => {
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                count($kind);
                Self(self.0.$method(other.0))
            }
        }
    };
}

counted!(Add, add, 0);
counted!(Sub, sub, 0);
counted!(Mul, mul, 0);
counted!(Div, div, 1);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        count(2);
        Self(-self.0)
    }
}

impl Lane for Counted {
    type Mask = bool;
    fn lit(self, value: f64) -> Self {
        Self(value as f32)
    }
    fn sqrt(self) -> Self {
        count(1);
        Self(self.0.sqrt())
    }
    fn abs(self) -> Self {
        count(2);
        Self(self.0.abs())
    }
    fn floor(self) -> Self {
        count(2);
        Self(self.0.floor())
    }
    fn lt(self, other: Self) -> bool {
        count(2);
        self.0 < other.0
    }
    fn le(self, other: Self) -> bool {
        count(2);
        self.0 <= other.0
    }
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        count(2);
        if mask { if_true } else { if_false }
    }
    fn ldexp(self, n: Self) -> Self {
        count(2);
        Self(self.0.ldexp(n.0))
    }
    fn frexp(self) -> (Self, Self) {
        count(2);
        let (mantissa, exponent) = self.0.frexp();
        (Self(mantissa), Self(exponent))
    }
    fn min(self, other: Self) -> Self {
        count(2);
        Self(Lane::min(self.0, other.0))
    }
    fn max(self, other: Self) -> Self {
        count(2);
        Self(Lane::max(self.0, other.0))
    }
    fn exp(self) -> Self {
        poly::exp(self)
    }
    fn exp2(self) -> Self {
        poly::exp2(self)
    }
    fn ln(self) -> Self {
        poly::ln(self)
    }
    fn log2(self) -> Self {
        poly::log2(self)
    }
    fn pow(self, exponent: Self) -> Self {
        poly::pow(self, exponent)
    }
}

fn counts() -> [u64; 3] {
    let at = std::array::from_fn(|i| Counted(0.2 + 0.05 * i as f32));
    let constants = constants(Counted);
    COUNTS.set([0; 3]);
    black_box(pixel(at, &constants));
    COUNTS.get()
}

fn main() {
    let [sums, divisions, others] = counts();
    let (maps, scene) = (maps(), sphere());
    // All parallel code uses the caller's pool.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let (mut studio, mut best) = (Studio::new(scene), [f64::INFINITY; 3]);
    let shaded = studio.draw();
    for _ in 0..ROUNDS {
        let frame = pool.install(|| fastest(shaded, || assert_eq!(studio.draw(), shaded)));
        for (best, time) in best.iter_mut().zip([arithmetic(), texels(&maps), frame]) {
            *best = best.min(time);
        }
    }
    let [arithmetic, texels, frame] = best;
    let (together, apart) = (arithmetic.max(texels), arithmetic + texels);
    println!("one pixel of `cook-torrance`: {sums} additions and multiplications, {divisions} divisions and");
    println!("roots, {others} comparisons, selects and roundings; 16 texels, loaded as 8 pairs");
    let row = |what: &str, time: f64| println!("{what:<44}{time:>8.2} ns");
    row("arithmetic", arithmetic);
    row("texels", texels);
    row("lower bound, if everything overlaps", together);
    row("lower bound, if nothing overlaps", apart);
    row(&format!("a frame, per pixel of {shaded} shaded"), frame);
    println!("relative to the bounds: {:.2} and {:.2}", frame / together, frame / apart);
}
