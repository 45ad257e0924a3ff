//! The pictures of a run, one after another, and the time of each stage.

use super::args::{Formats, RenderArgs};
use super::drawer::Drawer;
use super::output;
use crate::console::Bar;
use crate::device::Machine;
use crate::studio::{self, Motion, Viewpoint};
use anyhow::{Context, Result};
use std::path::PathBuf;
use std::time::Instant;
use taotie::studio::{CameraParameters, LightParameters, Sequence, SequenceFrame};
use taotie_engine::film::{self, Development};
use taotie_engine::image::{Image, Texels};
use taotie_engine::render::{EnvironmentLight, Frame, Lighting, RenderSettings, Renderer, Shot, reference};
use taotie_engine::scene::{Camera, Scene};
use taotie_engine::{Progress, Warnings};
use taotie_io::{AnimatedImage, AnimationSpec, FileSet, ImageFormat};

/// The camera and the light of a picture, for the report.
pub struct Setting {
    /// The camera.
    pub camera: CameraParameters,
    /// The lights, world space.
    pub lights: Vec<LightParameters>,
    /// Radiance from all around, linear RGB.
    pub ambient: [f32; 3],
}

impl Setting {
    fn new(camera: &Camera, lighting: &Lighting) -> Self {
        Self {
            camera: camera.into(),
            lights: lighting.lights.iter().map(LightParameters::from).collect(),
            ambient: lighting.ambient.to_array(),
        }
    }
}

/// The settings that all pictures of a run share, and its progress.
pub struct Shooting<'a> {
    args: &'a RenderArgs,
    settings: RenderSettings,
    formats: Formats,
    development: Development,
    plan: &'a Sequence,
    environment: Option<EnvironmentLight>,
    /// The device to render on.
    pub machine: Machine,
    /// The set that the pictures are written to.
    set: FileSet,
    /// The camera and the light of the first picture.
    pub setting: Option<Setting>,
    /// The time of each stage.
    pub watch: Watch,
    /// The number of pictures written.
    done: usize,
    files: Vec<PathBuf>,
}

impl<'a> Shooting<'a> {
    /// Sets up the pictures of `plan`.
    pub fn new(
        args: &'a RenderArgs,
        settings: RenderSettings,
        plan: &'a Sequence,
        watch: Watch,
    ) -> Result<Self> {
        let development = args.film.development(args.running.simd)?;
        let formats = args.formats()?;
        Ok(Self {
            args,
            settings,
            formats,
            development,
            plan,
            environment: None,
            machine: args.machine()?,
            set: FileSet::new(),
            setting: None,
            watch,
            done: 0,
            files: Vec::new(),
        })
    }

    /// Adds the light of an environment.
    pub fn within(self, environment: Option<EnvironmentLight>) -> Self {
        Self { environment, ..self }
    }

    /// Writes the pictures as files of a set, none of which may be an input.
    pub fn into_set(self, set: &FileSet) -> Result<Self> {
        let paths = (0..self.plan.shots.len()).map(|index| self.path(index));
        for path in paths.flat_map(|path| output::targets(self.args, &path)) {
            set.claim(&path)?;
        }
        Ok(Self { set: set.clone(), ..self })
    }

    /// Returns the path of a picture.
    fn path(&self, index: usize) -> PathBuf {
        match self.args.motion.takes_several() {
            true => output::numbered(&self.args.output, self.formats.still, index, self.plan.shots.len()),
            false => self.args.output.clone(),
        }
    }

