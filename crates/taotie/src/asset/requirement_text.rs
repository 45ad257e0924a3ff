//! Requirements as `--require` reads them.

use super::requirement::Requirement;
use std::fmt;

impl fmt::Display for Requirement {
    /// Writes the requirement so that reading it gives the same one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.unit();
        let level = self.level.map_or_else(String::new, |level| format!("@{level}"));
        let name = match unit.name {
            "%" => "%",
            // Typed on any keyboard.
            "µm" => "um",
            length if self.is_length => length,
            _ => "",
        };
        write!(f, "{}{level}={}{name}", self.name(), unit.shortest(self.most))
    }
}

/// Returns requirements as one argument of `--require`; those of [`Requirement::standard`] by that name.
pub(super) fn argument(requirements: &[Requirement]) -> String {
    let standard = Requirement::standard();
    let at = requirements.windows(standard.len()).position(|window| window == standard);
    let texts = |of: &[Requirement]| of.iter().map(ToString::to_string).collect::<Vec<_>>();
    let all = match at {
        None => texts(requirements),
        Some(at) => {
            let (before, rest) = requirements.split_at(at);
            [texts(before), vec!["standard".into()], texts(&rest[standard.len()..])].concat()
        }
    };
    all.join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        let lists = [
            "standard",
            "bytes=3000000,standard,flip=0.02",
            "hausdorff=0.2mm,texel=50um,silhouette=15mm",
            "within-5deg=99%,within-3.1234567dE=99.9%,within-0.3%@1=95%",
            "mean-angle=2,p95-angle@1=5.5,missed=0.1%,completeness=99.95%,hausdorff=0.3%,silhouette=2,ssim=0.97",
        ];
        for list in lists {
            let read = |text: &str| text.split(',').flat_map(|one| Requirement::read(one).unwrap()).collect();
            let requirements: Vec<Requirement> = read(list);
            assert_eq!(argument(&requirements), list);
            assert_eq!(read(&argument(&requirements)), requirements);
        }
    }
}
