//! Candidates that are the scan itself, packed: with its nodes, materials, uvs, skins and animations, fewer
//! triangles, and smaller or lossy textures.

use super::encodings::{EncodedTexture, Encodings, NORMAL_RATIOS};
use super::workshop::{AIM, Best, Candidate, Workshop, angle_of, is_hit, uv_bits};
use crate::asset::bake::Trial;
use crate::asset::source::Scan;
use taotie_engine::error::{Error, Result, Warnings};
use taotie_engine::image::Encoding;
use taotie_engine::math::Curve;
use taotie_engine::parallel;
use taotie_engine::progress::Progress;
use taotie_engine::proof::{Relook, Shown};
use taotie_io::{
    CodecSet, GltfPacker, GltfSource, ImageCodec, LossyTexture, PackedGeometry, PackedImage, VertexBits,
};

/// The fractions of their limits that colours may use up; the rest is for fewer triangles. Triangles are measured
/// with the first.
const COLOR_SHARES: [f64; 2] = [0.9, 0.95];
/// The index of the ratio in [`NORMAL_RATIOS`] with which triangles are measured.
const MIDDLING: usize = 2;
/// Bits of positions and normals, in ascending order.
const BITS: [[u8; 2]; 4] = [[12, 8], [13, 9], [14, 10], [15, 12]];
/// Fewer triangles are tried until the error exceeds its limit by this factor.
const FAR: f64 = 1.5;
/// The minimum fraction of the triangles that is kept.
const LEAST_KEPT: f64 = 1.0 / 256.0;
/// The number of trials that close in on the goal, and the factor on the target ratio after one that missed it.
const ROUNDS: usize = 10;
const AFTER_MISS: f64 = 0.985;
/// The factor on the fraction of kept triangles after a candidate beyond a ceiling.
const LESS: f64 = 0.95;
/// A candidate is tried if its forecast is at most this fraction of the bytes of the smallest one so far.
const WORTH: f64 = 0.99;

/// Finds the smallest packed scan that reaches the goal, and replaces `best` if it is smaller.
pub(super) fn smallest(workshop: &mut Workshop<'_>, best: &mut Best, progress: Progress<'_>) -> Result<()> {
    progress.at(0.0)?;
    match with(workshop, progress, &mut |mut search| search.measure(best)) {
        Err(error) if !matches!(error, Error::Cancelled) => {
            workshop.not_packed = Some(error);
            Ok(())
        }
        done => done,
    }
}

/// Opens the scan's file and examines its images, for a search.
fn with(
    workshop: &mut Workshop<'_>,
    progress: Progress<'_>,
    search: &mut dyn FnMut(PackedScan<'_, '_>) -> Result<()>,
) -> Result<()> {
    let (packer, losses) = &packer(workshop.scan())?;
    workshop.packing_losses = losses.clone();
    let look = Relook::new(workshop.side(), workshop.picture());
    let of_image = |number: usize| {
        let texture = packer.image(number)?;
        let shown = shown(workshop.scan(), texture)?;
        Some(
            look.at(shown)
                .map(|look| (number, Encodings::new(texture, look, (&workshop.goal, workshop.codecs())))),
        )
    };
    let encodings = (0..packer.image_count()).filter_map(of_image).collect::<Result<Vec<_>>>()?;
    let encodings = within_ceiling(encodings, packer, workshop);
    search(PackedScan {
        workshop,
        packer,
        encodings,
        images: Vec::new(),
        keeps_uvs: false,
        keeps_colors: false,
        progress,
    })
}

/// Limits images to the texels that fit the graphics memory ceiling, all by the same factor.
fn within_ceiling<'a>(
    encodings: Vec<(usize, Encodings<'a>)>,
    packer: &GltfPacker,
    workshop: &Workshop<'_>,
) -> Vec<(usize, Encodings<'a>)> {
    let own = (0..packer.image_count()).filter_map(|number| packer.image(number)).map(LossyTexture::texels);
    let part = workshop.ceilings.most_texels(workshop.codecs()) / own.sum::<u64>() as f64;
    let part = if part < 1.0 { part.sqrt() } else { 1.0 };
    encodings.into_iter().map(|(number, encodings)| (number, encodings.within(part))).collect()
}

