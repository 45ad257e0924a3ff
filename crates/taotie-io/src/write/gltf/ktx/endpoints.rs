//! The two endpoints of a block: their fit to its texels, and the levels that they are quantised to.

/// The position of each weight between the endpoints, in 64ths.
pub(super) const STEPS_OF_4: [u32; 4] = [0, 21, 43, 64];
pub(super) const STEPS_OF_8: [u32; 8] = [0, 9, 18, 27, 37, 46, 55, 64];
pub(super) const STEPS_OF_16: [u32; 16] = [0, 4, 8, 12, 17, 21, 25, 29, 35, 39, 43, 47, 52, 56, 60, 64];

/// Number of times that endpoints are refitted to the resulting weights.
const ROUNDS: usize = 2;

/// Texels of some channels; channels that are not fitted are zero.
pub(super) type Texels = [[f32; 3]; 16];

/// Endpoints as codes, channel by channel, and a weight per texel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    pub codes: [[u8; 3]; 2],
    pub weights: [u8; 16],
    /// The sum of squared differences.
    pub error: f32,
}

impl Fit {
    /// Fits the line through the texels along which they vary most.
    pub fn new(texels: &Texels, steps: &[u32], range: &Range) -> Self {
        let mut best = Self::between(texels, ends(texels), (steps, range));
        let mut fit = best;
        for _ in 0..ROUNDS {
            let Some(ends) = refined(texels, &fit.weights, steps) else { break };
            fit = Self::between(texels, ends, (steps, range));
            if fit.error < best.error {
                best = fit;
            }
        }
        best
    }

    fn between(texels: &Texels, ends: [[f32; 3]; 2], (steps, range): (&[u32], &Range)) -> Self {
        let codes = ends.map(|end| end.map(|v| range.code(v)));
        let palette = palette(codes, (steps, range));
        let mut fit = Self { codes, weights: [0; 16], error: 0.0 };
        for (weight, texel) in fit.weights.iter_mut().zip(texels) {
            let errors = palette[..steps.len()].iter().map(|color| squared(color, texel)).enumerate();
            let (nearest, error) = errors.fold((0, f32::INFINITY), |a, b| if b.1 < a.1 { b } else { a });
            *weight = nearest as u8;
            fit.error += error;
        }
        fit
    }

    /// Returns the same weights with the best endpoints for other texels; `None` if all weights are equal.
    pub fn refitted(&self, texels: &Texels, (steps, range): (&[u32], &Range)) -> Option<Self> {
        let ends = refined(texels, &self.weights, steps)?;
        let mut fit = Self { codes: ends.map(|end| end.map(|v| range.code(v))), ..*self };
        fit.error = squares(&fit.colors((steps, range)), texels);
        Some(fit)
    }

    /// Returns the decoded texels.
    pub fn colors(&self, levels: (&[u32], &Range)) -> Texels {
        let palette = palette(self.codes, levels);
        self.weights.map(|weight| palette[usize::from(weight)])
    }

    /// Swaps the endpoints if the first texel is nearer to the second one, since the highest bit of its weight is not
    /// stored. `top` is the largest weight.
    pub fn anchored(mut self, top: u8) -> Self {
        if self.weights[0] > top / 2 {
            self.codes.swap(0, 1);
            self.weights = self.weights.map(|weight| top - weight);
        }
        self
    }
}

/// Returns the decoded colours of the steps between two endpoints.
fn palette(codes: [[u8; 3]; 2], (steps, range): (&[u32], &Range)) -> Texels {
    let mut palette = [[0.0; 3]; 16];
    for (color, step) in palette.iter_mut().zip(steps) {
        *color = std::array::from_fn(|c| {
            let [low, high] = codes.map(|codes| u32::from(range.value[codes[c] as usize]) * 257);
            ((low * (64 - step) + high * step + 32) >> 14) as f32
        });
    }
    palette
}

/// Returns the sum of the squared differences between two blocks' texels.
pub(super) fn squares(a: &Texels, b: &Texels) -> f32 {
    a.iter().zip(b).map(|(a, b)| squared(a, b)).sum()
}

fn squared(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    x * x + y * y + z * z
}

/// Returns the outermost points of the texels along the line of their greatest variance.
fn ends(texels: &Texels) -> [[f32; 3]; 2] {
    let mean: [f32; 3] = std::array::from_fn(|c| texels.iter().map(|t| t[c]).sum::<f32>() / 16.0);
    let offsets = texels.map(|t| [t[0] - mean[0], t[1] - mean[1], t[2] - mean[2]]);
    let axis = principal_axis(&offsets);
    let along = offsets.map(|o| dot(&o, &axis));
    let least = along.into_iter().fold(f32::INFINITY, f32::min);
    let most = along.into_iter().fold(f32::NEG_INFINITY, f32::max);
    [least, most].map(|t| std::array::from_fn(|c| mean[c] + axis[c] * t))
}

fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Finds the principal axis by power iteration on the covariance.
fn principal_axis(offsets: &Texels) -> [f32; 3] {
    let mut covariance = [[0.0f32; 3]; 3];
    for o in offsets {
        for (row, a) in covariance.iter_mut().zip(o) {
            row.iter_mut().zip(o).for_each(|(sum, b)| *sum += a * b);
        }
    }
    // The row of the channel with the largest variance is not perpendicular to the axis.
    let widest = (1..3).fold(0, |best, c| if covariance[c][c] > covariance[best][best] { c } else { best });
    let mut axis = covariance[widest];
    for _ in 0..8 {
        let length = dot(&axis, &axis).sqrt();
        if length < 1e-6 {
            return [0.0; 3];
        }
        let unit = axis.map(|v| v / length);
        axis = std::array::from_fn(|c| dot(&covariance[c], &unit));
    }
    let length = dot(&axis, &axis).sqrt();
    axis.map(|v| v / length.max(1e-12))
}

/// Returns the least-squares endpoints for given weights; `None` if all weights are equal.
fn refined(texels: &Texels, weights: &[u8; 16], steps: &[u32]) -> Option<[[f32; 3]; 2]> {
    let (mut aa, mut ab, mut bb) = (0.0f32, 0.0f32, 0.0f32);
    let (mut to_a, mut to_b) = ([0.0f32; 3], [0.0f32; 3]);
    for (texel, weight) in texels.iter().zip(weights) {
        let b = steps[*weight as usize] as f32 / 64.0;
        let a = 1.0 - b;
        aa += a * a;
        ab += a * b;
        bb += b * b;
        for c in 0..3 {
            to_a[c] += a * texel[c];
            to_b[c] += b * texel[c];
        }
    }
    let determinant = aa * bb - ab * ab;
    if determinant < 1e-4 {
        return None;
    }
    Some([
        std::array::from_fn(|c| (to_a[c] * bb - to_b[c] * ab) / determinant),
        std::array::from_fn(|c| (to_b[c] * aa - to_a[c] * ab) / determinant),
    ])
}

/// Quantisation levels: bits, and above them a digit of three or five values. Source: Khronos Data Format 1.3, 23.18,
/// on the unquantisation of colours.
pub(super) struct Range {
    /// The number of bits below the digit.
    pub bits: u32,
    /// The number of values of the digit; 1 if there is none.
    pub digits: u32,
    /// The value from 0 to 255 of each code.
    value: [u8; 256],
    /// The code of the nearest level to each value.
    nearest: [u8; 256],
}

/// 192 levels: a three-valued digit and six bits.
pub(super) static OF_192: Range = Range::new(6, 3);

/// 160 levels: a five-valued digit and five bits.
pub(super) static OF_160: Range = Range::new(5, 5);

/// All 256 levels.
pub(super) static OF_256: Range = Range::new(8, 1);

impl Range {
    const fn new(bits: u32, digits: u32) -> Self {
        let mut range = Self { bits, digits, value: [0; 256], nearest: [0; 256] };
        let levels = (digits << bits) as usize;
        let mut code = 0;
        while code < levels {
            range.value[code] = unquantized(code as u32, bits, digits);
            code += 1;
        }
        let mut value = 0;
        while value < 256 {
            let mut best = 0;
            let mut code = 1;
            while code < levels {
                if range.value[code].abs_diff(value as u8) < range.value[best].abs_diff(value as u8) {
                    best = code;
                }
                code += 1;
            }
            range.nearest[value] = best as u8;
            value += 1;
        }
        range
    }

    /// Returns the code of the nearest level.
    fn code(&self, value: f32) -> u8 {
        self.nearest[(value + 0.5).clamp(0.0, 255.0) as usize]
    }
}

const fn unquantized(code: u32, bits: u32, digits: u32) -> u8 {
    let (digit, low) = (code >> bits, code & ((1 << bits) - 1));
    let high = low >> 1;
    let spread = match digits {
        3 => digit * 5 + (high << 4 | high >> 4),
        5 => digit * 6 + (high << 5 | high >> 3),
        _ => return code as u8,
    };
    let mirror = if low & 1 == 1 { 511 } else { 0 };
    ((mirror & 0x80) | ((spread ^ mirror) >> 2)) as u8
}

#[cfg(all(test, feature = "basis"))]
mod tests {
    use super::*;

    #[test]
    fn levels_are_those_of_the_decoder() {
        let table = basisu::uastc::bise::astc_unquant();
        for (range, number) in [(&OF_160, 18), (&OF_192, 19), (&OF_256, 20)] {
            let codes = (range.digits << range.bits) as usize;
            for (code, (ours, theirs)) in range.value.iter().zip(&table[number]).take(codes).enumerate() {
                assert_eq!(*ours, theirs.m_unquant, "{code} of range {number}");
            }
            let farthest =
                (0..=255u8).map(|v| v.abs_diff(range.value[range.nearest[v as usize] as usize])).max();
            assert!(farthest <= Some(1));
        }
    }
}
