//! Candidates that are the scan itself, packed: with its nodes, materials, uvs, skins and animations, fewer triangles, and
//! textures that are smaller or lossy.

use super::curve::Curve;
use super::trial::Trial;
use super::winner::{Candidate, Winner};
use super::workshop::{MOST_ERROR, QUALITIES, Workshop, uv_bits};
use crate::asset::scan::Scan;
use crate::error::{Error, Result, Warnings};
use crate::image::Encoding;
use crate::io::{self, GltfPacker, GltfSource, PackedGeometry, PackedImage, VertexBits};
use crate::parallel;
use crate::progress::Progress;
use std::ops::Range;

/// Textures begin with at most so many texels along the longer side, and are doubled until they are near enough.
const LEAST_SIDE: u32 = 128;
/// The number of the quality at which the size of colours is chosen.
const MIDDLING: usize = 2;
/// The part of the largest difference of colours that textures may use up; the rest is for fewer triangles.
const COLOR_SHARE: f64 = 0.9;
/// Textures that are neither colours nor normals are not tried with more texels unless fewer are not near enough.
const USUAL_SIDE: u32 = 1024;
/// Bits of positions and normals of which errors are measured, from the fewest up.
const BITS: [[u8; 2]; 5] = [[11, 8], [12, 8], [13, 9], [14, 10], [15, 12]];
/// Fewer triangles are tried until the error is so many times too large.
const FAR: f64 = 1.5;
/// The least part of the triangles that is kept.
const LEAST_KEPT: f64 = 1.0 / 256.0;
/// Trials that close in on the goal, and the part of the angle that is aimed at after one that missed it.
const ROUNDS: usize = 10;
const AFTER_MISS: f64 = 0.985;
/// A candidate is tried if its forecast has at most this part of the bytes of the smallest one so far.
const WORTH: f64 = 0.99;

/// Puts the smallest packed scan that reaches the goal in the place of a larger candidate.
pub(super) fn smallest(
    workshop: &mut Workshop<'_>,
    best: &mut Option<Winner>,
    progress: Progress<'_>,
) -> Result<()> {
    if !workshop.may_pack() {
        return Ok(());
    }
    progress.begin("pack the scan")?;
    match searched(workshop, best, progress) {
        Err(error) if !matches!(error, Error::Cancelled) => {
            workshop.not_packed = Some(error);
            Ok(())
        }
        done => done,
    }
}

fn searched(workshop: &mut Workshop<'_>, best: &mut Option<Winner>, progress: Progress<'_>) -> Result<()> {
    let packer = packer(workshop.scan())?;
    let mut search = PackedScan { workshop, packer, images: Vec::new(), floor: 0.0, progress };
    search.measure(best)
}

/// Opens the file of a scan; one that is no glTF is made glTF.
fn packer(scan: &Scan) -> Result<GltfPacker> {
    let path = scan.path();
    if io::is_gltf(path).unwrap_or(false) {
        return GltfPacker::open(GltfSource::File(path), &scan.limits);
    }
    let scene = scan.surface().clone().into_scene()?;
    let mut lost = Warnings::default();
    let bytes = io::encode_scene(&scene, &[], &mut lost)?;
    drop(scene);
    match lost.iter().next() {
        Some((what, _)) => Err(Error::unsupported("the scan as glTF", what)),
        None => GltfPacker::open(GltfSource::Glb(&bytes), &scan.limits),
    }
}

/// A search among packings of a scan.
struct PackedScan<'a, 'b> {
    workshop: &'b mut Workshop<'a>,
    packer: GltfPacker,
    /// Those that were chosen so far; others are as the scan has them.
    images: Vec<PackedImage>,
    /// The square of the error of all triangles with normal maps as they are.
    floor: f64,
    progress: Progress<'b>,
}

/// Normal maps in some size and quality, or rounded vertices: what they add to the square of the error, and their bytes.
struct Choice<T> {
    of: T,
    squared: f64,
    bytes: f64,
}

/// Normal maps, one for each image of normals.
#[derive(Clone)]
struct NormalMaps {
    images: Vec<PackedImage>,
    quality: Option<u8>,
}

const WHOLE: PackedGeometry = PackedGeometry { kept: 1.0, bits: vertex_bits(BITS[BITS.len() - 1]) };

/// Returns bits of positions and normals; those of uvs follow from textures.
const fn vertex_bits([positions, normals]: [u8; 2]) -> VertexBits {
    VertexBits { positions, normals, uvs: 16 }
}

