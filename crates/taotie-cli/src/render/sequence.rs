//! The pictures of a run, one after another.

use super::output::{self, Formats};
use super::plan::{Plan, Shot};
use super::{RenderArgs, Watch};
use crate::console::Progress;
use crate::studio::{self, Motion, Viewpoint};
use anyhow::{Context, Result};
use std::path::PathBuf;
use taotie::Warnings;
use taotie::film::{self, Development};
use taotie::image::Image;
use taotie::io::{MovingPicture, MovingSpec};
use taotie::render::{EnvironmentLight, Frame, Pass, Prepared, RenderSettings, reference};
use taotie::scene::Scene;

/// What all pictures of a run have in common.
pub struct Sequence<'a> {
    args: &'a RenderArgs,
    settings: RenderSettings,
    formats: Formats,
    development: Development,
    plan: &'a Plan,
    environment: Option<EnvironmentLight>,
    /// Where the time went.
    pub watch: Watch,
    /// How many pictures are written.
    done: usize,
    files: Vec<PathBuf>,
}

impl<'a> Sequence<'a> {
    /// The pictures of `plan`.
    pub fn new(args: &'a RenderArgs, settings: RenderSettings, plan: &'a Plan, watch: Watch) -> Result<Self> {
        let development = args.film.development(args.running.simd)?;
        let formats = Formats::of(args)?;
        Ok(Self {
            args,
            settings,
            formats,
            development,
            plan,
            environment: None,
            watch,
            done: 0,
            files: Vec::new(),
        })
    }

    /// With light from all around.
    pub fn within(self, environment: Option<EnvironmentLight>) -> Self {
        Self { environment, ..self }
    }

    /// Renders and writes all of them; returns the files.
    pub fn take(
        &mut self,
        scene: &mut Scene,
        motion: Option<&Motion>,
        warnings: &mut Warnings,
    ) -> Result<Vec<PathBuf>> {
        let framing = self.args.framing();
        let mut viewpoint = match motion {
            Some(motion) => Viewpoint::choose_moving(&self.args.camera, framing, scene, motion)?,
            None => Viewpoint::choose(&self.args.camera, framing, scene)?,
        };
        let mut moving = self.moving_picture()?;
        let count = self.plan.shots.len();
        let title = if count > 1 { format!("{count} pictures") } else { "render".into() };
        let progress = Progress::new(title);
        for shots in self.plan.shots.chunk_by(|a, b| a.seconds == b.seconds) {
            if let (Some(motion), Some(seconds)) = (motion, shots[0].seconds) {
                motion.pose(scene, seconds)?;
                viewpoint.follow(&self.args.camera, scene)?;
            }
            let prepared = Prepared::new(scene, &self.settings.surface)
                .with_context(|| self.args.model.display().to_string())?;
            if self.done == 0 {
                warnings.absorb(prepared.warnings().clone());
            }
            self.watch.lap("prepare");
            let stage = Stage { scene, prepared: &prepared, viewpoint: &viewpoint, progress: &progress };
            for shot in shots {
                let frame = self.render(&stage, shot)?;
                self.write(&frame, moving.as_mut())?;
            }
        }
        if let Some(picture) = moving {
            picture.finish()?;
            self.files.push(self.args.output.clone());
        }
        self.watch.lap("write");
        Ok(std::mem::take(&mut self.files))
    }

    fn moving_picture(&self) -> Result<Option<MovingPicture>> {
        let Some(format) = self.formats.moving else { return Ok(None) };
        let spec = MovingSpec {
            format,
            width: self.settings.width,
            height: self.settings.height,
            frames: self.plan.shots.len() as u32,
            seconds: self.plan.seconds,
            alpha: self.development.background.is_none(),
        };
        Ok(Some(MovingPicture::create(&self.args.output, &spec)?))
    }

    fn render(&mut self, stage: &Stage, shot: &Shot) -> Result<Frame> {
        let environment = self.environment.as_ref();
        let lighting =
            studio::lighting(&self.args.light, environment, stage.scene, stage.viewpoint, shot.turn)?;
        let (camera, settings) = (stage.viewpoint.camera(shot.turn), &self.settings);
        let (before, count) = (self.done as f64, self.plan.shots.len() as f64);
        let progress = |part: f64| stage.progress.set((before + part) / count);
        let frame = match self.args.integrator.reference() {
            None => Pass::new(stage.prepared, &camera, &lighting, settings)?.render(&progress)?,
            Some(paths) => reference(stage.prepared, &camera, &lighting, settings, &paths, &progress)?,
        };
        self.watch.lap("render");
        Ok(frame)
    }

    fn write(&mut self, frame: &Frame, moving: Option<&mut MovingPicture>) -> Result<()> {
        let still = self.formats.still;
        let path = match self.args.motion.takes_several() {
            true => output::numbered(&self.args.output, still, self.done, self.plan.shots.len()),
            false => self.args.output.clone(),
        };
        self.files.extend(output::write(self.args, &path, still, frame)?);
        if let Some(picture) = moving {
            picture.add(&self.developed(&frame.color)?)?;
        }
        self.done += 1;
        self.watch.lap("write");
        Ok(())
    }

    fn developed(&self, image: &Image) -> Result<Vec<[u8; 4]>> {
        Ok(film::develop8(image, &self.development)?)
    }
}

/// A pose of the scene, ready for pictures.
struct Stage<'a> {
    scene: &'a Scene,
    prepared: &'a Prepared<'a>,
    viewpoint: &'a Viewpoint,
    progress: &'a Progress,
}
