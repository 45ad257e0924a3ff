//! Environment lookup of many directions at a time: levels and positions are computed in packs, texels read one by
//! one, and decoded and filtered in packs.

use super::Environment;
use super::levels::{LevelPosition, Levels, octahedral_taps};
use crate::math::{Column, Pack, Quads, Vec3, Words, dispatch_pack};
use fearless_simd::Level;

/// The directions and roughnesses to look up, at most [`crate::math::BATCH`], in the environment's local space.
#[derive(Debug, Clone)]
pub(crate) struct LookupDirections {
    /// The directions that light comes from, of any length.
    pub direction: [Column; 3],
    /// [`Environment::place_of`] of the directions.
    pub place: [Column; 2],
    /// [0, 1].
    pub roughness: Column,
}

/// A lookup: the points, their number, and the factor of the light.
#[derive(Clone, Copy)]
pub(crate) struct LookupRequest<'a> {
    pub directions: &'a LookupDirections,
    /// The number of points in use, starting at the first.
    pub len: usize,
    /// The factor of the light.
    pub factor: f32,
}

impl Default for LookupDirections {
    fn default() -> Self {
        Self { direction: [Column::ZERO; 3], place: [Column::ZERO; 2], roughness: Column::ZERO }
    }
}

/// The scratch memory of a lookup: texels of two levels.
#[derive(Debug, Clone)]
pub(crate) struct EnvironmentLookup {
    below: Taps,
    above: Taps,
    /// The index of the lower level; −1 if all are rougher.
    number: Column,
    /// The weight of the upper level in the mean.
    share: Column,
}

/// The four texels around positions in maps.
#[derive(Debug, Clone)]
struct Taps {
    /// The indices of the maps, their texels across, and the factors of their half floats.
    map: Words,
    side: Column,
    decode: Column,
    /// The index of the top left texel.
    place: Words,
    across: Column,
    down: Column,
    /// The upper and the lower two texels: each as two words of two half floats each, as the bits of floats.
    rows: [Quads; 2],
}

impl Default for EnvironmentLookup {
    fn default() -> Self {
        let zero = Column::ZERO;
        let taps = Taps {
            map: Words::ZERO,
            side: zero,
            decode: zero,
            place: Words::ZERO,
            across: zero,
            down: zero,
            rows: [Quads::ZERO; 2],
        };
        Self { below: taps.clone(), above: taps, number: zero, share: zero }
    }
}

impl Environment {
    /// [`Self::specular`] of the directions, times the factor.
    pub(crate) fn look_up(
        &self,
        level: Level,
        lookup: &mut EnvironmentLookup,
        request: LookupRequest<'_>,
        out: &mut [Column; 3],
    ) {
        let LookupRequest { directions, len, factor } = request;
        dispatch_pack!(level, P, token => lookup.choose::<P>(token, &directions.roughness, len));
        let EnvironmentLookup { below, above, number, .. } = lookup;
        for (i, number) in number.iter().take(len).enumerate() {
            // As integers: −1 becomes 0.
            let number = *number as u32 as usize;
            below.choose(i, &self.levels, number);
            above.choose(i, &self.levels, number + 1);
        }
        for taps in [below, above] {
            taps.read(level, &self.levels, &directions.place, len);
        }
        dispatch_pack!(level, P, token => lookup.mix::<P>(token, len, factor, out));
        for i in (0..len).filter(|i| lookup.number[*i] < 0.0) {
            let direction = directions.direction.each_ref().map(|column| column[i]);
            let light = self.specular(Vec3::from_array(direction), directions.roughness[i]) * factor;
            for (column, value) in out.iter_mut().zip(light.to_array()) {
                column[i] = value;
            }
        }
    }

    /// [`Self::irradiance`] at the positions, times the factor divided by π.
    pub(crate) fn look_up_mean(
        &self,
        level: Level,
        lookup: &mut EnvironmentLookup,
        request: LookupRequest<'_>,
        out: &mut [Column; 3],
    ) {
        let LookupRequest { directions, len, factor } = request;
        let (taps, roughest) = (&mut lookup.below, self.levels.count() - 1);
        taps.choose_all(&self.levels, roughest, len);
        taps.read(level, &self.levels, &directions.place, len);
        dispatch_pack!(level, P, token => taps.fill::<P>(token, len, factor, out));
    }
}

impl EnvironmentLookup {
    #[inline(always)]
    fn choose<P: Pack>(&mut self, token: P::Token, roughness: &Column, len: usize) {
        for i in (0..len).step_by(P::LANES) {
            let LevelPosition { below, share } = LevelPosition::of(P::load(token, &roughness[i..]));
            below.store(&mut self.number[i..]);
            share.store(&mut self.share[i..]);
        }
    }

