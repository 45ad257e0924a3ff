//! Assets that were damaged after they were made, or lack something: each fails `standard`, with a warning that names
//! the cause and the place. Their sound twins are in `sound.rs`.

use crate::pairs::{
    Fate, ball, changed, copy_of, direction, grid, is_bad, is_sound, joined, lettered_pair, lettering, moved,
    proof, remade, repainted, reshaped, scan_of, turned, with_fates, with_part,
};
use taotie::asset::{BakeOptions, Baker, Figure, Lod, Proof, Requirement, Scan};
use taotie_engine::Progress;
use taotie_engine::math::{Mat4, Vec3, integration};
use taotie_engine::mesh::MeshData;
use taotie_engine::scene::{Instance, Material, Scene, SceneData};

/// A texel of a map of `side`² texels.
fn at(texels: &[[u8; 4]], side: u32, [x, y]: [u32; 2]) -> [u8; 4] {
    texels[(y.min(side - 1) * side + x.min(side - 1)) as usize]
}

/// The asset of the lettered ball with another normal map.
fn with_map(texel: impl Fn(&[[u8; 4]], u32, [u32; 2]) -> [u8; 4]) -> Scene {
    changed(&lettered_pair().1, |data| data.textures[0] = repainted(&data.textures[0], texel))
}

#[track_caller]
fn has_wrong_normals(asset: &Scene) {
    is_bad(asset, &lettered_pair().0, (&["mean-angle"], "normals are off"));
}

#[test]
fn it_is_sound_before() {
    let (scan, asset) = lettered_pair();
    is_sound(asset, scan);
}

#[test]
fn a_normal_map_whose_channels_are_wrong() {
    has_wrong_normals(&with_map(|all, side, place| {
        let [r, g, b, a] = at(all, side, place);
        [r, 255 - g, b, a]
    }));
    has_wrong_normals(&with_map(|all, side, place| {
        let [r, g, b, a] = at(all, side, place);
        [g, r, b, a]
    }));
}

#[test]
fn a_normal_map_that_is_lost() {
    has_wrong_normals(&changed(&lettered_pair().1, |data| data.materials[0].normal = None));
}

/// An unlit surface shows its base colour and no normals, whatever its map stores.
#[test]
fn a_material_that_is_unlit() {
    let unlit = changed(&lettered_pair().1, |data| data.materials[0].unlit = true);
    let proof =
        is_bad(&unlit, &lettered_pair().0, (&["missed", "mean-angle"], "no counterpart on the asset"));
    let what = "unlit look (KHR_materials_unlit), on 100.0 % of the asset's surface and 0.0 % of the scan's";
    assert!(proof.warnings.iter().any(|(warning, _)| warning.starts_with(what)), "{:?}", proof.warnings);
    assert!(proof.figures.unseen.iter().any(|own| own == what), "{:?}", proof.figures.unseen);
    // An unlit scan lacks nothing on an asset that is unlit too, or lit: only the latter is another look.
    let scan = Scan::from_scene(unlit.clone(), Progress::SILENT).unwrap();
    let names_it =
        |asset: &Scene| is_sound(asset, &scan).figures.unseen.iter().any(|own| own.contains("unlit"));
    assert_eq!([&unlit, &lettered_pair().1].map(names_it), [false, true]);
}

/// Angles compare what both show, so every set needs limits for lost parts.
#[test]
fn a_lost_part_fails_every_named_set() {
    let (scan, asset) = lettered_pair();
    let open = with_fates(asset, |_, middle| if middle.y > 0.95 { Fate::Removed } else { Fate::Kept });
    let figures = proof(&open, scan, Vec::new()).figures;
    for set in ["standard", "visually-lossless", "web", "archive", "engine"] {
        let met = figures.evaluate(&Requirement::read(set).unwrap());
        let fails = |figure: Figure| met.iter().any(|met| met.figure == figure && !met.met);
        assert!(fails(Figure::Missed) && fails(Figure::Hausdorff), "{set}: {met:?}");
    }
}

