//! Native numbers and packs as [`Lane`]s; powers and logarithms are those of [`poly`]. [`Number`]s are lanes of one
//! number, not a pack or a recording: they can be converted to array indices.

use super::{Lane, Mask, poly, scalar};
use fearless_simd::{Simd, f32x8, f32x16, i32x8, i32x16, mask32x8, mask32x16, prelude::*};

/// A [`Lane`] of one number.
pub trait Number: Lane {
    /// The number as an index: truncated, and 0 if it is negative or NaN.
    fn index(self) -> usize;
    /// The angle of the point (`x`, `y`) from the x axis, [−π, π].
    fn angle(y: Self, x: Self) -> Self;
}

impl Number for f32 {
    #[inline(always)]
    fn index(self) -> usize {
        self as usize
    }
    #[inline(always)]
    fn angle(y: Self, x: Self) -> Self {
        libm::atan2f(y, x)
    }
}

impl Number for f64 {
    #[inline(always)]
    fn index(self) -> usize {
        self as usize
    }
    #[inline(always)]
    fn angle(y: Self, x: Self) -> Self {
        scalar::atan2(y, x)
    }
}

/// The methods of [`Lane`] that are not machine operations.
macro_rules! by_polynomials {
    () => {
        #[inline(always)]
        fn exp(self) -> Self {
            poly::exp(self)
        }
        #[inline(always)]
        fn exp2(self) -> Self {
            poly::exp2(self)
        }
        #[inline(always)]
        fn ln(self) -> Self {
            poly::ln(self)
        }
        #[inline(always)]
        fn log2(self) -> Self {
            poly::log2(self)
        }
        #[inline(always)]
        fn pow(self, exponent: Self) -> Self {
            poly::pow(self, exponent)
        }
    };
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
            by_polynomials!();
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
            // The x86 instructions return the second operand if either is NaN or both are zero, as `select` does;
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
            by_polynomials!();
        }
    };
}

packed_lane!(f32x8, i32x8, mask32x8);
packed_lane!(f32x16, i32x16, mask32x16);
