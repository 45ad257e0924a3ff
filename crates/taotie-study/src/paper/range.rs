//! The range of numbers that are printed the same, since the paper truncates decimals.

/// Units of a [`Range`] per 1: fine enough for four decimals and for half a grey level in 255.
const UNITS: i64 = 10_000 * 2 * 255;

/// Numbers between two ends, in exact arithmetic. A range without an interior is empty; it is unspecified whether the
/// ends are included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Range {
    low: i64,
    high: i64,
}

impl Range {
    /// Returns the numbers printed as `printed`, with four decimals: the paper truncates towards zero.
    pub fn of(printed: f64) -> Self {
        let cut = (printed * 1e4).round() as i64 * (UNITS / 10_000);
        let step = UNITS / 10_000;
        if cut < 0 { Self { low: cut - step, high: cut } } else { Self { low: cut, high: cut + step } }
    }

    /// Returns the range shifted up by s · g/255, where g is `half_greys`/2.
    pub fn raised(self, scale: i64, half_greys: i64) -> Self {
        let by = scale * half_greys * (UNITS / 2 / 255);
        Self { low: self.low + by, high: self.high + by }
    }

    /// Returns the intersection of two ranges; `None` if it is empty.
    pub fn and(self, other: Self) -> Option<Self> {
        let (low, high) = (self.low.max(other.low), self.high.min(other.high));
        (low < high).then_some(Self { low, high })
    }

    /// Returns the ends.
    pub fn ends(self) -> [f64; 2] {
        [self.low, self.high].map(|end| end as f64 / UNITS as f64)
    }

    /// Returns the middle as it would be printed.
    pub fn printed(self) -> f64 {
        let middle = (self.low + self.high) as f64 / 2.0;
        (middle / (UNITS / 10_000) as f64).trunc() / 1e4
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_truncated_towards_zero() {
        assert_eq!(Range::of(0.5334).ends(), [0.5334, 0.5335]);
        assert_eq!(Range::of(-0.6374).ends(), [-0.6375, -0.6374]);
        for printed in [0.5334, -0.6374, 4.6518, -1.5216, 3.48] {
            assert_eq!(Range::of(printed).printed(), printed);
        }
    }

    #[test]
    fn shifts_are_exact() {
        let raised = Range::of(0.5334).raised(50, 3);
        let units = |tens: f64| (tens * 510.0 + 50.0 * 3.0 * 1e4) / 5.1e6;
        assert_eq!(raised.ends(), [units(5334.0), units(5335.0)]);
        assert_eq!(raised.raised(50, -3), Range::of(0.5334));
        assert_eq!(Range::of(0.5).and(Range::of(0.5001)), None);
        assert_eq!(Range::of(0.5).and(Range::of(0.5)), Some(Range::of(0.5)));
    }
}
