//! The numbers that formulas run on: native numbers and packs as [`Lane`]s, whose powers and logarithms are those of
//! [`poly`], and dual numbers, which yield the derivatives of a formula by running it.
//!
//! [`Number`]s are lanes of one number, not a pack or a recording: they can be converted to array indices.

use super::{Lane, Mask, poly, scalar};
use fearless_simd::{Simd, f32x8, f32x16, i32x8, i32x16, mask32x8, mask32x16, prelude::*};
use std::array::from_fn;
use std::f64::consts::{LN_2, LOG2_E};
use std::ops::{Add, Div, Mul, Neg, Sub};

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

/// A number and its partial derivatives with respect to `N` variables.
///
/// Every formula over [`Lane`] accepts it and returns its derivatives with its result, exact except for rounding. At
/// a kink (`min`, `abs`, a select) they are those of the branch taken; a root has none at zero. Powers and logarithms
/// are differentiated as functions, not as their polynomial approximations.
///
/// ```
/// use taotie_engine::math::Dual;
/// use taotie_engine::shade::microfacets::d_ggx;
///
/// let alpha = Dual::<f64, 1>::variable(0.25, 0);
/// let [n_dot_h, sin2_h] = [1.0, 0.0].map(Dual::constant);
/// let d = d_ggx(n_dot_h, sin2_h, alpha);
/// // D = 1/(π α²) at the peak, so dD/dα = −2/(π α³).
/// assert!((d.partials[0] + 128.0 / std::f64::consts::PI).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<L, const N: usize> {
    /// The number itself.
    pub value: L,
    /// Its derivative with respect to each variable.
    pub partials: [L; N],
}

impl<L: Lane, const N: usize> Dual<L, N> {
    /// A number that depends on no variable.
    #[inline(always)]
    pub fn constant(value: L) -> Self {
        Self { value, partials: [value.lit(0.0); N] }
    }

    /// The variable with index `index`; a constant if `index` is not below `N`.
    #[inline(always)]
    pub fn variable(value: L, index: usize) -> Self {
        Self { value, partials: from_fn(|i| value.lit(if i == index { 1.0 } else { 0.0 })) }
    }

    /// A function of this number, from its value and derivative at this number.
    #[inline(always)]
    fn function(self, value: L, slope: L) -> Self {
        Self { value, partials: self.partials.map(|partial| partial * slope) }
    }

    /// Returns the partials of a function of two numbers, from those of both.
    #[inline(always)]
    fn partials(self, other: Self, partial: impl Fn(L, L) -> L) -> [L; N] {
        from_fn(|i| partial(self.partials[i], other.partials[i]))
    }

    /// The product rule.
    #[inline(always)]
    fn product(self, o: Self) -> Self {
        let partials = self.partials(o, |by_self, by_o| by_self * o.value + self.value * by_o);
        Self { value: self.value * o.value, partials }
    }

    /// The quotient rule.
    #[inline(always)]
    fn quotient(self, o: Self) -> Self {
        let value = self.value / o.value;
        Self { value, partials: self.partials(o, |by_self, by_o| (by_self - value * by_o) / o.value) }
    }
}

impl<L: Number, const N: usize> Number for Dual<L, N> {
    fn index(self) -> usize {
        self.value.index()
    }
    /// At the origin, where the angle has no derivative, it is 0.
    fn angle(y: Self, x: Self) -> Self {
        let squared = x.value * x.value + y.value * y.value;
        let zero = squared.lit(0.0);
        let partials = y.partials(x, |by_y, by_x| {
            let slope = (by_y * x.value - by_x * y.value) / squared;
            L::select(zero.lt(squared), slope, zero)
        });
        Self { value: L::angle(y.value, x.value), partials }
    }
}

impl<L: Lane, const N: usize> Add for Dual<L, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { value: self.value + o.value, partials: self.partials(o, |a, b| a + b) }
    }
}

impl<L: Lane, const N: usize> Sub for Dual<L, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { value: self.value - o.value, partials: self.partials(o, |a, b| a - b) }
    }
}

impl<L: Lane, const N: usize> Mul for Dual<L, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        self.product(o)
    }
}

impl<L: Lane, const N: usize> Div for Dual<L, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        self.quotient(o)
    }
}

impl<L: Lane, const N: usize> Neg for Dual<L, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, partials: self.partials.map(|partial| -partial) }
    }
}

impl<L: Lane, const N: usize> Lane for Dual<L, N> {
    type Mask = L::Mask;

    #[inline(always)]
    fn lit(self, value: f64) -> Self {
        Self::constant(self.value.lit(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let (root, zero) = (self.value.sqrt(), self.value.lit(0.0));
        self.function(root, L::select(zero.lt(root), root.lit(0.5) / root, zero))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::select(self.value.lt(self.value.lit(0.0)), -self, self)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }
    #[inline(always)]
    fn lt(self, other: Self) -> L::Mask {
        self.value.lt(other.value)
    }
    #[inline(always)]
    fn le(self, other: Self) -> L::Mask {
        self.value.le(other.value)
    }
    #[inline(always)]
    fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        let partials = from_fn(|i| L::select(mask, if_true.partials[i], if_false.partials[i]));
        Self { value: L::select(mask, if_true.value, if_false.value), partials }
    }
    #[inline(always)]
    fn ldexp(self, n: Self) -> Self {
        let scaled = |x: L| x.ldexp(n.value);
        Self { value: scaled(self.value), partials: self.partials.map(scaled) }
    }
    #[inline(always)]
    fn frexp(self) -> (Self, Self) {
        let (mantissa, exponent) = self.value.frexp();
        // The power of two may be outside the range of `ldexp`.
        (self.function(mantissa, mantissa / self.value), Self::constant(exponent))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.function(value, value)
    }
    #[inline(always)]
    fn exp2(self) -> Self {
        let value = self.value.exp2();
        self.function(value, value * value.lit(LN_2))
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.function(self.value.ln(), self.value.lit(1.0) / self.value)
    }
    #[inline(always)]
    fn log2(self) -> Self {
        self.function(self.value.log2(), self.value.lit(LOG2_E) / self.value)
    }
    #[inline(always)]
    fn pow(self, exponent: Self) -> Self {
        let (base, power) = (self.value, exponent.value);
        let (zero, value) = (base.lit(0.0), base.pow(power));
        let positive = zero.lt(base);
        let by_base = L::select(positive, power * base.pow(power - base.lit(1.0)), zero);
        let by_power = L::select(positive, value * base.ln(), zero);
        let partials = from_fn(|i| self.partials[i] * by_base + exponent.partials[i] * by_power);
        Self { value, partials }
    }
}
