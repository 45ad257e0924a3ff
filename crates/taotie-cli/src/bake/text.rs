//! The text that a bake or a proof prints: the chosen trial of a search, the figures of the finest level, the worst
//! parts of the asset, and the requirements.

use std::fmt::Write;
use taotie::asset::{
    BakeFigures, Beyond, Figures, LevelFigures, MaterialFigures, PartFigures, Report, RequirementOutcome,
    Trial, ViewFigures, WorstParts,
};
use taotie_engine::bake::MapKind;
use taotie_engine::compare::Summary;
use taotie_engine::length::{ShownLength, Unit, place_text, texel_text};
use taotie_engine::proof::{Patch, Region, WorstRegions};
use taotie_engine::surface::{Noise, NoiseChange};
use taotie_report::table::{Table, map_error_texts, sizes_text, summary_text};

/// Formats the report as aligned lines.
pub fn of(report: &Report) -> String {
    let triangles: Vec<String> = report.triangles.iter().map(ToString::to_string).collect();
    let mut text = format!("{} triangles onto {}", report.high_triangles, triangles.join(", "));
    if !report.sizes.is_empty() {
        let _ = write!(text, ", maps of {}", sizes_text(&report.sizes));
    }
    text.push('\n');
    text.extend(chosen_trial(report).map(|line| line + "\n"));
    let mut table = Table::untitled(&["", ""]);
    if !report.origin.groups.is_empty() {
        table.row(["matched by name".into(), report.origin.groups.join(", ")]);
    }
    let lacks_normals = lacks_normals(report);
    if lacks_normals {
        table.row(["baked".into(), baked_without_normals(report)]);
        map_errors(report).into_iter().for_each(|row| table.row(row));
    }
    if !report.carried.is_empty() {
        table.row(["carried".into(), report.carried.join(", ")]);
    }
    if let Some(noise) = &report.noise {
        table.row(["noise of the scan".into(), noise_text(noise, report.unit)]);
    }
    if let Some(figures) = &report.proof {
        if let Some(finest) = figures.finest() {
            as_seen(figures, finest, &mut table);
            worst_parts(figures, &finest.worst_parts, &mut table);
            beyond(&finest.beyond, &mut table);
            on_surface(finest, report.bake.as_ref(), &mut table);
            shape(figures, finest, &mut table);
            material(&finest.material, &mut table);
            table.row(["visual difference".into(), visual_difference(&finest.views)]);
            if !finest.full_views.is_empty() {
                table.row(["in full material".into(), visual_difference(&finest.full_views)]);
            }
        }
        levels(figures, &mut table);
        figures.parts.iter().for_each(|part| table.row([part.material.clone(), of_part(part)]));
        if !lacks_normals {
            map_errors(report).into_iter().for_each(|row| table.row(row));
        }
        let not_compared = report.not_compared();
        if !not_compared.is_empty() {
            table.row(["not compared".into(), not_compared.join("; ")]);
        }
        table.row(["bytes".into(), format!("{} in, {} out", figures.bytes_in, figures.bytes_out)]);
    } else {
        // There is no report file that states them.
        map_ranges(report).into_iter().for_each(|row| table.row(row));
    }
    let required = report.required().iter().map(|met| requirement(met, &report.triangles));
    required.for_each(|line| table.row(["required".into(), line]));
    text += &table.lines(0);
    for file in &report.files {
        let _ = writeln!(text, "wrote {}", file.display());
    }
    text.trim_end().to_owned()
}

/// Returns the noise of the scan, and the change by its removal; lengths are in this unit.
fn noise_text(noise: &Noise, unit: Option<Unit>) -> String {
    let length = |length: f64| ShownLength::of(length, unit, 3);
    let measured = format!("σ {}, from wavelengths of {} upwards", length(noise.sigma), length(noise.scale));
    match &noise.removed {
        None => format!("{measured}; kept"),
        Some(NoiseChange { rms, mean_deg, p95_deg }) => format!(
            "{measured}; removed: vertices moved by {} RMS, normals changed by mean {mean_deg:.3}°, p95 {p95_deg:.3}°, \
             which the errors below include",
            length(*rms)
        ),
    }
}

