//! The example `turntable` renders an object that turns in front of a fixed camera.

#[path = "../examples/turntable.rs"]
mod turntable;

use taotie::{Error, Picture, RenderSettings};
use taotie_engine::image::{Bitmap, Texels};
use taotie_engine::math::Vec3;
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{Material, Scene, SceneData};

/// Its `main` reads arguments, which a test does not have.
const _: fn() -> taotie_engine::Result<()> = turntable::main;

/// Returns a square in the plane z = 0.
fn square() -> Scene {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mesh = Mesh::new(MeshData {
        positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..MeshData::default()
    });
    let material = Material { double_sided: true, ..Material::default() };
    Scene::of_mesh(mesh.expect("the square is sound"), material).unwrap()
}

/// Counts the pixels that show something.
fn covered(bitmap: &Bitmap) -> usize {
    let Texels::U8(texels) = bitmap.texels() else { panic!("8 bits were written") };
    texels.iter().filter(|texel| texel[3] > 0).count()
}

#[test]
fn a_square_is_seen_narrow_and_wide_and_never_touches_the_frame() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = turntable::turntable(square(), 8, 24, &folder.path().join("turn")).expect("it turns");
    let names: Vec<_> = files.iter().filter_map(|file| file.file_name()?.to_str()).collect();
    assert_eq!((names.len(), names[7]), (8, "turn.007.png"));
    let pictures: Vec<Bitmap> =
        files.iter().map(|file| taotie_io::read_bitmap(file).expect("it is a PNG")).collect();
    let counts: Vec<usize> = pictures.iter().map(covered).collect();
    let (most, least) = (counts.iter().max().expect("eight"), counts.iter().min().expect("eight"));
    assert!(*least > 0 && most > &(2 * least), "{counts:?}");
    for picture in &pictures {
        let edge = (0..24 * 24).filter(|i| [0, 23].contains(&(i % 24)) || [0, 23].contains(&(i / 24)));
        assert!(edge.into_iter().all(|i| picture.stored(i)[3] == 0.0), "{counts:?}");
    }
}

#[test]
fn a_written_picture_has_the_pixels_of_the_one_taken() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let settings = RenderSettings { width: 40, height: 24, ..RenderSettings::default() };
    let picture = Picture { settings, ..Picture::default() };
    let path = folder.path().join("square.png");
    picture.write(&square(), &path).expect("it is rendered");
    let written = taotie_io::read_bitmap(&path).expect("it is a PNG");
    let taken = picture.take(square()).expect("it is rendered");
    assert_eq!((taken.width(), taken.height()), (40, 24));
    assert!(covered(&taken) > 40 && taken.texels() == written.texels());
    let nothing = Scene::new(SceneData::default()).expect("an empty scene is valid");
    assert!(matches!(picture.render(&nothing), Err(Error::Invalid { .. })));
}
