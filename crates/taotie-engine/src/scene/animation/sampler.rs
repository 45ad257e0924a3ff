//! Keyframes and interpolation between them.

use crate::error::{Error, Result};
use crate::math::scalar;

/// The interpolation from one keyframe to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// Constant until the next keyframe.
    Step,
    /// Linear; rotations turn uniformly the shorter way.
    #[default]
    Linear,
    /// A cubic Hermite spline with authored tangents.
    CubicSpline,
}

/// Keyframes: values of any width at non-decreasing times.
#[derive(Debug, Clone, PartialEq)]
pub struct Sampler {
    interpolation: Interpolation,
    times: Vec<f32>,
    values: Vec<f32>,
}

/// The keyframes around a time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Segment {
    from: usize,
    to: usize,
    /// The fraction of the way from the first to the second, in [0, 1).
    t: f64,
    /// The time between the two, seconds.
    length: f64,
}

impl Sampler {
    /// Validates keyframes at `times` (seconds). `values` has the same number of values for each keyframe; for
    /// [`Interpolation::CubicSpline`] an in-tangent, a value and an out-tangent, each of that width.
    ///
    /// # Errors
    /// [`Error::Invalid`] if there is no keyframe, a time is negative, not finite or earlier than the previous one, a
    /// value is not finite, or the values do not divide evenly among the keyframes.
    pub fn new(interpolation: Interpolation, times: Vec<f32>, values: Vec<f32>) -> Result<Self> {
        let wrong = |why: String| Err(Error::invalid("animation sampler", why));
        if times.is_empty() {
            return wrong("it has no keyframes".into());
        }
        if let Some(i) = times.iter().position(|t| !(t.is_finite() && *t >= 0.0)) {
            return wrong(format!("time {i} is {}; times must be finite and not negative", times[i]));
        }
        if let Some(i) = times.windows(2).position(|pair| pair[0] > pair[1]) {
            return wrong(format!("time {} is before time {i}; times must not decrease", i + 1));
        }
        if let Some(i) = values.iter().position(|v| !v.is_finite()) {
            return wrong(format!("value {i} is infinite or NaN"));
        }
        let sampler = Self { interpolation, times, values };
        let elements = sampler.times.len() * sampler.elements_per_key();
        if sampler.values.is_empty() || !sampler.values.len().is_multiple_of(elements) {
            return wrong(format!("{} numbers for {elements} keyframe values", sampler.values.len()));
        }
        Ok(sampler)
    }

    /// Returns the number of components in a value.
    pub fn width(&self) -> usize {
        self.values.len() / (self.times.len() * self.elements_per_key())
    }

    /// Returns the times of the keyframes, in seconds, non-decreasing.
    pub fn times(&self) -> &[f32] {
        &self.times
    }

    /// Returns the numbers of all keyframes, as passed to [`Sampler::new`].
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Returns the value at a time, component by component, clamped to the first and last keyframe.
    ///
    /// Source: glTF 2.0, appendix C.2, C.3 and C.5.
    pub fn at(&self, seconds: f64) -> Vec<f64> {
        let segment = self.segment(seconds);
        (0..self.width()).map(|i| self.number_at(segment, i)).collect()
    }

    /// Returns the value at a time as a unit quaternion (x, y, z, w); for samplers of width 4.
    ///
    /// Source: glTF 2.0, appendix C.4 and C.5.
    pub fn rotation_at(&self, seconds: f64) -> [f64; 4] {
        let segment = self.segment(seconds);
        if self.interpolation == Interpolation::Linear {
            let key = |k| unit_quaternion([0, 1, 2, 3].map(|i| self.value(k, i)));
            return slerp(key(segment.from), key(segment.to), segment.t);
        }
        unit_quaternion([0, 1, 2, 3].map(|i| self.number_at(segment, i)))
    }

