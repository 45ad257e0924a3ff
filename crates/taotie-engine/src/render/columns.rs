//! Columns: numbers and vectors of a batch's fragments, packs of neighbours in them, and the values at the corners of
//! each fragment's triangle.

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

/// The fragments of one triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    /// The triangle's index over all draws.
    pub triangle: u32,
    pub start: usize,
    pub end: usize,
}

/// The maximum number of fragments that are written one by one, which is faster than a pack that crosses cache lines.
const SHORT: usize = 2;

/// Up to four numbers of each corner, side by side with the fragments of a batch.
///
/// Triangles may be smaller than a pixel. Written out per fragment, the values of their corners can be weighted in
/// packs over all fragments, regardless of their triangles.
#[derive(Debug, Clone)]
pub(super) struct VertexAttributes([[Column; 4]; 3]);

impl VertexAttributes {
    pub(super) const ZERO: Self = Self([[Column::ZERO; 4]; 3]);

    /// Writes numbers of the three corners unchanged. Runs come in the order of their fragments, since the end of a
    /// pack may overwrite the next run.
    #[inline(always)]
    pub(super) fn write<P: Pack, const N: usize>(
        &mut self,
        token: P::Token,
        run: Run,
        numbers: [[f32; N]; 3],
    ) {
        let Run { start, end, .. } = run;
        if end - start <= SHORT {
            for (columns, numbers) in self.0.iter_mut().zip(&numbers) {
                for (column, number) in columns.iter_mut().zip(numbers) {
                    column[start..end].iter_mut().for_each(|value| *value = *number);
                }
            }
            return;
        }
        for i in (run.start..run.end).step_by(P::LANES) {
            for (columns, numbers) in self.0.iter_mut().zip(&numbers) {
                for (column, number) in columns.iter_mut().zip(numbers) {
                    P::splat(token, *number).store(&mut column[i..]);
                }
            }
        }
    }

    /// Writes the first corner's numbers and their differences to the others: two weights then suffice, and a value
    /// that is equal at all corners stays exact.
    #[inline(always)]
    pub(super) fn write_differences<P: Pack, const N: usize>(
        &mut self,
        token: P::Token,
        run: Run,
        [first, mut second, mut third]: [[f32; N]; 3],
    ) {
        for n in 0..N {
            second[n] -= first[n];
            third[n] -= first[n];
        }
        self.write::<P, N>(token, run, [first, second, third]);
    }

    /// A number as written, at the fragments from `i` onwards.
    #[inline(always)]
    pub(super) fn written<P: Pack>(&self, token: P::Token, corner: usize, n: usize, i: usize) -> P {
        load(token, &self.0[corner][n], i)
    }

    /// The first three numbers as written.
    #[inline(always)]
    pub(super) fn written3<P: Pack>(&self, token: P::Token, corner: usize, i: usize) -> Vec3<P> {
        let [x, y, z, _] = &self.0[corner];
        Vec3::new(load(token, x, i), load(token, y, i), load(token, z, i))
    }

    /// A number written by [`Self::write_differences`], for these weights of the corners.
    #[inline(always)]
    pub(super) fn at<P: Pack>(&self, token: P::Token, weights: &Column3, n: usize, i: usize) -> P {
        self.written::<P>(token, 0, n, i) + self.change(token, weights, n, i)
    }

    /// Returns the change of the number for these changes of the weights.
    #[inline(always)]
    pub(super) fn change<P: Pack>(&self, token: P::Token, weights: &Column3, n: usize, i: usize) -> P {
        let (second, third): (P, P) = (load(token, &weights[1], i), load(token, &weights[2], i));
        self.written::<P>(token, 1, n, i) * second + self.written::<P>(token, 2, n, i) * third
    }

    /// The first three numbers written by [`Self::write_differences`], for these weights of the corners.
    #[inline(always)]
    pub(super) fn at3<P: Pack>(&self, token: P::Token, weights: &Column3, i: usize) -> Vec3<P> {
        let (x, y) = (self.at(token, weights, 0, i), self.at(token, weights, 1, i));
        Vec3::new(x, y, self.at(token, weights, 2, i))
    }

    /// Returns the change of the numbers for these changes of the weights.
    #[inline(always)]
    pub(super) fn change3<P: Pack>(&self, token: P::Token, weights: &Column3, i: usize) -> Vec3<P> {
        let (x, y) = (self.change(token, weights, 0, i), self.change(token, weights, 1, i));
        Vec3::new(x, y, self.change(token, weights, 2, i))
    }
}