impl PackedScan<'_, '_> {
    fn measure(&mut self, best: &mut Option<Winner>) -> Result<()> {
        self.choose_colors()?;
        self.choose_numbers()?;
        let whole = self.trial(WHOLE, None, best)?;
        if whole.mean_angle > self.workshop.goal.angle {
            return Ok(());
        }
        self.floor = whole.mean_angle * whole.mean_angle;
        let maps = self.normal_maps(best)?;
        let bits = self.bits(&whole, best)?;
        let (mut errors, mut bytes, mut colors) = (Curve::default(), Curve::default(), Curve::default());
        let (mut kept, mut before) = (1.0, usize::MAX);
        loop {
            let trial =
                if kept < 1.0 { self.trial(PackedGeometry { kept, ..WHOLE }, None, best)? } else { whole };
            errors.add(kept, trial.mean_angle);
            bytes.add(kept, trial.bytes as f64);
            colors.add(kept, trial.mean_color.unwrap_or_default());
            let is_far = trial.mean_angle > FAR * self.workshop.goal.angle || kept <= LEAST_KEPT;
            if is_far || trial.triangles >= before {
                break;
            }
            before = trial.triangles;
            kept *= 0.5;
        }
        let most_color = self.workshop.goal.color;
        self.close_in(
            Forecast { whole, maps, bits, errors, bytes, colors, most_color, floor: self.floor },
            best,
        )
    }

    /// Makes, writes and measures a candidate.
    fn trial(
        &mut self,
        geometry: PackedGeometry,
        maps: Option<&NormalMaps>,
        best: &mut Option<Winner>,
    ) -> Result<Trial> {
        self.progress.begin("pack the scan")?;
        let mut images = self.images.clone();
        images.extend(maps.into_iter().flat_map(|maps| &maps.images).cloned());
        let size = self.longest_side(&images);
        let bits = VertexBits { uvs: size.map_or(geometry.bits.uvs, uv_bits), ..geometry.bits };
        let glb = self.packer.encode(PackedGeometry { bits, ..geometry }, &images)?;
        let about = Trial {
            is_scan: true,
            size: size.unwrap_or_default(),
            has_normal_map: self.normals().next().is_some(),
            quality: maps.and_then(|maps| maps.quality),
            bits,
            ..Trial::default()
        };
        let trial = self.workshop.measured(about, glb.clone())?;
        if trial.is_near {
            let of_images = images.iter().map(|image| image.bytes.len() as u64).sum();
            Winner::replace(best, Winner { candidate: Candidate::Packed { glb, of_images }, trial });
        }
        Ok(trial)
    }

    /// Returns the longest side of any image if these are in place of its own; `None` if that is unknown.
    fn longest_side(&self, images: &[PackedImage]) -> Option<u32> {
        self.packer.longest_side()?;
        let side = |number: usize| {
            let packed = images.iter().find(|image| image.number == number).map(|image| image.side);
            packed.or_else(|| self.packer.image(number).map(|(_, side)| side))
        };
        // One that stays as it is counts as the longest.
        (0..self.packer.image_count())
            .map(|number| side(number).or(self.packer.longest_side()))
            .try_fold(0, |longest, side| Some(side?.max(longest)))
    }

    fn of_encoding(&self, wanted: Encoding) -> impl Iterator<Item = usize> {
        let encoding = |number: &usize| self.packer.image(*number).map(|(encoding, _)| encoding);
        (0..self.packer.image_count()).filter(move |number| encoding(number) == Some(wanted))
    }

    fn normals(&self) -> impl Iterator<Item = usize> {
        self.of_encoding(Encoding::Normal)
    }

    /// Encodes images with at most `side` texels along the longer side.
    fn encoded(&self, numbers: &[usize], side: u32, quality: Option<u8>) -> Result<Vec<PackedImage>> {
        let encode = |i: usize| self.packer.encode_image(numbers[i], side, quality);
        Ok(parallel::try_tasks(numbers.len(), &encode)?.into_iter().flatten().collect())
    }

    /// Returns the sides to try for images, from the shortest up.
    fn sides(&self, numbers: &[usize]) -> Vec<u32> {
        let longest =
            numbers.iter().filter_map(|number| self.packer.image(*number)).map(|(_, side)| side).max();
        let longest = longest.unwrap_or_default();
        let doubled = std::iter::successors(Some(LEAST_SIDE), |side| side.checked_mul(2));
        doubled.take_while(|side| *side < longest).chain((longest > 0).then_some(longest)).collect()
    }

    /// Chooses the smallest colours that are near enough: the least side at a middling quality, then the quality. If none is
    /// they stay as they are.
    fn choose_colors(&mut self) -> Result<()> {
        let numbers: Vec<usize> = self.of_encoding(Encoding::Srgb).collect();
        let sides = self.sides(&numbers);
        for side in &sides {
            let highest = if Some(side) == sides.last() { QUALITIES.len() } else { MIDDLING + 1 };
            for quality in MIDDLING..highest {
                let Some(enough) = self.near_colors(&numbers, *side, quality)? else { continue };
                let lower = if quality == MIDDLING { 0..MIDDLING } else { 0..0 };
                self.images = self.first_near(&numbers, *side, lower)?.unwrap_or(enough);
                return Ok(());
            }
        }
        Ok(())
    }

