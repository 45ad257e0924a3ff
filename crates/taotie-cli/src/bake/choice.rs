//! What a search chose, and what it beat, in one line.

use taotie::asset::{Report, Trial};

/// Returns a line about the trial that was chosen, and the smallest one of the other kind that is near enough; `None` without a
/// search.
pub fn line(report: &Report) -> Option<String> {
    let trials = &report.trials;
    let is_chosen = |trial: &&Trial| {
        trial.is_near && Some(&trial.triangles) == report.triangles.first() && trial.size == report.size[0]
    };
    let near = |has_map: bool| {
        let of_kind = trials.iter().filter(|trial| trial.is_near && trial.has_normal_map == has_map);
        of_kind.min_by_key(|trial| trial.bytes)
    };
    let chosen = trials.iter().filter(is_chosen).min_by_key(|trial| trial.bytes)?;
    let other = match near(!chosen.has_normal_map) {
        Some(other) => format!("the smallest {} has {}", kind(other), kilobytes(other.bytes)),
        None => {
            let all = trials.iter().filter(|trial| trial.has_normal_map != chosen.has_normal_map);
            let nearest = all.min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle))?;
            format!(
                "no asset {} was near enough or worth trying; the nearest had {:.2}°",
                kind(nearest),
                nearest.mean_angle
            )
        }
    };
    let Trial { triangles, mean_angle, bytes, .. } = chosen;
    let maps = match (chosen.size, chosen.quality) {
        (0, _) => String::new(),
        (size, None) => format!(" and lossless maps of {size}×{size}"),
        (size, Some(quality)) => format!(" and maps of {size}×{size} in quality {quality}"),
    };
    Some(format!(
        "chosen of {} trials: {triangles} triangles{maps} {}, {}, {mean_angle:.2}°; {other}",
        trials.len(),
        kind(chosen),
        kilobytes(*bytes)
    ))
}

fn kind(trial: &Trial) -> &'static str {
    if trial.has_normal_map { "with a normal map" } else { "without a normal map" }
}

fn kilobytes(bytes: u64) -> String {
    format!("{:.0} kB", bytes as f64 / 1000.0)
}
