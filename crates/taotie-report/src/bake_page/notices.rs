//! The lines that the page of a bake opens with: the verdict, the warnings, and what was not looked at.

use crate::{Notice, Tone};
use taotie::asset::{Figures, Met, Report, Warning};

/// Makes all notices, the verdict first.
pub fn notices(report: &Report, proof: &Figures) -> Vec<Notice> {
    let mut notices = vec![verdict(report)];
    notices.extend(report.warnings.iter().map(|seen| Notice::new(warning(seen), Tone::Changed)));
    if !proof.unseen.is_empty() {
        let text = format!("Not looked at: {}.", proof.unseen.join("; "));
        notices.push(Notice::new(text, Tone::Changed));
    }
    notices
}

fn verdict(report: &Report) -> Notice {
    let has_levels = report.triangles.len() > 1;
    let name = |met: &Met| match met.level {
        Some(level) if has_levels => format!("{} of level {level}", met.name()),
        _ => met.name().into_owned(),
    };
    let names = |is_met: bool| {
        let those = report.required.iter().filter(|met| met.met == is_met);
        those.map(name).collect::<Vec<_>>().join(", ")
    };
    match [names(false), names(true)] {
        [failed, met] if failed.is_empty() && met.is_empty() => {
            Notice::new("Nothing was required of the asset: judge by the figures below.", Tone::Changed)
        }
        [failed, met] if failed.is_empty() => Notice::new(format!("Required and met: {met}."), Tone::Good),
        [failed, met] if met.is_empty() => Notice::new(format!("Required and NOT met: {failed}."), Tone::Bad),
        [failed, met] => Notice::new(format!("Required and NOT met: {failed}. Met: {met}."), Tone::Bad),
    }
}

fn warning(warning: &Warning) -> String {
    match warning.count {
        1 => warning.what.clone(),
        count => format!("{} ({count} times)", warning.what),
    }
}
