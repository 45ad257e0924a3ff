//! A still picture of the initial view, which a page shows if the browser cannot draw the model.

use super::Subject;
use super::document::Blob;
use taotie_engine::film::Development;
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::{Vec3, srgb};
use taotie_engine::render::{Pass, Prepared, RenderSettings, Shot};
use taotie_engine::scene::Projection;
use taotie_engine::{Progress, Result, Warnings};

/// The longer side, pixels.
const SIDE: u32 = 480;

/// The quality of the JPEG.
const QUALITY: u8 = 80;

/// The colour behind the model in the viewer's style sheet, sRGB.
const BEHIND: [u8; 3] = [0x2a, 0x2b, 0x2e];

/// Returns the still picture of a page; `None` with a warning if the view cannot be rendered.
pub(super) fn still(subject: &Subject<'_>, warnings: &mut Warnings) -> Option<Blob> {
    match picture(subject) {
        Ok(jpeg) => Some(Blob::new("still", jpeg)),
        Err(error) => {
            warnings.note(format!("the page has no still picture: {error}"), 1);
            None
        }
    }
}

fn picture(subject: &Subject<'_>) -> Result<Vec<u8>> {
    let surface = subject.settings.surface;
    let [width, height] = size(&subject.camera.projection);
    let settings = RenderSettings {
        width,
        height,
        samples: 4,
        shadows: false,
        ground: false,
        aovs: false,
        ..subject.settings.clone()
    };
    // The page prepares surfaces for the best method, so that all can be chosen.
    let asked =
        surface.method.map(|_| Prepared::new(subject.prepared.scene().clone(), &surface)).transpose()?;
    let prepared = asked.as_ref().unwrap_or(subject.prepared);
    let pass = Pass::new(
        prepared,
        &Shot { camera: subject.camera, lighting: subject.lighting, settings: &settings },
    )?;
    let background = subject.development.background.or(Some(behind()));
    let development = Development { background, ..*subject.development };
    let mut pixels = vec![[0; 4]; (width * height) as usize];
    pass.develop(&development, &mut pixels, Progress::SILENT)?;
    taotie_io::encode_jpeg_bitmap(&Bitmap::new(width, height, 3, Texels::U8(pixels))?, QUALITY)
}

/// Returns the size of a picture with the shape that the camera states, or else a square one.
fn size(projection: &Projection) -> [u32; 2] {
    let aspect = match *projection {
        Projection::Perspective { aspect, .. } => aspect.unwrap_or(1.0),
        Projection::Orthographic { half_width, half_height, .. } => (half_width / half_height).abs(),
    };
    let shorter = |share: f64| (f64::from(SIDE) * share).round().clamp(1.0, f64::from(SIDE)) as u32;
    if aspect >= 1.0 { [SIDE, shorter(1.0 / aspect)] } else { [shorter(aspect), SIDE] }
}

fn behind() -> Vec3 {
    let [r, g, b] = BEHIND.map(|code| srgb::linear_from_srgb(f64::from(code) / 255.0) as f32);
    Vec3::new(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_picture_has_the_shape_of_the_camera() {
        let of = |half_width: f64| {
            size(&Projection::Orthographic { half_width, half_height: 1.0, near: 0.1, far: 9.0 })
        };
        assert_eq!([of(2.0), of(0.5), of(1.0)], [[SIDE, 240], [240, SIDE], [SIDE, SIDE]]);
    }
}