    fn number_at(&self, Segment { from, to, t, length }: Segment, i: usize) -> f64 {
        let (a, b) = (self.value(from, i), self.value(to, i));
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear => a * (1.0 - t) + b * t,
            Interpolation::CubicSpline => {
                hermite([a, b], [self.element(from, 2, i) * length, self.element(to, 0, i) * length], t)
            }
        }
    }

    fn segment(&self, seconds: f64) -> Segment {
        let last = self.times.len() - 1;
        let time = |k: usize| f64::from(self.times[k]);
        // At equal times the later keyframe counts, so no requested segment has length zero.
        match self.times.partition_point(|t| f64::from(*t) <= seconds) {
            0 => Segment { from: 0, to: 0, t: 0.0, length: 0.0 },
            after if after > last => Segment { from: last, to: last, t: 0.0, length: 0.0 },
            to => {
                let (from, length) = (to - 1, time(to) - time(to - 1));
                Segment { from, to, t: (seconds - time(from)) / length, length }
            }
        }
    }

    fn elements_per_key(&self) -> usize {
        if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 }
    }

    /// Returns number `i` of the value at keyframe `k`.
    fn value(&self, k: usize, i: usize) -> f64 {
        self.element(k, self.elements_per_key() / 2, i)
    }

    /// Returns number `i` of element `e` of keyframe `k`: of a spline 0 is the in-tangent, 1 the value, 2 the
    /// out-tangent.
    fn element(&self, k: usize, e: usize, i: usize) -> f64 {
        f64::from(self.values[(k * self.elements_per_key() + e) * self.width() + i])
    }
}

/// Evaluates the cubic through `ends` with `slopes` there, for the parameter `t` from 0 to 1.
///
/// (2t³ − 3t² + 1) p₀ + (t³ − 2t² + t) m₀ + (−2t³ + 3t²) p₁ + (t³ − t²) m₁
fn hermite([p0, p1]: [f64; 2], [m0, m1]: [f64; 2], t: f64) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * p0 + (t3 - 2.0 * t2 + t) * m0 + (3.0 * t2 - 2.0 * t3) * p1 + (t3 - t2) * m1
}

/// Rotates uniformly from the unit quaternion `a` (`t` = 0) to `b` (`t` = 1), the shorter way.
///
/// Source: Shoemake 1985, "Animating rotation with quaternion curves".
fn slerp(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    /// Below this the arc is straight to double precision, and its sine too small to divide by.
    const STRAIGHT: f64 = 1.0 - 1e-12;
    let dot: f64 = a.iter().zip(&b).map(|(x, y)| x * y).sum();
    let side = if dot < 0.0 { -1.0 } else { 1.0 };
    let (from, to) = if dot.abs() > STRAIGHT {
        (1.0 - t, t)
    } else {
        let angle = scalar::acos(dot.abs());
        let sine = scalar::sin(angle);
        (scalar::sin(angle * (1.0 - t)) / sine, scalar::sin(angle * t) / sine)
    };
    unit_quaternion([0, 1, 2, 3].map(|i| a[i] * from + b[i] * to * side))
}

