//! The asset itself in the page of its bake, to be turned and lit by hand.

use crate::viewer::{MeasuredErrors, Subject, Viewer, facts};
use std::path::Path;
use taotie::Result;
use taotie::asset::{Limits, Proof};
use taotie::film::Development;
use taotie::image::Texture;
use taotie::render::{Prepared, RenderSettings};
use taotie::scene::Scene;
use taotie::studio::{self, CameraOptions, Framing, LightOptions, MaterialOptions, Viewpoint};

/// Texels along a side of the maps that the page holds, at most.
const MOST_TEXELS: u32 = 2048;

/// Makes the viewer of an asset as it lies at `path`, with what its proof measured.
///
/// # Errors
/// Those of [`studio::load_within`] and [`Viewer::new`].
pub fn viewer(path: &Path, proof: &Proof) -> Result<Viewer> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut loaded = studio::load_within(path, &MaterialOptions::default(), &Limits::default())?;
    let facts = facts(&loaded, &name);
    shrink(&mut loaded.scene)?;
    let settings = RenderSettings::default();
    let prepared = Prepared::new(loaded.scene, &settings.surface)?;
    let framing = Framing { size: [1024; 2], all_around: false };
    let viewpoint = Viewpoint::choose(&CameraOptions::default(), framing, prepared.scene())?;
    let view = viewpoint.at(0.0);
    let (rms, hausdorff) = (proof.figures.rms, proof.figures.hausdorff);
    Viewer::new(&Subject {
        title: &name,
        facts: &facts,
        bookmarks: &[],
        prepared: &prepared,
        settings: &settings,
        camera: &view.camera(),
        lighting: &LightOptions::default().lighting(None, prepared.scene(), view),
        development: &Development::default(),
        scan: None,
        errors: Some(MeasuredErrors { normals: &proof.error_map, rms, hausdorff }),
    })
}

/// Takes coarser levels of textures that are too large for a page.
fn shrink(scene: &mut Scene) -> Result<()> {
    scene.edit(|data| data.textures.iter_mut().for_each(|texture| *texture = shrunk(texture)))
}

fn shrunk(texture: &Texture) -> Texture {
    let fits = |level: &usize| {
        let (width, height) = texture.level_size(*level);
        width.max(height) <= MOST_TEXELS
    };
    match (0..texture.levels()).find(fits) {
        None | Some(0) => texture.clone(),
        Some(level) => Texture::new(texture.level(level).clone(), texture.encoding()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use taotie::image::{Bitmap, Encoding, Texels};

    #[test]
    fn large_maps_become_smaller() {
        let of = |width: u32, height: u32| {
            let texels = Texels::U8(vec![[7, 8, 9, 255]; (width * height) as usize]);
            let small =
                shrunk(&Texture::new(Bitmap::new(width, height, 3, texels).unwrap(), Encoding::Linear));
            [small.width(), small.height()]
        };
        assert_eq!([of(4096, 16), of(16, 2048), of(5000, 2)], [[2048, 8], [16, 2048], [1250, 1]]);
    }
}
