//! The number type of every formula: a scalar, a SIMD pack, a dual number or a recorder of expressions.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The result of comparing two [`Lane`]s.
pub trait Mask: Copy {
    /// True if both are true.
    fn and(self, other: Self) -> Self;
    /// True if either is true.
    fn or(self, other: Self) -> Self;
    /// True if `self` is false.
    fn not(self) -> Self;
    /// Returns true if any lane is true.
    fn any(self) -> bool;
}

/// A number or a pack of numbers; formulas use nothing else.
///
/// Implementations for `f32`, `f64` and the packs of eight and sixteen `f32` round the same way: every operation is
/// one of IEEE 754's basic operations, exact, or one of the polynomials of [`super::poly`] in these, so lane `i` of a
/// pack has the bits that `f32` would have. There is no fused multiply-add and no approximate reciprocal. Branches
/// are written as [`Lane::select`].
///
/// Constants are created from an existing value with [`Lane::lit`], since a pack needs the proof of its SIMD level
/// and a recorder its graph, and values carry both.
pub trait Lane:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The result of a comparison.
    type Mask: Mask;

    /// The constant `value`, rounded to this type.
    fn lit(self, value: f64) -> Self;
    /// The square root, correctly rounded; NaN below zero.
    fn sqrt(self) -> Self;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The largest integer not above `self`.
    fn floor(self) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn le(self, other: Self) -> Self::Mask;
    /// `if_true` if `mask` is true, else `if_false`.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// `self · 2^n` for an integral `n` in [-126, 127].
    fn ldexp(self, n: Self) -> Self;
    /// Splits a normal positive number into a mantissa in [0.5, 1) and an integral exponent, `self = m · 2^e`.
    fn frexp(self) -> (Self, Self);
    /// e^self. Numbers and packs: [`super::poly::exp`], with its range.
    fn exp(self) -> Self;
    /// 2^self. Numbers and packs: [`super::poly::exp2`], with its range.
    fn exp2(self) -> Self;
    /// The natural logarithm, for `self` above 0. Numbers and packs: [`super::poly::ln`], with its range.
    fn ln(self) -> Self;
    /// The logarithm to base 2, for `self` above 0. Numbers and packs: [`super::poly::log2`], with its range.
    fn log2(self) -> Self;
    /// self^exponent; `self` below 0 counts as 0. Numbers and packs: [`super::poly::pow`], with its range.
    fn pow(self, exponent: Self) -> Self;

    /// The minimum; `other` if either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// The maximum; `other` if either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }

    /// `self` clamped to [low, high].
    #[inline(always)]
    fn clamp(self, low: f64, high: f64) -> Self {
        self.max(self.lit(low)).min(self.lit(high))
    }

    /// `self · self`.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
}

impl Mask for bool {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self | other
    }
    #[inline(always)]
    fn not(self) -> Self {
        !self
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
}
