//! The viewpoint of an image.

use super::motion::{Motion, part_of_turn};
use std::f64::consts::{PI, TAU};
use taotie_engine::error::{Error, Result};
use taotie_engine::math::{Mat4, Vec3};
use taotie_engine::scene::{Bounds, Camera, Orbit, Outline, Scene};
use taotie_io::parse::MOST;

/// Number of directions from which a turning object must fit.
const TURNS: u32 = 24;

/// The fraction of the image that a framed object fills.
const FILL: f64 = 0.9;

/// Default azimuth, elevation and vertical angle of view, degrees: slightly from the side and from above.
const DEFAULT_DEGREES: [f64; 3] = [25.0, 15.0, 30.0];

/// The camera of a model: one of its file, else an orbit, by default at the distance that frames the object.
///
/// ```
/// use taotie::studio::CameraOptions;
///
/// let from_the_left = CameraOptions { azimuth: -0.8, ..CameraOptions::default() };
/// assert_eq!(from_the_left.distance, None);
/// ```
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct CameraOptions {
    /// A camera of the file by name, or one without a name by its index from 0; the orbit is then ignored.
    pub name: Option<String>,
    /// Radians to the right of the front, which is +z.
    pub azimuth: f64,
    /// Radians above the horizon.
    pub elevation: f64,
    /// From the target, model units, above 0; `None` frames the object.
    pub distance: Option<f64>,
    /// The point looked at, world space; `None` for the object's middle.
    pub target: Option<Vec3<f64>>,
    /// Full vertical angle of view, radians, in (0, π).
    pub fov_y: f64,
    /// A camera placed by the caller, in place of the one that the other options choose; its transform may shear, for
    /// an image whose centre is off the viewing axis. A turntable turns about `target`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub placed: Option<Camera>,
}

impl Default for CameraOptions {
    fn default() -> Self {
        let [azimuth, elevation, fov_y] = DEFAULT_DEGREES.map(f64::to_radians);
        Self { name: None, azimuth, elevation, distance: None, target: None, fov_y, placed: None }
    }
}

impl CameraOptions {
    fn check(&self) -> Result<()> {
        let numbers = [("azimuth", self.azimuth), ("elevation", self.elevation)];
        let is_wrong = |value: f64| value.is_nan() || value.abs() > MOST;
        if let Some((name, value)) = numbers.iter().find(|(_, value)| is_wrong(*value)) {
            return Err(Error::invalid(format!("{name} {value}"), "it must be a finite angle in radians"));
        }
        if !(self.fov_y > 0.0 && self.fov_y < PI) {
            return Err(Error::invalid(
                format!("fov_y {}", self.fov_y),
                "it must be between 0 and π radians",
            ));
        }
        if let Some(distance) = self.distance.filter(|distance| !(*distance > 0.0 && *distance <= MOST)) {
            return Err(Error::invalid(
                format!("distance {distance}"),
                "it must be finite and above 0, at most 1e18",
            ));
        }
        let target = self.target.unwrap_or_default();
        if target.to_array().iter().any(|v| is_wrong(*v)) {
            return Err(Error::invalid("target", "its coordinates must be finite, at most 1e18"));
        }
        Ok(())
    }

    /// Returns the camera that is not an orbit, if any.
    fn given(&self, scene: &Scene) -> Result<Option<Camera>> {
        match (&self.placed, &self.name) {
            (Some(camera), _) => Ok(Some(camera.clone())),
            (None, name) => name.as_ref().map(|name| named(scene, name)).transpose(),
        }
    }
}

/// The frame into which an object must fit.
///
/// ```
/// use taotie::studio::{CameraOptions, Framing, Viewpoint};
/// use taotie::{Material, Mesh, Scene};
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let distance = |size| -> taotie::Result<f64> {
///     let framing = Framing { size, all_around: false };
///     let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, &ball)?;
///     Ok(viewpoint.at(0.0).camera().world_from_view.axis(3).length())
/// };
/// assert!(distance([400, 800])? > 1.5 * distance([800, 800])?, "a narrow image is taken from afar");
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Framing {
    /// Width and height of the image, pixels, above 0.
    pub size: [u32; 2],
    /// `true` if the object must fit at every rotation of a turntable, so that the image does not jump.
    pub all_around: bool,
}

impl Framing {
    fn distance(self, outline: &Outline<'_>, orbit: &Orbit) -> f64 {
        let aspect = f64::from(self.size[0]) / f64::from(self.size[1]);
        let turns = if self.all_around { TURNS } else { 1 };
        let around = (0..turns).map(|i| TAU * f64::from(i) / f64::from(turns));
        let distances = around.map(|turn| {
            let turned = Orbit { azimuth: orbit.azimuth + turn, ..*orbit };
            outline.fitting_distance(&turned, aspect, FILL)
        });
        distances.fold(0.0, f64::max)
    }
}

/// A camera that can be rotated about the vertical through its target.
///
/// ```
/// use taotie::studio::{CameraOptions, Framing, Viewpoint};
/// use taotie::{Material, Mesh, Scene};
///
/// let scene = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let framing = Framing { size: [256, 256], all_around: true };
/// let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, &scene)?;
/// let cameras: Vec<_> = viewpoint.turn(12).map(|view| view.camera()).collect();
/// assert_eq!(cameras.len(), 12);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Viewpoint {
    camera: Camera,
    pivot: Vec3<f64>,
}

