//! The angle between two vectors.

use taotie_engine::math::{Vec3, scalar};

/// The angle between two vectors, radians; good to the last digits for small angles too.
pub fn angle(a: Vec3<f64>, b: Vec3<f64>) -> f64 {
    scalar::atan2(a.cross(b).length(), a.dot(b))
}
