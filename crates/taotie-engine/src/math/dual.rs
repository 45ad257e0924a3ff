//! Dual numbers: the derivatives of a formula by running it.

use super::{Lane, Number};
use std::array::from_fn;
use std::f64::consts::{LN_2, LOG2_E};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number and its partial derivatives with respect to `N` variables.
///
/// Every formula over [`Lane`] accepts it and returns its derivatives with its result, exact except for rounding. At
/// a kink (`min`, `abs`, a select) they are those of the branch taken; a root has none at zero. Powers and logarithms
/// are differentiated as functions, not as their polynomial approximations.
///
/// ```
/// use taotie_engine::math::Dual;
/// use taotie_engine::shade::ndf::d_ggx;
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
