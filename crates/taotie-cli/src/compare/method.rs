//! Methods in the notation of the command line.

use crate::options;
use taotie::comparison::Method;

/// Parses `NAME` or `NAME:FACTOR`.
pub fn parse(value: &str) -> Result<Method, String> {
    let (name, factor) = match value.split_once(':') {
        Some((name, factor)) => (name, Some(options::number(factor)? as f32)),
        None => (value, None),
    };
    let surface = options::named(name)?;
    if factor.is_some() && !Method::takes_factor(surface) {
        return Err(format!("`{name}` takes no factor; only bump and bump-printed do, such as bump:5"));
    }
    Ok(Method { surface, factor })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        for method in Method::defaults() {
            assert_eq!(parse(&method.id()), Ok(method));
        }
    }

    #[test]
    fn factors_belong_to_bump() {
        assert!(parse("smooth:5").unwrap_err().contains("bump:5"));
        assert!(parse("bump:high").unwrap_err().contains("high"));
        assert!(parse("bmup").unwrap_err().contains("tangent-normal"));
    }
}
