//! The space of a scan whose unit is not the metre: glTF, which is in metres, is converted to it on reading.

use super::scan::Scan;
use crate::error::Result;
use crate::length::Unit;
use crate::names::Named;
use crate::scene::Scene;

/// Returns the metres of a unit other than the metre, by which an asset's root node is scaled; `None` if there is
/// nothing to scale.
pub(super) fn root_scale(unit: Option<Unit>) -> Option<f32> {
    unit.filter(|unit| *unit != Unit::Metre).map(|unit| unit.metres() as f32)
}

/// Converts a scan's scene, with coordinates in `unit`, to the space of its assets, which are in metres.
///
/// ```
/// use taotie::asset::into_metres;
/// use taotie::length::Unit;
/// use taotie::mesh::Mesh;
/// use taotie::scene::{Material, Scene};
///
/// let mut scan = Scene::of_mesh(Mesh::sphere(40.0, 16, 8), Material::default())?;
/// into_metres(&mut scan, Some(Unit::Millimetre))?;
/// assert!(scan.bounds().unwrap().max.y < 0.041);
/// # Ok::<(), taotie::Error>(())
/// ```
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) if its transforms are no longer finite.
pub fn into_metres(scene: &mut Scene, unit: Option<Unit>) -> Result<()> {
    match root_scale(unit) {
        Some(scale) => scaled(scene, |v| v * f64::from(scale)),
        None => Ok(()),
    }
}

/// Converts a glTF scene to the space of a scan in this unit. An asset written for that scan gets its transforms back
/// bit for bit: they are divided by the scale of its root node.
pub(super) fn from_metres(scene: &mut Scene, unit: Option<Unit>) -> Result<()> {
    match root_scale(unit) {
        Some(scale) => scaled(scene, |v| v / f64::from(scale)),
        None => Ok(()),
    }
}

/// Applies a function to the scales and translations of all instances.
fn scaled(scene: &mut Scene, change: impl Fn(f64) -> f64) -> Result<()> {
    let mut data = std::mem::take(scene).into_data();
    for instance in &mut data.instances {
        for column in &mut instance.world_from_object.columns {
            column[..3].iter_mut().for_each(|v| *v = change(*v));
        }
    }
    *scene = Scene::new(data)?;
    Ok(())
}

/// Returns the name of the scan's unit if a glTF scene, which should be in metres, has the size of the scan in that
/// unit: its unconverted diagonal is closer to the scan's than in metres.
pub(super) fn is_in_scan_unit(scene: &Scene, scan: &Scan) -> Option<&'static str> {
    let (unit, scale) = (scan.unit()?, f64::from(root_scale(scan.unit())?));
    // The ratio of the sizes, closest to 1 up to √scale.
    let ratio = scene.bounds()?.diagonal() / scan.mesh().diagonal();
    (ratio > scale.sqrt()).then(|| unit.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Mat4, Vec3};
    use crate::mesh::Mesh;
    use crate::scene::Material;

    #[test]
    fn transforms_come_back_to_the_bit() {
        for unit in [Unit::Millimetre, Unit::Centimetre, Unit::Metre, Unit::Inch] {
            let mut scene = Scene::of_mesh(Mesh::sphere(1.0, 8, 4), Material::default()).unwrap();
            let own = Mat4::translation(Vec3::new(0.1f32, -7.3, 1e-3).to_f64())
                * Mat4::scale(Vec3::splat(f64::from(0.123_456_7f32)));
            let root = Mat4::scale(Vec3::splat(f64::from(root_scale(Some(unit)).unwrap_or(1.0))));
            scene.edit(|scene| scene.instances[0].world_from_object = root * own).unwrap();
            from_metres(&mut scene, Some(unit)).unwrap();
            assert_eq!(scene.instances()[0].world_from_object, own, "{unit:?}");
        }
    }

    #[test]
    fn the_size_shows_the_unit() {
        let ball = |radius: f64| Scene::of_mesh(Mesh::sphere(radius, 16, 8), Material::default()).unwrap();
        let file = super::super::ScanFile::from_scene(ball(50.0)).unwrap();
        let options = super::super::ScanOptions { unit: Some(Unit::Millimetre), ..Default::default() };
        let scan = file.with_options(options).into_scan(crate::Progress::SILENT).unwrap();
        let found = [49.0, 5.0, 0.5, 0.05].map(|radius| is_in_scan_unit(&ball(radius), &scan));
        assert_eq!(found, [Some("mm"), Some("mm"), None, None]);
        let unknown = Scan::from_scene(ball(50.0), crate::Progress::SILENT).unwrap();
        assert_eq!(is_in_scan_unit(&ball(50.0), &unknown), None);
    }
}
