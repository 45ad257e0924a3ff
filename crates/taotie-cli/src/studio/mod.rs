//! How a model is seen: its material, its light, where it is seen from, and how that becomes a picture. What
//! subcommands that take pictures of a user's model have in common.

mod args;
mod cache;
mod camera;
mod environment;
mod lights;
mod material;
mod model;
mod motion;

pub use args::{CameraArgs, FilmArgs, Green, LightArgs, MaterialArgs, ReflectionArgs, RunningArgs, Space};
pub use camera::{Framing, Viewpoint};
pub use lights::lighting;
pub use material::apply_choice;
pub use model::load;
pub use motion::Motion;

use anyhow::{Context, Result};

/// Runs `work` on `threads` threads, or on all of the machine's.
pub fn in_pool<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()
        .context("the threads could not be started; ask for fewer with --threads")?;
    Ok(pool.install(work))
}
