//! Assets that look different although their points are where those of the scan are: backs that are not drawn, thin parts
//! between others, light, opacity, and materials; and cut-away surface that makes no difference.

use crate::pairs::{
    ball, changed, copy_of, direction, first_texture, grid, is_bad, is_sound, joined, lettering, proof,
    reshaped, scan_of,
};
use taotie::asset::{Figure, Requirement, Scan};
use taotie_engine::Progress;
use taotie_engine::image::{Bitmap, Encoding, Texels, Texture};
use taotie_engine::math::{Mat4, Vec2, Vec3};
use taotie_engine::mesh::{Mesh, MeshData};
use taotie_engine::scene::{AlphaMode, Instance, Material, Scene, Transmission};

fn shown(data: MeshData, material: Material) -> Scene {
    Scene::of_mesh(scan_of(data).mesh().clone(), material).unwrap()
}

fn scan(scene: &Scene) -> Scan {
    Scan::from_scene(scene.clone(), Progress::SILENT).unwrap()
}

/// The lower half of a ball, a sheet.
fn bowl(double_sided: bool) -> Scene {
    let sheet = grid([96, 48], true, |u, v| direction(if v == 1.0 { 0.0 } else { u }, 0.5 + 0.5 * v));
    shown(sheet, Material { double_sided, ..Material::default() })
}

#[test]
fn a_vessel_whose_inside_is_not_drawn() {
    let [double, single] = [true, false].map(bowl);
    is_bad(&single, &scan(&double), (&["missed"], "no counterpart on the asset"));
    // A back that only the asset draws hides nothing.
    is_sound(&double, &scan(&single));
}

/// A scan without materials is opaque.
#[test]
fn a_ghost_of_a_plain_scan() {
    let scan = scan_of(ball([96, 48], lettering));
    is_sound(&copy_of(&scan), &scan);
    for opacity in [0.06, 0.5] {
        let material =
            Material { base_color: [1.0, 1.0, 1.0, opacity], alpha: AlphaMode::Blend, ..Material::default() };
        let ghost = Scene::of_mesh(scan.mesh().clone(), material).unwrap();
        let proof = is_bad(&ghost, &scan, (&["mean-color", "patch-color"], "colours are off"));
        let flip = proof.figures.levels[0].views.iter().map(|view| view.flip).fold(0.0, f64::max);
        assert!(flip > 0.05, "{opacity}: {flip}");
    }
}

/// Wires fill hardly any pixel of the whole object: they are compared closer.
#[test]
fn a_cage_of_wires() {
    let wire = |i: usize| {
        let (a, rest) = (i as f64 * 2.4, 1.5e-3);
        let axis = Vec3::new(libm::cos(a) * 0.8, libm::sin(a) * 0.8, 0.6 - 0.04 * i as f64)
            .normalize_or(Vec3::splat(1.0));
        let side = axis.any_perpendicular();
        let across = axis.cross(side);
        grid([8, 24], false, move |u, v| {
            let turn = u * std::f64::consts::TAU;
            let out = side * libm::cos(turn) + across * libm::sin(turn);
            axis * (2.0 * v - 1.0) + out * (rest * (1.0 + 0.2 * libm::sin(60.0 * v)))
        })
    };
    let cage = shown(joined((0..24).map(wire)), Material { double_sided: true, ..Material::default() });
    let bent = reshaped(&cage, |data| {
        data.normals.iter_mut().for_each(|n| *n = (*n + Vec3::new(0.0, 0.0, 0.4)).normalize());
    });
    let scan = scan(&cage);
    let proof = is_sound(&cage, &scan);
    let overview = &proof.figures.levels[0].overview;
    assert!(overview.across > 512.0 && overview.pixels > 100, "{} {}", overview.across, overview.pixels);
    is_bad(&bent, &scan, (&["mean-angle"], "normals are off"));
}

/// A frame with thin bars, narrower than the tolerance next to outlines, and the gaps between them.
fn screen(is_there: impl Fn(usize) -> bool) -> Scene {
    let bar = |i: usize| {
        let left = 0.1 + 0.005 * i as f64;
        grid([1, 16], false, move |u, v| Vec3::new(left + 0.0022 * u, 0.1 + 0.8 * v, 0.0))
    };
    let side = |[x, y]: [f64; 2], [width, height]: [f64; 2]| {
        grid([8, 8], false, move |u, v| Vec3::new(x + width * u, y + height * v, 0.0))
    };
    let frame = [
        side([0.0, 0.0], [1.0, 0.1]),
        side([0.0, 0.9], [1.0, 0.1]),
        side([0.0, 0.1], [0.1, 0.8]),
        side([0.9, 0.1], [0.1, 0.8]),
    ];
    let bars = (0..160).filter(|i| is_there(*i)).map(bar);
    shown(joined(frame.into_iter().chain(bars)), Material { double_sided: true, ..Material::default() })
}

