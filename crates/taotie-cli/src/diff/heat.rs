//! The picture of where two files differ, with its scale below.

use super::args::{DiffArgs, Metric};
use super::subject::{Content, Subject};
use anyhow::Result;
use std::path::Path;
use taotie::compare::{self, ColorMap, Field, Picture};
use taotie::io;
use taotie_report::heat_map::HeatMap;

/// A field with how it is to be shown.
struct Shown {
    field: Field,
    title: &'static str,
    unit: &'static str,
    map: ColorMap,
    top: f32,
}

/// Writes the heat map of the metric asked for, else of FLIP or of the angle.
pub fn write(args: &DiffArgs, path: &Path, subject: &Subject) -> Result<()> {
    let mut shown = match &subject.content {
        Content::Normals([(a, _), (b, _)]) => angle(compare::angular_error(&a.normals, &b.normals)?),
        Content::Pictures([a, b]) => of_pictures(args, a, b)?,
    };
    if let Some(top) = args.heat_top {
        shown.top = top as f32;
    }
    let Shown { field, title, unit, map, top } = &shown;
    let sheet = HeatMap { field, title, unit, map: *map, top: *top }.with_scale();
    Ok(io::write_png(path, &sheet.png())?)
}

fn angle(field: Field) -> Shown {
    let top = scale(&field);
    Shown { field, title: "angle between normals", unit: "°", map: ColorMap::Viridis, top }
}

fn of_pictures(args: &DiffArgs, a: &Picture, b: &Picture) -> Result<Shown> {
    let shown = |field, title, map, top| Shown { field, title, unit: "", map, top };
    Ok(match args.metric.unwrap_or(Metric::Flip) {
        Metric::Ssim => {
            let map = compare::ssim_map(a, b)?;
            let unlike = map.values().iter().map(|v| 1.0 - v).collect();
            shown(Field::new(map.width(), map.height(), unlike)?, "1 - SSIM", ColorMap::Viridis, 1.0)
        }
        Metric::Psnr | Metric::Rmse => {
            let field = compare::difference(a, b)?;
            let top = scale(&field);
            shown(field, "mean absolute difference", ColorMap::Viridis, top)
        }
        Metric::Flip | Metric::Angle => {
            let field = compare::flip(a, b, args.pixels_per_degree as f32)?;
            shown(field, "FLIP", ColorMap::Magma, 1.0)
        }
    })
}

/// A scale that a few wild texels do not stretch: the 95 % quantile, else the largest number, else 1.
fn scale(field: &Field) -> f32 {
    let summary = field.summary();
    let tops = summary.map_or([0.0; 2], |summary| [summary.p95, summary.max]);
    tops.into_iter().map(|top| top as f32).find(|top| *top > 0.0).unwrap_or(1.0)
}