/// Returns a line about the chosen trial and the smallest of each other kind; `None` without a search.
fn chosen_trial(report: &Report) -> Option<String> {
    let trials = &report.trials;
    let chosen = trials.iter().find(|trial| trial.is_chosen)?;
    let others = Trial::KINDS.into_iter().filter(|kind| *kind != chosen.kind()).filter_map(|kind| {
        let of_kind = || trials.iter().filter(|trial| trial.kind() == kind);
        let smallest = of_kind().filter(|trial| trial.is_near).min_by_key(|trial| trial.bytes);
        let within = of_kind().filter(|trial| trial.is_within());
        let nearest = within.min_by(|a, b| a.ratio().total_cmp(&b.ratio()));
        of_kind().next()?;
        Some(match (smallest, nearest) {
            (Some(other), _) => format!("{kind}: {}", kilobytes(other.bytes)),
            (None, Some(nearest)) => format!("{kind}: not close enough, {}", differences(nearest)),
            (None, None) => format!("{kind}: exceeds a ceiling"),
        })
    });
    let others: Vec<String> = others.collect();
    let Trial { triangles, bytes, size, normals, .. } = *chosen;
    let maps = match (size, normals) {
        (0, _) => String::new(),
        (size, None) if chosen.is_scan => format!(", textures of at most {size} texels per side"),
        (size, Some(lossy)) if chosen.is_scan => {
            format!(", textures of at most {size} texels per side, normals as {lossy}")
        }
        (size, None) => format!(", maps of {size}×{size}"),
        (size, Some(lossy)) => format!(", maps of {size}×{size}, normals as {lossy}"),
    };
    let beaten = if others.is_empty() { String::new() } else { format!(" ({})", others.join("; ")) };
    Some(format!(
        "chosen from {} trials: {}, {triangles} triangles{maps}, {}, {}{beaten}",
        trials.len(),
        chosen.kind(),
        kilobytes(bytes),
        differences(chosen)
    ))
}

/// Returns the mean visible differences.
fn differences(trial: &Trial) -> String {
    let color = trial.mean_color.map_or_else(String::new, |color| format!(" and ΔE {color:.2}"));
    format!("{:.2}°{color}", trial.mean_angle)
}

fn kilobytes(bytes: u64) -> String {
    format!("{:.0} kB", bytes as f64 / 1000.0)
}

/// Formats a share; the sum of no samples is -0, which adding zero turns into 0.
fn percent(part: f64) -> String {
    format!("{:.3} %", part * 100.0 + 0.0)
}

fn as_seen(figures: &Figures, level: &LevelFigures, table: &mut Table) {
    if let Some(angles) = &level.overview.angles {
        let [low, high] = angles.mean_interval;
        let half = (high - low) / 2.0;
        let text = summary_text(&angles.summary, 3, "°");
        table.row(["normal error as seen".into(), format!("{text}; mean ± {half:.3}°")]);
    }
    if let Some(color) = &level.overview.color {
        table.row(["colour error as seen (ΔE00)".into(), summary_text(&color.summary, 2, "")]);
    }
    if let Some(material) = &level.overview.material {
        table.row(["material error as seen".into(), summary_text(&material.summary, 3, "")]);
    }
    let worst = &level.patches;
    let text = |patch: &Option<Patch>, shown: &dyn Fn(f64) -> String| {
        let patch = patch.as_ref()?;
        let place = place_text(patch.center, figures.diagonal, figures.unit);
        Some(format!("{} around {place}", shown(patch.mean)))
    };
    let patches = [
        text(&worst.angle, &|mean| format!("{mean:.2}°")),
        text(&worst.color, &|mean| format!("ΔE {mean:.2}")),
        text(&worst.material, &|mean| format!("material {mean:.2}")),
        text(&worst.detail, &|lost| format!("detail {:.0} % lost", lost.min(1.0) * 100.0)),
    ];
    let patches: Vec<String> = patches.into_iter().flatten().collect();
    if !patches.is_empty() {
        table.row(["worst 1 % of the surface".into(), patches.join("; ")]);
    }
}

/// Adds the worst UV island and the worst material.
fn worst_parts(figures: &Figures, parts: &WorstParts, table: &mut Table) {
    let place = |region: &Region| place_text(region.center, figures.diagonal, figures.unit);
    if let Some(islands) = &parts.islands {
        let name = |number: usize| format!("island {number} of {}", islands.count);
        let mut text = worst(islands, &name, &place);
        if islands.skipped > 0 {
            text += &format!("; {} islands are too small to compare", islands.skipped);
        }
        table.row(["worst UV island".into(), text]);
    }
    if let Some(materials) = &parts.materials {
        let name = |number: usize| parts.material_names.get(number).cloned().unwrap_or_default();
        table.row(["worst material".into(), worst(materials, &name, &place)]);
    }
}

fn worst(
    regions: &WorstRegions,
    name: &dyn Fn(usize) -> String,
    place: &dyn Fn(&Region) -> String,
) -> String {
    let words = |(region, before, after): (&Option<Region>, &str, &str)| {
        let region = region.as_ref()?;
        let Region { number, mean, share, .. } = region;
        let (name, share, place) = (name(*number), share * 100.0, place(region));
        Some(format!("{before}{mean:.2}{after} on {name} ({share:.2} % of the area) around {place}"))
    };
    let found = [(&regions.angle, "", "°"), (&regions.color, "ΔE ", "")];
    let found: Vec<String> = found.into_iter().filter_map(words).collect();
    if found.is_empty() { "could not be measured".into() } else { found.join("; ") }
}

