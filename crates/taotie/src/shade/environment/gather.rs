//! What many directions see at once: texels are read one by one, and decoded and filtered in packs.

use super::Environment;
use super::octahedron::Octahedron;
use crate::math::{Column, Pack, Vec3, Words, dispatch_pack};
use fearless_simd::Level;

/// Where and how rough mirrors gather light, at most [`crate::math::BATCH`] of them, in the environment's space.
#[derive(Debug, Clone)]
pub(crate) struct Mirrors {
    /// Where light comes from, of any length.
    pub direction: [Column; 3],
    /// [`Environment::place_of`] it.
    pub place: [Column; 2],
    /// [0, 1].
    pub roughness: Column,
}

impl Default for Mirrors {
    fn default() -> Self {
        Self { direction: [Column::ZERO; 3], place: [Column::ZERO; 2], roughness: Column::ZERO }
    }
}

/// Room for texels of two levels.
#[derive(Debug, Clone)]
pub(crate) struct Gatherer {
    below: Taps,
    above: Taps,
    /// How much of the level above is in the mean.
    share: Column,
    /// Those that are smoother than the smoothest level.
    smooth: Vec<usize>,
}

/// The four texels around places in maps.
#[derive(Debug, Clone)]
struct Taps {
    /// Top left, top right, bottom left, bottom right: two words with two half floats each.
    words: [[Words; 2]; 4],
    across: Column,
    down: Column,
    /// What half floats are multiplied by.
    decode: Column,
}

impl Default for Gatherer {
    fn default() -> Self {
        let taps = Taps {
            words: [[Words::ZERO; 2]; 4],
            across: Column::ZERO,
            down: Column::ZERO,
            decode: Column::ZERO,
        };
        Self { below: taps.clone(), above: taps, share: Column::ZERO, smooth: Vec::new() }
    }
}

impl Environment {
    /// [`Self::specular`] of the first `len` mirrors, times `factor`.
    pub(crate) fn gather(
        &self,
        level: Level,
        gatherer: &mut Gatherer,
        (mirrors, len): (&Mirrors, usize),
        factor: f32,
        out: &mut [Column; 3],
    ) {
        gatherer.smooth.clear();
        for i in 0..len {
            let place = [mirrors.place[0][i], mirrors.place[1][i]];
            match self.levels.around(mirrors.roughness[i]) {
                Some((below, above, share)) => {
                    gatherer.below.set(i, below, place);
                    gatherer.above.set(i, above, place);
                    gatherer.share[i] = share;
                }
                None => gatherer.smooth.push(i),
            }
        }
        dispatch_pack!(level, P, token => gatherer.mix::<P>(token, len, factor, out));
        for i in gatherer.smooth.iter().copied() {
            let direction = mirrors.direction.each_ref().map(|column| column[i]);
            let light = self.specular(Vec3::from_array(direction), mirrors.roughness[i]) * factor;
            for (column, value) in out.iter_mut().zip(light.to_array()) {
                column[i] = value;
            }
        }
    }

    /// [`Self::irradiance`] at the first `len` places, times `factor`/π.
    pub(crate) fn gather_mean(
        &self,
        level: Level,
        gatherer: &mut Gatherer,
        (mirrors, len): (&Mirrors, usize),
        factor: f32,
        out: &mut [Column; 3],
    ) {
        let Some(roughest) = self.levels.0.last() else { return };
        for i in 0..len {
            gatherer.below.set(i, &roughest.map, [mirrors.place[0][i], mirrors.place[1][i]]);
        }
        dispatch_pack!(level, P, token => gatherer.below.fill::<P>(token, len, factor, out));
    }
}

impl Gatherer {
    #[inline(always)]
    fn mix<P: Pack>(&self, token: P::Token, len: usize, factor: f32, out: &mut [Column; 3]) {
        let (one, factor) = (P::splat(token, 1.0), P::splat(token, factor));
        for i in (0..len).step_by(P::LANES) {
            let share = P::load(token, &self.share[i..]);
            for (channel, out) in out.iter_mut().enumerate() {
                let below = self.below.filtered::<P>(token, channel, i);
                let above = self.above.filtered::<P>(token, channel, i);
                ((below * (one - share) + above * share) * factor).store(&mut out[i..]);
            }
        }
    }
}

impl Taps {
    /// Reads the texels of point `i`.
    #[inline]
    fn set(&mut self, i: usize, map: &Octahedron, place: [f32; 2]) {
        let (start, [across, down]) = map.taps(place);
        let below = start + map.side() + 2;
        for (words, index) in self.words.iter_mut().zip([start, start + 1, below, below + 1]) {
            let [r, g, b, _] = map.texels().stored(index).map(u32::from);
            (words[0][i], words[1][i]) = (r | g << 16, b);
        }
        (self.across[i], self.down[i], self.decode[i]) = (across, down, map.texels().factor());
    }

    #[inline(always)]
    fn fill<P: Pack>(&self, token: P::Token, len: usize, factor: f32, out: &mut [Column; 3]) {
        let factor = P::splat(token, factor);
        for i in (0..len).step_by(P::LANES) {
            for (channel, out) in out.iter_mut().enumerate() {
                (self.filtered::<P>(token, channel, i) * factor).store(&mut out[i..]);
            }
        }
    }

    /// A channel of the means of the four texels.
    #[inline(always)]
    fn filtered<P: Pack>(&self, token: P::Token, channel: usize, i: usize) -> P {
        let (across, down) = (P::load(token, &self.across[i..]), P::load(token, &self.down[i..]));
        let one = P::splat(token, 1.0);
        let top = self.texel::<P>(token, 0, channel, i) * (one - across)
            + self.texel::<P>(token, 1, channel, i) * across;
        let bottom = self.texel::<P>(token, 2, channel, i) * (one - across)
            + self.texel::<P>(token, 3, channel, i) * across;
        top * (one - down) + bottom * down
    }

    #[inline(always)]
    fn texel<P: Pack>(&self, token: P::Token, corner: usize, channel: usize, i: usize) -> P {
        let half = P::load_half_float(token, &self.words[corner][channel / 2][i..], channel as u32 % 2);
        half * P::load(token, &self.decode[i..])
    }
}