/// Returns the textures of a scan that show an image of its file; `None` if none does.
fn shown(scan: &Scan, image: &LossyTexture) -> Option<Shown> {
    let all = scan.surface().textures().iter().enumerate();
    let those = all
        .filter(|(_, texture)| texture.encoding() == image.encoding() && texture.bitmap() == image.bitmap());
    let textures: Vec<usize> = those.map(|(number, _)| number).collect();
    (!textures.is_empty()).then(|| Shown { textures, encoding: image.encoding() })
}

/// Opens the file of a scan, or converts the scan to glTF if its file is in another format, it has several, or it was
/// changed since. Also returns the losses of that. Those that affect angles or colours are measured with the candidate,
/// and all others also occur in candidates made from the scan.
pub(super) fn packer(scan: &Scan) -> Result<(GltfPacker, Warnings)> {
    let mut lost = Warnings::default();
    if let Some(path) = scan.packed_file().filter(|path| taotie_io::is_gltf(path).unwrap_or(false)) {
        return Ok((GltfPacker::open(GltfSource::File(path), &scan.limits)?, lost));
    }
    let scene = scan.surface().clone().into_scene()?;
    let bytes = taotie_io::encode_scene(&scene, &[], &mut lost)?;
    drop(scene);
    Ok((GltfPacker::open(GltfSource::Glb(&bytes), &scan.limits)?, lost))
}

/// A search among packings of a scan.
struct PackedScan<'a, 'b> {
    workshop: &'b mut Workshop<'a>,
    packer: &'b GltfPacker,
    /// Each image that can be re-encoded, by its number.
    encodings: Vec<(usize, Encodings<'b>)>,
    /// The chosen images of colours and other numbers.
    images: Vec<PackedImage>,
    /// `true` if uvs keep all their bits, since colours need them.
    keeps_uvs: bool,
    /// `true` if colours are kept as is.
    keeps_colors: bool,
    progress: Progress<'b>,
}

/// A choice, with its contribution to the square of the ratio and to the bytes, relative to all triangles with the
/// original normal maps.
struct Choice<T> {
    of: T,
    squared: f64,
    bytes: f64,
}

/// Images that replace a scan's own.
#[derive(Clone, Default)]
struct Images {
    images: Vec<PackedImage>,
    /// The largest ratio of any of them.
    ratio: f64,
    /// The format of the first of them.
    codec: Option<ImageCodec>,
    /// Their bytes minus those of the images they replace.
    bytes: f64,
}

impl Images {
    fn has(&self, number: usize) -> bool {
        self.images.iter().any(|image| image.number == number)
    }
}

const WHOLE: PackedGeometry =
    PackedGeometry { kept: 1.0, bits: vertex_bits(BITS[BITS.len() - 1]), codecs: CodecSet::Portable };

/// Returns bits of positions and normals; those of uvs follow from textures.
const fn vertex_bits([positions, normals]: [u8; 2]) -> VertexBits {
    VertexBits { positions, normals, uvs: 16 }
}

impl PackedScan<'_, '_> {
    fn measure(&mut self, best: &mut Best) -> Result<()> {
        self.images = self.chosen(Encoding::Linear, 1.0)?.images;
        let mut of_colors = self.chosen(Encoding::Srgb, COLOR_SHARES[0])?;
        self.images.extend(of_colors.images.clone());
        let maps = self.normal_maps()?;
        let base = &maps[MIDDLING.min(maps.len() - 1)];
        let whole = self.with_near_colors(&base.of, best)?;
        let floor = (whole.angle_ratio * whole.angle_ratio - base.squared).max(0.0);
        let bits = self.bits()?;
        let (mut errors, mut bytes, mut colors) = (Curve::default(), Curve::default(), Curve::default());
        let (mut kept, mut before, mut least_kept) = (1.0, usize::MAX, LEAST_KEPT);
        loop {
            let fewer = PackedGeometry { kept, ..WHOLE };
            let trial = if kept < 1.0 { self.trial(fewer, &base.of, best)? } else { whole };
            let squared = trial.angle_ratio * trial.angle_ratio - base.squared;
            errors.add(kept, squared.max(floor).sqrt());
            bytes.add(kept, trial.bytes as f64 - base.bytes);
            colors.add(kept, trial.color_ratio.unwrap_or_default());
            if trial.triangles >= before {
                least_kept = kept * 2.0;
                break;
            }
            if trial.angle_ratio > FAR || kept <= LEAST_KEPT {
                break;
            }
            before = trial.triangles;
            kept *= 0.5;
        }
        let has_textures = !self.encodings.is_empty();
        let most_kept =
            (self.workshop.ceilings.most_triangles(has_textures) / whole.triangles as f64).min(1.0);
        let mut forecast = Forecast { maps, bits, errors, bytes, colors, floor, least_kept, most_kept };
        self.close_in(&mut forecast, best)?;
        for most in &COLOR_SHARES[1..] {
            let lossier = self.chosen(Encoding::Srgb, *most)?;
            if lossier.bytes < of_colors.bytes && !self.keeps_colors {
                forecast.take_colors([&of_colors, &lossier]);
                self.images.retain(|image| !of_colors.has(image.number));
                self.images.extend(lossier.images.clone());
                of_colors = lossier;
                self.close_in(&mut forecast, best)?;
            }
        }
        self.fit_ceilings(&forecast, best)
    }

