//! The views of a page: the initial camera as an orbit around a point, bookmarks, and the camera and lights that a
//! link describes.

use crate::Fact;
use serde::{Deserialize, Serialize};
use taotie_engine::Warnings;
use taotie_engine::math::{Vec3, scalar};
use taotie_engine::scene::{Bounds, Camera, Projection};

/// A view of a page, with a title and a text.
///
/// ```
/// use taotie_report::viewer::Bookmark;
///
/// let mask = Bookmark { title: "The mask".into(), link: "light=raking&from=-75,10".into(), ..Bookmark::default() };
/// assert_eq!(mask.text, "");
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bookmark {
    /// The title.
    pub title: String,
    /// A description of the view; may be empty.
    #[serde(default)]
    pub text: String,
    /// The fragment of a link to the view, without `#`.
    pub link: String,
}

/// A position on a sphere around a target, and the field of view from there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Orbit {
    /// Degrees to the right of the front, which is +z.
    pub azimuth: f64,
    /// Degrees above the horizon.
    pub elevation: f64,
    /// Model units.
    pub distance: f64,
    /// World space.
    pub target: [f64; 3],
    /// The vertical field of view in degrees, for pictures of this aspect ratio or wider.
    pub fov_y: f64,
    pub aspect: f64,
    /// The centre and radius of a sphere around the model.
    pub center: [f64; 3],
    pub radius: f64,
}

/// The vertical field of view for cameras without one, degrees.
const FOV_Y: f64 = 30.0;

impl Orbit {
    /// Returns the orbit of a camera looking at the model, around the point of its axis nearest the model's centre.
    pub fn new(camera: &Camera, bounds: &Bounds, warnings: &mut Warnings) -> Self {
        let [right, back, eye] = [0, 2, 3].map(|axis| camera.world_from_view.axis(axis));
        let (center, radius) = (bounds.center(), bounds.diagonal() / 2.0);
        let lens = Lens::new(&camera.projection, warnings);
        warnings.note("a tilted camera is shown upright", usize::from(right.y.abs() > 1e-6));
        let seen = (eye - center).dot(back);
        let distance = match lens.half_height {
            Some(half) => half / scalar::tan(FOV_Y.to_radians() / 2.0),
            None if seen > 0.0 => seen,
            None => radius,
        };
        let target = eye - back * if lens.half_height.is_some() { seen } else { distance };
        Self {
            azimuth: scalar::atan2(back.x, back.z).to_degrees(),
            elevation: scalar::atan2(back.y, Vec3::new(back.x, 0.0, back.z).length()).to_degrees(),
            distance,
            target: target.to_array(),
            fov_y: lens.fov_y,
            aspect: lens.aspect,
            center: center.to_array(),
            radius,
        }
    }
}

/// The parts of a projection that an orbit keeps.
struct Lens {
    fov_y: f64,
    aspect: f64,
    /// Half the height of an orthographic view.
    half_height: Option<f64>,
}

impl Lens {
    fn new(projection: &Projection, warnings: &mut Warnings) -> Self {
        match *projection {
            Projection::Perspective { fov_y, aspect, .. } => {
                Self { fov_y: fov_y.to_degrees(), aspect: aspect.unwrap_or(1.0), half_height: None }
            }
            Projection::Orthographic { half_width, half_height, .. } => {
                warnings.note("an orthographic camera is shown in perspective", 1);
                let half_height = half_height.abs();
                Self { fov_y: FOV_Y, aspect: half_width.abs() / half_height, half_height: Some(half_height) }
            }
        }
    }
}

/// The content of a page that its manifests describe.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    pub title: String,
    pub facts: Vec<Fact>,
    pub bookmarks: Vec<Bookmark>,
    pub camera: Option<Orbit>,
    /// Sixteen numbers per light.
    pub lights: Vec<[f32; 16]>,
    pub ambient: [f32; 3],
}

/// The camera and the lights of a view.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct View {
    pub eye: Vec3<f64>,
    pub target: Vec3<f64>,
    pub fov_y: f64,
    pub lights: Vec<Directional>,
    /// Ambient radiance.
    pub fill: [f64; 3],
}

/// A directional light.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Directional {
    /// Unit vector to the light.
    pub to: Vec3<f64>,
    /// Linear RGB.
    pub color: [f64; 3],
}

impl View {
    /// Returns the view of a link; `None` if the page has no camera.
    pub fn of(link: &str, outline: &Outline) -> Option<Self> {
        let (link, orbit) = (Link::new(link), outline.camera?);
        let [azimuth, elevation, distance] =
            link.numbers("view", [orbit.azimuth, orbit.elevation, orbit.distance].map(six_digits));
        let target = Vec3::from_array(link.numbers("target", orbit.target.map(six_digits)));
        let back = direction([azimuth, elevation]);
        let raking = link.word("light") == Some("raking");
        let [fill] = link.numbers("fill", [0.05]);
        Some(Self {
            eye: target + back * distance,
            target,
            fov_y: orbit.fov_y,
            lights: if raking { vec![link.raking([azimuth, elevation])] } else { given(outline) },
            fill: if raking { [fill; 3] } else { outline.ambient.map(f64::from) },
        })
    }
}

