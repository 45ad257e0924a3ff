//! The background behind the surfaces: the shadow of an object on the ground under it, then the environment.

use super::camera::CameraRays;
use super::prepare::{Prepared, Ready};
use super::settings::{EnvironmentLight, Lighting, Shot};
use super::tree::Casters;
use crate::image::Image;
use crate::math::Vec3;
use crate::math::integration::Sequence;
use crate::parallel;
use crate::pixel::{Incidence, LightSource, Turn};
use crate::raster::{TILE_SIZE, Tile};
use crate::scene::Bounds;
use crate::shade::sampling::{cosine_direction, cosine_pdf};

/// Side length of the shadow map, in texels.
const SIDE: usize = 160;

/// Half the side of the ground, in radii of the object's foot.
const REACH: f64 = 2.5;

/// Directions in which each point of the ground samples the environment.
const DIRECTIONS: u32 = 128;

/// The distance below the object, as a fraction of its size, so that objects on the ground do not intersect it.
const GAP: f64 = 1e-4;

/// Calls `change` with each pixel of a tile, and its column and row in the image.
fn each_pixel(tile: &Tile, color: &mut [[f32; 4]], change: impl Fn(&mut [f32; 4], [u32; 2])) {
    for y in 0..tile.height {
        for x in 0..tile.width {
            change(&mut color[(y * TILE_SIZE + x) as usize], [tile.x + x, tile.y + y]);
        }
    }
}

/// Composites the shadow on the ground, if the shot has one, below an image with premultiplied alpha, linear RGB: the
/// next step of a renderer that only draws surfaces, before [`fill_backdrop`]. `image` has the size of the
/// shot.
pub fn fill_ground(image: &mut Image, prepared: &Prepared, shot: &Shot<'_>) {
    let (width, height) = (image.width(), image.height());
    let rays = CameraRays::new(shot.camera, [width, height]);
    let Some(ground) = Ground::of(prepared.ready(), shot, rays) else { return };
    parallel::pieces(image.pixels_mut(), width as usize, &|y, row| {
        row.iter_mut().zip(0..).for_each(|(pixel, x)| ground.lay_under(pixel, [x, y as u32]));
    });
}

/// A shadow catcher, visible only where the object darkens it: the fraction of light that is missing on a horizontal
/// square under the object.
pub(super) struct Ground {
    height: f64,
    center: [f64; 2],
    half: f64,
    /// The shadow, row by row from the minimum z, each from the minimum x; [0, 1].
    shadow: Vec<f32>,
    rays: CameraRays,
}

impl Ground {
    /// The ground of a shot; `None` if it has none.
    pub(super) fn of(ready: Ready<'_>, shot: &Shot<'_>, rays: CameraRays) -> Option<Self> {
        let bounds = ready.bounds().filter(|_| shot.settings.ground)?;
        let casters = Casters { tree: ready.tree(0), draws: &ready.draws() };
        Some(Self::new(casters, bounds, shot.lighting, rays))
    }

    /// The ground under casters with these bounds.
    fn new(casters: Casters<'_>, bounds: Bounds, lighting: &Lighting, rays: CameraRays) -> Self {
        let size = bounds.diagonal();
        let (middle, extent) = (bounds.center(), bounds.max - bounds.min);
        let half = REACH * 0.5 * (extent.x * extent.x + extent.z * extent.z).sqrt().max(0.2 * size);
        let height = bounds.min.y - GAP * size;
        let mut ground = Self { height, center: [middle.x, middle.z], half, shadow: Vec::new(), rays };
        let lights = Lights::new(lighting);
        ground.shadow = parallel::collect(SIDE * SIDE, |i| lights.missing_at(casters, ground.texel(i)));
        ground
    }

