//! UASTC blocks of 4 × 4 texels without alpha, by four of its nineteen modes. Source: Khronos Data Format 1.3, 25,
//! and the UASTC texture specification.

use super::endpoints::{Fit, OF_160, OF_192, OF_256, Range, STEPS_OF_4, STEPS_OF_8, STEPS_OF_16, Texels};

/// The texels of a block as stored, row by row.
pub(super) type Tile = [[u8; 3]; 16];

/// A mode with one line in colour space: 16 weights and 192 levels, or 8 weights and all levels.
pub(super) struct Line {
    prefix: (u32, u32),
    steps: &'static [u32],
    weight_bits: u32,
    range: &'static Range,
}

/// Mode 0, for most blocks, and mode 5, for smooth ones.
static LINES: [Line; 2] = [
    Line { prefix: (0x1, 4), steps: &STEPS_OF_16, weight_bits: 4, range: &OF_192 },
    Line { prefix: (0xb, 5), steps: &STEPS_OF_8, weight_bits: 3, range: &OF_256 },
];

/// Mode 6: one channel has separate weights, 4 each.
const PLANES: (u32, u32) = (0x1b, 5);

/// Mode 8: one colour.
const SOLID: (u32, u32) = (0x17, 5);

/// A block before serialisation.
#[derive(Clone, Copy)]
pub(super) enum Block {
    /// One colour.
    Solid([u8; 3]),
    /// A mode with one line, and its endpoints and weights.
    Line(&'static Line, Fit),
    /// Two channels on a line, and one separate channel.
    Planes(Planes),
}

impl Block {
    /// Returns the nearest block.
    pub fn nearest(tile: &Tile) -> Self {
        if tile.iter().all(|texel| *texel == tile[0]) {
            return Self::Solid(tile[0]);
        }
        let values = values(tile);
        let lines = LINES.iter().map(|line| (line, Fit::new(&values, line.steps, line.range)));
        let (line, fit) =
            lines.reduce(|a, b| if b.1.error < a.1.error { b } else { a }).expect("there are two");
        if fit.error > 0.0 {
            let planes = (0..3).map(|channel| Planes::new(&values, channel));
            let planes =
                planes.reduce(|a, b| if b.error() < a.error() { b } else { a }).expect("there are three");
            if planes.error() < fit.error {
                return Self::Planes(planes);
            }
        }
        Self::Line(line, fit)
    }

    /// Returns the block of the same mode and weights with the best endpoints for other texels; `None` if all weights
    /// are equal.
    pub fn refitted(&self, texels: &Texels) -> Option<Self> {
        match self {
            Self::Solid(_) => None,
            Self::Line(line, fit) => Some(Self::Line(line, fit.refitted(texels, (line.steps, line.range))?)),
            Self::Planes(planes) => planes.refitted(texels).map(Self::Planes),
        }
    }

    /// Returns the decoded texels.
    pub fn colors(&self) -> Texels {
        match self {
            Self::Solid(color) => [color.map(f32::from); 16],
            Self::Line(line, fit) => fit.colors((line.steps, line.range)),
            Self::Planes(planes) => planes.colors(),
        }
    }

    /// Returns its bytes; `tile`, the original texels, provides hints for GPU formats.
    pub fn bytes(&self, tile: &Tile) -> [u8; 16] {
        match self {
            Self::Solid(color) => solid(*color),
            Self::Line(line, fit) => line.block(fit, tile),
            Self::Planes(planes) => planes.block(tile),
        }
    }
}

/// Returns the texels of a block as floats.
pub(super) fn values(tile: &Tile) -> Texels {
    tile.map(|texel| texel.map(f32::from))
}

/// A bit writer, from the lowest bit of the first byte upwards.
#[derive(Default)]
struct Bits {
    block: u128,
    at: u32,
}

impl Bits {
    fn push(&mut self, (value, count): (u32, u32)) {
        self.block |= u128::from(value) << self.at;
        self.at += count;
    }

    /// Writes endpoints, low and high channel by channel: first the digits of all, packed in fives or threes, then
    /// the bits.
    fn push_endpoints(&mut self, [low, high]: [[u8; 3]; 2], range: &Range) {
        let codes = [low[0], high[0], low[1], high[1], low[2], high[2]].map(u32::from);
        let (bundle, widths): (usize, &[u32]) = match range.digits {
            3 => (5, &[8, 2]),
            5 => (3, &[7, 7]),
            _ => (6, &[]),
        };
        for (codes, width) in codes.chunks(bundle).zip(widths) {
            let digits = codes.iter().rev().fold(0, |sum, code| sum * range.digits + (code >> range.bits));
            self.push((digits, *width));
        }
        codes.iter().for_each(|code| self.push((code & ((1 << range.bits) - 1), range.bits)));
    }

    /// Writes the hints for transcoding the block to BC1 and ETC1.
    fn push_hints(&mut self, texels: &Tile) {
        // The two BC1 hints promise that endpoints can be reused; without them they are refitted.
        self.push((0, 2));
        let hints = EtcHints::new(texels);
        self.push((u32::from(hints.flip), 1));
        self.push((u32::from(hints.differential), 1));
        hints.tables.iter().for_each(|table| self.push((*table, 3)));
        // Mean colours are unchanged.
        self.push((13, 5));
    }

