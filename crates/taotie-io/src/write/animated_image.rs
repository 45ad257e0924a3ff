//! Animated images, PNG or GIF, written frame by frame.

use super::file_set::{BUFFER, Draft, FileSet};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;
use taotie_engine::error::{Error, Result};
use taotie_engine::parallel;

type PngResult<T> = std::result::Result<T, png::EncodingError>;
type GifResult<T> = std::result::Result<T, gif::EncodingError>;

/// The file format of an animated image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnimationFormat {
    /// Animated PNG: full colour and alpha, 8 bits per channel. Programs without animation support show the first
    /// frame.
    Png,
    /// GIF: 256 colours per frame, with each pixel either opaque or fully transparent.
    Gif,
}

/// The properties shared by all frames of an animated image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnimationSpec {
    /// The file format.
    pub format: AnimationFormat,
    /// Width in pixels, 1 to 16384.
    pub width: u32,
    /// Height in pixels, 1 to 16384.
    pub height: u32,
    /// The number of frames, at least 1.
    pub frames: u32,
    /// The total duration of all frames in seconds, after which the animation repeats.
    pub seconds: f64,
    /// `true` if alpha is kept.
    pub alpha: bool,
}

/// An animated image being written, a file of a [`FileSet`].
pub struct AnimatedImage {
    draft: Draft,
    spec: AnimationSpec,
    encoder: Encoder,
    added: u32,
}

enum Encoder {
    Png(Box<png::Writer<BufWriter<File>>>),
    Gif {
        writer: Box<gif::Encoder<BufWriter<File>>>,
        /// Frames that wait until there is one per thread, since quantising colours is slow.
        waiting: Vec<gif::Frame<'static>>,
    },
}

impl AnimatedImage {
    /// Starts an image at `path`, as a file of a set.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an invalid size, number of frames or duration, [`Error::Io`] if the location is not
    /// writable.
    pub fn create(files: &FileSet, path: &Path, spec: &AnimationSpec) -> Result<Self> {
        const LARGEST: u32 = 16384;
        let sized = (1..=LARGEST).contains(&spec.width) && (1..=LARGEST).contains(&spec.height);
        if !sized || spec.frames == 0 || !(spec.seconds >= 0.0 && spec.seconds.is_finite()) {
            return Err(Error::invalid("animated image", format!("invalid specification {spec:?}")));
        }
        let draft = files.begin(path)?;
        let second_handle = draft.file.try_clone().map_err(|e| Error::io(path, e))?;
        let out = BufWriter::with_capacity(BUFFER, second_handle);
        let encoder = match spec.format {
            AnimationFormat::Png => Encoder::Png(Box::new(png(spec, out).map_err(|e| png_error(path, e))?)),
            AnimationFormat::Gif => {
                let writer = Box::new(gif(spec, out).map_err(|e| gif_error(path, e))?);
                Encoder::Gif { writer, waiting: Vec::new() }
            }
        };
        Ok(Self { draft, spec: *spec, encoder, added: 0 })
    }

    /// Adds the next frame: sRGB with straight (not premultiplied) alpha, row by row from the top. Without
    /// [`AnimationSpec::alpha`], alpha is ignored; a GIF shows pixels with an alpha of at least one half.
    ///
    /// # Errors
    /// [`Error::Invalid`] if the number of pixels is wrong, or all frames were already added; [`Error::Io`] if the
    /// file cannot be written.
    pub fn add(&mut self, pixels: &[[u8; 4]]) -> Result<()> {
        let AnimationSpec { width, height, frames, alpha, .. } = self.spec;
        let wanted = width as usize * height as usize;
        if pixels.len() != wanted || self.added == frames {
            let why = format!(
                "frame {} of {frames} has {} pixels; expected {wanted}",
                self.added + 1,
                pixels.len()
            );
            return Err(Error::invalid("animated image", why));
        }
        match &mut self.encoder {
            Encoder::Png(writer) => {
                let bytes = channels(pixels, alpha);
                let delay = self.spec.delay(self.added, 1000).min(u64::from(u16::MAX)) as u16;
                let written =
                    writer.set_frame_delay(delay, 1000).and_then(|()| writer.write_image_data(&bytes));
                written.map_err(|e| png_error(self.draft.path(), e))?;
            }
            Encoder::Gif { writer, waiting } => {
                waiting.push(self.spec.gif_frame(self.added, pixels));
                if waiting.len() >= rayon::current_num_threads() {
                    write_gif_frames(writer, waiting).map_err(|e| gif_error(self.draft.path(), e))?;
                }
            }
        }
        self.added += 1;
        Ok(())
    }

