//! Requirements as text for `--require`.

use super::requirement::Requirement;
use std::fmt;

impl fmt::Display for Requirement {
    /// Writes the requirement so that parsing it gives the same one.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.unit();
        let level = self.level.map_or_else(String::new, |level| format!("@{level}"));
        let name = match unit.name {
            "%" => "%",
            // ASCII, for easy typing.
            "µm" => "um",
            length if self.is_length => length,
            _ => "",
        };
        write!(f, "{}{level}={}{name}", self.name(), unit.shortest(self.most))
    }
}

/// Returns requirements as one argument of `--require`, with named sets by their name.
pub(super) fn argument(requirements: &[Requirement]) -> String {
    let named = Requirement::named();
    let (mut texts, mut rest) = (Vec::new(), requirements);
    while let [first, others @ ..] = rest {
        (rest, _) = match named.iter().find(|(_, several)| rest.starts_with(several)) {
            Some((name, several)) => (&rest[several.len()..], texts.push((*name).to_owned())),
            None => (others, texts.push(first.to_string())),
        };
    }
    texts.join(",")
}

/// Serde support for optional requirements: one argument of `--require`, or none.
#[cfg(feature = "serde")]
pub(super) mod optional {
    use super::{Requirement, argument};
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    pub fn serialize<S: Serializer>(goal: &Option<Vec<Requirement>>, to: S) -> Result<S::Ok, S::Error> {
        goal.as_deref().map(argument).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Vec<Requirement>>, D::Error> {
        let text = Option::<String>::deserialize(from)?;
        text.map(|text| Requirement::read(&text).map_err(D::Error::custom)).transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        let lists = [
            "standard",
            "bytes=3000000,standard,flip=0.02",
            "standard,visually-lossless",
            "web",
            "engine,archive,triangles=10",
            "hausdorff=0.2mm,texel=50um,silhouette=15mm",
            "within-5deg=99%,within-3.1234567dE=99.9%,within-0.3%@1=95%",
            "mean-angle=2,p95-angle@1=5.5,missed=0.1%,completeness=99.95%,hausdorff=0.3%,silhouette=2,ssim=0.97",
        ];
        for list in lists {
            let requirements = Requirement::read(list).unwrap();
            assert_eq!(argument(&requirements), list);
            assert_eq!(Requirement::read(&argument(&requirements)).unwrap(), requirements);
        }
    }
}
