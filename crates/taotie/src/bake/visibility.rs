//! Which points of a surface can be seen from outside, or from within a room.

use super::scan::Scan;
use super::sights::{SightLine, Sights};
use crate::math::Vec3;
use crate::mesh::Point;

/// Determines which points of a surface a viewer can see.
///
/// A point is visible from outside if nothing hides it in the direction of its facet normal or in one of 256 fixed
/// directions on its front; for double-sided materials, on either side. If less than half of the area is visible in
/// this way, and more of it from the largest free space within, the surface is an interior (a room, a tomb, a cave),
/// and its points are seen from there.
#[derive(Clone, Copy)]
pub struct Visibility<'a> {
    surface: &'a Scan,
    sights: &'a Sights,
}

impl<'a> Visibility<'a> {
    /// Analyses a surface.
    pub fn of(surface: &'a Scan) -> Self {
        Self { surface, sights: surface.sights() }
    }

    /// Returns the viewpoints in the free space of an interior; none if it is seen from outside.
    pub fn places(&self) -> &'a [Vec3] {
        self.sights.places()
    }

    /// Returns `true` if the surface is seen from within: a room, a tomb or a cave.
    pub fn is_interior(&self) -> bool {
        !self.sights.places().is_empty()
    }

    /// Returns the line of sight closest to the normal at a point. `None` if it is hidden.
    pub fn sight_line(&self, point: Point) -> Option<SightLine> {
        self.sights.sight_line(self.surface.ground(), point)
    }
}