    /// The centre of a texel, in world space.
    fn texel(&self, i: usize) -> Vec3 {
        let along = |k: usize| ((k as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0) * self.half;
        let (x, z) = (self.center[0] + along(i % SIDE), self.center[1] + along(i / SIDE));
        Vec3::new(x, self.height, z).to_f32()
    }

    /// Darkens the premultiplied pixels of a tile where the ground is visible behind them.
    pub(super) fn fill(&self, tile: &Tile, color: &mut [[f32; 4]]) {
        each_pixel(tile, color, |pixel, at| self.lay_under(pixel, at));
    }

    /// Darkens the pixel in column and row `at`.
    fn lay_under(&self, pixel: &mut [f32; 4], at: [u32; 2]) {
        let uncovered = (1.0 - pixel[3]).max(0.0);
        if uncovered > 0.0 {
            pixel[3] += uncovered * self.seen_at(at.map(|i| f64::from(i) + 0.5));
        }
    }

    /// The shadow at the centre of a pixel; none from below.
    fn seen_at(&self, at: [f64; 2]) -> f32 {
        let ray = self.rays.through(at);
        self.shadow_along(ray.origin, ray.direction)
    }

    /// The shadow at the point where a ray from above hits the ground.
    pub(super) fn shadow_along(&self, origin: Vec3, direction: Vec3) -> f32 {
        let (origin, direction) = (origin.to_f64(), direction.to_f64());
        if direction.y >= 0.0 || origin.y <= self.height {
            return 0.0;
        }
        let hit = origin + direction * ((self.height - origin.y) / direction.y);
        let [u, v] = [hit.x - self.center[0], hit.z - self.center[1]].map(|d| d / self.half);
        self.faded(u) * self.faded(v) * self.bilinear(u, v)
    }

    /// Returns 1 at the centre, 0 at the edge, and a smooth transition between; `u` in [−1, 1].
    fn faded(&self, u: f64) -> f32 {
        let t = ((1.0 - u.abs()) * 2.0).clamp(0.0, 1.0);
        (t * t * (3.0 - 2.0 * t)) as f32
    }

    fn bilinear(&self, u: f64, v: f64) -> f32 {
        let place = |u: f64| {
            let x = ((u + 1.0) * 0.5 * SIDE as f64 - 0.5).clamp(0.0, (SIDE - 1) as f64);
            let i = (x as usize).min(SIDE - 2);
            (i, (x - i as f64) as f32)
        };
        let ((i, fx), (j, fy)) = (place(u), place(v));
        let row = |j: usize| {
            let [a, b] = [self.shadow[j * SIDE + i], self.shadow[j * SIDE + i + 1]];
            a + (b - a) * fx
        };
        let (top, bottom) = (row(j), row(j + 1));
        top + (bottom - top) * fy
    }
}

/// The lights over the ground.
struct Lights {
    sources: Vec<LightSource<f32>>,
    /// Directions to the environment, each with its irradiance.
    sky: Vec<(Vec3, f32)>,
}

impl Lights {
    fn new(lighting: &Lighting) -> Self {
        let sources = lighting.lights.iter().map(LightSource::new).collect();
        let mut sky = lighting.environment.as_ref().map_or_else(Vec::new, environment);
        if lighting.ambient != Vec3::default() {
            let share = luminance(lighting.ambient) * std::f32::consts::PI / DIRECTIONS as f32;
            sky.extend(directions().map(|[a, b, ..]| (upward(cosine_direction([a, b])), share)));
        }
        Self { sources, sky }
    }

    /// The fraction of light that does not reach a point of the ground.
    fn missing_at(&self, casters: Casters<'_>, point: Vec3) -> f32 {
        let (mut all, mut seen) = (0.0f32, 0.0f32);
        let mut add = |irradiance: f32, direction: Vec3, limit: f32| {
            all += irradiance;
            if irradiance > 0.0 && casters.sees(point, direction, limit) {
                seen += irradiance;
            }
        };
        for source in &self.sources {
            let Incidence { l, irradiance } = source.incidence(point);
            add(luminance(irradiance) * l.y.max(0.0), source.ray_from(point), source.ray_limit());
        }
        for (direction, irradiance) in &self.sky {
            add(*irradiance, *direction, f32::INFINITY);
        }
        if all > 0.0 { 1.0 - seen / all } else { 0.0 }
    }
}

/// Returns directions, half of them sampled by the environment's brightness, half by the cosine, weighted so that
/// both agree: the balance heuristic (Veach 1997, eq. 9.8).
fn environment(light: &EnvironmentLight) -> Vec<(Vec3, f32)> {
    let turn = light.turn();
    let sources = directions().flat_map(|[a, b, c, d]| {
        let by_cosine = upward(cosine_direction([a, b]));
        [by_cosine, turn.to_world(light.environment.sample([c, d]).direction)]
    });
    let weigh = |direction: Vec3| {
        let inside = turn.to_environment(direction);
        let cosine = direction.y.max(0.0);
        let pdf = 0.5 * (light.environment.pdf(inside) + cosine_pdf(cosine));
        let radiance = luminance(light.environment.radiance(inside)) * light.intensity;
        (direction, radiance * cosine / (pdf * DIRECTIONS as f32))
    };
    sources.take(DIRECTIONS as usize).map(weigh).filter(|(_, irradiance)| *irradiance > 0.0).collect()
}

/// Evenly distributed numbers in [0, 1)⁴, the same for every point.
fn directions() -> impl Iterator<Item = [f32; 4]> {
    let sequence = Sequence::new(1);
    (0..DIRECTIONS).map(move |i| sequence.four(i, 0))
}

/// Rotates a vector from z up to y up.
fn upward(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, -v.y)
}

