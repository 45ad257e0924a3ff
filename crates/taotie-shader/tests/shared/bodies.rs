//! The functions in the text of a shader.

/// The lines of each function between its braces.
pub fn bodies(text: &str) -> Vec<Vec<&str>> {
    let lines: Vec<&str> = text.lines().collect();
    let functions = lines.split(|line| *line == "}" || *line == "};");
    let inside = functions.filter_map(|lines| {
        let opening = lines.iter().position(|line| line.ends_with(") {") || line.contains(") -> "))?;
        Some(lines[opening + 1..].to_vec())
    });
    inside.collect()
}