#[test]
fn a_normal_map_that_is_blurred() {
    has_wrong_normals(&with_map(|all, side, [x, y]| {
        let around = (0..29u32).flat_map(|v| (0..29u32).map(move |u| [u, v]));
        let texels =
            around.map(|[u, v]| at(all, side, [(x + u).saturating_sub(14), (y + v).saturating_sub(14)]));
        let sum = texels.fold([0u32; 4], |sum, texel| std::array::from_fn(|k| sum[k] + u32::from(texel[k])));
        sum.map(|v| (v / (29 * 29)) as u8)
    }));
}

#[test]
fn a_normal_map_with_noise() {
    has_wrong_normals(&with_map(|all, side, place| {
        let [r, g, b, a] = at(all, side, place);
        let noise = integration::hash(place[0], place[1]).to_le_bytes();
        let [x, y] = [0, 1].map(|k| (i32::from(noise[k]) % 41 - 20) as i8);
        [r.saturating_add_signed(x), g.saturating_add_signed(y), b, a]
    }));
}

#[test]
fn uvs_that_are_moved_by_half_a_map() {
    let moved = reshaped(&lettered_pair().1, |data| data.uvs[0].iter_mut().for_each(|uv| uv.x += 0.5));
    has_wrong_normals(&moved);
}

#[test]
fn an_asset_that_is_mirrored() {
    has_wrong_normals(&reshaped(&lettered_pair().1, |data| {
        data.positions.iter_mut().chain(&mut data.normals).for_each(|v| v.x = -v.x);
        data.tangents.iter_mut().for_each(|t| (t[0], t[3]) = (-t[0], -t[3]));
        data.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }));
}

#[test]
fn half_of_it_inside_out() {
    let (scan, asset) = lettered_pair();
    let half = with_fates(asset, |_, middle| if middle.x < 0.0 { Fate::Reversed } else { Fate::Kept });
    is_bad(&half, scan, (&["mean-angle", "patch-angle", "missed"], "no counterpart on the asset"));
}

/// A viewer sees the far side of the shell around the ball, and nothing else hides it.
#[test]
fn a_shell_around_it_that_is_inside_out() {
    let (scan, asset) = lettered_pair();
    for size in [1.06, 1.5] {
        let shell = scan_of(turned(moved(ball([64, 32], |_, _| 0.0), |p| p * size), |_| true));
        let around = with_part(asset, shell.mesh().clone());
        is_bad(&around, scan, (&["missed", "hausdorff"], "no counterpart on the scan"));
    }
}

/// Each hole is smaller than the gap allowed next to an outline.
#[test]
fn a_sieve() {
    let scan = &lettered_pair().0;
    let sieve = with_fates(&copy_of(scan), |t, _| if t % 3 == 0 { Fate::Removed } else { Fate::Kept });
    let proof = is_bad(&sieve, scan, (&["missed"], "no counterpart on the asset"));
    let missed = proof.figures.levels[0].coverage.missed_of_scan;
    assert!((0.2..0.4).contains(&missed), "{missed}");
}

#[test]
fn a_spike_and_a_gap() {
    let (scan, asset) = lettered_pair();
    let spike = reshaped(asset, |data| {
        let top = data.positions.iter().fold(Vec3::splat(0.0), |top, p| if p.y > top.y { *p } else { top });
        data.positions.iter_mut().filter(|p| **p == top).for_each(|p| p.y *= 1.06);
    });
    let proof = is_bad(&spike, scan, (&["hausdorff"], "farthest apart"));
    let at = proof.figures.levels[0].hausdorff.at.unwrap();
    assert!(at[1] > 1.03 && at[0].hypot(at[2]) < 0.05, "{at:?}");
    // The upper half is lifted.
    let gap = reshaped(asset, |data| {
        let first = data.positions.len() as u32;
        let whole = data.clone();
        data.positions.extend(whole.positions.iter().map(|p| Vec3::new(p.x, p.y + 0.02, p.z)));
        data.normals.extend(&whole.normals);
        data.uvs[0].extend(&whole.uvs[0]);
        data.tangents.extend(&whole.tangents);
        let is_above = |t: &[u32; 3]| t.iter().map(|v| whole.positions[*v as usize].y).sum::<f32>() > 0.0;
        data.triangles.iter_mut().filter(|t| is_above(t)).for_each(|t| *t = t.map(|v| v + first));
    });
    is_bad(&gap, scan, (&["missed"], "no counterpart on the asset"));
}