/// Returns the Rec. 709 luminance of linear sRGB.
fn luminance(rgb: Vec3) -> f32 {
    0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z
}

/// Composites the shot's environment, if it is visible, below an image with premultiplied alpha, linear RGB: the last
/// step of a renderer that only draws surfaces. `image` has the size of the shot.
pub fn fill_backdrop(image: &mut Image, shot: &Shot<'_>) {
    let (width, height) = (image.width(), image.height());
    let rays = CameraRays::new(shot.camera, [width, height]);
    let Some(backdrop) = Backdrop::new(shot.lighting.environment.as_ref(), rays) else { return };
    parallel::pieces(image.pixels_mut(), width as usize, &|y, row| {
        row.iter_mut().zip(0..).for_each(|(pixel, x)| backdrop.lay_under(pixel, [x, y as u32]));
    });
}

/// A visible environment, seen from a camera.
pub(super) struct Backdrop {
    light: EnvironmentLight,
    turn: Turn<f32>,
    rays: CameraRays,
}

impl Backdrop {
    /// Creates the backdrop; `None` if nothing is visible.
    pub(super) fn new(light: Option<&EnvironmentLight>, rays: CameraRays) -> Option<Self> {
        light.filter(|light| light.visible).map(|light| Self {
            light: light.clone(),
            turn: light.turn(),
            rays,
        })
    }

    /// Composites the environment below the premultiplied pixels of a tile, as seen through the centre of each pixel.
    pub(super) fn fill(&self, tile: &Tile, color: &mut [[f32; 4]]) {
        each_pixel(tile, color, |pixel, at| self.lay_under(pixel, at));
    }

    /// Composites the environment below the pixel in column and row `at`.
    fn lay_under(&self, pixel: &mut [f32; 4], at: [u32; 2]) {
        let uncovered = (1.0 - pixel[3]).max(0.0);
        if uncovered == 0.0 {
            return;
        }
        let middle = at.map(|i| f64::from(i) + 0.5);
        let direction = self.turn.to_environment(self.rays.through(middle).direction);
        let radiance = self.light.environment.radiance(direction) * (self.light.intensity * uncovered);
        let [r, g, b] = radiance.to_array();
        *pixel = [pixel[0] + r, pixel[1] + g, pixel[2] + b, 1.0];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Mesh;
    use crate::progress::Progress;
    use crate::render::{Pass, RenderSettings};
    use crate::scene::{Light, LightKind, Material, Orbit, Scene};

    #[test]
    fn laid_under_a_finished_image_it_is_that_of_the_renderer() {
        let orbit =
            Orbit { azimuth: 0.3, elevation: 0.5, distance: 4.0, target: Vec3::default(), fov_y: 0.9 };
        let camera = orbit.camera(1.0);
        let direction = Vec3::new(0.6, -1.0, -0.4).normalize();
        let kind = LightKind::Directional { direction };
        let sun = Light { name: String::new(), kind, color: Vec3::splat(2.0), falloff: Default::default() };
        let lighting = Lighting { lights: vec![sun], ambient: Vec3::splat(0.1), environment: None };
        let settings = RenderSettings { width: 90, height: 70, ..RenderSettings::default() };
        let grounded = RenderSettings { ground: true, ..settings.clone() };
        let scene = Scene::of_mesh(Mesh::sphere(1.0, 16, 8), Material::default()).unwrap();
        let prepared = Prepared::new(scene, &settings.surface).unwrap();
        let shot = |settings| Shot { camera: &camera, lighting: &lighting, settings };
        let render =
            |settings| Pass::new(&prepared, &shot(settings)).unwrap().render(Progress::SILENT).unwrap().color;
        let mut image = render(&settings);
        fill_ground(&mut image, &prepared, &shot(&settings));
        assert!(image.pixels() == render(&settings).pixels(), "it was not requested");
        fill_ground(&mut image, &prepared, &shot(&grounded));
        assert!(image.pixels() == render(&grounded).pixels());
        assert!(image.pixels() != render(&settings).pixels(), "there is a shadow");
    }
}
