//! The camera of an image: chosen as by the command, or placed by a pose, with central or parallel projection.

use serde::Deserialize;
use taotie::studio::{CameraOptions, Framing};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::scene::{Bounds, Camera, Orbit, Projection, Scene};

/// The share of an image that the box around an object fills under a parallel projection.
const FILL: f64 = 0.9;

/// The requested camera.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraRequest {
    /// The camera as the command chooses it.
    options: CameraOptions,
    placed: Option<Placed>,
}

/// A camera that the command lacks.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct Placed {
    /// The columns of the transform from view space, which may be sheared, to world space; `None` for the orbit.
    world_from_view: Option<Mat4>,
    /// `true` for a parallel projection.
    is_parallel: bool,
    /// The height seen by a parallel projection, model units; `None` frames the object.
    height: Option<f64>,
    /// Distances of the planes, model units; `None` keeps the whole object.
    near: Option<f64>,
    far: Option<f64>,
}

impl CameraRequest {
    /// Returns the options for an image of `scene`.
    pub fn options(&self, scene: &Scene, framing: Framing) -> CameraOptions {
        let options = self.options.clone();
        // Without triangles there is nothing to place a camera for: that is an error of the viewpoint.
        let Some((placed, bounds)) = self.placed.as_ref().zip(scene.bounds()) else { return options };
        let framed = if framing.all_around { swept(bounds, options.target) } else { bounds };
        let subject = Subject { bounds, framed, size: framing.size };
        CameraOptions { placed: Some(placed.camera(&options, &subject)), ..options }
    }
}

/// Returns the bounds of an object that is turned about the vertical axis through the target.
fn swept(bounds: Bounds, target: Option<Vec3<f64>>) -> Bounds {
    let pivot = target.unwrap_or(bounds.center());
    let reach = |corner: Vec3<f64>| (corner.x - pivot.x).hypot(corner.z - pivot.z);
    let reach = bounds.corners().into_iter().map(reach).fold(0.0, f64::max);
    let at = |side: f64, y: f64| Vec3::new(pivot.x + side, y, pivot.z + side);
    Bounds { min: at(-reach, bounds.min.y), max: at(reach, bounds.max.y) }
}

/// The object in an image.
struct Subject {
    bounds: Bounds,
    /// The part of the world that a parallel projection shows.
    framed: Bounds,
    /// The size of the image, pixels.
    size: [u32; 2],
}

impl Placed {
    fn camera(&self, options: &CameraOptions, subject: &Subject) -> Camera {
        let world_from_view = self.world_from_view.unwrap_or_else(|| subject.orbit(options));
        let view_from_world = world_from_view.inverse_affine().unwrap_or_default();
        let depth = -view_from_world.transform_point(subject.bounds.center()).z;
        let radius = subject.bounds.diagonal() / 2.0;
        let projection = if self.is_parallel {
            let aspect = subject.aspect();
            let half_height = self.height.map_or_else(|| subject.half_height(&view_from_world), |h| h / 2.0);
            let near = self.near.unwrap_or(depth - 2.0 * radius);
            let far = self.far.unwrap_or((depth + 2.0 * radius).max(near + radius));
            Projection::Orthographic { half_width: half_height * aspect, half_height, near, far }
        } else {
            // Precision does not depend on the near plane, which must only not cut the object.
            let near = (depth - radius * 1.01).max(depth.abs().max(radius) * 1e-4);
            let near = self.near.unwrap_or(near);
            Projection::Perspective { fov_y: options.fov_y, aspect: None, near, far: self.far }
        };
        Camera { name: String::new(), world_from_view, projection }
    }
}

impl Subject {
    fn aspect(&self) -> f64 {
        f64::from(self.size[0]) / f64::from(self.size[1])
    }

    /// Returns the transform of a camera on the requested orbit; at the object's diameter if no distance is given.
    fn orbit(&self, options: &CameraOptions) -> Mat4 {
        let CameraOptions { azimuth, elevation, distance, target, fov_y, .. } = *options;
        let target: Vec3<f64> = target.unwrap_or(self.bounds.center());
        let distance = distance.unwrap_or(self.bounds.diagonal());
        Orbit { azimuth, elevation, distance, target, fov_y }.camera(0.0).world_from_view
    }

    /// Returns half the height that a parallel projection must show for the object to be in the image.
    fn half_height(&self, view_from_world: &Mat4) -> f64 {
        let needed = self.framed.corners().map(|corner| {
            let seen = view_from_world.transform_point(corner);
            seen.y.abs().max(seen.x.abs() / self.aspect())
        });
        needed.into_iter().fold(f64::MIN_POSITIVE, f64::max) / FILL
    }
}