    /// Returns colours in the first of some qualities, by their numbers, in which they are near enough.
    fn first_near(
        &mut self,
        numbers: &[usize],
        side: u32,
        qualities: Range<usize>,
    ) -> Result<Option<Vec<PackedImage>>> {
        for quality in qualities {
            if let Some(images) = self.near_colors(numbers, side, quality)? {
                return Ok(Some(images));
            }
        }
        Ok(None)
    }

    /// Returns colours of a side and of the number of a quality if they leave something for fewer triangles.
    fn near_colors(
        &mut self,
        numbers: &[usize],
        side: u32,
        quality: usize,
    ) -> Result<Option<Vec<PackedImage>>> {
        self.images = self.encoded(numbers, side, Some(QUALITIES[quality]))?;
        let trial = self.trial(WHOLE, None, &mut None)?;
        let images = std::mem::take(&mut self.images);
        let most = COLOR_SHARE * self.workshop.goal.color;
        Ok(trial.mean_color.is_none_or(|color| color <= most).then_some(images))
    }

    /// Chooses the smallest of other textures whose own error is small enough, each by itself.
    fn choose_numbers(&mut self) -> Result<()> {
        let numbers: Vec<usize> = self.of_encoding(Encoding::Linear).collect();
        let chosen = parallel::try_tasks(numbers.len(), &|i| self.smallest_numbers(numbers[i]))?;
        self.images.extend(chosen.into_iter().flatten());
        Ok(())
    }

    fn smallest_numbers(&self, number: usize) -> Result<Option<PackedImage>> {
        let mut best: Option<PackedImage> = None;
        for side in self.sides(&[number]) {
            if side > USUAL_SIDE && best.is_some() {
                break;
            }
            for quality in QUALITIES {
                let Some(image) = self.encoded(&[number], side, Some(quality))?.into_iter().next() else {
                    break;
                };
                if best.as_ref().is_some_and(|best| best.bytes.len() <= image.bytes.len()) {
                    break;
                }
                if self.packer.image_error(&image)? <= MOST_ERROR {
                    best = Some(image);
                    break;
                }
            }
        }
        match best {
            Some(best) => Ok(Some(best)),
            None => Ok(self.encoded(&[number], u32::MAX, None)?.into_iter().next()),
        }
    }

    /// Measures normal maps in sizes and qualities whose error is not far beyond the goal.
    fn normal_maps(&mut self, best: &mut Option<Winner>) -> Result<Vec<Choice<Option<NormalMaps>>>> {
        let mut choices = vec![Choice { of: None, squared: 0.0, bytes: 0.0 }];
        let numbers: Vec<usize> = self.normals().collect();
        if numbers.is_empty() {
            return Ok(choices);
        }
        let (goal, mut before) = (self.workshop.goal.angle, None);
        for side in self.sides(&numbers) {
            let of_side = self.normal_maps_of(&numbers, side, best)?;
            let angle = of_side.first().map_or(0.0, |highest| (highest.squared + self.floor).sqrt());
            choices.extend(of_side);
            if let Some(smaller) = before.filter(|_| angle < goal) {
                // In between there may be one that is just near enough.
                choices.extend(self.normal_maps_of(&numbers, u32::midpoint(smaller, side), best)?);
            }
            if angle < 0.5 * goal {
                break;
            }
            before = (angle >= goal).then_some(side);
        }
        Ok(choices)
    }

    /// Measures normal maps of a size in falling quality until their error is beyond the goal.
    fn normal_maps_of(
        &mut self,
        numbers: &[usize],
        side: u32,
        best: &mut Option<Winner>,
    ) -> Result<Vec<Choice<Option<NormalMaps>>>> {
        let mut choices = Vec::with_capacity(QUALITIES.len() + 1);
        let lossy = QUALITIES.into_iter().rev().map(Some);
        for quality in std::iter::once(None).chain(lossy) {
            let images = self.encoded(numbers, side, quality)?;
            let maps = NormalMaps { images, quality };
            let trial = self.trial(WHOLE, Some(&maps), best)?;
            choices.push(Choice { of: Some(maps), squared: self.added(&trial), bytes: trial.bytes as f64 });
            if trial.mean_angle > self.workshop.goal.angle {
                break;
            }
        }
        Ok(choices)
    }

