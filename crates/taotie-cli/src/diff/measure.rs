//! The metrics of a subject.

use super::args::{DiffArgs, Metric};
use super::subject::{Content, Subject};
use crate::console::Bar;
use anyhow::{Result, bail};
use serde::Serialize;
use taotie::compare::{self, Field, Picture, SSIM_WINDOW};
use taotie_report::spread::Spread;

/// What was measured; `None` where it does not apply or was not asked for.
#[derive(Debug, Default, Serialize)]
pub struct Measured {
    /// Degrees.
    pub angle: Option<Spread>,
    /// [0, 1].
    pub flip: Option<Spread>,
    /// 1 where equal.
    pub ssim: Option<f64>,
    /// Decibels; infinite where the pictures are equal, which JSON writes as `null`.
    pub psnr: Option<f64>,
    /// [0, 1].
    pub rmse: Option<f64>,
}

impl Measured {
    /// The one number of a metric that a threshold is held against.
    pub fn value(&self, metric: Metric) -> Option<f64> {
        match metric {
            Metric::Angle => self.angle.map(|spread| spread.mean),
            Metric::Flip => self.flip.map(|spread| spread.mean),
            Metric::Ssim => self.ssim,
            Metric::Psnr => self.psnr,
            Metric::Rmse => self.rmse,
        }
    }
}

/// Every metric that applies and was asked for.
pub fn measure(args: &DiffArgs, subject: &Subject) -> Result<Measured> {
    match &subject.content {
        Content::Normals([(a, _), (b, _)]) => {
            let angle = Some(spread(&compare::angular_error(&a.normals, &b.normals)?)?);
            Ok(Measured { angle, ..Measured::default() })
        }
        Content::Pictures([a, b]) => pictures(args, a, b),
    }
}

fn pictures(args: &DiffArgs, a: &Picture, b: &Picture) -> Result<Measured> {
    let progress = Bar::new("diff");
    let mut measured = Measured::default();
    let asked = |metric| args.metric.is_none_or(|asked| asked == metric);
    if asked(Metric::Rmse) {
        measured.rmse = Some(compare::rmse(a, b)?);
    }
    if asked(Metric::Psnr) {
        measured.psnr = Some(compare::psnr(a, b)?);
    }
    progress.set(0.1);
    let large_enough = a.width().min(a.height()) >= SSIM_WINDOW;
    if asked(Metric::Ssim) && (large_enough || args.metric.is_some()) {
        measured.ssim = Some(compare::ssim(a, b)?);
    }
    progress.set(0.4);
    if asked(Metric::Flip) {
        measured.flip = Some(spread(&compare::flip(a, b, args.pixels_per_degree as f32)?)?);
    }
    Ok(measured)
}

fn spread(field: &Field) -> Result<Spread> {
    match field.summary() {
        Some(summary) => Ok(summary.into()),
        None => bail!("no texel holds a normal in both files; there is nothing to compare"),
    }
}