/// Returns `q` normalised; if its length is zero, no rotation.
pub(super) fn unit_quaternion(q: [f64; 4]) -> [f64; 4] {
    let length = q.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length == 0.0 { [0.0, 0.0, 0.0, 1.0] } else { q.map(|v| v / length) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_1_SQRT_2, PI};

    fn sampler(interpolation: Interpolation, times: &[f32], values: &[f32]) -> Sampler {
        Sampler::new(interpolation, times.to_vec(), values.to_vec()).unwrap()
    }

    /// Returns a rotation about z by `degrees`.
    fn about_z(degrees: f64) -> [f64; 4] {
        let half = degrees.to_radians() / 2.0;
        [0.0, 0.0, scalar::sin(half), scalar::cos(half)]
    }

    fn close(a: [f64; 4], b: [f64; 4]) -> bool {
        a.iter().zip(&b).all(|(x, y)| (x - y).abs() < 1e-12)
    }

    #[test]
    fn values_hold_before_between_and_after() {
        let at = |i, t| sampler(i, &[1.0, 3.0], &[10.0, 0.0, 30.0, 4.0]).at(t);
        for interpolation in [Interpolation::Step, Interpolation::Linear] {
            assert_eq!(at(interpolation, 0.0), [10.0, 0.0]);
            assert_eq!(at(interpolation, 1.0), [10.0, 0.0]);
            assert_eq!(at(interpolation, 3.0), [30.0, 4.0]);
            assert_eq!(at(interpolation, 99.0), [30.0, 4.0]);
        }
        assert_eq!(at(Interpolation::Step, 2.9), [10.0, 0.0]);
        assert_eq!(at(Interpolation::Linear, 1.5), [15.0, 1.0]);
    }

    /// p = t³ over [0, 2]: values 0 and 8, slopes 0 and 12. A cubic is its own spline only if the tangents are scaled
    /// by the length of the segment.
    #[test]
    fn a_cubic_goes_through_its_spline_unchanged() {
        let spline = sampler(Interpolation::CubicSpline, &[0.0, 2.0], &[7.0, 0.0, 0.0, 12.0, 8.0, 7.0]);
        for t in [0.0f64, 0.5, 1.0, 1.75, 2.0] {
            assert!((spline.at(t)[0] - t * t * t).abs() < 1e-12, "{t}");
        }
        assert_eq!((spline.width(), spline.at(5.0)[0]), (1, 8.0));
    }

    #[test]
    fn rotations_turn_evenly_the_shorter_way() {
        let quarter = slerp(about_z(0.0), about_z(90.0), 1.0 / 3.0);
        assert!(close(quarter, about_z(30.0)), "{quarter:?}");
        // −q is the same rotation as q; from 10° to 350° is 20° back.
        assert!(close(slerp(about_z(10.0), about_z(350.0), 0.25), about_z(5.0)));
        assert!(close(slerp(about_z(20.0), about_z(20.0).map(|v| -v), 0.5), about_z(20.0)));
        // Half a turn has no shorter way, but is still uniform.
        let half = slerp(about_z(0.0), about_z(180.0), 0.5);
        assert!(close(half, [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]), "{half:?}");
        let tiny = slerp(about_z(0.0), about_z(1e-7), 0.5);
        assert!((tiny[2] - 1e-7 * PI / 720.0).abs() < 1e-22, "{tiny:?}");
    }

    #[test]
    fn keyframes_need_not_be_unit() {
        let q = sampler(Interpolation::Linear, &[0.0, 1.0], &[0., 0., 0., 2., 0., 0., 3., 3.]);
        assert!(close(q.rotation_at(0.5), about_z(45.0)));
        let step = sampler(Interpolation::Step, &[0.0], &[0., 0., 0., 0.]);
        assert_eq!(step.rotation_at(1.0), [0.0, 0.0, 0.0, 1.0], "of length zero");
    }

    #[test]
    fn splines_of_rotations_are_made_unit() {
        let (zero, a, b) = ([0.0f32; 4], [0., 0., 0., 1.], [0., 0., 1., 0.]);
        let values = [zero, a, zero, zero, b, zero].concat();
        let q = sampler(Interpolation::CubicSpline, &[0.0, 1.0], &values).rotation_at(0.5);
        assert!(close(q, [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2]), "{q:?}");
    }

    #[test]
    fn equal_times_are_a_jump() {
        let jump = sampler(Interpolation::Linear, &[0.0, 1.0, 1.0, 2.0], &[0.0, 1.0, 5.0, 6.0]);
        assert_eq!([jump.at(0.5)[0], jump.at(1.0)[0], jump.at(1.5)[0]], [0.5, 5.0, 5.5]);
    }

    #[test]
    fn wrong_keyframes_are_refused() {
        let why = |i, times: &[f32], values: &[f32]| {
            Sampler::new(i, times.to_vec(), values.to_vec()).unwrap_err().to_string()
        };
        let linear = Interpolation::Linear;
        assert!(why(linear, &[], &[]).contains("no keyframe"));
        assert!(why(linear, &[0.0, f32::NAN], &[1.0, 2.0]).contains("time 1"));
        assert!(why(linear, &[-1.0], &[1.0]).contains("negative"));
        assert!(why(linear, &[0.0, 2.0, 1.0], &[1.0; 3]).contains("time 2 is before time 1"));
        assert!(why(linear, &[0.0, 1.0], &[1.0; 3]).contains("3 numbers for 2"));
        assert!(why(linear, &[0.0], &[]).contains("0 numbers"));
        assert!(why(linear, &[0.0], &[f32::INFINITY]).contains("value 0"));
        assert!(why(Interpolation::CubicSpline, &[0.0, 1.0], &[1.0; 4]).contains("for 6"));
    }
}
