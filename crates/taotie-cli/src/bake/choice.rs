//! One line about a search: the chosen trial, and those it beat.

use taotie::asset::{Report, Trial};

/// Returns a line about the chosen trial and the smallest of each other kind; `None` without a search.
pub fn line(report: &Report) -> Option<String> {
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
