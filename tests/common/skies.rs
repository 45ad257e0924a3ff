//! Environments built by code, and integrals over an environment's picture by summing all of its texels.
use crate::random::Random;
use std::f64::consts::{PI, TAU};
use taotie_engine::image::Image;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::shade::environment::Environment;

/// Returns the direction at a point of an equirectangular picture: u = atan2(z, x)/2π + 1/2, v = acos(y)/π.
pub fn direction(u: f64, v: f64) -> Vec3<f64> {
    let (azimuth, polar) = ((u - 0.5) * TAU, v * PI);
    let ring = scalar::sin(polar);
    Vec3::new(ring * scalar::cos(azimuth), scalar::cos(polar), ring * scalar::sin(azimuth))
}

/// Returns the solid angle of a texel in row `y` of a picture `width` wide and half as high.
pub fn solid_angle(width: usize, y: usize) -> f64 {
    let edge = |y: usize| scalar::cos(PI * y as f64 / (width / 2) as f64);
    (edge(y) - edge(y + 1)) * TAU / width as f64
}

/// Returns a picture `width` wide and half as high from a function of the direction.
pub fn equirect(width: u32, light: impl Fn(Vec3<f64>) -> Vec3<f64>) -> Image {
    let mut image = Image::new(width, width / 2, [0.0; 4]).expect("a valid size");
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i % width as usize, i / width as usize);
        let middle = |k: usize, n: u32| (k as f64 + 0.5) / f64::from(n);
        let color = light(direction(middle(x, width), middle(y, width / 2))).to_f32();
        *pixel = [color.x, color.y, color.z, 1.0];
    }
    image
}

/// Returns a dim coloured sky with a few texels a thousand times as bright.
pub fn speckled(width: u32) -> Image {
    let mut image = equirect(width, |n| Vec3::new(0.6 + 0.4 * n.y, 0.5, 0.5 - 0.3 * n.x));
    let count = image.pixels().len();
    for (k, color) in [[900.0, 800.0, 500.0], [0.0, 40.0, 900.0], [300.0, 0.0, 0.0]].into_iter().enumerate() {
        let [r, g, b] = color;
        image.pixels_mut()[count * (2 * k + 1) / 7 + 5 * k] = [r, g, b, 1.0];
    }
    image
}

/// Returns every texel's direction, light and solid angle.
pub fn texels(image: &Image) -> impl Iterator<Item = (Vec3<f64>, Vec3<f64>, f64)> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    image.pixels().iter().enumerate().map(move |(i, [r, g, b, _])| {
        let (x, y) = (i % width, i / width);
        let d = direction((x as f64 + 0.5) / width as f64, (y as f64 + 0.5) / height as f64);
        (d, Vec3::new(*r, *g, *b).to_f64(), solid_angle(width, y))
    })
}

/// All texels of a picture, for summation.
pub struct Texels {
    /// Direction, light times solid angle, solid angle.
    texels: Vec<(Vec3<f64>, Vec3<f64>, f64)>,
}

impl Texels {
    /// Reads the texels of a picture.
    pub fn new(image: &Image) -> Self {
        Self { texels: texels(image).map(|(l, light, angle)| (l, light * angle, angle)).collect() }
    }

    /// Returns ∫ L D(h) (n·l)⁺ dl / ∫ D(h) (n·l)⁺ dl with n = v and the D of GGX, for each roughness.
    pub fn specular(&self, n: Vec3<f64>, roughnesses: &[f64]) -> Vec<Vec3<f64>> {
        let mut sums = vec![(Vec3::splat(0.0), 0.0); roughnesses.len()];
        for (l, light, angle) in &self.texels {
            let n_dot_l = n.dot(*l);
            if n_dot_l <= 0.0 {
                continue;
            }
            // The angle between h and n is half of that between l and n: sin²(γ/2) = |l − n|²/4.
            let apart = *l - n;
            let sin2_h = apart.dot(apart) / 4.0;
            for (roughness, (sum, weights)) in roughnesses.iter().zip(&mut sums) {
                let alpha = roughness * roughness;
                let t = alpha * alpha * (1.0 - sin2_h) + sin2_h;
                let weight = n_dot_l / (t * t);
                *sum += *light * weight;
                *weights += weight * angle;
            }
        }
        sums.into_iter().map(|(sum, weights)| sum * (1.0 / weights)).collect()
    }
}

/// Returns the error of `environment` for rough mirrors, compared with the integral over all texels of its picture:
/// for each roughness, the root mean square error over the directions, relative to that of the light.
pub fn specular_errors(
    environment: &Environment,
    texels: &Texels,
    directions: &[Vec3<f64>],
    roughnesses: &[f64],
) -> Vec<f64> {
    use rayon::prelude::*;
    let truths: Vec<_> = directions.par_iter().map(|n| texels.specular(*n, roughnesses)).collect();
    let square = |v: Vec3<f64>| v.dot(v);
    let error = |(k, roughness): (usize, &f64)| {
        let found = |n: &Vec3<f64>| environment.specular(n.to_f32(), *roughness as f32).to_f64();
        let errors: f64 = directions.iter().zip(&truths).map(|(n, truth)| square(found(n) - truth[k])).sum();
        let light: f64 = truths.iter().map(|truth| square(truth[k])).sum();
        (errors / light).sqrt()
    };
    roughnesses.iter().enumerate().map(error).collect()
}

/// Returns directions everywhere, and directions about a lobe's width away from the bright parts.
pub fn directions(environment: &Environment, count: usize, random: &mut Random) -> [Vec<Vec3<f64>>; 2] {
    let everywhere = (0..count).map(|_| random.unit()).collect();
    let mut near_light = || {
        let bright = environment.sample([random.next() as f32, random.next() as f32]).direction;
        let far = random.next() * random.next() * 0.5;
        (bright.to_f64() + random.unit() * far).normalize()
    };
    [everywhere, (0..count).map(|_| near_light()).collect()]
}