/// The state in a link, in the format of `viewer/src/state.ts` and with the defaults of the page.
struct Link<'a> {
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Link<'a> {
    fn new(text: &'a str) -> Self {
        Self { pairs: text.split('&').filter_map(|pair| pair.split_once('=')).collect() }
    }

    fn word(&self, name: &str) -> Option<&'a str> {
        self.pairs.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }

    fn numbers<const N: usize>(&self, name: &str, usual: [f64; N]) -> [f64; N] {
        let read = |text: &str| text.parse().ok().filter(|number: &f64| number.is_finite());
        let numbers = |text: &str| text.split(',').map(read).collect::<Option<Vec<_>>>()?.try_into().ok();
        self.word(name).and_then(numbers).unwrap_or(usual)
    }
}

impl Link<'_> {
    /// Returns the raking light for a camera at these angles.
    fn raking(&self, camera: [f64; 2]) -> Directional {
        let local = direction(self.numbers("from", [-60.0, 20.0]));
        let [strength] = self.numbers("strength", [3.0]);
        let to = if self.word("fixed") == Some("object") { local } else { turned(local, camera) };
        Directional { to, color: [strength; 3] }
    }
}

/// Returns the directional lights among those of the page.
fn given(outline: &Outline) -> Vec<Directional> {
    let light = |numbers: &[f32; 16]| {
        let [x, y, z, kind, r, g, b, ..] = numbers.map(f64::from);
        (kind == 0.0).then(|| Directional { to: Vec3::new(x, y, z), color: [r, g, b] })
    };
    outline.lights.iter().filter_map(light).collect()
}

/// Returns the unit direction at an azimuth to the right of +z and an elevation above the horizon, degrees.
fn direction([azimuth, elevation]: [f64; 2]) -> Vec3<f64> {
    let (a, e) = (azimuth.to_radians(), elevation.to_radians());
    Vec3::new(scalar::sin(a) * scalar::cos(e), scalar::sin(e), scalar::cos(a) * scalar::cos(e))
}

/// Transforms a direction relative to the camera to world space.
fn turned(local: Vec3<f64>, [azimuth, elevation]: [f64; 2]) -> Vec3<f64> {
    let back = direction([azimuth, elevation]);
    let a = azimuth.to_radians();
    let right = Vec3::new(scalar::cos(a), 0.0, -scalar::sin(a));
    right * local.x + back.cross(right) * local.y + back * local.z
}

/// Rounds a number to the six digits used in links; 0 has no sign.
pub(super) fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie_engine::scene;

    #[test]
    fn an_orbit_is_restored() {
        let target = Vec3::new(0.5, 0.25, -0.125);
        let (azimuth, elevation, fov_y) = (0.6, -0.3, 0.5);
        let placed = scene::Orbit { azimuth, elevation, distance: 4.0, target, fov_y };
        let one = Vec3::splat(1.0);
        let bounds = Bounds { min: target - one, max: target + one };
        let mut warnings = Warnings::default();
        let found = Orbit::new(&placed.camera(1.0), &bounds, &mut warnings);
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{found:?}");
        close(found.azimuth.to_radians(), azimuth);
        close(found.elevation.to_radians(), elevation);
        close(found.fov_y.to_radians(), fov_y);
        close(found.distance, 4.0);
        found.target.iter().zip(target.to_array()).for_each(|(a, b)| close(*a, b));
        assert!(warnings.is_empty());
    }

    fn outline() -> Outline {
        let camera = Orbit {
            azimuth: 90.0,
            elevation: 0.0,
            distance: 4.0,
            target: [0.0; 3],
            fov_y: 30.0,
            aspect: 1.0,
            center: [0.0; 3],
            radius: 1.0,
        };
        let sun = [0.0, 1.0, 0.0, 0.0, 2.0, 2.0, 1.0, 1e18, 0.0, 0.0, 1.0, -2.0, -3.0, 0.0, 0.0, 0.0];
        let mut lamp = sun;
        lamp[3] = 1.0;
        Outline {
            title: "A jue".into(),
            facts: Vec::new(),
            bookmarks: Vec::new(),
            camera: Some(camera),
            lights: vec![sun, lamp],
            ambient: [0.1; 3],
        }
    }

    fn assert_close(a: Vec3<f64>, b: [f64; 3]) {
        assert!((a - Vec3::from_array(b)).length() < 1e-12, "{a:?}, {b:?}");
    }

    #[test]
    fn an_empty_link_is_the_initial_view_with_its_directional_lights() {
        let view = View::of("", &outline()).unwrap();
        assert_close(view.eye, [4.0, 0.0, 0.0]);
        assert_eq!((view.lights.len(), view.fill), (1, [f64::from(0.1f32); 3]));
        assert_close(view.lights[0].to, [0.0, 1.0, 0.0]);
    }

    #[test]
    fn a_link_moves_camera_and_light() {
        let of = |link| View::of(link, &outline()).unwrap();
        let view = of("view=0,90,2&target=1,0,0&light=raking&from=0,90&strength=2&fill=0");
        assert_close(view.eye, [1.0, 2.0, 0.0]);
        // The camera looks down, and its up direction is −z.
        assert_close(view.lights[0].to, [0.0, 0.0, -1.0]);
        assert_eq!((view.lights[0].color, view.fill), ([2.0; 3], [0.0; 3]));
        assert_close(of("light=raking&from=0,90&fixed=object").lights[0].to, [0.0, 1.0, 0.0]);
        assert_eq!(of("view=1,2&target=a,b,c&strength=inf"), of(""));
    }
}
