//! A view of a worst patch from the direction in which it is seen.

use super::footprint::Footprint;
use super::pair::{Look, Sample};
use super::window::Window;
use crate::bake::{LookupPoint, Scan};
use crate::compare::Field;
use crate::error::Result;
use crate::math::{Mat4, Vec3};
use crate::parallel;
use crate::scene::{Camera, Projection};
use crate::trace::Ray;

/// Half the width of the picture in radii of the patch.
const MARGIN: f64 = 1.5;
/// The distance of the viewer in radii of the patch: closer parts of the object are cut away.
const AWAY: f64 = 4.0;
/// The angle used if one of the surfaces shows nothing, in degrees.
const NOTHING_DEG: f32 = 90.0;

/// The quantity by which a patch is the worst.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PatchQuantity {
    /// The angle between normals, degrees.
    Angle,
    /// The difference of base colours, CIEDE2000.
    Color,
}

/// A parallel view of a patch, from the direction in which it is seen, with some margin.
#[derive(Debug, Clone, Copy)]
pub struct PatchView {
    center: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    toward: Vec3<f64>,
    /// Half the width and height, in model units.
    half: f64,
    /// The distance of the viewer, in model units.
    away: f64,
    /// The distance of the farthest surface from the viewer, in model units.
    far: f64,
}

impl PatchView {
    /// Makes the view of a window on an object with this diagonal, in model units.
    pub fn of(window: Window, diagonal: f64) -> Self {
        let toward = Vec3::from_array(window.toward);
        // Up is that of the world, unless the view is along it.
        let world_up =
            if toward.y.abs() < 0.95 { Vec3::new(0.0, 1.0, 0.0) } else { Vec3::new(0.0, 0.0, -1.0) };
        let right = world_up.cross(toward).normalize();
        let radius = window.radius.max(diagonal * 1e-6);
        let away = radius * AWAY;
        Self {
            center: Vec3::from_array(window.center),
            right,
            up: toward.cross(right),
            toward,
            half: radius * MARGIN,
            away,
            far: away + diagonal,
        }
    }

    /// Returns the camera for a renderer.
    pub fn camera(&self) -> Camera {
        let eye = self.center + self.toward * self.away;
        Camera {
            name: String::new(),
            world_from_view: Mat4::from_axes(self.right, self.up, self.toward, eye),
            projection: Projection::Orthographic {
                half_width: self.half,
                half_height: self.half,
                near: self.away * 1e-3,
                far: self.far,
            },
        }
    }

    /// Compares the two surfaces at each pixel, sampled as finely as the scan has detail, as in a close-up; NaN where
    /// there is nothing to compare. An angle counts as 90° where only one of them shows anything.
    ///
    /// # Errors
    /// As [`Field::new`].
    pub fn differences(&self, [scan, asset]: [&Scan; 2], of: PatchQuantity, side: u32) -> Result<Field> {
        let footprint = Footprint::of(scan);
        let toward = self.toward.to_f32();
        let difference = |i: usize| {
            let ray = self.ray(i as u32, side);
            let hits = [scan, asset].map(|surface| surface.first_seen(&ray, self.far as f32));
            let [Some(on_scan), Some(on_asset)] = hits.map(|hit| hit.map(|hit| hit.point())) else {
                let is_lost = of == PatchQuantity::Angle && hits.iter().any(Option::is_some);
                return if is_lost { NOTHING_DEG } else { f32::NAN };
            };
            let width = footprint.at(scan, on_scan);
            let [seen, shown] = [(scan, on_scan), (asset, on_asset)].map(|(surface, point)| {
                let mut look = Look::default();
                let sample = Sample { at: LookupPoint { point, width }, toward };
                look.add(surface, sample, of == PatchQuantity::Color);
                look
            });
            match of {
                PatchQuantity::Angle => seen.angle_deg(&shown),
                PatchQuantity::Color => seen.color_difference(&shown),
            }
        };
        Field::new(side, side, parallel::collect((side * side) as usize, difference))
    }

    /// Returns the ray through the centre of a pixel.
    fn ray(&self, pixel: u32, side: u32) -> Ray {
        let from_middle = |k: u32| ((f64::from(k) + 0.5) / f64::from(side) * 2.0 - 1.0) * self.half;
        let [x, y] = [from_middle(pixel % side), -from_middle(pixel / side)];
        let origin = self.center + self.right * x + self.up * y + self.toward * self.away;
        Ray::new(origin.to_f32(), -self.toward.to_f32())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::scalar;
    use crate::mesh::{Mesh, MeshData};
    use crate::scene::{Material, Scene};

    /// A square in the plane z = 0 whose right half is tilted by this angle. The halves share no vertices.
    fn bent(degrees: f64) -> Scan {
        let (sin, cos) = (scalar::sin(degrees.to_radians()), scalar::cos(degrees.to_radians()));
        let at = |x: f64, y: f64| Vec3::new(x, y, -sin / cos * x.max(0.0)).to_f32();
        let positions =
            [[-1.0, 0.0], [0.0, 1.0]].as_flattened().iter().flat_map(|x| [at(*x, -1.0), at(*x, 1.0)]);
        let (flat, leaning) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(sin, 0.0, cos).to_f32());
        let mesh = Mesh::new(MeshData {
            positions: positions.collect(),
            normals: [[flat; 4], [leaning; 4]].concat(),
            triangles: vec![[0, 2, 3], [0, 3, 1], [4, 6, 7], [4, 7, 5]],
            ..MeshData::default()
        });
        Scan::new(Scene::of_mesh(mesh.unwrap(), Material::default()).unwrap()).unwrap()
    }

    #[test]
    fn the_picture_shows_where_the_difference_is() {
        let window = Window { radius: 0.5, toward: [0.0, 0.0, 1.0], ..Window::default() };
        let view = PatchView::of(window, 2.0);
        let field = view.differences([&bent(0.0), &bent(20.0)], PatchQuantity::Angle, 16).unwrap();
        let row = &field.values()[8 * 16..9 * 16];
        assert!(row[..7].iter().all(|angle| *angle < 1e-3), "the left half is the same: {row:?}");
        assert!(
            row[9..].iter().all(|angle| (angle - 20.0).abs() < 0.01),
            "the right half is tilted: {row:?}"
        );
        let Projection::Orthographic { half_width, .. } = view.camera().projection else {
            panic!("parallel")
        };
        assert_eq!(half_width, 0.75);
    }
}