    /// Renders and writes all pictures; returns the files.
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
        let bar = Bar::new(title);
        for shots in self.plan.shots.chunk_by(|a, b| a.seconds == b.seconds) {
            if let (Some(motion), Some(seconds)) = (motion, shots[0].seconds) {
                motion.pose(scene, seconds)?;
                viewpoint.follow(&self.args.camera, scene)?;
            }
            let mut renderer = Renderer::new(scene.clone(), &self.settings.surface)
                .with_context(|| self.args.model.display().to_string())?;
            if self.done == 0 {
                warnings.absorb(renderer.prepared().warnings().clone());
            }
            let drawer = Drawer::of(&self.machine, &mut renderer)?;
            self.watch.lap("prepare");
            let mut stage = Stage { drawer, viewpoint: &viewpoint, bar: &bar };
            for shot in shots {
                let picture = self.render(&mut stage, shot)?;
                self.write(picture, moving.as_mut())?;
            }
        }
        if let Some(picture) = moving {
            picture.finish()?;
            self.files.push(self.args.output.clone());
        }
        self.set.commit()?;
        self.watch.lap("write");
        Ok(std::mem::take(&mut self.files))
    }

    fn moving_picture(&self) -> Result<Option<AnimatedImage>> {
        let Some(format) = self.formats.moving else { return Ok(None) };
        let spec = AnimationSpec {
            format,
            width: self.settings.width,
            height: self.settings.height,
            frames: self.plan.shots.len() as u32,
            seconds: self.plan.seconds,
            alpha: self.development.background.is_none(),
        };
        Ok(Some(AnimatedImage::create(&self.set, &self.args.output, &spec)?))
    }

    fn render(&mut self, stage: &mut Stage<'_>, planned: &SequenceFrame) -> Result<Picture> {
        let environment = self.environment.as_ref();
        let scene = stage.drawer.prepared().scene();
        let lighting =
            studio::lighting(&self.args.light, environment, scene, stage.viewpoint.at(planned.turn))?;
        let (camera, settings) = (stage.viewpoint.camera(planned.turn), &self.settings);
        self.setting.get_or_insert_with(|| Setting::new(&camera, &lighting));
        let (before, count) = (self.done as f64, self.plan.shots.len() as f64);
        let bar = stage.bar;
        let listener = |_: &str, part: f64| {
            bar.set((before + part) / count);
            true
        };
        let progress = Progress::new(&listener);
        let shot = Shot { camera: &camera, lighting: &lighting, settings };
        let drawer = &mut stage.drawer;
        let picture = match self.args.integrator.reference() {
            None if self.formats.still == ImageFormat::Png8 && !settings.aovs => {
                Picture::Developed(drawer.develop(&shot, &self.development, progress)?)
            }
            None => Picture::Linear(drawer.render(&shot, progress)?),
            Some(paths) => Picture::Linear(reference(drawer.prepared(), &shot, &paths, progress)?),
        };
        self.watch.lap("render");
        Ok(picture)
    }

    fn write(&mut self, picture: Picture, moving: Option<&mut AnimatedImage>) -> Result<()> {
        let path = self.path(self.done);
        match picture {
            Picture::Linear(frame) => {
                self.files.extend(output::write(&self.set, self.args, &path, &frame)?);
                if let Some(moving) = moving {
                    moving.add(&self.developed(&frame.color)?)?;
                }
            }
            Picture::Developed(codes) => {
                if let Some(moving) = moving {
                    moving.add(&codes)?;
                }
                let size = [self.settings.width, self.settings.height];
                self.set.write_developed(&path, size, &self.development, Texels::U8(codes))?;
                self.files.push(path);
            }
        }
        self.done += 1;
        self.watch.lap("write");
        Ok(())
    }

    fn developed(&self, image: &Image) -> Result<Vec<[u8; 4]>> {
        Ok(film::develop8(image, &self.development)?)
    }
}

/// A picture to write.
enum Picture {
    Linear(Frame),
    /// 8 bits a channel, row by row.
    Developed(Vec<[u8; 4]>),
}

/// A pose of the scene, ready to render.
struct Stage<'a> {
    drawer: Drawer<'a>,
    viewpoint: &'a Viewpoint,
    bar: &'a Bar,
}

/// Accumulates the time of each stage.
pub struct Watch {
    last: Instant,
    /// Stage and seconds.
    pub laps: Vec<(&'static str, f64)>,
}

impl Watch {
    /// Starts measuring.
    pub fn new() -> Self {
        Self { last: Instant::now(), laps: Vec::new() }
    }

    /// Adds the time since the last lap to a stage.
    pub fn lap(&mut self, stage: &'static str) {
        let now = Instant::now();
        let seconds = now.duration_since(self.last).as_secs_f64();
        self.last = now;
        match self.laps.iter_mut().find(|(known, _)| *known == stage) {
            Some((_, total)) => *total += seconds,
            None => self.laps.push((stage, seconds)),
        }
    }
}
