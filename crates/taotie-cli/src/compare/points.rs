//! Sample points in the notation of the command line.

use taotie::comparison::SamplePoints;

/// Maximum number of points: more would be a picture, not a table.
const MOST: usize = 1000;

/// Parses `N`, or `X,Y;X,Y`.
pub fn parse(value: &str) -> Result<SamplePoints, String> {
    if let Ok(count) = value.trim().parse::<usize>() {
        return match count {
            0..=MOST => Ok(SamplePoints::Spread(count)),
            _ => Err(format!("at most {MOST} points can be listed")),
        };
    }
    let pixels: Result<Vec<_>, _> = value.split(';').map(pixel).collect();
    pixels.map(SamplePoints::Pixels)
}

fn pixel(text: &str) -> Result<[u32; 2], String> {
    let wrong =
        || format!("`{text}` is not a pixel; give a number of points, or pixels such as 320,200;100,50");
    let (x, y) = text.split_once(',').ok_or_else(wrong)?;
    let number = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    Ok([number(x)?, number(y)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_counts_and_pixels() {
        assert_eq!(parse("10"), Ok(SamplePoints::Spread(10)));
        assert_eq!(parse("1,2; 3,4"), Ok(SamplePoints::Pixels(vec![[1, 2], [3, 4]])));
        for written in ["10", "1,2;3,4"] {
            assert_eq!(parse(written).unwrap().to_string(), written);
        }
        assert!(parse("1,2;x").is_err() && parse("1001").is_err() && parse("-1").is_err());
    }
}