    /// Tries the candidate closest to the scan within the ceilings, if none so far is within them.
    fn fit_ceilings(&mut self, forecast: &Forecast, best: &mut Best) -> Result<()> {
        let Some(maps) = forecast.maps.last() else { return Ok(()) };
        let mut kept = forecast.most_kept;
        for _ in 0..ROUNDS {
            if best.is_within() || kept < LEAST_KEPT {
                break;
            }
            let trial = self.trial(PackedGeometry { kept, ..WHOLE }, &maps.of, best)?;
            kept *= LESS / trial.ceiling_ratio.max(1.0);
        }
        Ok(())
    }

    /// Measures all triangles. If colours are too far off, uvs keep their bits; if they still are, colours are kept
    /// as is.
    fn with_near_colors(&mut self, maps: &Images, best: &mut Best) -> Result<Trial> {
        let mut trial = self.trial(WHOLE, maps, best)?;
        let is_far = |trial: &Trial| trial.color_ratio.is_some_and(|ratio| ratio > 1.0);
        if is_far(&trial) {
            self.keeps_uvs = true;
            trial = self.trial(WHOLE, maps, best)?;
        }
        if is_far(&trial) {
            let colors: Vec<usize> = self.of_encoding(Encoding::Srgb).map(|(number, _)| *number).collect();
            self.images.retain(|image| !colors.contains(&image.number));
            self.images.extend(self.replaced(Encoding::Srgb)?.images);
            self.keeps_colors = true;
            trial = self.trial(WHOLE, maps, best)?;
        }
        Ok(trial)
    }

    /// Makes, writes and measures a candidate.
    fn trial(&mut self, geometry: PackedGeometry, maps: &Images, best: &mut Best) -> Result<Trial> {
        self.progress.at(0.0)?;
        let images: Vec<PackedImage> = self.images.iter().chain(&maps.images).cloned().collect();
        let (size, geometry) = self.completed(geometry, &images);
        let glb = self.packer.encode(geometry, &images)?;
        let about = Trial {
            is_scan: true,
            size: size.unwrap_or_default(),
            has_normal_map: self.of_encoding(Encoding::Normal).next().is_some(),
            normals: maps.codec,
            bits: geometry.bits,
            ..Trial::default()
        };
        let trial = self.workshop.measured(about, glb.clone())?;
        best.offer(Candidate::Packed { glb, geometry, images }, trial);
        Ok(trial)
    }

    /// Returns the longest side of any image after these replacements, `None` if unknown, and the geometry with the
    /// bits that uvs then need and the extension of the workshop's codecs.
    fn completed(&self, geometry: PackedGeometry, images: &[PackedImage]) -> (Option<u32>, PackedGeometry) {
        let side = |number: usize| {
            let packed = images.iter().find(|image| image.number == number).map(|image| image.side);
            // An image kept as is counts as the longest.
            packed
                .or_else(|| self.packer.image(number).map(LossyTexture::side))
                .or(self.packer.longest_side())
        };
        let sides = (0..self.packer.image_count()).map(side);
        let longest = sides.chain([self.packer.longest_side().map(|_| 0)]);
        let size = longest.into_iter().try_fold(0, |longest, side| Some(side?.max(longest)));
        let uvs = size.filter(|_| !self.keeps_uvs).map_or(geometry.bits.uvs, uv_bits);
        let codecs = self.workshop.codecs().set;
        (size, PackedGeometry { bits: VertexBits { uvs, ..geometry.bits }, codecs, ..geometry })
    }

    fn of_encoding(&self, wanted: Encoding) -> impl Iterator<Item = &(usize, Encodings<'_>)> {
        self.encodings.iter().filter(move |(_, encodings)| encodings.encoding() == wanted)
    }

