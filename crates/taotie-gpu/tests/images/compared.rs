//! An image by GPU and CPU, and the difference between them.

use crate::common::absent;
use std::sync::{Arc, LazyLock};
use taotie_engine::Progress;
use taotie_engine::film::{Development, develop8};
use taotie_engine::math::Vec3;
use taotie_engine::render::{EnvironmentLight, Lighting, Pass, Prepared, RenderSettings, Shot};
use taotie_engine::scene::{Camera, Light, Scene};
use taotie_engine::shade::environment::Environment;
use taotie_gpu::{AdapterChoice, Gpu, GpuRenderer};

/// The maximum mean difference, in 8-bit codes.
const MOST_MEAN: f64 = 0.5;

/// The maximum difference of all pixels except one in a thousand, in 8-bit codes.
const MOST_OF_NEARLY_ALL: u8 = 3;

/// The fraction of pixels that may differ by more.
const OUTLIERS: f64 = 0.001;

static GPU: LazyLock<Result<Gpu, String>> =
    LazyLock::new(|| Gpu::find(&AdapterChoice::default()).map_err(|error| error.to_string()));

static SKY: LazyLock<Arc<Environment>> =
    LazyLock::new(|| Environment::new(crate::finishes::sky()).unwrap().into());

/// The GPU of this machine, or `None` if there is none and the test has to be skipped.
pub fn gpu() -> Option<Gpu> {
    match &*GPU {
        Ok(gpu) => Some(gpu.clone()),
        Err(why) => {
            absent(why);
            None
        }
    }
}

/// An image that both render.
pub struct View {
    pub name: String,
    pub scene: Scene,
    pub camera: Camera,
    pub lighting: Lighting,
    pub settings: RenderSettings,
}

/// The differences of two images, in 8-bit codes: the worst channel of each pixel. Pixels that are empty in both
/// images do not count.
#[derive(Debug)]
pub struct Difference {
    pub mean: f64,
    /// The fraction of pixels that differ by more than [`MOST_OF_NEARLY_ALL`].
    pub outliers: f64,
    pub most: u8,
}

impl View {
    /// One sample per pixel under lights of every kind.
    pub fn new(name: impl Into<String>, scene: Scene, camera: Camera) -> Self {
        let lighting = lit(crate::scenes::every_light());
        let settings = RenderSettings { width: 480, height: 360, samples: 1, ..RenderSettings::default() };
        Self { name: name.into(), scene, camera, lighting, settings }
    }

    /// The same with other settings.
    pub fn with(mut self, change: impl FnOnce(&mut RenderSettings)) -> Self {
        change(&mut self.settings);
        self
    }

    /// Under a visible sky instead of the ambient light.
    pub fn under_sky(mut self) -> Self {
        let sky = EnvironmentLight { environment: SKY.clone(), rotation: 0.4, intensity: 0.8, visible: true };
        self.lighting.environment = Some(sky);
        self.lighting.ambient = Vec3::splat(0.0);
        self
    }

    pub fn shot(&self) -> Shot<'_> {
        Shot { camera: &self.camera, lighting: &self.lighting, settings: &self.settings }
    }

    pub fn prepared(&self) -> Prepared {
        Prepared::new(self.scene.clone(), &self.settings.surface).unwrap()
    }

    /// Renders it with both and measures the difference.
    pub fn difference(&self, gpu: &Gpu) -> Difference {
        let (prepared, shot) = (self.prepared(), self.shot());
        let codes =
            |frame: &taotie_engine::render::Frame| develop8(&frame.color, &Development::default()).unwrap();
        let expected = Pass::new(&prepared, &shot).unwrap().render(Progress::SILENT).unwrap();
        let seen = expected.color.pixels().iter().filter(|pixel| pixel[3] > 0.0).count();
        assert!(seen > expected.color.pixels().len() / 20, "{}: only {seen} pixels are visible", self.name);
        let mut renderer = GpuRenderer::new(gpu, &prepared).unwrap();
        let found = renderer.render(&shot, Progress::SILENT).unwrap();
        Difference::of(&codes(&expected), &codes(&found))
    }

    /// Renders it with both and fails if they differ too much.
    pub fn check(&self, gpu: &Gpu) {
        let difference = self.difference(gpu);
        let Difference { mean, outliers, most } = difference;
        println!(
            "{}: mean {mean:.4}, beyond {MOST_OF_NEARLY_ALL}: {:.3} %, most {most}",
            self.name,
            100.0 * outliers
        );
        assert!(mean <= MOST_MEAN && outliers <= OUTLIERS, "{}: {difference:?}", self.name);
    }
}

impl Difference {
    pub fn of(one: &[[u8; 4]], other: &[[u8; 4]]) -> Self {
        assert_eq!(one.len(), other.len());
        let worst = |(a, b): (&[u8; 4], &[u8; 4])| (0..4).map(|c| a[c].abs_diff(b[c])).max().unwrap_or(0);
        let shown = one.iter().zip(other).filter(|(a, b)| a[3] > 0 || b[3] > 0);
        let all: Vec<u8> = shown.map(worst).collect();
        let count = all.len() as f64;
        Self {
            mean: all.iter().map(|d| f64::from(*d)).sum::<f64>() / count,
            outliers: all.iter().filter(|d| **d > MOST_OF_NEARLY_ALL).count() as f64 / count,
            most: all.iter().copied().max().unwrap_or(0),
        }
    }
}

/// Lights with some ambient light.
pub fn lit(lights: Vec<Light>) -> Lighting {
    Lighting { lights, ambient: Vec3::splat(0.08), environment: None }
}