/// Adds the shares of the surface beyond the usual limits.
fn beyond(beyond: &Beyond, table: &mut Table) {
    let curves = [
        (&beyond.angle, 5.0, "beyond 5°"),
        (&beyond.angle, 10.0, "beyond 10°"),
        (&beyond.color, 3.0, "beyond ΔE 3"),
    ];
    let shares: Vec<String> = curves
        .into_iter()
        .filter_map(|(curve, limit, words)| {
            let share = curve.as_ref()?.beyond(limit);
            let [low, high] = share.interval.map(|bound| bound * 100.0);
            Some(format!("{:.2} % {words} ({low:.2} to {high:.2})", share.value * 100.0))
        })
        .collect();
    if !shares.is_empty() {
        table.row(["share of the surface".into(), shares.join("; ")]);
    }
}

fn on_surface(level: &LevelFigures, bake: Option<&BakeFigures>, table: &mut Table) {
    if let Some(angles) = &level.surface_angles {
        table.row(["normal error on the surface".into(), summary_text(angles, 3, "°")]);
    }
    let mean = level.surface_angles.as_ref().map_or(0.0, |angles| angles.mean);
    // It is that of directions spread evenly, which the normals of a flat asset are not.
    if let Some([floor, _]) = bake.and_then(|bake| bake.floor_8_bit).filter(|[floor, _]| *floor <= mean) {
        table.row([String::new(), format!("8-bit storage of normals accounts for {floor}° on average")]);
    }
    if let Some(plain) = &level.without_map {
        let mean = format!("mean {:.3}°, from vertex normals only", plain.mean);
        table.row(["error without normal map".into(), mean]);
    }
    let Some(bake) = bake else { return };
    let rays = format!(
        "{} of the texels, {} of the samples (closest point used); no hit: {} of the samples",
        percent(bake.missed_texels),
        percent(bake.missed_samples),
        percent(bake.lost_samples)
    );
    table.row(["ray missed".into(), rays]);
}

fn shape(figures: &Figures, level: &LevelFigures, table: &mut Table) {
    let LevelFigures { hausdorff, hausdorff_of_diagonal, silhouette, coverage, .. } = level;
    let length = |length: f64| ShownLength::of(length, figures.unit, 3);
    let distances = format!(
        "maximum between {} and {} ({} of the diagonal), RMS {} ({})",
        length(hausdorff.lower),
        length(hausdorff.upper),
        percent(hausdorff_of_diagonal.upper),
        length(level.rms),
        percent(level.rms_of_diagonal)
    );
    table.row(["shape error".into(), distances]);
    let outline = format!(
        "{:.2} pixels of 512 on average, {:.1} at most, which is {}",
        silhouette.mean_pixels,
        silhouette.max_pixels,
        length(silhouette.max_length)
    );
    table.row(["silhouette".into(), outline]);
    let missed = format!(
        "{} of the scan, {} of the asset; {} of the scan within 0.5 % of the diagonal",
        percent(coverage.missed_of_scan),
        percent(coverage.missed_of_asset),
        percent(coverage.completeness)
    );
    table.row(["missed".into(), missed]);
    if coverage.hidden_of_scan > 0.001 {
        table.row([
            "hidden".into(),
            format!("{} of the scan's area cannot be seen", percent(coverage.hidden_of_scan)),
        ]);
    }
    if let Some(resolution) = &level.resolution {
        let loss = resolution.loss().map_or_else(String::new, |loss| format!(", {loss}"));
        let text = format!("{} wide (median){loss}", texel_text(resolution.texel, figures.unit));
        table.row(["texel".into(), text]);
    }
}

fn material(figures: &MaterialFigures, table: &mut Table) {
    if figures.not_finite > 0.0 {
        let part = percent(figures.not_finite);
        table.row(["material not finite".into(), format!("at {part} of the points, which are not compared")]);
    }
    let Some(color) = &figures.color else { return };
    table.row(["colour error on the surface (ΔE00)".into(), summary_text(color, 2, "")]);
    let mean = |(name, of): (&str, Option<Summary>)| Some(format!("{name} {:.4}", of?.mean));
    let means: Vec<String> = figures.numbers().into_iter().filter_map(mean).collect();
    table.row(["material error".into(), format!("means: {}", means.join(", "))]);
}