    /// Returns the smallest images of an encoding, each with a ratio of at most `most`; those that would not get
    /// smaller are kept.
    fn chosen(&self, wanted: Encoding, most: f64) -> Result<Images> {
        let of: Vec<_> = self.of_encoding(wanted).collect();
        let found = parallel::try_tasks(of.len(), &|i| of[i].1.smallest(most))?;
        let mut chosen = Images::default();
        for (image, found) in of.into_iter().zip(found) {
            match found {
                Some(found) => self.put(image, found, &mut chosen),
                None if self.may_stay(image) => {}
                None => self.put(image, image.1.nearest()?, &mut chosen),
            }
        }
        Ok(chosen)
    }

    /// Returns the images of an encoding that cannot be kept as is, with the least loss.
    fn replaced(&self, wanted: Encoding) -> Result<Images> {
        let mut replaced = Images::default();
        for image in self.of_encoding(wanted).filter(|image| !self.may_stay(image)) {
            self.put(image, image.1.nearest()?, &mut replaced);
        }
        Ok(replaced)
    }

    /// Returns `true` if an image may be kept as stored: its format is among those allowed, and its texels fit the
    /// ceiling.
    fn may_stay(&self, (number, encodings): &(usize, Encodings<'_>)) -> bool {
        let is_allowed = |(kind, _)| self.workshop.codecs().allows(kind);
        self.packer.stored(*number).is_some_and(is_allowed) && !encodings.must_shrink()
    }

    /// Replaces an image by an encoding, unless the image may be kept and is not larger.
    fn put(&self, image: &(usize, Encodings<'_>), found: EncodedTexture, images: &mut Images) {
        let number = image.0;
        let stored = self.packer.stored(number).map_or(0, |(_, bytes)| bytes);
        if self.may_stay(image) && found.bytes.len() >= stored {
            return;
        }
        images.ratio = images.ratio.max(found.ratio);
        images.codec = images.codec.or(Some(found.codec));
        images.bytes += found.bytes.len() as f64 - stored as f64;
        images.images.push(PackedImage { number, side: found.side, bytes: found.bytes });
    }

    /// Encodes normal maps for several ratios of angles; the last are those of the scan, or as close to them as
    /// possible.
    fn normal_maps(&self) -> Result<Vec<Choice<Images>>> {
        let mut choices = Vec::with_capacity(NORMAL_RATIOS.len() + 1);
        if self.of_encoding(Encoding::Normal).next().is_some() {
            for ratio in NORMAL_RATIOS {
                let of = self.chosen(Encoding::Normal, ratio)?;
                choices.push(Choice { squared: of.ratio * of.ratio, bytes: of.bytes, of });
            }
        }
        let own = self.replaced(Encoding::Normal)?;
        choices.push(Choice { squared: own.ratio * own.ratio, bytes: own.bytes, of: own });
        Ok(choices)
    }

    /// Returns the cost of fewer vertex bits.
    fn bits(&self) -> Result<Vec<Choice<VertexBits>>> {
        let choice = |bits: VertexBits| -> Result<Choice<VertexBits>> {
            let (_, geometry) = self.completed(PackedGeometry { bits, ..WHOLE }, &self.images);
            let bytes = self.packer.encode(geometry, &self.images)?.len() as f64;
            let ratio = self.workshop.goal.ratio_of_mean(angle_of(bits.normals));
            Ok(Choice { of: bits, squared: ratio * ratio, bytes })
        };
        let mut choices = BITS.into_iter().map(vertex_bits).map(choice).collect::<Result<Vec<_>>>()?;
        // The last are those of the whole scan.
        let Choice { squared, bytes, .. } = choices[BITS.len() - 1];
        for choice in &mut choices {
            choice.squared -= squared;
            choice.bytes -= bytes;
        }
        Ok(choices)
    }

    /// Tries the likely smallest candidates, and updates the forecast from them.
    fn close_in(&mut self, forecast: &mut Forecast, best: &mut Best) -> Result<()> {
        let (mut tried, mut aim) = (Vec::new(), AIM);
        for _ in 0..ROUNDS {
            let Some(Likely { choice, bytes }) = forecast.smallest(aim) else { break };
            if bytes > WORTH * best.bytes() || tried.contains(&choice) {
                break;
            }
            tried.push(choice);
            let Combined { kept, maps, bits } = choice;
            let geometry = PackedGeometry { kept, bits: forecast.bits[bits].of, ..WHOLE };
            let trial = self.trial(geometry, &forecast.maps[maps].of, best)?;
            forecast.learn(choice, &trial);
            if is_hit(&trial) {
                break;
            }
            if trial.angle_ratio > 1.0 {
                aim *= AFTER_MISS;
            }
        }
        Ok(())
    }
}

/// The estimated bytes and errors of packed scans.
struct Forecast {
    maps: Vec<Choice<Images>>,
    bits: Vec<Choice<VertexBits>>,
    /// The error over the fraction of triangles kept, and the bytes.
    errors: Curve,
    bytes: Curve,
    /// The square of the error of the whole.
    floor: f64,
    /// The ratio of colours over the fraction of triangles.
    colors: Curve,
    /// The fraction of the triangles below which no more are removed: those of parts that move stay.
    least_kept: f64,
    /// The fraction of the triangles within the ceiling.
    most_kept: f64,
}

/// A fraction of the triangles, and the indices of the normal maps and bits among those measured.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Combined {
    kept: f64,
    maps: usize,
    bits: usize,
}

/// The candidate that is likely to be the smallest.
struct Likely {
    choice: Combined,
    bytes: f64,
}

impl Forecast {
    /// Returns the packing that is likely to have the fewest bytes with at most this ratio of angles.
    fn smallest(&self, ratio: f64) -> Option<Likely> {
        let mut best: Option<Likely> = None;
        for (m, maps) in self.maps.iter().enumerate() {
            for (b, bits) in self.bits.iter().enumerate() {
                let Some(kept) = self.kept_within(ratio * ratio - maps.squared - bits.squared) else {
                    continue;
                };
                // Fewer bits save bytes in proportion to the triangles.
                let bytes = self.bytes.at(kept) + bits.bytes * kept + maps.bytes;
                if best.as_ref().is_none_or(|best| bytes < best.bytes) {
                    best = Some(Likely { choice: Combined { kept, maps: m, bits: b }, bytes });
                }
            }
        }
        best
    }