    fn bytes(self) -> [u8; 16] {
        self.block.to_le_bytes()
    }
}

impl Line {
    fn block(&self, fit: &Fit, texels: &Tile) -> [u8; 16] {
        let fit = fit.anchored((self.steps.len() - 1) as u8);
        let mut bits = Bits::default();
        bits.push(self.prefix);
        bits.push_hints(texels);
        bits.push_endpoints(fit.codes, self.range);
        for (i, weight) in fit.weights.iter().enumerate() {
            bits.push((u32::from(*weight), self.weight_bits - u32::from(i == 0)));
        }
        bits.bytes()
    }
}

/// Two channels on a line in their plane, and one separate channel.
#[derive(Clone, Copy)]
pub(super) struct Planes {
    channel: usize,
    plane: Fit,
    own: Fit,
}

impl Planes {
    fn new(texels: &Texels, channel: usize) -> Self {
        let [plane, own] =
            parted(texels, channel).map(|texels| Fit::new(&texels, &STEPS_OF_4, &OF_160).anchored(3));
        Self { channel, plane, own }
    }

    fn refitted(&self, texels: &Texels) -> Option<Self> {
        let [plane, own] = parted(texels, self.channel);
        let levels = (STEPS_OF_4.as_slice(), &OF_160);
        Some(Self {
            plane: self.plane.refitted(&plane, levels)?,
            own: self.own.refitted(&own, levels)?,
            ..*self
        })
    }

    fn colors(&self) -> Texels {
        let [plane, own] = [&self.plane, &self.own].map(|fit| fit.colors((STEPS_OF_4.as_slice(), &OF_160)));
        std::array::from_fn(|i| {
            std::array::from_fn(|c| if c == self.channel { own[i][c] } else { plane[i][c] })
        })
    }

    fn error(&self) -> f32 {
        self.plane.error + self.own.error
    }

    fn block(&self, texels: &Tile) -> [u8; 16] {
        let mut bits = Bits::default();
        bits.push(PLANES);
        bits.push_hints(texels);
        bits.push((self.channel as u32, 2));
        let codes = [0, 1].map(|end| {
            let mut codes = self.plane.codes[end];
            codes[self.channel] = self.own.codes[end][self.channel];
            codes
        });
        bits.push_endpoints(codes, &OF_160);
        for i in 0..16 {
            let width = 2 - u32::from(i == 0);
            bits.push((self.plane.weights[i].into(), width));
            bits.push((self.own.weights[i].into(), width));
        }
        bits.bytes()
    }
}

/// Returns the texels without one channel, and that channel separately.
fn parted(texels: &Texels, channel: usize) -> [Texels; 2] {
    [false, true]
        .map(|own| texels.map(|t| std::array::from_fn(|c| if (c == channel) == own { t[c] } else { 0.0 })))
}

/// Returns a block of one opaque colour; for ETC1, the nearest 5-bit colour, lightened or darkened by the smallest
/// step.
fn solid(color: [u8; 3]) -> [u8; 16] {
    let mut bits = Bits::default();
    bits.push(SOLID);
    color.iter().chain(&[255]).for_each(|channel| bits.push((u32::from(*channel), 8)));
    let fives = color.map(|channel| (u32::from(channel) * 31 + 127) / 255);
    let reached = fives.iter().map(|five| five << 3 | five >> 2).sum::<u32>();
    let lighter = color.iter().map(|channel| u32::from(*channel)).sum::<u32>() > reached;
    bits.push((1, 1));
    bits.push((0, 3));
    bits.push((if lighter { 2 } else { 1 }, 2));
    fives.iter().for_each(|five| bits.push((*five, 5)));
    bits.bytes()
}

/// How ETC1 should halve the block, and the spread of lightness in each half.
struct EtcHints {
    flip: bool,
    differential: bool,
    tables: [u32; 2],
}

/// The larger step of each ETC1 table.
const SPREADS: [f32; 8] = [8.0, 17.0, 29.0, 42.0, 60.0, 80.0, 106.0, 183.0];

impl EtcHints {
    fn new(texels: &Tile) -> Self {
        let [upright, flipped] = [false, true].map(|flip| Self::halves(texels, flip));
        let variance = |halves: &[Half; 2]| halves[0].variance + halves[1].variance;
        let flip = variance(&flipped) < variance(&upright);
        let halves = if flip { flipped } else { upright };
        let [a, b] = halves.each_ref().map(|half| half.mean.map(|v| (v * 31.0 / 255.0 + 0.5) as i32));
        let differential = a.iter().zip(b).all(|(a, b)| (-4..=3).contains(&(b - a)));
        let table = |half: &Half| {
            SPREADS.iter().position(|step| *step >= half.farthest).unwrap_or(SPREADS.len() - 1) as u32
        };
        Self { flip, differential, tables: halves.each_ref().map(table) }
    }

    /// Returns the left and right halves, or with `flip` the upper and lower ones.
    fn halves(texels: &Tile, flip: bool) -> [Half; 2] {
        let half_of = |i: usize| if flip { i / 8 } else { i % 4 / 2 };
        [0, 1].map(|half| {
            let mut own = [[0.0; 3]; 8];
            let texels = texels.iter().enumerate().filter(|(i, _)| half_of(*i) == half);
            own.iter_mut().zip(texels).for_each(|(own, (_, texel))| *own = texel.map(f32::from));
            Half::new(&own)
        })
    }
}

struct Half {
    mean: [f32; 3],
    variance: f32,
    /// The largest distance from the mean, in lightness.
    farthest: f32,
}

impl Half {
    fn new(texels: &[[f32; 3]; 8]) -> Self {
        let mean: [f32; 3] = std::array::from_fn(|c| texels.iter().map(|t| t[c]).sum::<f32>() / 8.0);
        let lightness = |t: &[f32; 3]| {
            let [r, g, b] = [t[0] - mean[0], t[1] - mean[1], t[2] - mean[2]];
            (r + g + g + b) / 4.0
        };
        let offsets = texels.each_ref().map(lightness);
        Self {
            mean,
            variance: offsets.iter().map(|v| v * v).sum(),
            farthest: offsets.iter().fold(0.0, |most, v| v.abs().max(most)),
        }
    }
}