#[test]
fn a_screen_without_every_second_bar() {
    let all = scan(&screen(|_| true));
    is_sound(&screen(|_| true), &all);
    is_bad(&screen(|i| i % 2 == 0), &all, (&["missed"], "no counterpart on the asset"));
}

#[test]
fn light_beyond_white_that_is_lost() {
    let lit = |strength: f32| {
        shown(ball([48, 24], |_, _| 0.0), Material { emissive: [strength; 3], ..Material::default() })
    };
    let bright = scan(&lit(20.0));
    is_sound(&lit(20.0), &bright);
    is_bad(&lit(1.0), &bright, (&["mean-color", "patch-color"], "colours are off"));
    is_bad(&lit(20.0), &scan(&lit(1.0)), (&["mean-color", "patch-color"], "colours are off"));
}

#[test]
fn a_body_that_is_opaque_instead_of_translucent() {
    let of = |opacity: f32| {
        let material =
            Material { base_color: [0.5, 0.5, 0.5, opacity], alpha: AlphaMode::Blend, ..Material::default() };
        shown(ball([48, 24], |_, _| 0.0), material)
    };
    let translucent = scan(&of(0.7));
    is_sound(&of(0.7), &translucent);
    is_bad(&of(1.0), &translucent, (&["mean-color"], "colours are off"));
    // So is a faint one.
    let faint = scan(&of(0.3));
    is_sound(&of(0.3), &faint);
    is_bad(&of(0.4), &faint, (&["mean-color"], "colours are off"));
    // Blending of opaque surface changes no figure, but its order in viewers.
    let solid = |alpha: AlphaMode| changed(&of(1.0), |data| data.materials[0].alpha = alpha);
    let blended = proof(&solid(AlphaMode::Blend), &scan(&solid(AlphaMode::Opaque)), Vec::new());
    assert!(blended.warnings.iter().any(|(what, _)| what.contains("although nothing shows through it")));
}

/// A ball of this size around the middle.
fn ball_of(radius: f32) -> MeshData {
    crate::pairs::moved(ball([48, 24], |_, _| 0.0), |p| p * radius)
}

/// A small ball in a large one of this material.
fn in_a_case(case: Material) -> Scene {
    let exhibit = shown(ball_of(0.4), Material::default());
    crate::pairs::with_part(&shown(ball_of(1.0), case), exhibit.meshes()[0].clone())
}

#[test]
fn what_is_seen_through_glass() {
    let blended = |opacity: f32| Material {
        base_color: [0.9, 0.9, 0.9, opacity],
        alpha: AlphaMode::Blend,
        ..Material::default()
    };
    let transmission = Some(Transmission { factor: 1.0, ..Transmission::default() });
    for glass in [blended(0.1), blended(0.6), Material { transmission, ..Material::default() }] {
        let behind_glass = in_a_case(glass.clone());
        let whole = scan(&behind_glass);
        is_sound(&behind_glass, &whole);
        // Only the case, opaque or as it is; only the exhibit.
        for case in [Material::default(), glass] {
            is_bad(&shown(ball_of(1.0), case), &whole, (&["missed"], "no counterpart on the asset"));
        }
        is_bad(
            &shown(ball_of(0.4), Material::default()),
            &whole,
            (&["missed"], "no counterpart on the asset"),
        );
    }
}

/// Materials that transmit light in the file, but show nothing behind them: metals, black, unlit surface, a black texture.
#[test]
fn what_is_opaque_in_spite_of_transmission_hides() {
    let transmission = Some(Transmission { factor: 1.0, ..Transmission::default() });
    let glass = Material { transmission, ..Material::default() };
    let cases = [
        Material { metallic: 1.0, ..glass.clone() },
        Material { base_color: [0.01, 0.01, 0.01, 1.0], ..glass.clone() },
        Material { unlit: true, ..glass },
    ];
    for case in cases {
        is_sound(&shown(ball_of(1.0), case.clone()), &scan(&in_a_case(case)));
    }
    let masked = |texel: u8| {
        let inlaid = inlaid(|_| [texel, 128, 0]);
        let red = inlaid.materials()[0].metallic_roughness_texture;
        changed(&inlaid, |data| {
            data.materials[0].occlusion_texture = None;
            data.materials[0].transmission = Some(Transmission { factor: 1.0, texture: red });
        })
    };
    let exhibit = shown(ball_of(0.4), Material::default());
    let with_exhibit = |case: &Scene| crate::pairs::with_part(case, exhibit.meshes()[0].clone());
    is_sound(&masked(0), &scan(&with_exhibit(&masked(0))));
    let glass = masked(255);
    is_bad(&glass, &scan(&with_exhibit(&glass)), (&["missed"], "no counterpart on the asset"));
}