    /// Finishes the image, so that its file is complete.
    ///
    /// # Errors
    /// [`Error::Invalid`] if frames are missing, [`Error::Io`] if the file cannot be written.
    pub fn finish(self) -> Result<()> {
        let Self { draft, spec, encoder, added } = self;
        let path = draft.path();
        if added != spec.frames {
            return Err(Error::invalid(
                "animated image",
                format!("incomplete: {added} of {} frames", spec.frames),
            ));
        }
        match encoder {
            Encoder::Png(writer) => writer.finish().map_err(|e| png_error(path, e))?,
            Encoder::Gif { mut writer, mut waiting } => {
                write_gif_frames(&mut writer, &mut waiting).map_err(|e| gif_error(path, e))?;
                let out = writer.into_inner().map_err(|e| gif_error(path, e))?;
                out.into_inner().map_err(|e| Error::io(path, e.into_error()))?;
            }
        }
        draft.finish()
    }
}

impl AnimationSpec {
    /// Returns the duration of frame `index` in units of 1/`parts` second, rounded so that the sum over all frames is
    /// right.
    fn delay(&self, index: u32, parts: u32) -> u64 {
        let end = |frames: u32| {
            (self.seconds * f64::from(frames) / f64::from(self.frames) * f64::from(parts)).round() as u64
        };
        end(index + 1) - end(index)
    }

    /// Returns a frame before colour quantisation.
    fn gif_frame(&self, index: u32, pixels: &[[u8; 4]]) -> gif::Frame<'static> {
        // Many viewers treat less than two hundredths as ten.
        let delay = self.delay(index, 100).clamp(2, u64::from(u16::MAX)) as u16;
        let dispose = if self.alpha { gif::DisposalMethod::Background } else { gif::DisposalMethod::Keep };
        gif::Frame {
            delay,
            dispose,
            width: self.width as u16,
            height: self.height as u16,
            buffer: self.gif_pixels(pixels).into(),
            ..gif::Frame::default()
        }
    }

    fn gif_pixels(&self, pixels: &[[u8; 4]]) -> Vec<u8> {
        let seen = |[r, g, b, a]: [u8; 4]| {
            if self.alpha && a < 128 { [0; 4] } else { [r, g, b, u8::MAX] }
        };
        pixels.iter().flat_map(|pixel| seen(*pixel)).collect()
    }
}

