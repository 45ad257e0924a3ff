//! The number type of every formula: a scalar, a SIMD pack, later a dual number or a recorder of expressions.

use fearless_simd::{Simd, f32x8, f32x16, i32x8, i32x16, mask32x8, mask32x16, prelude::*};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The truth values that comparing two [`Lane`]s gives.
pub trait Mask: Copy {
    /// True where both are true.
    fn and(self, other: Self) -> Self;
    /// True where either is true.
    fn or(self, other: Self) -> Self;
    /// True where `self` is false.
    fn not(self) -> Self;
    /// Says whether any lane is true.
    fn any(self) -> bool;
}

/// A number or a pack of numbers; all that a formula may use.
///
/// Implementations for `f32`, `f64`, [`f32x8`] and [`f32x16`] round alike: every operation here is one of IEEE 754's
/// basic operations or exact, so lane `i` of a pack has the bits that `f32` would have. There is no fused multiply-add
/// and no approximate reciprocal. Branches are written as [`Lane::select`].
///
/// Constants are made from a value at hand, [`Lane::lit`], since a pack needs the proof of its SIMD level and a
/// recorder its graph, and both travel with values.
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
    /// `if_true` where `mask` holds, else `if_false`.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// `self · 2^n` for an integral `n` in [-126, 127].
    fn ldexp(self, n: Self) -> Self;
    /// Splits a normal positive number into a mantissa in [0.5, 1) and an integral exponent, `self = m · 2^e`.
    fn frexp(self) -> (Self, Self);

    /// The smaller; `other` where either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }

    /// The larger; `other` where either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }

    /// `self` kept within [low, high].
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

macro_rules! scalar_lane {
    ($float:ty, $int:ty, $mantissa_bits:expr, $bias:expr) => {
        impl Lane for $float {
            type Mask = bool;
            #[inline(always)]
            fn lit(self, value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$float>::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                <$float>::floor(self)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
            #[inline(always)]
            fn ldexp(self, n: Self) -> Self {
                let power = <$float>::from_bits((((n as $int) + $bias) << $mantissa_bits) as _);
                self * power
            }
            #[inline(always)]
            fn frexp(self) -> (Self, Self) {
                let bits = self.to_bits() as $int;
                let exponent = (bits >> $mantissa_bits) - ($bias - 1);
                let mantissa = (bits & ((1 << $mantissa_bits) - 1)) | (($bias - 1) << $mantissa_bits);
                (<$float>::from_bits(mantissa as _), exponent as $float)
            }
        }
    };
}

scalar_lane!(f32, i32, 23, 127);
scalar_lane!(f64, i64, 52, 1023);

macro_rules! packed_lane {
    ($float:ident, $int:ident, $mask:ident) => {
        impl<S: Simd> Mask for $mask<S> {
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
                self.any_true()
            }
        }

        impl<S: Simd> Lane for $float<S> {
            type Mask = $mask<S>;
            #[inline(always)]
            fn lit(self, value: f64) -> Self {
                Self::splat(self.token(), value as f32)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                SimdFloat::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                SimdBase::abs(self)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                SimdFloat::floor(self)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                self.simd_le(other)
            }
            #[inline(always)]
            fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self {
                mask.select(if_true, if_false)
            }
            // The instructions of x86 take the second operand where either is NaN or both are zero, as `select` does;
            // other levels need not.
            #[cfg(target_arch = "x86_64")]
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                match self.token().level().as_sse2() {
                    Some(_) => SimdBase::min(self, other),
                    None => Self::select(self.lt(other), self, other),
                }
            }
            #[cfg(target_arch = "x86_64")]
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                match self.token().level().as_sse2() {
                    Some(_) => SimdBase::max(self, other),
                    None => Self::select(other.lt(self), self, other),
                }
            }
            #[inline(always)]
            fn ldexp(self, n: Self) -> Self {
                let power: $int<S> = (n.to_int::<$int<S>>() + 127) << 23;
                self * power.bitcast::<Self>()
            }
            #[inline(always)]
            fn frexp(self) -> (Self, Self) {
                let bits = self.bitcast::<$int<S>>();
                let exponent = (bits >> 23) - 126;
                let mantissa = (bits & 0x007f_ffff) | (126 << 23);
                (mantissa.bitcast::<Self>(), exponent.to_float())
            }
        }
    };
}

packed_lane!(f32x8, i32x8, mask32x8);
packed_lane!(f32x16, i32x16, mask32x16);