fn visual_difference(views: &[ViewFigures]) -> String {
    let mean = |of: fn(&ViewFigures) -> f64| views.iter().map(of).sum::<f64>() / views.len().max(1) as f64;
    let (flip, ssim) = (mean(|view| view.flip), mean(|view| view.ssim));
    format!("FLIP {flip:.4}, SSIM {ssim:.4}, mean of {} views", views.len())
}

/// Adds a row for each coarser level of detail.
fn levels(figures: &Figures, table: &mut Table) {
    for (level, figures) in figures.levels.iter().enumerate().skip(1) {
        table.row([format!("level {level}"), of_level(figures)]);
    }
}

/// Returns `true` if maps were baked as requested, but not normals.
fn lacks_normals(report: &Report) -> bool {
    let mut maps = report.maps.iter().filter(|note| note.channel.is_none());
    let is_searched = !report.trials.is_empty();
    !report.maps.is_empty() && !is_searched && !maps.any(|note| note.map == MapKind::Normal)
}

/// Lists the baked maps, none of which is the normal map.
fn baked_without_normals(report: &Report) -> String {
    let mut maps: Vec<String> = Vec::new();
    for note in &report.maps {
        let name = note.title();
        if !maps.contains(&name) {
            maps.push(name);
        }
    }
    format!("{}; no normal map: normal errors are those of the mesh", maps.join(", "))
}

/// Describes what black and white mean in the maps that store numbers in a range.
fn map_ranges(report: &Report) -> Vec<[String; 2]> {
    let ranges = report.maps.iter().filter_map(|note| {
        let (black, white) = (note.black?, note.white?);
        let material = note.material.as_ref().map_or(String::new(), |material| format!(" of {material}"));
        let unit = if note.unit.is_empty() { String::new() } else { format!(" {}", note.unit) };
        let origin = note.origin.map_or(String::new(), |[x, y, z]| format!(", from ({x}, {y}, {z})"));
        let name = note.title();
        Some([format!("range of {name}{material}"), format!("black is {black}, white {white}{unit}{origin}")])
    });
    ranges.collect()
}

/// Describes the errors of maps that no other figure covers.
fn map_errors(report: &Report) -> Vec<[String; 2]> {
    let errors = report.maps.iter().filter_map(|note| Some((note, note.error.as_ref()?)));
    let mut rows = Vec::new();
    for (note, error) in errors {
        let material = note.material.as_ref().map_or(String::new(), |material| format!(" of {material}"));
        let [mean, p95, max] = map_error_texts(error, report.unit);
        let unseen = match error.unseen {
            share if share > 0.001 => format!("; {} of the points see no scan", percent(share)),
            _ => String::new(),
        };
        let text = format!("mean {mean}, p95 {p95}, max {max}{unseen}");
        rows.push([format!("error of {}{material}", note.title()), text]);
    }
    rows
}

/// Describes the triangles of one material.
fn of_part(figures: &PartFigures) -> String {
    let (angles, missed) = (mean_and_p95(figures.angles.as_ref()), percent(figures.missed));
    format!(
        "{} triangles: normal error mean {angles}; ray missed at {missed} of the points",
        figures.triangles
    )
}

fn mean_and_p95(angles: Option<&Summary>) -> String {
    match angles {
        Some(angles) => format!("{:.3}°, p95 {:.3}°", angles.mean, angles.p95),
        None => "could not be measured".into(),
    }
}

fn of_level(figures: &LevelFigures) -> String {
    let seen = mean_and_p95(figures.overview.angles.as_ref().map(|angles| &angles.summary));
    let surface = mean_and_p95(figures.surface_angles.as_ref());
    format!(
        "{} triangles, as seen at {:.0}² pixels: normal error mean {seen}, on the surface mean {surface}; \
         shape error at most {} of the diagonal; {}",
        figures.triangles,
        figures.overview.across,
        percent(figures.hausdorff_of_diagonal.upper),
        visual_difference(&figures.views)
    )
}

/// Formats a requirement's outcome, with its level if there are several.
fn requirement(met: &RequirementOutcome, triangles: &[usize]) -> String {
    let verdict = match met.met {
        true => "met",
        false if met.is_undecided() => "UNDECIDED",
        false => "NOT met",
    };
    let level = match (met.level, triangles.len()) {
        (None, _) | (_, 0..=1) => String::new(),
        (Some(level), _) => match triangles.get(level) {
            Some(count) => format!(" of level {level} ({count} triangles)"),
            None => format!(" of level {level}, which does not exist,"),
        },
    };
    format!("{verdict}: {}{level} {}", met.name(), met.text())
}

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn the_sum_of_no_samples_has_no_sign() {
        let none: f64 = std::iter::empty::<f64>().sum();
        assert!(none.is_sign_negative());
        assert_eq!([percent(none), percent(0.125)], ["0.000 %", "12.500 %"]);
    }
}
