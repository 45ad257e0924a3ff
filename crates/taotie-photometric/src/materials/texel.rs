//! A texel of a map: the point of the model that it shows.

use taotie_engine::math::Vec3;

/// A texel whose centre a triangle covers.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Texel {
    /// Its number, row by row from the top.
    pub index: u32,
    /// The triangle that covers its centre.
    pub triangle: u32,
    /// World space.
    pub position: Vec3<f64>,
    /// Unit normal of the triangle.
    pub facet: Vec3<f64>,
    /// Unit normal, interpolated between vertices.
    pub smooth: Vec3<f64>,
    /// Unit normal as a renderer shades it: with the normal map.
    pub normal: Vec3<f64>,
    /// The variance of the normal map's vectors within the texel, [0, 1].
    pub variance: f64,
    /// The angle by which the normal differs from those of the texels around, root mean square, radians.
    pub bend: f64,
    /// The side of the texel on the surface, model units.
    pub width: f64,
    /// The model's metallic there.
    pub metallic: f64,
    /// The model's alpha there; 1 if it is opaque.
    pub alpha: f64,
}