impl Viewpoint {
    /// Chooses the requested camera.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an option out of range, a name that no camera of the scene has (the message lists the
    /// existing ones), or a scene without triangles.
    pub fn choose(options: &CameraOptions, framing: Framing, scene: &Scene) -> Result<Self> {
        let outline = Outline::new(scene);
        let bounds = outline.bounds().ok_or_else(nothing_to_see)?;
        Chosen { options, given: options.given(scene)?, bounds }
            .viewpoint(|orbit| Ok(framing.distance(&outline, orbit)))
    }

    /// Like [`Viewpoint::choose`], but frames everything that the object covers during its motion, so that every
    /// image is taken from the same position. Leaves the scene at the end of the motion.
    ///
    /// # Errors
    /// As [`Viewpoint::choose`] and [`Motion::pose`].
    pub fn choose_moving(
        options: &CameraOptions,
        framing: Framing,
        scene: &mut Scene,
        motion: &Motion,
    ) -> Result<Self> {
        let mut all: Option<Bounds> = None;
        motion.tour(scene, |posed| all = united(all, posed.bounds()))?;
        let bounds = all.ok_or_else(nothing_to_see)?;
        Chosen { options, given: options.given(scene)?, bounds }.viewpoint(|orbit| {
            let mut distance = 0.0;
            motion.tour(scene, |posed| {
                distance = framing.distance(&Outline::new(posed), orbit).max(distance);
            })?;
            Ok(distance)
        })
    }

    /// Follows the requested camera of the file if it moves.
    ///
    /// # Errors
    /// [`Error::Invalid`] if `scene` has no camera of that name.
    pub fn follow(&mut self, options: &CameraOptions, scene: &Scene) -> Result<()> {
        if let Some(camera) = options.given(scene)? {
            self.camera = camera;
        }
        Ok(())
    }

    /// Returns the view after the object has turned by `turn` radians on a turntable.
    pub fn at(&self, turn: f64) -> View<'_> {
        View { viewpoint: self, turn }
    }

    /// Returns `count` views at equal steps of a full turn, from the front.
    pub fn turn(&self, count: u32) -> impl Iterator<Item = View<'_>> {
        (0..count).map(move |i| self.at(part_of_turn(i, count)))
    }
}

/// A viewpoint while a turntable turns the object; see [`Viewpoint::at`].
///
/// ```
/// use taotie::studio::{CameraOptions, Framing, Viewpoint};
/// use taotie::{Material, Mesh, Scene};
///
/// let ball = Scene::of_mesh(Mesh::sphere(1.0, 32, 16), Material::default())?;
/// let framing = Framing { size: [256, 256], all_around: false };
/// let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, &ball)?;
/// let from = |turn: f64| viewpoint.at(turn).camera().world_from_view.axis(3);
/// let (front, back) = (from(0.0), from(180f64.to_radians()));
/// assert!((front.x + back.x).abs() < 1e-6 && (front.y - back.y).abs() < 1e-6);
/// # Ok::<(), taotie::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View<'a> {
    viewpoint: &'a Viewpoint,
    turn: f64,
}

impl View<'_> {
    /// Returns the rotation of the object, in radians.
    pub fn angle(&self) -> f64 {
        self.turn
    }

    /// Returns the camera: it orbits the object, which is fixed in the scene.
    pub fn camera(&self) -> Camera {
        let mut camera = self.viewpoint.camera.clone();
        camera.world_from_view = self.world_from_studio() * camera.world_from_view;
        camera
    }

    /// Returns the camera before the object turned.
    pub fn front(&self) -> Camera {
        self.viewpoint.at(0.0).camera()
    }

    /// Returns the transform that keeps things fixed to the camera while the object turns.
    pub fn world_from_studio(&self) -> Mat4 {
        let (up, pivot) = (Vec3::new(0.0, 1.0, 0.0), self.viewpoint.pivot);
        Mat4::translation(pivot) * Mat4::rotation_about(up, -self.turn) * Mat4::translation(-pivot)
    }
}

/// A choice of camera for an object within `bounds`.
struct Chosen<'a> {
    options: &'a CameraOptions,
    /// The placed camera, or the one of the file.
    given: Option<Camera>,
    bounds: Bounds,
}

