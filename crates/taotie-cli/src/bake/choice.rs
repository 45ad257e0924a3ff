//! What a search chose, and what it beat, in one line.

use taotie::asset::{Report, Trial};

/// Returns a line about the trial that was chosen, and the smallest of each other kind; `None` without a search.
pub fn line(report: &Report) -> Option<String> {
    let trials = &report.trials;
    let chosen = trials.iter().find(|trial| trial.is_chosen)?;
    let others = KINDS.into_iter().filter(|kind| *kind != kind_of(chosen)).filter_map(|kind| {
        let of_kind = || trials.iter().filter(|trial| kind_of(trial) == kind);
        let smallest = of_kind().filter(|trial| trial.is_near).min_by_key(|trial| trial.bytes);
        let within = of_kind().filter(|trial| trial.is_within());
        let nearest = within.min_by(|a, b| a.ratio().total_cmp(&b.ratio()));
        of_kind().next()?;
        Some(match (smallest, nearest) {
            (Some(other), _) => format!("{kind}: {}", kilobytes(other.bytes)),
            (None, Some(nearest)) => format!("{kind}: not near enough, {}", differences(nearest)),
            (None, None) => format!("{kind}: beyond a ceiling"),
        })
    });
    let others: Vec<String> = others.collect();
    let Trial { triangles, bytes, size, normals, .. } = *chosen;
    let maps = match (size, normals) {
        (0, _) => String::new(),
        (size, None) if chosen.is_scan => format!(", textures of at most {size} texels a side"),
        (size, Some(lossy)) if chosen.is_scan => {
            format!(", textures of at most {size} texels a side, normals as {lossy}")
        }
        (size, None) => format!(", maps of {size}×{size}"),
        (size, Some(lossy)) => format!(", maps of {size}×{size}, normals as {lossy}"),
    };
    let beaten = if others.is_empty() { String::new() } else { format!(" ({})", others.join("; ")) };
    Some(format!(
        "chosen of {} trials: {}, {triangles} triangles{maps}, {}, {}{beaten}",
        trials.len(),
        kind_of(chosen),
        kilobytes(bytes),
        differences(chosen)
    ))
}

/// The kinds of assets.
const KINDS: [&str; 3] = ["a normal map", "no normal map", "the packed scan"];

fn kind_of(trial: &Trial) -> &'static str {
    match trial {
        Trial { is_scan: true, .. } => KINDS[2],
        Trial { has_normal_map: true, .. } => KINDS[0],
        _ => KINDS[1],
    }
}

/// Returns what is seen of differences on average.
fn differences(trial: &Trial) -> String {
    let color = trial.mean_color.map_or_else(String::new, |color| format!(" and ΔE {color:.2}"));
    format!("{:.2}°{color}", trial.mean_angle)
}

fn kilobytes(bytes: u64) -> String {
    format!("{:.0} kB", bytes as f64 / 1000.0)
}
