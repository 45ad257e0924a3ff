//! File names, made from material names.

/// Maximum length of a name, characters.
const LONGEST: usize = 60;

/// Unique shader names, even on file systems that ignore case.
#[derive(Default)]
pub struct Names(Vec<String>);

impl Names {
    /// Returns a name of letters, digits, `-` and `_` like the one wanted, with a number if it is taken.
    pub fn take(&mut self, wanted: &str) -> String {
        let plain = plain(wanted);
        let numbered = (2..).map(|number| format!("{plain}-{number}"));
        let mut candidates = std::iter::once(plain.clone()).chain(numbered);
        let free = candidates.find(|name| !self.0.contains(&name.to_lowercase())).unwrap_or(plain);
        self.0.push(free.to_lowercase());
        free
    }
}

/// Returns the name with only ASCII letters, digits, `-` and `_`.
fn plain(wanted: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = wanted.split(|c| !is_plain(c)).filter(|word| !word.is_empty());
    let name: String = words.collect::<Vec<_>>().join("-").chars().take(LONGEST).collect();
    if name.is_empty() { "material".into() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain_and_apart() {
        let mut names = Names::default();
        let taken =
            ["Old Gold", "old gold", "../../etc/passwd", "", "黄金", "a.b"].map(|name| names.take(name));
        assert_eq!(taken, ["Old-Gold", "old-gold-2", "etc-passwd", "material", "material-2", "a-b"]);
        assert_eq!(names.take(&"x".repeat(1000)).len(), LONGEST);
    }
}