#[test]
fn a_plane_through_it() {
    let (scan, asset) = lettered_pair();
    let plane = grid([1, 1], false, |u, v| Vec3::new(u * 4.0 - 2.0, 0.3, v * 4.0 - 2.0));
    let crossed = with_part(asset, scan_of(plane).mesh().clone());
    is_bad(&crossed, scan, (&["missed", "hausdorff"], "no counterpart on the scan"));
}

#[test]
fn a_coarse_level_of_a_sound_asset() {
    let scan = &lettered_pair().0;
    let options =
        BakeOptions { triangles: 3_000, lods: vec![Lod::Triangles(60)], size: 512, ..BakeOptions::default() };
    let asset = Baker::new(options).bake(scan, Progress::SILENT).unwrap();
    let proof = is_bad(&asset, scan, (&["mean-angle@1", "p95-angle@1"], "at level of detail 1"));
    assert!(
        proof
            .evaluate(&taotie::asset::Requirement::standard())
            .iter()
            .all(|met| met.met || met.level == Some(1))
    );
}

/// A bowl: outside, rim and inside.
fn bowl() -> MeshData {
    turned(
        grid([96, 72], true, |u, v| {
            let (down, radius) = if v < 0.5 { (1.0 - v, 1.0) } else { (v, 0.93) };
            direction(if v == 0.0 || v == 1.0 { 0.0 } else { u }, down) * radius
        }),
        |_| true,
    )
}

#[test]
fn a_bowl_that_is_filled_or_lost_its_rim() {
    let scan = scan_of(bowl());
    is_sound(&copy_of(&scan), &scan);
    let lid = grid([48, 1], true, |u, v| direction(u, 0.5) * (0.93 * v));
    let lid = scan_of(lid).mesh().clone();
    assert!(lid.normals()[0].y > 0.9, "it faces up: {:?}", lid.normals()[0]);
    let filled = with_part(&copy_of(&scan), lid);
    is_bad(&filled, &scan, (&["missed", "hausdorff"], "no counterpart on the scan"));
    let rimless =
        with_fates(&copy_of(&scan), |_, middle| if middle.y > -0.1 { Fate::Removed } else { Fate::Kept });
    is_bad(&rimless, &scan, (&["missed", "hausdorff"], "no counterpart on the asset"));
}

#[test]
fn a_hole_in_one_side_of_a_thin_wall() {
    let side = |y: f64| grid([96, 96], false, move |u, v| Vec3::new(u, 0.05 * libm::sin(u * 9.0) + y, v));
    let scan = scan_of(joined([side(0.0), turned(side(-0.004), |_| true)]));
    let front = scan.mesh().triangles().len() / 2;
    let hole = with_fates(&copy_of(&scan), |t, middle| {
        let away = Vec3::new(middle.x - 0.5, 0.0, middle.z - 0.5).length();
        if t < front && away < 0.05 { Fate::Removed } else { Fate::Kept }
    });
    is_bad(&hole, &scan, (&["missed"], "no counterpart on the asset"));
}

/// Two balls of different colours.
fn colored() -> (Scan, Scene) {
    let part = |x: f32| scan_of(moved(ball([96, 48], lettering), move |p| Vec3::new(p.x + x, p.y, p.z)));
    let paint = |base_color: [f32; 4]| Material { base_color, ..Material::default() };
    let scene = SceneData {
        meshes: vec![part(0.0).mesh().clone(), part(2.5).mesh().clone()],
        materials: vec![paint([0.6, 0.2, 0.15, 1.0]), paint([0.2, 0.3, 0.5, 1.0])],
        ..SceneData::default()
    };
    let instance = |part: usize| taotie_engine::scene::Instance {
        mesh: part,
        material: part,
        world_from_object: taotie_engine::math::Mat4::IDENTITY,
    };
    let scene = Scene::new(SceneData { instances: vec![instance(0), instance(1)], ..scene }).unwrap();
    (Scan::from_scene(scene.clone(), Progress::SILENT).unwrap(), scene)
}

