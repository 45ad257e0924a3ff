//! Chooses one of several items of a file, by name or by number from 0.

/// Returns the index of the requested item, as a number only if no name matches; `one` and `many` are the words for
/// it. The error lists all items.
pub fn chosen(asked: &str, [one, many]: [&str; 2], names: &[&str]) -> Result<usize, String> {
    let named: Vec<usize> = (0..names.len()).filter(|i| names[*i] == asked).collect();
    let number = asked.parse().ok().filter(|i| *i < names.len());
    match (named.as_slice(), number) {
        ([i], _) => Ok(*i),
        ([], Some(i)) => Ok(i),
        ([], None) => Err(format!("unknown {one} `{asked}`; expected one of: {}", listed(names))),
        _ => Err(format!("several {many} are named `{asked}`; use the number: {}", listed(names))),
    }
}

/// Lists each name after its number.
pub fn listed(names: &[&str]) -> String {
    let each = |(i, name): (usize, &&str)| format!("{i} {name}").trim_end().to_owned();
    names.iter().enumerate().map(each).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_before_numbers() {
        let choose = |asked: &str| chosen(asked, ["mesh", "meshes"], &["lid", "0", "", "leg", "leg"]);
        assert_eq!((choose("lid"), choose("0"), choose("2")), (Ok(0), Ok(1), Ok(2)));
        let list = "0 lid, 1 0, 2, 3 leg, 4 leg";
        assert_eq!(choose("arm"), Err(format!("unknown mesh `arm`; expected one of: {list}")));
        assert_eq!(choose("9"), Err(format!("unknown mesh `9`; expected one of: {list}")));
        assert_eq!(choose("leg"), Err(format!("several meshes are named `leg`; use the number: {list}")));
    }
}
