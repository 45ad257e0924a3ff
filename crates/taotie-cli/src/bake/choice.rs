//! What a search chose, and what it beat, in one line.

use taotie::asset::Trial;

/// Returns a line about the smallest trial that is near enough, and the smallest one of the other kind; `None` without a
/// search.
pub fn line(trials: &[Trial]) -> Option<String> {
    let near = |has_map: Option<bool>| {
        let of_kind = trials
            .iter()
            .filter(|trial| trial.is_near && has_map.is_none_or(|has| has == trial.has_normal_map));
        of_kind.min_by_key(|trial| trial.bytes)
    };
    let chosen = near(None)?;
    let other = match near(Some(!chosen.has_normal_map)) {
        Some(other) => format!("the smallest {} has {}", kind(other), kilobytes(other.bytes)),
        None => {
            let all = trials.iter().filter(|trial| trial.has_normal_map != chosen.has_normal_map);
            let nearest = all.min_by(|a, b| a.mean_angle.total_cmp(&b.mean_angle))?;
            format!(
                "none {} is near enough or worth trying, the nearest has {:.2}°",
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
