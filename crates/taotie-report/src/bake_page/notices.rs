//! The warnings of a page, by importance.

use crate::{Notice, Section, Tone};
use taotie::asset::{Proof, Report, Warning};

/// Builds the section of all distinct warnings: first those of the proof, then those about the files and the bake.
/// `None` if there are none.
pub fn section(report: &Report, proof: &Proof) -> Option<Section> {
    let found = Warning::list(&proof.warnings);
    let (first, others): (Vec<&Warning>, Vec<&Warning>) =
        report.warnings.iter().partition(|warning| found.iter().any(|found| found.what == warning.what));
    let mut notices: Vec<Notice> = Vec::new();
    for (warning, tone) in with(first, Tone::Bad).chain(with(others, Tone::Changed)) {
        let notice = Notice::new(text(warning), tone);
        if notices.iter().all(|known| known.text != notice.text) {
            notices.push(notice);
        }
    }
    (!notices.is_empty()).then(|| Section::Notices {
        title: "Warnings".into(),
        note: "Findings of the proof come first, then problems in the files and changes made to fix them."
            .into(),
        notices,
    })
}

fn with(warnings: Vec<&Warning>, tone: Tone) -> impl Iterator<Item = (&Warning, Tone)> {
    warnings.into_iter().map(move |warning| (warning, tone))
}

fn text(warning: &Warning) -> String {
    match warning.count {
        1 => warning.what.clone(),
        count => format!("{} ({count} times)", warning.what),
    }
}
