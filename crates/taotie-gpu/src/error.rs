//! What can go wrong on a graphics processor.

/// The result of work on a graphics processor.
pub type Result<T> = std::result::Result<T, GpuError>;

/// An error on the way to an image. Its text is one sentence that says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No graphics processor fits.
    #[error(
        "no graphics processor was found ({looked_for}); install the system's graphics driver, on Debian \
         mesa-vulkan-drivers, which has a software one too, or render on the processor"
    )]
    NoAdapter {
        /// The interfaces that were asked, and the choice.
        looked_for: String,
    },
    /// The graphics processor was found but does not work.
    #[error("{adapter} cannot be used: {why}; update its driver, or render on the processor")]
    Unusable {
        /// The name of the graphics processor.
        adapter: String,
        /// The reason that its driver gives.
        why: String,
    },
    /// Something is larger than the graphics processor takes.
    #[error(
        "{what} is too large for {adapter}: {size}, at most {most}; make it smaller, or render on the processor"
    )]
    TooLarge {
        /// The texture, mesh or image.
        what: String,
        /// The name of the graphics processor.
        adapter: String,
        /// Its size.
        size: String,
        /// The largest size.
        most: String,
    },
    /// The driver refused a step.
    #[error("{adapter} refused {doing}: {why}")]
    Refused {
        /// The name of the graphics processor.
        adapter: String,
        /// The step.
        doing: String,
        /// The reason that it gives.
        why: String,
    },
    /// The shot asks for something that is only drawn on the processor.
    #[error("{what}: graphics processors do not draw it; leave it out, or render on the processor")]
    Unsupported {
        /// The feature.
        what: String,
    },
    /// A scene or shot that no renderer draws.
    #[error(transparent)]
    Scene(#[from] taotie::Error),
}
