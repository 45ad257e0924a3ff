//! Plain decimal numbers, to the bit as the standard library reads them, and sooner.
//!
//! Where ten to the power of the exponent and the digits as a whole number are exact in `f64`, one multiplication or
//! division rounds once, and so rightly (Clinger 1990, "How to read floating point numbers accurately", section 4). What
//! is not plain is left to the standard library.

/// A decimal number: the digits as a whole number, times ten to the power of the exponent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decimal {
    is_negative: bool,
    digits: u64,
    exponent: i32,
}

/// The powers of ten that are exact in `f64`.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

impl Decimal {
    /// Scans the number that `text` starts with; returns its bytes too. `None` where there is none, or none that is plain.
    #[inline]
    pub fn scan(text: &[u8]) -> Option<(Self, usize)> {
        /// Whole numbers of so many digits fit 64 bits.
        const MOST_DIGITS: usize = 19;
        let is_negative = text.first() == Some(&b'-');
        let start = usize::from(is_negative || text.first() == Some(&b'+'));
        let (mut digits, mut end) = take_digits(text, start, 0);
        let (mut count, mut places) = (end - start, 0);
        if text.get(end) == Some(&b'.') {
            let point = end + 1;
            (digits, end) = take_digits(text, point, digits);
            places = end - point;
            count += places;
        }
        if count == 0 || count > MOST_DIGITS {
            return None;
        }
        let mut exponent = -(places as i32);
        if let Some(b'e' | b'E') = text.get(end) {
            let (power, behind) = take_power(text, end + 1)?;
            (exponent, end) = (exponent + power, behind);
        }
        Some((Self { is_negative, digits, exponent }, end))
    }

    /// The nearest `f64`; `None` where it is not sure.
    #[inline]
    pub fn to_f64(self) -> Option<f64> {
        let power = *POWERS.get(self.exponent.unsigned_abs() as usize)?;
        if self.digits > 1 << 53 {
            return None;
        }
        let digits = self.digits as f64;
        let value = if self.exponent < 0 { digits / power } else { digits * power };
        Some(if self.is_negative { -value } else { value })
    }

    /// The nearest `f32`; `None` where it is not sure.
    ///
    /// It is that of the nearest `f64`, unless this lies halfway between two `f32`, since rounding never passes a number
    /// that is exact. All are 0 or at least 1e-22 and at most 1e38, where `f32` has all of its 24 bits.
    #[inline]
    pub fn to_f32(self) -> Option<f32> {
        const REST: u64 = (1 << 29) - 1;
        const HALF: u64 = 1 << 28;
        self.to_f64().filter(|value| value.to_bits() & REST != HALF).map(|value| value as f32)
    }
}

/// Appends the digits from `at` on to `number`, which wraps, and returns their end.
#[inline]
fn take_digits(text: &[u8], mut at: usize, mut number: u64) -> (u64, usize) {
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0'))
        && digit < 10
    {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (number, at)
}

/// Returns the exponent that stands at `at`, and its end; `None` where there is none, or one of more than three digits.
fn take_power(text: &[u8], at: usize) -> Option<(i32, usize)> {
    let is_negative = text.get(at) == Some(&b'-');
    let start = at + usize::from(is_negative || text.get(at) == Some(&b'+'));
    let (power, end) = take_digits(text, start, 0);
    let power = i32::try_from(power).ok().filter(|_| (1..=3).contains(&(end - start)))?;
    Some((if is_negative { -power } else { power }, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Holds a number against the standard library, and says whether it was plain.
    fn is_plain(text: &str) -> bool {
        let Some((decimal, length)) = Decimal::scan(text.as_bytes()) else { return false };
        assert_eq!(length, text.len(), "{text}");
        let (single, double): (f32, f64) = (text.parse().unwrap(), text.parse().unwrap());
        if let Some(value) = decimal.to_f32() {
            assert_eq!(value.to_bits(), single.to_bits(), "{text}");
        }
        let value = decimal.to_f64();
        assert_eq!(value.map(f64::to_bits), value.map(|_| double.to_bits()), "{text}");
        value.is_some()
    }

    #[test]
    fn what_is_written_is_read_as_by_the_standard_library() {
        for text in [
            "0",
            "-0",
            "+0.0",
            ".5",
            "1.",
            "-.5e1",
            "1e22",
            "1E-22",
            "9007199254740992",
            "000123.4500",
            "1e+05",
            "0.1",
            "-8.222098e-001",
            "4294967295",
            "9007199254740992e22",
        ] {
            assert!(is_plain(text), "{text}");
        }
        for text in [
            "",
            "-",
            ".",
            "-.",
            "e5",
            "1e",
            "1e+",
            "1e0001",
            "nan",
            "inf",
            "1e23",
            "1e-23",
            "9007199254740993",
            "12345678901234567890",
            "1e99999999999999999999",
            "0e999",
        ] {
            assert!(!is_plain(text), "{text}");
        }
        assert_eq!(Decimal::scan(b"1.5,2").map(|(_, length)| length), Some(3));
    }

    /// The next random number of a fixed sequence (SplitMix64, Steele et al. 2014).
    fn random(state: &mut u64) -> u64 {
        *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (*state ^ *state >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }

    #[test]
    fn random_numbers_have_the_bits_of_the_standard_library() {
        let (mut state, mut plain) = (7, 0);
        for _ in 0..100_000 {
            let value = f32::from_bits(random(&mut state) as u32);
            let near = (random(&mut state) >> 40) as f32 / 1e5 - 50.0;
            let whole = random(&mut state) as i64;
            let forms = [
                format!("{near}"),
                format!("{near:.6}"),
                format!("{near:e}"),
                format!("{:.9}", f64::from(near)),
                format!("{:.12e}", f64::from(near)),
                format!("{}", whole >> 20),
                format!("{whole}"),
                format!("{value}"),
                format!("{value:e}"),
            ];
            plain += forms.iter().filter(|text| is_plain(text)).count();
        }
        assert!(plain > 600_000, "{plain}");
    }

    /// Halfway between two numbers, and just beside it.
    #[test]
    fn single_numbers_are_rounded_once() {
        let mut state = 8;
        for _ in 0..100_000 {
            let digits = random(&mut state) >> 37 | 1 << 24 | 1;
            let places = random(&mut state) as usize % 8;
            let power = 10_u64.pow(places as u32);
            is_plain(&format!("{}.{:0places$}", digits / power, digits % power));
            is_plain(&format!("{digits}.5"));
            is_plain(&format!("{digits}.{}1", "0".repeat(places)));
        }
        let halfway = Decimal::scan(b"16777217").map(|(decimal, _)| decimal.to_f32());
        assert_eq!(halfway, Some(None));
    }
}