fn png(spec: &AnimationSpec, out: BufWriter<File>) -> PngResult<png::Writer<BufWriter<File>>> {
    let mut encoder = png::Encoder::new(out, spec.width, spec.height);
    encoder.set_color(if spec.alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    encoder.set_animated(spec.frames, 0)?;
    encoder.write_header()
}

fn gif(spec: &AnimationSpec, out: BufWriter<File>) -> GifResult<gif::Encoder<BufWriter<File>>> {
    let mut encoder = gif::Encoder::new(out, spec.width as u16, spec.height as u16, &[])?;
    encoder.set_repeat(gif::Repeat::Infinite)?;
    Ok(encoder)
}

/// Quantises the colours of RGBA frames with a neural net (Dekker 1994), and writes the frames.
fn write_gif_frames(
    writer: &mut gif::Encoder<BufWriter<File>>,
    frames: &mut Vec<gif::Frame<'static>>,
) -> GifResult<()> {
    /// The net is trained on one pixel out of this many.
    const SPEED: i32 = 10;
    let mut frames = std::mem::take(frames);
    parallel::pieces(&mut frames, 1, &|_, piece| {
        let frame = &mut piece[0];
        let pixels = frame.buffer.to_mut();
        let chosen = gif::Frame::from_rgba_speed(frame.width, frame.height, pixels, SPEED);
        *frame = gif::Frame { delay: frame.delay, dispose: frame.dispose, ..chosen };
        frame.make_lzw_pre_encoded();
    });
    frames.iter().try_for_each(|frame| writer.write_lzw_pre_encoded_frame(frame))
}

/// Returns the interleaved channels of pixels, with or without alpha.
fn channels(pixels: &[[u8; 4]], alpha: bool) -> Vec<u8> {
    if alpha {
        return pixels.as_flattened().to_vec();
    }
    let mut bytes = vec![0; pixels.len() * 3];
    let (colors, _) = bytes.as_chunks_mut::<3>();
    colors.iter_mut().zip(pixels).for_each(|(color, [r, g, b, _])| *color = [*r, *g, *b]);
    bytes
}

fn png_error(path: &Path, error: png::EncodingError) -> Error {
    match error {
        png::EncodingError::IoError(e) => Error::io(path, e),
        other => Error::invalid("animated image", other.to_string()),
    }
}

fn gif_error(path: &Path, error: gif::EncodingError) -> Error {
    match error {
        gif::EncodingError::Io(e) => Error::io(path, e),
        other => Error::io(path, io::Error::other(other)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn spec(format: AnimationFormat, alpha: bool) -> AnimationSpec {
        AnimationSpec { format, width: 3, height: 2, frames: 3, seconds: 0.1, alpha }
    }

    /// A frame of a single grey, with its first pixel transparent.
    fn frame(grey: u8) -> Vec<[u8; 4]> {
        let mut pixels = vec![[grey, grey / 2, 0, 255]; 6];
        pixels[0][3] = 0;
        pixels
    }

    fn written(spec: &AnimationSpec) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let (files, path) = (FileSet::new(), folder.path().join("moving"));
        let mut picture = AnimatedImage::create(&files, &path, spec).unwrap();
        [20, 120, 220].iter().for_each(|grey| picture.add(&frame(*grey)).unwrap());
        picture.finish().unwrap();
        assert!(!path.exists(), "appears only with its set");
        files.commit().unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        (folder, path)
    }

    #[test]
    fn png_frames_read_back_as_written() {
        for alpha in [false, true] {
            let (_folder, path) = written(&spec(AnimationFormat::Png, alpha));
            let file = io::BufReader::new(File::open(&path).unwrap());
            let mut reader = png::Decoder::new(file).read_info().unwrap();
            assert_eq!(reader.info().animation_control().unwrap().num_frames, 3);
            let channels = if alpha { 4 } else { 3 };
            let mut milliseconds = 0;
            for grey in [20, 120, 220] {
                let mut bytes = vec![0; 6 * channels];
                reader.next_frame(&mut bytes).unwrap();
                assert_eq!(bytes, super::channels(&frame(grey), alpha));
                let control = reader.info().frame_control().unwrap();
                assert_eq!(control.delay_den, 1000);
                milliseconds += control.delay_num;
            }
            assert_eq!(milliseconds, 100, "33, 34 and 33");
        }
    }

    #[test]
    fn gif_frames_keep_colours_and_holes() {
        for alpha in [false, true] {
            let (_folder, path) = written(&spec(AnimationFormat::Gif, alpha));
            let mut options = gif::DecodeOptions::new();
            options.set_color_output(gif::ColorOutput::RGBA);
            let mut reader = options.read_info(File::open(&path).unwrap()).unwrap();
            assert_eq!(reader.repeat(), gif::Repeat::Infinite);
            let mut hundredths = 0;
            for grey in [20, 120, 220] {
                let frame = reader.read_next_frame().unwrap().unwrap();
                assert_eq!(frame.buffer[4..8], [grey, grey / 2, 0, 255]);
                assert_eq!(frame.buffer[3] == 0, alpha, "the first pixel is hidden only if alpha is kept");
                hundredths += frame.delay;
            }
            assert_eq!(hundredths, 10);
            assert!(reader.read_next_frame().unwrap().is_none());
        }
    }

    #[test]
    fn unfinished_pictures_leave_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let (files, path) = (FileSet::new(), folder.path().join("m.png"));
        let mut picture = AnimatedImage::create(&files, &path, &spec(AnimationFormat::Png, false)).unwrap();
        assert!(picture.add(&[[0; 4]; 5]).is_err(), "a pixel is missing");
        picture.add(&frame(1)).unwrap();
        assert!(picture.finish().unwrap_err().to_string().contains("1 of 3 frames"));
        files.commit().unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn wrong_sizes_lengths_and_places_are_refused() {
        let files = FileSet::new();
        let create =
            |spec: AnimationSpec| AnimatedImage::create(&files, Path::new("no/such/m.gif"), &spec).is_err();
        let good = spec(AnimationFormat::Gif, true);
        assert!(create(good));
        assert!(create(AnimationSpec { width: 0, ..good }) && create(AnimationSpec { frames: 0, ..good }));
        assert!(
            create(AnimationSpec { height: 70_000, ..good })
                && create(AnimationSpec { seconds: f64::NAN, ..good })
        );
    }
}