    /// Returns what a trial adds to the square of the error of the whole.
    fn added(&self, trial: &Trial) -> f64 {
        (trial.mean_angle * trial.mean_angle - self.floor).max(0.0)
    }

    /// Measures vertices in fewer bits.
    fn bits(&mut self, whole: &Trial, best: &mut Option<Winner>) -> Result<Vec<Choice<VertexBits>>> {
        let mut choices = Vec::with_capacity(BITS.len());
        let whole = Choice { of: WHOLE.bits, squared: 0.0, bytes: whole.bytes as f64 };
        for bits in BITS[..BITS.len() - 1].iter().copied().map(vertex_bits) {
            let trial = self.trial(PackedGeometry { bits, ..WHOLE }, None, best)?;
            choices.push(Choice { of: bits, squared: self.added(&trial), bytes: trial.bytes as f64 });
        }
        choices.push(whole);
        Ok(choices)
    }

    /// Tries what is likely to be the smallest, and learns from it.
    fn close_in(&mut self, mut forecast: Forecast, best: &mut Option<Winner>) -> Result<()> {
        let goal = self.workshop.goal;
        let (mut tried, mut aim) = (Vec::new(), goal.aim());
        for _ in 0..ROUNDS {
            let Some(Likely { choice, bytes }) = forecast.smallest(aim) else { break };
            let is_worth = best.as_ref().is_none_or(|best| bytes <= WORTH * best.trial.bytes as f64);
            if !is_worth || tried.contains(&choice) {
                break;
            }
            tried.push(choice);
            let Combined { kept, maps, bits } = choice;
            let geometry = PackedGeometry { kept, bits: forecast.bits[bits].of };
            let trial = self.trial(geometry, forecast.maps[maps].of.as_ref(), best)?;
            forecast.learn(choice, &trial);
            if goal.is_hit(&trial) {
                break;
            }
            if trial.mean_angle > goal.angle {
                aim *= AFTER_MISS;
            }
        }
        Ok(())
    }
}

/// The estimated bytes and errors of packed scans.
struct Forecast {
    /// All triangles with all bits, and normal maps as the scan has them.
    whole: Trial,
    maps: Vec<Choice<Option<NormalMaps>>>,
    bits: Vec<Choice<VertexBits>>,
    /// The error over the part of the triangles that is kept, and the bytes.
    errors: Curve,
    bytes: Curve,
    /// The square of the error of the whole.
    floor: f64,
    /// The difference of colours over the part of the triangles, and the largest that may be.
    colors: Curve,
    most_color: f64,
}

/// A part of the triangles, and the numbers of the normal maps and bits among those that were measured.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Combined {
    kept: f64,
    maps: usize,
    bits: usize,
}

/// What is likely to be the smallest.
struct Likely {
    choice: Combined,
    bytes: f64,
}

impl Forecast {
    /// Returns the packing that is likely to have the fewest bytes with an error of at most `angle`.
    fn smallest(&self, angle: f64) -> Option<Likely> {
        let whole = self.whole.bytes as f64;
        let mut best: Option<Likely> = None;
        for (m, maps) in self.maps.iter().enumerate() {
            for (b, bits) in self.bits.iter().enumerate() {
                let Some(kept) = self.kept_within(angle * angle - maps.squared - bits.squared) else {
                    continue;
                };
                // Fewer bits save in proportion to the triangles.
                let of_vertices = self.bytes.at(kept) - whole + (bits.bytes - whole) * kept;
                let of_maps = if maps.of.is_some() { maps.bytes - whole } else { 0.0 };
                let bytes = whole + of_vertices + of_maps;
                if best.as_ref().is_none_or(|best| bytes < best.bytes) {
                    best = Some(Likely { choice: Combined { kept, maps: m, bits: b }, bytes });
                }
            }
        }
        best
    }

    /// Returns the least part of the triangles whose error has at most this square.
    fn kept_within(&self, squared: f64) -> Option<f64> {
        if squared < self.floor {
            return None;
        }
        let range = [LEAST_KEPT, 1.0];
        let found = self.errors.first_within(squared.sqrt(), range).unwrap_or(1.0);
        let with_colors = self.colors.first_within(self.most_color, range).unwrap_or(1.0);
        Some(found.max(with_colors).clamp(LEAST_KEPT, 1.0))
    }

    /// Takes the error of the triangles that a trial had.
    fn learn(&mut self, Combined { kept, maps, bits }: Combined, trial: &Trial) {
        let squared = trial.mean_angle * trial.mean_angle - self.maps[maps].squared - self.bits[bits].squared;
        self.errors.add(kept, squared.max(self.floor).sqrt());
        self.colors.add(kept, trial.mean_color.unwrap_or_default());
    }
}
