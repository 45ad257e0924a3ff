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

/// The permitted difference from the original keyframes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tolerance {
    /// Degrees between rotations, for samplers of width 4.
    Degrees(f64),
    /// The difference of any component.
    Numbers(f64),
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

    /// Returns the interpolation between keyframes.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
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

    /// Returns the sampler without the keyframes that interpolation between the others restores within a tolerance. The
    /// first and the last stay. Splines are returned unchanged, as are samplers that would keep more than half.
    pub fn thinned(&self, within: Tolerance) -> Self {
        /// Maximum distance between kept keyframes, which bounds the time.
        const WINDOW: usize = 128;
        let last = self.times.len() - 1;
        if last < 2 || self.interpolation == Interpolation::CubicSpline {
            return self.clone();
        }
        let restores =
            |from: usize, to: usize| (from + 1..to).all(|k| self.is_restored(k, [from, to], within));
        let mut kept = vec![0];
        while let Some(&from) = kept.last().filter(|from| **from < last) {
            let next = if from == 0 && restores(0, last) {
                last
            } else {
                (from + 1..last.min(from + WINDOW))
                    .find(|to| !restores(from, to + 1))
                    .unwrap_or(last.min(from + WINDOW))
            };
            kept.push(next);
        }
        if 2 * kept.len() > self.times.len() {
            return self.clone();
        }
        let times = kept.iter().map(|k| self.times[*k]).collect();
        let values = self.values.chunks_exact(self.width()).enumerate();
        let values = values.filter(|(k, _)| kept.binary_search(k).is_ok()).flat_map(|(_, value)| value);
        Self { interpolation: self.interpolation, times, values: values.copied().collect() }
    }

    /// Returns `true` if every keyframe has this value within a tolerance.
    pub fn stays_at(&self, value: &[f64], within: Tolerance) -> bool {
        let is_close = |k: usize| within.holds(&self.value_of(k), value);
        self.interpolation != Interpolation::CubicSpline && (0..self.times.len()).all(is_close)
    }

    /// Returns `true` if interpolation between the keyframes `from` and `to` restores keyframe `k`.
    fn is_restored(&self, k: usize, [from, to]: [usize; 2], within: Tolerance) -> bool {
        let [start, time, end] = [from, k, to].map(|k| f64::from(self.times[k]));
        let t = if end > start { (time - start) / (end - start) } else { 0.0 };
        let [a, b] = [from, to].map(|k| self.value_of(k));
        let restored: Vec<f64> = match (self.interpolation, within) {
            (Interpolation::Step, _) => a,
            (_, Tolerance::Degrees(_)) => {
                let [a, b] = [a, b].map(|q| unit_quaternion([q[0], q[1], q[2], q[3]]));
                slerp(a, b, t).to_vec()
            }
            _ => a.iter().zip(&b).map(|(a, b)| a * (1.0 - t) + b * t).collect(),
        };
        // Equal times mark a jump.
        let is_apart = |i: usize| self.times[i] < self.times[i + 1];
        is_apart(k - 1) && is_apart(k) && within.holds(&self.value_of(k), &restored)
    }

    fn value_of(&self, k: usize) -> Vec<f64> {
        (0..self.width()).map(|i| self.value(k, i)).collect()
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

impl Tolerance {
    fn holds(self, a: &[f64], b: &[f64]) -> bool {
        match self {
            Self::Numbers(most) => a.iter().zip(b).all(|(a, b)| (a - b).abs() <= most),
            Self::Degrees(most) => {
                let unit = |q: &[f64]| unit_quaternion([q[0], q[1], q[2], q[3]]);
                let dot: f64 = unit(a).iter().zip(unit(b)).map(|(x, y)| x * y).sum();
                dot.abs() >= scalar::cos(most.to_radians() / 2.0)
            }
        }
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

    /// A turn of a second, at rest for another, in 60 frames each: five keyframes of a quarter turn restore it.
    #[test]
    fn keyframes_that_interpolation_restores_are_dropped() {
        let times: Vec<f32> = (0..=120).map(|i| i as f32 / 60.0).collect();
        let turned = |i: usize| about_z(360.0 * i.min(60) as f64 / 60.0);
        let values: Vec<f32> = (0..=120).flat_map(turned).map(|v| v as f32).collect();
        let all = sampler(Interpolation::Linear, &times, &values);
        let few = all.thinned(Tolerance::Degrees(0.01));
        assert!((4..=6).contains(&few.times().len()), "{:?}", few.times());
        assert_eq!([few.times()[0], *few.times().last().unwrap()], [0.0, 2.0]);
        let off = |t: f64| {
            let pair = all.rotation_at(t).into_iter().zip(few.rotation_at(t));
            1.0 - pair.map(|(x, y)| x * y).sum::<f64>().abs()
        };
        assert!((0..=400).all(|i| off(f64::from(i) / 200.0) < 1e-8));
        let still = sampler(Interpolation::Linear, &times[..3], &[0.5, 2.0, 0.5, 2.0, 0.5, 2.0]);
        assert_eq!(still.thinned(Tolerance::Numbers(1e-6)).times().len(), 3, "more than half is left");
        assert!(still.stays_at(&[0.5, 2.0], Tolerance::Numbers(0.0)));
        assert!(!still.stays_at(&[0.5, 2.1], Tolerance::Numbers(0.05)));
    }

    #[test]
    fn jumps_and_curves_keep_their_keyframes() {
        let curve: Vec<f32> = (0..40).map(|i| (i * i) as f32).collect();
        let times: Vec<f32> = (0..40).map(|i| i as f32).collect();
        let all = sampler(Interpolation::Linear, &times, &curve);
        assert_eq!(all.thinned(Tolerance::Numbers(0.1)), all);
        // The chord of a parabola over n steps is off by n²/4.
        let few = all.thinned(Tolerance::Numbers(4.0));
        assert_eq!(few.times()[..3], [0.0, 4.0, 8.0]);
        let steps = sampler(
            Interpolation::Step,
            &times,
            &times.iter().map(|t| (t / 10.0).floor()).collect::<Vec<_>>(),
        );
        assert_eq!(steps.thinned(Tolerance::Numbers(0.0)).times(), [0.0, 10.0, 20.0, 30.0, 39.0]);
        let twice = [0.0, 1.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let jump = sampler(Interpolation::Linear, &twice, &twice).thinned(Tolerance::Numbers(0.1));
        assert_eq!(jump.times(), [0.0, 1.0, 1.0, 6.0]);
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
