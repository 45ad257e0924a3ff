//! Vectors in columns, and packs of neighbours in them.

pub(super) use crate::math::Column;
use crate::math::{Pack, Vec3};

/// A vector per fragment.
pub(super) type Column3 = [Column; 3];

pub(super) const ZERO: Column = Column::ZERO;
pub(super) const ZERO3: Column3 = [ZERO; 3];

#[inline(always)]
pub(super) fn set3(column: &mut Column3, i: usize, value: Vec3) {
    column[0][i] = value.x;
    column[1][i] = value.y;
    column[2][i] = value.z;
}

#[inline(always)]
pub(super) fn get3(column: &Column3, i: usize) -> Vec3 {
    Vec3::new(column[0][i], column[1][i], column[2][i])
}

#[inline(always)]
pub(super) fn load<P: Pack>(token: P::Token, column: &Column, i: usize) -> P {
    P::load(token, &column[i..])
}

#[inline(always)]
pub(super) fn load3<P: Pack>(token: P::Token, column: &Column3, i: usize) -> Vec3<P> {
    Vec3::new(load(token, &column[0], i), load(token, &column[1], i), load(token, &column[2], i))
}

#[inline(always)]
pub(super) fn store3<P: Pack>(value: Vec3<P>, column: &mut Column3, i: usize) {
    value.x.store(&mut column[0][i..]);
    value.y.store(&mut column[1][i..]);
    value.z.store(&mut column[2][i..]);
}

#[inline(always)]
pub(super) fn splat3<P: Pack>(token: P::Token, value: Vec3) -> Vec3<P> {
    Vec3::new(P::splat(token, value.x), P::splat(token, value.y), P::splat(token, value.z))
}