impl Chosen<'_> {
    /// Returns the placed camera or the one of the file, else an orbit, by default at the distance that `fit` finds.
    fn viewpoint(self, fit: impl FnOnce(&Orbit) -> Result<f64>) -> Result<Viewpoint> {
        self.options.check()?;
        let CameraOptions { azimuth, elevation, distance, target, fov_y, .. } = *self.options;
        let pivot = target.unwrap_or(self.bounds.center());
        if let Some(camera) = self.given {
            return Ok(Viewpoint { camera, pivot });
        }
        let mut orbit = Orbit { azimuth, elevation, distance: 0.0, target: pivot, fov_y };
        orbit.distance = distance.map_or_else(|| fit(&orbit), Ok)?;
        let reach = self.bounds.diagonal() / 2.0 + (pivot - self.bounds.center()).length();
        Ok(Viewpoint { camera: orbit.camera(reach), pivot })
    }
}

fn nothing_to_see() -> Error {
    Error::invalid("scene", "it has no triangles")
}

fn united(a: Option<Bounds>, b: Option<Bounds>) -> Option<Bounds> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.united(&b)),
        (one, other) => one.or(other),
    }
}

fn named(scene: &Scene, name: &str) -> Result<Camera> {
    if let Some(camera) = scene.cameras().iter().find(|camera| camera.name == name) {
        return Ok(camera.clone());
    }
    // Cameras without a name can be chosen by index.
    if let Some(camera) = name.parse::<usize>().ok().and_then(|index| scene.cameras().get(index)) {
        return Ok(camera.clone());
    }
    let title = |(i, c): (usize, &Camera)| if c.name.is_empty() { i.to_string() } else { c.name.clone() };
    let names: Vec<String> = scene.cameras().iter().enumerate().map(title).collect();
    let why = match names.is_empty() {
        true => "the file has no cameras; use an orbit".into(),
        false => format!("the file has no such camera; it has: {}", names.join(", ")),
    };
    Err(Error::invalid(format!("camera {name}"), why))
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::mesh::Mesh;
    use taotie_engine::scene::Material;

    const SQUARE: Framing = Framing { size: [64, 64], all_around: false };

    fn ball() -> Scene {
        Scene::of_mesh(Mesh::sphere(1.0, 16, 8), Material::default()).unwrap()
    }

    #[test]
    fn a_turntable_keeps_its_distance_and_looks_at_the_object() {
        let options = CameraOptions { distance: Some(4.0), ..CameraOptions::default() };
        let viewpoint = Viewpoint::choose(&options, SQUARE, &ball()).unwrap();
        for view in viewpoint.turn(5) {
            let camera = view.camera().world_from_view;
            let target = camera.transform_point(Vec3::new(0.0, 0.0, -4.0));
            assert!(target.length() < 1e-6, "{target:?} after {}", view.angle());
        }
        assert_eq!(viewpoint.turn(4).nth(1).unwrap().angle(), TAU / 4.0);
    }

    #[test]
    fn a_placed_camera_is_used_as_it_is_and_turns_about_the_target() {
        let far = CameraOptions { distance: Some(9.0), ..CameraOptions::default() };
        let camera = Viewpoint::choose(&far, SQUARE, &ball()).unwrap().at(0.0).camera();
        let options = CameraOptions { placed: Some(camera.clone()), name: Some("a".into()), ..far };
        let viewpoint = Viewpoint::choose(&options, SQUARE, &ball()).unwrap();
        assert_eq!(viewpoint.at(0.0).camera(), camera);
        let turned = viewpoint.at(1.0).camera().world_from_view;
        assert!(turned.transform_point(Vec3::new(0.0, 0.0, -9.0)).length() < 1e-6);
    }

    #[test]
    fn what_cannot_be_seen_or_is_out_of_range_is_refused() {
        let why = |options: CameraOptions, scene: &Scene| {
            Viewpoint::choose(&options, SQUARE, scene).unwrap_err().to_string()
        };
        let options = CameraOptions::default;
        assert!(why(options(), &Scene::default()).contains("no triangle"));
        assert!(why(CameraOptions { fov_y: 4.0, ..options() }, &ball()).contains("π"));
        assert!(why(CameraOptions { azimuth: f64::NAN, ..options() }, &ball()).contains("azimuth"));
        assert!(why(CameraOptions { distance: Some(0.0), ..options() }, &ball()).contains("distance"));
        assert!(why(CameraOptions { distance: Some(1e39), ..options() }, &ball()).contains("at most 1e18"));
        let far = Some(Vec3::splat(-1e39));
        assert!(why(CameraOptions { target: far, ..options() }, &ball()).contains("target"));
        assert!(why(CameraOptions { name: Some("a".into()), ..options() }, &ball()).contains("no camera"));
    }
}