    #[inline(always)]
    fn mix<P: Pack>(&self, token: P::Token, len: usize, factor: f32, out: &mut [Column; 3]) {
        let (one, factor) = (P::splat(token, 1.0), P::splat(token, factor));
        let [r, g, b] = out;
        for i in (0..len).step_by(P::LANES) {
            let share = P::load(token, &self.share[i..]);
            let [below_r, below_g, below_b] = self.below.filtered::<P>(token, i);
            let [above_r, above_g, above_b] = self.above.filtered::<P>(token, i);
            ((below_r * (one - share) + above_r * share) * factor).store(&mut r[i..]);
            ((below_g * (one - share) + above_g * share) * factor).store(&mut g[i..]);
            ((below_b * (one - share) + above_b * share) * factor).store(&mut b[i..]);
        }
    }
}

impl Taps {
    /// Looks up point `i` in a map.
    #[inline(always)]
    fn choose(&mut self, i: usize, levels: &Levels, number: usize) {
        let map = levels.numbered(number);
        self.map[i] = number as u32;
        self.side[i] = map.side() as f32;
        self.decode[i] = map.texels().factor();
    }

    /// Looks up the first `len` points in one map.
    fn choose_all(&mut self, levels: &Levels, number: usize, len: usize) {
        let map = levels.numbered(number);
        self.map[..len].fill(number as u32);
        self.side[..len].fill(map.side() as f32);
        self.decode[..len].fill(map.texels().factor());
    }

    /// Reads the texels around the positions.
    fn read(&mut self, level: Level, levels: &Levels, places: &[Column; 2], len: usize) {
        dispatch_pack!(level, P, token => self.find::<P>(token, places, len));
        let (maps, places) = (&self.map[..len], &self.place[..len]);
        let [top, bottom] = &mut self.rows;
        let (top, bottom) = (&mut top[..len], &mut bottom[..len]);
        for i in 0..len {
            let (map, start) = (levels.numbered(maps[i] as usize), places[i] as usize);
            top[i] = words(map.texels().two(start));
            bottom[i] = words(map.texels().two(start + map.side() + 2));
        }
    }

    #[inline(always)]
    fn find<P: Pack>(&mut self, token: P::Token, [u, v]: &[Column; 2], len: usize) {
        let two = P::splat(token, 2.0);
        for i in (0..len).step_by(P::LANES) {
            let side = P::load(token, &self.side[i..]);
            let (left, across) = octahedral_taps(P::load(token, &u[i..]), side);
            let (top, down) = octahedral_taps(P::load(token, &v[i..]), side);
            left.store_place(top, side + two, &mut self.place[i..]);
            across.store(&mut self.across[i..]);
            down.store(&mut self.down[i..]);
        }
    }

    #[inline(always)]
    fn fill<P: Pack>(&self, token: P::Token, len: usize, factor: f32, out: &mut [Column; 3]) {
        let factor = P::splat(token, factor);
        let [r, g, b] = out;
        for i in (0..len).step_by(P::LANES) {
            let [red, green, blue] = self.filtered::<P>(token, i);
            (red * factor).store(&mut r[i..]);
            (green * factor).store(&mut g[i..]);
            (blue * factor).store(&mut b[i..]);
        }
    }

    /// The means of the four texels, linear RGB.
    #[inline(always)]
    fn filtered<P: Pack>(&self, token: P::Token, i: usize) -> [P; 3] {
        let top: [P; 4] = P::load_pixels(token, &self.rows[0][i..]);
        let bottom: [P; 4] = P::load_pixels(token, &self.rows[1][i..]);
        let red = self.mean(token, [top[0], top[2], bottom[0], bottom[2]], 0, i);
        let green = self.mean(token, [top[0], top[2], bottom[0], bottom[2]], 1, i);
        [red, green, self.mean(token, [top[1], top[3], bottom[1], bottom[3]], 0, i)]
    }

    /// The mean of one half of four words.
    #[inline(always)]
    fn mean<P: Pack>(&self, token: P::Token, [a, b, c, d]: [P; 4], half: u32, i: usize) -> P {
        let (across, down) = (P::load(token, &self.across[i..]), P::load(token, &self.down[i..]));
        let (one, decode) = (P::splat(token, 1.0), P::load(token, &self.decode[i..]));
        let (a, b) = (a.half_float(half) * decode, b.half_float(half) * decode);
        let (c, d) = (c.half_float(half) * decode, d.half_float(half) * decode);
        let top = a * (one - across) + b * across;
        let bottom = c * (one - across) + d * across;
        top * (one - down) + bottom * down
    }
}

/// Two texels as the bits of floats.
#[inline(always)]
fn words([a, b]: [[u16; 3]; 2]) -> [f32; 4] {
    let word = |low: u16, high: u16| f32::from_bits(u32::from(low) | u32::from(high) << 16);
    [word(a[0], a[1]), word(a[2], 0), word(b[0], b[1]), word(b[2], 0)]
}