/// Layers of glass and a body below are closer to each other than points that count as the same part.
#[test]
fn close_layers_of_glass_are_compared_with_themselves() {
    let transmission = Some(Transmission { factor: 1.0, ..Transmission::default() });
    let glass = Material { transmission, double_sided: true, ..Material::default() };
    let painted =
        grid([48, 24], true, |u, v| direction(if v == 0.0 || v == 1.0 { 0.0 } else { u }, v) * 0.97);
    let colors = painted.positions.iter().map(|p| [0.5 + 0.5 * p.x, 0.5, 0.5 + 0.5 * p.y, 1.0]).collect();
    let body = scan_of(MeshData { colors, ..painted }).mesh().clone();
    let lens = crate::pairs::with_part(&shown(ball_of(1.0), glass.clone()), body);
    let lens = changed(&lens, |data| {
        data.materials[1].base_color = [1.0; 4];
        data.meshes.push(scan_of(ball_of(0.985)).mesh().clone());
        data.instances.push(Instance { mesh: 2, material: 0, world_from_object: Mat4::IDENTITY });
    });
    let itself = is_sound(&lens, &scan(&lens));
    let patches = &itself.figures.levels[0].patches;
    let worst = [patches.angle.unwrap().mean, patches.color.unwrap().mean];
    assert!(worst.iter().all(|mean| *mean < 0.01), "{worst:?}");
}

#[test]
fn shells_that_only_the_asset_has() {
    let body = shown(ball_of(1.0), Material { base_color: [0.5, 0.4, 0.3, 1.0], ..Material::default() });
    let shell = Material {
        base_color: [0.8, 0.0, 0.0, 0.49],
        alpha: AlphaMode::Blend,
        double_sided: true,
        ..Material::default()
    };
    let covered = changed(&body, |data| {
        data.meshes.push(Mesh::new(ball_of(1.01)).unwrap());
        data.materials.push(shell);
        data.instances.push(Instance { mesh: 1, material: 1, world_from_object: Mat4::IDENTITY });
    });
    is_bad(&covered, &scan(&body), (&["mean-color", "patch-color"], "colours are off"));
}

/// A ball whose texture holds occlusion, roughness and metallic, given at each of its columns, [0, 1].
fn inlaid(numbers: impl Fn(u32) -> [u8; 3]) -> Scene {
    const COLUMNS: u32 = 64;
    let texels = (0..COLUMNS).map(numbers).map(|[r, g, b]| [r, g, b, u8::MAX]).collect();
    let bitmap = Bitmap::new(COLUMNS, 1, 3, Texels::U8(texels)).unwrap();
    let body = shown(ball([64, 32], |_, _| 0.0), Material::default());
    changed(&body, |data| {
        data.textures.push(Texture::new(bitmap, Encoding::Linear));
        let [occlusion_texture, metallic_roughness_texture] = [Some(first_texture()); 2];
        let (metallic, roughness) = (1.0, 1.0);
        let material = &mut data.materials[0];
        *material = Material {
            metallic,
            roughness,
            metallic_roughness_texture,
            occlusion_texture,
            ..material.clone()
        };
    })
}

#[test]
fn materials_that_are_lost() {
    let gilded = |x: u32| if x < 4 { u8::MAX } else { 0 };
    let sound = |x: u32| [u8::MAX, 100, gilded(x)];
    let all = scan(&inlaid(sound));
    is_sound(&inlaid(|x| [255, 101, sound(x)[2]]), &all);
    let is_off = |numbers: &dyn Fn(u32) -> [u8; 3], figures: &[&str]| {
        is_bad(&inlaid(numbers), &all, (figures, "metallic, roughness or occlusion is off by"))
    };
    is_off(&|_| [255, 100, 0], &["mean-material", "patch-material"]);
    is_off(&|x| [255, 200, gilded(x)], &["mean-material", "patch-material"]);
    is_off(&|x| [128, 100, gilded(x)], &["mean-material", "patch-material"]);
    // A bake may add occlusion.
    let bare = changed(&inlaid(sound), |data| data.materials[0].occlusion_texture = None);
    is_sound(&inlaid(|x| [128, 100, gilded(x)]), &scan(&bare));
    // But not omit it.
    let shaded = scan(&inlaid(|x| [if x < 32 { 100 } else { 255 }, 100, gilded(x)]));
    is_bad(
        &bare,
        &shaded,
        (&["mean-material", "patch-material"], "metallic, roughness or occlusion is off by"),
    );
}

