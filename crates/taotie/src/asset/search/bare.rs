//! Candidates whose relief is only in their vertex normals.

use super::workshop::{AIM, Best, Candidate, Draft, Shape, Workshop, angle_of, is_hit, uv_bits};
use crate::asset::bake::Trial;
use taotie_engine::error::Result;
use taotie_engine::math::Curve;
use taotie_engine::progress::Progress;
use taotie_io::VertexBits;

/// The minimum number of triangles of the finest level.
const LEAST: u32 = 100;
/// The number of triangles of the finest level at which the curve starts.
const START: u32 = 16_000;
/// Candidate bits of normals.
const NORMAL_BITS: [u8; 5] = [7, 8, 9, 10, 12];
/// Candidate bits of positions: the fewest whose steps are at most half of the simplification's own error are used.
/// The fewest of all move an outline by 0.02 % of the longest side.
const POSITION_BITS: [u8; 4] = [11, 12, 13, 14];
/// The number of trials that close in on the goal.
const ROUNDS: usize = 8;

/// A search among candidates without a normal map.
pub(super) struct Bare<'a, 'b> {
    workshop: &'b mut Workshop<'a>,
    /// Texels along a side of maps, 0 if there are none.
    size: u32,
    /// The ratio of angles of meshes over their triangles, without that of rounding.
    errors: Curve,
    /// The ratio of colours over the triangles.
    colors: Curve,
    /// Bytes per triangle for each of [`NORMAL_BITS`].
    rates: [f64; NORMAL_BITS.len()],
}

impl<'a, 'b> Bare<'a, 'b> {
    /// Finds the smallest candidate that reaches the goal, and replaces `best` if it is smaller.
    pub fn smallest(
        workshop: &'b mut Workshop<'a>,
        size: u32,
        best: &mut Best,
        progress: Progress<'_>,
    ) -> Result<()> {
        let (errors, rates) = (Curve::default(), [0.0; NORMAL_BITS.len()]);
        let mut search = Self { workshop, size, errors, colors: Curve::default(), rates };
        search.bracket(best, progress)?;
        let mut tried = Vec::new();
        for _ in 0..ROUNDS {
            let likely = search.likely().filter(|likely| !tried.contains(likely));
            let Some((triangles, normals)) = likely else { break };
            tried.push((triangles, normals));
            let Some(draft) = search.draft(triangles, progress)? else { break };
            let bits = search.bits(&draft, normals);
            let trial = search.add(draft, bits, best)?;
            if is_hit(&trial) {
                break;
            }
        }
        Ok(())
    }

    /// Measures a quarter or four times the triangles until the goal is bracketed.
    fn bracket(&mut self, best: &mut Best, progress: Progress<'_>) -> Result<()> {
        let level = self.workshop.level();
        let rungs = rungs(self.workshop.triangles(), level.triangles(LEAST));
        let start = level.triangles(START);
        let mut at = rungs.partition_point(|count| *count <= start).saturating_sub(1);
        let mut before = None;
        loop {
            let is_met = match self.draft(rungs[at], progress)? {
                Some(draft) => {
                    let trial = self.add(draft, VertexBits::default(), best)?;
                    // More triangles lead further beyond a ceiling.
                    trial.ratio() <= 1.0 || !trial.is_within()
                }
                None => false,
            };
            let last = if is_met { 0 } else { rungs.len() - 1 };
            if at == last || before.is_some_and(|before| before != is_met) {
                return Ok(());
            }
            before = Some(is_met);
            if is_met { at -= 1 } else { at += 1 }
        }
    }

    fn draft(&mut self, triangles: u32, progress: Progress<'_>) -> Result<Option<Draft>> {
        self.workshop.draft(Shape { triangles, size: self.size, has_normal_map: false }, progress)
    }

    /// Tries a candidate and updates the model of the search.
    fn add(&mut self, draft: Draft, bits: VertexBits, best: &mut Best) -> Result<Trial> {
        let rounding = self.workshop.rounding(bits, self.workshop.codecs().least_lossy());
        let trial = self.workshop.trial(&draft, rounding)?;
        let count = trial.triangles as f64;
        self.errors.add(count, remaining(trial.angle_ratio, self.rounding(bits.normals)));
        if let Some(ratio) = trial.color_ratio {
            self.colors.add(count, ratio);
        }
        for (i, normals) in NORMAL_BITS.into_iter().enumerate() {
            let (bits, codecs) = (self.bits(&draft, normals), self.workshop.codecs().set);
            self.rates[i] = draft.mesh_bytes(bits, codecs)? as f64 / count;
        }
        best.offer(Candidate::made(draft, rounding), trial);
        Ok(trial)
    }

    /// Returns the minimum number of triangles within a range at which colours are close enough; its end if there is
    /// none.
    fn least_of_colors(&self, range: [f64; 2]) -> f64 {
        match self.colors == Curve::default() {
            true => range[0],
            false => self.colors.first_within(1.0, range).unwrap_or(range[1]),
        }
    }

    /// Returns the contribution of rounding normals to `bits` bits to the ratio of angles.
    fn rounding(&self, bits: u8) -> f64 {
        self.workshop.goal.ratio_of_mean(angle_of(bits))
    }

    fn bits(&self, draft: &Draft, normals: u8) -> VertexBits {
        VertexBits { positions: position_bits(draft), normals, uvs: uv_bits(self.size) }
    }

    /// Returns the number of triangles and the bits of normals that are likely to reach the goal with the fewest
    /// bytes.
    fn likely(&self) -> Option<(u32, u8)> {
        let all = f64::from(self.workshop.triangles());
        let least = f64::from(self.workshop.level().triangles(LEAST));
        let choices = NORMAL_BITS.into_iter().zip(self.rates).filter_map(|(bits, rate)| {
            let angle = remaining(AIM, self.rounding(bits));
            let range = [least.min(all), all];
            let triangles = self.errors.first_within(angle, range)?.max(self.least_of_colors(range));
            Some((triangles, bits, triangles * rate))
        });
        let (triangles, bits, _) = choices.min_by(|a, b| a.2.total_cmp(&b.2))?;
        Some((triangles.ceil() as u32, bits))
    }
}

/// Returns the numbers of triangles at which the curve is measured, in ascending order: all, a quarter, a sixteenth
/// and so on, down to `least`.
fn rungs(all: u32, least: u32) -> Vec<u32> {
    let quarters = std::iter::successors(Some(all), |count| Some(count / 4));
    let mut rungs: Vec<u32> = quarters.take_while(|count| *count >= least.min(all)).collect();
    rungs.reverse();
    rungs
}

fn position_bits(draft: &Draft) -> u8 {
    let error = draft.low.origin.simplified.as_ref().map_or(0.0, |simplified| simplified.error);
    let step = |bits: u8| draft.low.mesh.diagonal() / f64::from(1u32 << bits);
    POSITION_BITS.into_iter().find(|bits| step(*bits) <= 0.5 * error).unwrap_or(POSITION_BITS[3])
}

/// Returns an error without one of its sources; they add up in squares.
fn remaining(error: f64, source: f64) -> f64 {
    (error * error - source * source).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rungs_rise_to_all() {
        assert_eq!(rungs(70_000, LEAST), [273, 1093, 4375, 17_500, 70_000]);
        assert_eq!((rungs(12, LEAST), rungs(399, LEAST)), (vec![12], vec![399]));
    }
}