#[test]
fn colours_that_are_wrong() {
    let (scan, asset) = colored();
    is_sound(&asset, &scan);
    let swapped = changed(&asset, |data| data.materials.swap(0, 1));
    is_bad(&swapped, &scan, (&["mean-color", "patch-color"], "colours are off"));
    let darker = changed(&asset, |data| {
        data.materials
            .iter_mut()
            .for_each(|material| material.base_color[..3].iter_mut().for_each(|c| *c *= 0.85));
    });
    is_bad(&darker, &scan, (&["mean-color"], "colours are off"));
    let plain = changed(&asset, |data| data.materials = vec![Material::default(); 2]);
    is_bad(&plain, &scan, (&["mean-color", "patch-color"], "colours are off"));
    // A tint of two per cent of one ball, by the colours of vertices.
    let tint = |p: &Vec3| if p.normalize().x < -0.96 { [1.0, 0.6, 0.6, 1.0] } else { [1.0; 4] };
    let tinted = changed(&asset, |data| {
        data.meshes[0] =
            remade(&data.meshes[0], |mesh| mesh.colors = mesh.positions.iter().map(tint).collect());
    });
    is_bad(&tinted, &scan, (&["patch-color"], "colours are off"));
}

/// A lit display covers a thousandth of a ball: among all that is around it, its loss is hardly a difference.
#[test]
fn a_small_display_that_is_dark() {
    let of = |emissive: [f32; 3]| {
        let (data, side) = (ball([240, 120], |_, _| 0.0), 4);
        let is_display =
            |t: usize| (118..118 + 2 * side).contains(&(t % 480)) && (56..56 + side).contains(&(t / 480));
        let part = |lit: bool| {
            let triangles =
                (0..data.triangles.len()).filter(|t| is_display(*t) == lit).map(|t| data.triangles[t]);
            scan_of(MeshData { triangles: triangles.collect(), ..data.clone() }).mesh().clone()
        };
        let display = Material { emissive, ..Material::default() };
        let scene = SceneData {
            meshes: vec![part(false)],
            materials: vec![Material::default()],
            ..SceneData::default()
        };
        let instances = vec![Instance { mesh: 0, material: 0, world_from_object: Mat4::IDENTITY }];
        let body = Scene::new(SceneData { instances, ..scene }).unwrap();
        let whole = with_part(&body, part(true));
        changed(&whole, |data| data.materials[1] = display)
    };
    let [lit, dim, dark] = [0.02, 0.019, 0.0].map(|light| of([light; 3]));
    let scan = Scan::from_scene(lit, Progress::SILENT).unwrap();
    let color = |proof: Proof| proof.figures.levels[0].patches.color.unwrap().mean;
    let [dim, dark] =
        [color(is_sound(&dim, &scan)), color(is_bad(&dark, &scan, (&["patch-color"], "colours are off")))];
    assert!((0.1..1.0).contains(&dim) && dark > 9.0, "{dim} {dark}");
}

/// No requirement limits these, so they are warnings.
#[test]
fn materials_that_are_wrong_are_noted() {
    let (scan, asset) = colored();
    let warned = |change: fn(&mut Material), words: &str| {
        let spoiled = changed(&asset, |data| data.materials.iter_mut().for_each(change));
        let proof = proof(&spoiled, &scan, Vec::new());
        assert!(proof.warnings.iter().any(|(what, _)| what == words), "{:?}", proof.warnings);
    };
    warned(|material| material.metallic = 1.0, "metallic is off by 1.00 on average");
    warned(|material| material.roughness = 0.0, "roughness is off by 0.60 on average");
    warned(|material| material.emissive = [0.3; 3], "emission is off by 0.30 on average");
    let sound = proof(&asset, &scan, Vec::new());
    assert!(!sound.warnings.iter().any(|(what, _)| what.contains("is off by")), "{:?}", sound.warnings);
}
