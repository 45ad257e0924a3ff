//! Errors of rendering on a GPU.

/// The result of an operation on a GPU.
pub type Result<T> = std::result::Result<T, GpuError>;

/// An error while rendering on a GPU. Its text is one sentence that includes what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No suitable GPU was found.
    #[error(
        "no GPU was found ({looked_for}); install the system's graphics driver (on Debian \
         mesa-vulkan-drivers, which includes a software renderer), or render on the CPU"
    )]
    NoAdapter {
        /// The graphics APIs searched, and the choice.
        looked_for: String,
    },
    /// The GPU was found but does not work.
    #[error("{adapter} cannot be used: {why}; update its driver, or render on the CPU")]
    Unusable {
        /// The name of the GPU.
        adapter: String,
        /// The reason reported by its driver.
        why: String,
    },
    /// Something exceeds a limit of the GPU.
    #[error("{what}: too large for {adapter}: {size}, at most {most}; make it smaller, or render on the CPU")]
    TooLarge {
        /// The texture, mesh or image.
        what: String,
        /// The name of the GPU.
        adapter: String,
        /// Its size.
        size: String,
        /// The largest size.
        most: String,
    },
    /// The driver rejected a step.
    #[error("{adapter} rejected {doing}: {why}")]
    Refused {
        /// The name of the GPU.
        adapter: String,
        /// The step.
        doing: String,
        /// The reason reported by the driver.
        why: String,
    },
    /// The shot needs a feature that is only available on the CPU.
    #[error("{what}: not supported on GPUs; leave it out, or render on the CPU")]
    Unsupported {
        /// The feature.
        what: String,
    },
    /// An invalid scene or shot.
    #[error(transparent)]
    Scene(#[from] taotie_engine::Error),
}