/// The distance from the strokes of a line of letters, which are 0.09 high on a plate of side 1.
fn off_strokes(u: f64, v: f64) -> f64 {
    let (cell, y) = ((u * 14.0).fract() / 14.0, v - 0.5);
    let inside = (0.12..0.88).contains(&u) && y.abs() < 0.045;
    let upright = (cell - 0.02).abs();
    let across = if cell < 0.02 { f64::INFINITY } else { (y - 0.02 * (u * 14.0).floor() / 14.0).abs() };
    if inside { upright.min(across) } else { f64::INFINITY }
}

/// A plate with a back, engraved where `depth` is above 0.
fn plate(depth: impl Fn(f64, f64) -> f64) -> MeshData {
    const BACK: f64 = -0.04;
    let front = grid([320, 320], false, |u, v| Vec3::new(u, 1.0 - v, -depth(u, v)));
    joined([front, grid([4, 4], false, |u, v| Vec3::new(1.0 - u, 1.0 - v, BACK))])
}

/// Strokes cover so little of the worst patch that its mean is hardly off.
#[test]
fn inscriptions_that_are_gone() {
    let groove = |u: f64, v: f64| 0.4 * (0.007 - off_strokes(u, v)).max(0.0);
    let engraved = shown(plate(groove), Material::default());
    let itself = scan(&engraved);
    is_sound(&engraved, &itself);
    let blank = shown(plate(|_, _| 0.0), Material::default());
    let lost = is_bad(&blank, &itself, (&["patch-detail"], "of the relief or of the colours is lost"));
    let level = &lost.figures.levels[0];
    let [detail, angle] = [level.patches.detail, level.patches.angle].map(|patch| patch.unwrap().mean);
    assert!(detail > 0.7 && angle < 8.0, "{detail} {angle}");
    // Slightly deeper grooves are still there.
    is_sound(&shown(plate(|u, v| 1.1 * groove(u, v)), Material::default()), &itself);
    let painted = |ink: [f32; 4]| {
        let data = plate(|_, _| 0.0);
        let color = |p: &Vec3| {
            let is_ink = p.z == 0.0 && off_strokes(p.x.into(), 1.0 - f64::from(p.y)) < 0.007;
            if is_ink { ink } else { [0.6, 0.55, 0.5, 1.0] }
        };
        let colors = data.positions.iter().map(color).collect();
        let base_color = [1.0; 4];
        shown(MeshData { colors, ..data }, Material { base_color, ..Material::default() })
    };
    let text = scan(&painted([0.3, 0.25, 0.2, 1.0]));
    is_sound(&painted([0.31, 0.26, 0.21, 1.0]), &text);
    is_bad(
        &painted([0.6, 0.55, 0.5, 1.0]),
        &text,
        (&["patch-detail"], "of the relief or of the colours is lost"),
    );
    // Nor may there be text that the scan does not have.
    let unmarked = scan(&painted([0.6, 0.55, 0.5, 1.0]));
    is_bad(&painted([0.1, 0.05, 0.02, 1.0]), &unmarked, (&["patch-detail"], "is lost or added"));
}

/// A card of which a texture shows only the left half.
fn card() -> Scene {
    let mut data = grid([2, 1], false, |u, v| Vec3::new(u, v, 0.0));
    data.uvs = vec![data.positions.iter().map(|p| Vec2::new(p.x, p.y)).collect()];
    let texels = (0..64).map(|x| [200, 200, 200, if x < 32 { 255 } else { 0 }]).collect();
    let bitmap = Bitmap::new(64, 1, 4, Texels::U8(texels)).unwrap();
    let material = Material {
        alpha: AlphaMode::Mask(0.5),
        base_color_texture: Some(first_texture()),
        double_sided: true,
        ..Material::default()
    };
    let scene = Scene::of_mesh(Mesh::new(data).unwrap(), Material::default()).unwrap();
    changed(&scene, |data| {
        data.textures.push(Texture::new(bitmap, Encoding::Srgb));
        data.materials[0] = material;
    })
}

#[test]
fn surface_that_is_cut_away_has_no_distance() {
    let trimmed = changed(&card(), |data| {
        data.meshes[0] = crate::pairs::remade(&data.meshes[0], |mesh| {
            mesh.positions.iter_mut().for_each(|p| p.x *= 0.5);
            mesh.uvs[0].iter_mut().for_each(|uv| uv.x *= 0.5);
        });
    });
    for (asset, of) in [(&trimmed, card()), (&card(), trimmed.clone())] {
        let figures = proof(asset, &scan(&of), Vec::new()).figures;
        let met = figures.evaluate(&Requirement::standard());
        let hausdorff = met.iter().find(|met| met.figure == Figure::Hausdorff).unwrap();
        assert!(hausdorff.met, "{} {:?}", hausdorff.text(), figures.levels[0].hausdorff);
    }
}
