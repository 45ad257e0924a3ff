//! Two- and three-component vectors over any [`Lane`].

use super::Lane;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A vector of two components.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vec2<L = f32> {
    /// First component.
    pub x: L,
    /// Second component.
    pub y: L,
}

/// A vector of three components: a point, a direction or a linear RGB colour.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vec3<L = f32> {
    /// First component.
    pub x: L,
    /// Second component.
    pub y: L,
    /// Third component.
    pub z: L,
}

impl<L> Vec2<L> {
    /// A vector from its components.
    #[inline(always)]
    pub const fn new(x: L, y: L) -> Self {
        Self { x, y }
    }
}

impl<L: Lane> Vec2<L> {
    /// The z component of the cross product: twice the signed area of the triangle that both span.
    #[inline(always)]
    pub fn cross(self, o: Self) -> L {
        self.x * o.y - self.y * o.x
    }
}

impl<L: Lane> Add for Vec2<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y)
    }
}

impl<L: Lane> Sub for Vec2<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y)
    }
}

impl<L: Lane> Mul<L> for Vec2<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: L) -> Self {
        Self::new(self.x * s, self.y * s)
    }
}

impl<L> Vec3<L> {
    /// A vector from its components.
    #[inline(always)]
    pub const fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z }
    }

    /// A vector from an array.
    #[inline(always)]
    pub fn from_array([x, y, z]: [L; 3]) -> Self {
        Self { x, y, z }
    }

    /// The components as an array.
    #[inline(always)]
    pub fn to_array(self) -> [L; 3] {
        [self.x, self.y, self.z]
    }

    /// Applies `f` to each component.
    #[inline(always)]
    pub fn map<M>(self, mut f: impl FnMut(L) -> M) -> Vec3<M> {
        Vec3::new(f(self.x), f(self.y), f(self.z))
    }
}

impl<L: Lane> Vec3<L> {
    /// All components equal to `value`.
    #[inline(always)]
    pub fn splat(value: L) -> Self {
        Self::new(value, value, value)
    }

    /// The dot product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> L {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// The cross product, right-handed.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }

    /// The Euclidean length.
    #[inline(always)]
    pub fn length(self) -> L {
        self.dot(self).sqrt()
    }

    /// The unit vector of this direction; NaN for the zero vector.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * (self.x.lit(1.0) / self.length())
    }

    /// The unit vector of this direction, or `fallback` if the length is not above 1e-18.
    #[inline(always)]
    pub fn normalize_or(self, fallback: Self) -> Self {
        let squared = self.dot(self);
        let long = squared.lit(1e-36).lt(squared);
        Self::select(long, self * (squared.lit(1.0) / squared.sqrt()), fallback)
    }

    /// A unit vector perpendicular to this unit vector, without a preferred direction.
    ///
    /// Source: Duff et al. 2017, "Building an orthonormal basis, revisited", listing 3.
    #[inline(always)]
    pub fn any_perpendicular(self) -> Self {
        let one = self.x.lit(1.0);
        let sign = L::select(self.z.lt(self.x.lit(0.0)), -one, one);
        let a = -one / (sign + self.z);
        Self::new(one + sign * self.x * self.x * a, sign * self.x * self.y * a, -sign * self.x)
    }

    /// The component-wise product.
    #[inline(always)]
    pub fn mul_elements(self, o: Self) -> Self {
        Self::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }

    /// `if_true` if `mask` is true, else `if_false`.
    #[inline(always)]
    pub fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self::new(
            L::select(mask, if_true.x, if_false.x),
            L::select(mask, if_true.y, if_false.y),
            L::select(mask, if_true.z, if_false.z),
        )
    }
}

impl Vec3<f32> {
    /// Each component widened.
    pub fn to_f64(self) -> Vec3<f64> {
        Vec3::new(f64::from(self.x), f64::from(self.y), f64::from(self.z))
    }

    /// Returns true if all components are finite, neither infinite nor NaN.
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl Vec3<f64> {
    /// Each component rounded.
    pub fn to_f32(self) -> Vec3<f32> {
        Vec3::new(self.x as f32, self.y as f32, self.z as f32)
    }
}

impl<L: Lane> Add for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<L: Lane> AddAssign for Vec3<L> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<L: Lane> Sub for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<L: Lane> Neg for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<L: Lane> Mul<L> for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: L) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<L: Lane> Div<L> for Vec3<L> {
    type Output = Self;
    #[inline(always)]
    fn div(self, s: L) -> Self {
        Self::new(self.x / s, self.y / s, self.z / s)
    }
}

/// Vectors are serialised as arrays of their components.
impl<L: Copy + Serialize> Serialize for Vec3<L> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [self.x, self.y, self.z].serialize(serializer)
    }
}

impl<'de, L: Deserialize<'de>> Deserialize<'de> for Vec3<L> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let [x, y, z] = <[L; 3]>::deserialize(deserializer)?;
        Ok(Self { x, y, z })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_perpendicular_is_perpendicular_everywhere() {
        for (x, y, z) in
            [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.6, 0.8, 0.0), (0.0, 0.6, -0.8), (1.0, 0.0, -0.0)]
        {
            let n = Vec3::new(x, y, z);
            let t = n.any_perpendicular();
            assert!(t.dot(n).abs() < 1e-15 && (t.length() - 1.0).abs() < 1e-15, "{n:?} {t:?}");
        }
    }
}
