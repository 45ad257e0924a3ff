//! One search among all kinds of candidates.

use super::bare::Bare;
use super::winner::Best;
use super::workshop::Workshop;
use super::{mapped, other_maps, packed};
use crate::asset::scan::Scan;
use crate::error::Result;
use crate::progress::Progress;

/// Returns the smallest candidate that meets the goal of a workshop, or the nearest one.
pub(super) fn round(workshop: &mut Workshop<'_>, progress: Progress<'_>) -> Result<Best> {
    let (mut best, scan) = (Best::default(), workshop.scan());
    if workshop.packs_first() {
        packed::smallest(workshop, &mut best, progress)?;
    }
    // Candidates made from the scan no longer move.
    let is_packed = best.is_mostly_textures() || (scan.about.is_rigged && best.bytes().is_finite());
    if !is_packed && let Some(size) = other_maps::chosen(workshop, &best, progress)? {
        Bare::smallest(workshop, size, &mut best, progress)?;
        mapped::smallest(workshop, size, &mut best, progress)?;
    }
    // The result is no larger than the scan, and no farther from it than necessary.
    let is_enough = best.bytes().is_finite() && best.bytes() <= bytes_of(scan);
    if !is_enough && workshop.may_pack() && !workshop.packs_first() {
        packed::smallest(workshop, &mut best, progress)?;
    }
    Ok(best)
}

/// Returns the bytes of a scan's files; infinite in memory.
fn bytes_of(scan: &Scan) -> f64 {
    if scan.about.bytes > 0 { scan.about.bytes as f64 } else { f64::INFINITY }
}