    /// Returns the smallest fraction of the triangles whose error has at most this square.
    fn kept_within(&self, squared: f64) -> Option<f64> {
        if squared < self.floor {
            return None;
        }
        let range = [self.least_kept, 1.0];
        let found = self.errors.first_within(squared.sqrt(), range).unwrap_or(1.0);
        let with_colors = self.colors.first_within(1.0, range).unwrap_or(1.0);
        let kept = found.max(with_colors).clamp(self.least_kept, 1.0);
        (kept <= self.most_kept).then_some(kept)
    }

    /// Replaces images of colours by others. Their differences and those of fewer triangles add up in squares.
    fn take_colors(&mut self, [from, to]: [&Images; 2]) {
        let more = to.ratio * to.ratio - from.ratio * from.ratio;
        self.colors.change(|ratio| (ratio * ratio + more).max(0.0).sqrt());
        self.bytes.change(|bytes| bytes + to.bytes - from.bytes);
    }

    /// Updates the error at the fraction of triangles of a trial.
    fn learn(&mut self, Combined { kept, maps, bits }: Combined, trial: &Trial) {
        let squared =
            trial.angle_ratio * trial.angle_ratio - self.maps[maps].squared - self.bits[bits].squared;
        self.errors.add(kept, squared.max(self.floor).sqrt());
        self.colors.add(kept, trial.color_ratio.unwrap_or_default());
    }
}

/// Tries every combination of some fractions of the triangles, bits, normal maps and losses of colours.
#[cfg(test)]
pub(super) fn all(
    workshop: &mut Workshop<'_>,
    (kept, colors): (&[f64], &[f64]),
    progress: Progress<'_>,
) -> Result<()> {
    let best = &mut Best::default();
    with(workshop, progress, &mut |mut search| {
        for most in colors {
            search.images = search.chosen(Encoding::Linear, 1.0)?.images;
            search.images.extend(search.chosen(Encoding::Srgb, *most)?.images);
            for maps in search.normal_maps()? {
                for (kept, bits) in kept.iter().flat_map(|kept| BITS.map(|bits| (*kept, vertex_bits(bits)))) {
                    search.trial(PackedGeometry { kept, bits, ..WHOLE }, &maps.of, best)?;
                }
            }
        }
        Ok(())
    })
}
