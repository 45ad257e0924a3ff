//! A photograph taken by a known camera under a known light.

use std::path::PathBuf;
use taotie_engine::math::{Mat4, Vec3, scalar};

/// A photograph with its camera and light.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// The image file.
    pub path: PathBuf,
    /// An image of the same size, black where the photograph does not count; `None` if all of it counts.
    pub mask: Option<PathBuf>,
    /// A rigid transform from view space to the model's world space. The camera looks along −z with +y up.
    pub world_from_view: Mat4,
    /// The projection.
    pub lens: Lens,
    /// The light.
    pub lamp: Lamp,
}

/// A projection without distortion. What is not stated follows from the size of the image.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Lens {
    /// Focal lengths across and down, pixels.
    pub focal: [Option<f64>; 2],
    /// Full angles of view across and down, radians.
    pub angle: [Option<f64>; 2],
    /// The principal point from the top left corner, pixels.
    pub centre: [Option<f64>; 2],
    /// Width and height of the image, pixels.
    pub size: [Option<f64>; 2],
}

/// The camera of photographs from one position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// A rigid transform from view space to the model's world space.
    pub world_from_view: Mat4,
    /// The projection.
    pub lens: Lens,
}

/// A light in world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lamp {
    /// Where it is.
    pub place: LampPlace,
    /// Linear RGB, at least 0: the irradiance on a surface that faces a distant light, or the intensity of a near one, whose
    /// irradiance falls with the square of the distance. A white matt surface reflects the irradiance divided by π.
    pub intensity: [f64; 3],
}

/// The place of a light, world space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LampPlace {
    /// Far away, in this unit direction.
    Towards(Vec3<f64>),
    /// At this position.
    At(Vec3<f64>),
}

/// A projection onto an image of known size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    focal: [f64; 2],
    centre: [f64; 2],
    size: [f64; 2],
}

/// A point as a camera sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projected {
    /// Its place in the image, pixels from the top left corner.
    pub place: [f64; 2],
    /// The size of a pixel at its distance, model units.
    pub pixel: f64,
}

impl Lens {
    /// Returns the stated size as text if it differs from that of an image.
    pub fn other_size(&self, size: [u32; 2]) -> Option<String> {
        let is_other = |axis: usize| self.size[axis].is_some_and(|stated| stated != f64::from(size[axis]));
        let text = |stated: Option<f64>| stated.map_or("?".to_owned(), |v| v.to_string());
        (is_other(0) || is_other(1)).then(|| self.size.map(text).join("x"))
    }

    /// Returns the projection onto an image of this size.
    pub fn projection(&self, size: [u32; 2]) -> Projection {
        let size = size.map(f64::from);
        let of_angle =
            |axis: usize| self.angle[axis].map(|angle| 0.5 * size[axis] / scalar::tan(0.5 * angle));
        let own = |axis: usize| self.focal[axis].or_else(|| of_angle(axis));
        // Pixels are square unless both are stated; a lens without both has been rejected.
        let focal = [own(0).or_else(|| own(1)), own(1).or_else(|| own(0))].map(|focal| focal.unwrap_or(1.0));
        let centre = [0, 1].map(|axis| self.centre[axis].unwrap_or(0.5 * size[axis]));
        Projection { focal, centre, size }
    }
}

impl Projection {
    /// Returns the size of a pixel at a depth, model units.
    pub fn pixel(&self, depth: f64) -> f64 {
        depth / self.focal[0].max(self.focal[1])
    }

    /// Returns a point of view space as the camera sees it; `None` if it is behind the camera or outside the image.
    pub fn project(&self, view: Vec3<f64>) -> Option<Projected> {
        let depth = -view.z;
        if depth.is_nan() || depth <= 0.0 {
            return None;
        }
        let place = [
            self.centre[0] + self.focal[0] * view.x / depth,
            self.centre[1] - self.focal[1] * view.y / depth,
        ];
        let inside = (0..2).all(|axis| place[axis] >= 0.0 && place[axis] <= self.size[axis]);
        inside.then_some(Projected { place, pixel: self.pixel(depth) })
    }

    /// Returns the direction of view space that a place in the image shows; its z is −1.
    pub fn direction(&self, [x, y]: [f64; 2]) -> Vec3<f64> {
        Vec3::new((x - self.centre[0]) / self.focal[0], (self.centre[1] - y) / self.focal[1], -1.0)
    }

    /// Returns the distance of a place from the nearest border, pixels.
    pub fn margin(&self, place: [f64; 2]) -> f64 {
        (0..2).map(|axis| place[axis].min(self.size[axis] - place[axis])).fold(f64::INFINITY, f64::min)
    }
}

impl Lamp {
    /// Returns the vector from a point to the light, not normalised, and the irradiance on a surface that faces it.
    pub fn seen_from(&self, point: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>) {
        let intensity = Vec3::from_array(self.intensity);
        match self.place {
            LampPlace::Towards(direction) => (direction, intensity),
            LampPlace::At(position) => {
                let to = position - point;
                (to, intensity / to.dot(to).max(1e-12))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_see_the_points_that_they_project() {
        let lens = Lens { focal: [Some(500.0), None], centre: [None, Some(140.0)], ..Lens::default() };
        let projection = lens.projection([400, 300]);
        let point = Vec3::new(0.3, -0.2, -2.0);
        let seen = projection.project(point).unwrap();
        assert_eq!(seen.place, [275.0, 190.0]);
        assert_eq!(seen.pixel, 2.0 / 500.0);
        assert!((projection.direction(seen.place) * 2.0 - point).length() < 1e-12);
        assert_eq!(projection.margin(seen.place), 110.0);
        assert!(projection.project(Vec3::new(0.0, 0.0, 1.0)).is_none());
        assert!(projection.project(Vec3::new(2.0, 0.0, -1.0)).is_none());
        let angle = Lens { angle: [Some(2.0 * scalar::atan2(0.5, 1.0)), None], ..Lens::default() };
        assert!((angle.projection([400, 300]).direction([400.0, 150.0]).x - 0.5).abs() < 1e-12);
    }
}
