//! Double precision without joints, for differences.

use std::ops::{Add, Div, Mul, Neg, Sub};
use taotie_engine::math::{Lane, Number, scalar};

/// A number in double precision whose powers and logarithms are exact to the last place.
///
/// The polynomials of `f64` are accurate to 1e-8 and made of pieces: a difference over 1e-4 would see the joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exact(pub f64);

macro_rules! operator {
    ($($trait:ident $method:ident),*) => {
        $(impl $trait for Exact {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        })*
    };
}

operator!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Exact {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Lane for Exact {
    type Mask = bool;
    fn lit(self, value: f64) -> Self {
        Self(value)
    }
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    fn abs(self) -> Self {
        Self(self.0.abs())
    }
    fn floor(self) -> Self {
        Self(self.0.floor())
    }
    fn lt(self, other: Self) -> bool {
        self.0 < other.0
    }
    fn le(self, other: Self) -> bool {
        self.0 <= other.0
    }
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    fn ldexp(self, n: Self) -> Self {
        Self(self.0.ldexp(n.0))
    }
    fn frexp(self) -> (Self, Self) {
        let (mantissa, exponent) = self.0.frexp();
        (Self(mantissa), Self(exponent))
    }
    fn exp(self) -> Self {
        Self(scalar::exp(self.0))
    }
    fn exp2(self) -> Self {
        Self(scalar::exp2(self.0))
    }
    fn ln(self) -> Self {
        Self(scalar::ln(self.0))
    }
    fn log2(self) -> Self {
        Self(scalar::log2(self.0))
    }
    fn pow(self, exponent: Self) -> Self {
        Self(scalar::pow(self.0.max(0.0), exponent.0))
    }
}

impl Number for Exact {
    fn index(self) -> usize {
        self.0 as usize
    }
    fn angle(y: Self, x: Self) -> Self {
        Self(scalar::atan2(y.0, x.0))
    }
}
