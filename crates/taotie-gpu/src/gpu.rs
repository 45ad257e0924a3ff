//! An opened GPU: its choice, its checked use, and the errors of working on it.

use serde::Serialize;
use std::sync::mpsc;
use wgpu::{Buffer, BufferUsages, ErrorFilter, Features, MapMode, PollType, SubmissionIndex};

/// The features that are used if available.
const USED: [Features; 2] = [Features::FLOAT32_FILTERABLE, Features::TEXTURE_FORMAT_16BIT_NORM];

/// The features without which images have lower precision.
const BLENDED_FLOATS: Features = Features::FLOAT32_BLENDABLE;

/// An opened GPU. Copies share it.
#[derive(Debug, Clone)]
pub struct Gpu {
    pub(crate) device: wgpu::Device,
    pub(crate) queue: wgpu::Queue,
    pub(crate) features: Features,
    pub(crate) limits: wgpu::Limits,
    description: AdapterDescription,
}

impl Gpu {
    /// Finds and opens a GPU.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] if none fits, [`GpuError::Unusable`] if its driver fails.
    pub fn find(choice: &AdapterChoice) -> Result<Self> {
        let (adapter, description) = find_adapter(choice)?;
        let wanted = USED.into_iter().fold(BLENDED_FLOATS, Features::union);
        let (features, limits) = (adapter.features() & wanted, adapter.limits());
        let request = wgpu::DeviceDescriptor {
            label: Some("taotie"),
            required_features: features,
            required_limits: limits.clone(),
            ..wgpu::DeviceDescriptor::default()
        };
        let opened = pollster::block_on(adapter.request_device(&request));
        let (device, queue) = opened.map_err(|error| GpuError::Unusable {
            adapter: description.name.clone(),
            why: error.to_string(),
        })?;
        Ok(Self { device, queue, features, limits, description })
    }

    /// The description of the GPU as data.
    pub fn description(&self) -> &AdapterDescription {
        &self.description
    }

    /// Its capabilities for textures.
    pub(crate) fn texture_support(&self) -> TextureSupport {
        TextureSupport { features: self.features, is_coarse: self.description.is_software() }
    }

    /// Waits until submitted work is done.
    pub(crate) fn wait(&self, doing: &str, submitted: SubmissionIndex) -> Result<()> {
        let submission_index = Some(submitted);
        let waited = self.device.poll(PollType::Wait { submission_index, timeout: None });
        waited.map(drop).map_err(|error| self.refused(doing, &error))
    }

    /// Returns the bytes of a buffer that the submitted work copies to.
    pub(crate) fn read(
        &self,
        doing: &str,
        (buffer, submitted): (Buffer, SubmissionIndex),
    ) -> Result<Vec<u8>> {
        let (sender, receiver) = mpsc::channel();
        buffer.map_async(MapMode::Read, .., move |result| {
            // If waiting has failed, the receiver no longer exists.
            let _ = sender.send(result);
        });
        self.wait(doing, submitted)?;
        match receiver.recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(self.refused(doing, &error)),
            Err(error) => return Err(self.refused(doing, &error)),
        }
        let bytes = buffer.get_mapped_range(..).map_err(|error| self.refused(doing, &error))?.to_vec();
        buffer.unmap();
        Ok(bytes)
    }

    /// Runs a step and returns the driver's rejection as an error.
    pub(crate) fn checked<T>(&self, doing: &str, step: impl FnOnce() -> T) -> Result<T> {
        let filters = [ErrorFilter::OutOfMemory, ErrorFilter::Validation, ErrorFilter::Internal];
        let scopes = filters.map(|filter| self.device.push_error_scope(filter));
        let done = step();
        let mut refusal = None;
        for scope in scopes.into_iter().rev() {
            refusal = pollster::block_on(scope.pop()).or(refusal);
        }
        refusal.map_or(Ok(done), |error| Err(self.refused(doing, &error)))
    }

    /// The error of a step that the driver rejected.
    pub(crate) fn refused(&self, doing: &str, why: &dyn std::fmt::Display) -> GpuError {
        let adapter = self.description.name.clone();
        let (doing, why) = (one_line(doing), one_line(&why.to_string()));
        GpuError::Refused { adapter, doing, why }
    }

    /// The error of something whose `size` exceeds `most`.
    pub(crate) fn too_large(&self, what: &str, size: String, most: String) -> GpuError {
        let (what, adapter) = (one_line(what), self.description.name.clone());
        GpuError::TooLarge { what, adapter, size, most }
    }

    /// Creates a buffer of `bytes` that shaders read as an array; `what` names it in errors.
    pub(crate) fn storage(&self, what: &str, bytes: &[u8]) -> Result<Buffer> {
        let (size, most) = (bytes.len() as u64, self.limits.max_storage_buffer_binding_size);
        if size > most {
            return Err(self.too_large(what, format!("{size} bytes"), format!("{most} bytes")));
        }
        self.buffer(what, bytes, BufferUsages::STORAGE)
    }

    /// Creates a buffer of `bytes`; `what` names it in errors.
    pub(crate) fn buffer(&self, what: &str, bytes: &[u8], usage: BufferUsages) -> Result<Buffer> {
        let buffer = self.empty(what, bytes.len() as u64, usage)?;
        let mut padded = bytes.to_vec();
        padded.resize(buffer.size() as usize, 0);
        self.checked(what, || self.queue.write_buffer(&buffer, 0, &padded))?;
        Ok(buffer)
    }

    /// Creates a buffer of zeros, of at least `size` bytes; `what` names it in errors.
    pub(crate) fn empty(&self, what: &str, size: u64, usage: BufferUsages) -> Result<Buffer> {
        let size = size.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT).max(16);
        let most = self.limits.max_buffer_size;
        if size > most {
            return Err(self.too_large(what, format!("{size} bytes"), format!("{most} bytes")));
        }
        let descriptor = wgpu::BufferDescriptor {
            label: Some(what),
            size,
            usage: usage | BufferUsages::COPY_DST,
            mapped_at_creation: false,
        };
        self.checked(what, || self.device.create_buffer(&descriptor))
    }
}

/// The text with every run of whitespace and control characters replaced by one space: texts of drivers and names in
/// files have many.
fn one_line(text: &str) -> String {
    let words = text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(" ")
}

/// The texture capabilities of a GPU.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextureSupport {
    /// Its features.
    pub features: Features,
    /// `true` if 8-bit texels are filtered with 8 bits and decoded with an approximation of sRGB, as software
    /// implementations do.
    pub is_coarse: bool,
}

/// Criteria for choosing a GPU.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct AdapterChoice {
    /// `true` to exclude software implementations.
    pub hardware_only: bool,
    /// A part of its name, case-insensitive; `None` for the fastest kind available.
    pub name: Option<String>,
}

/// A kind of GPU, from the fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AdapterKind {
    /// A card with its own memory.
    Discrete,
    /// A part of the CPU, sharing its memory.
    Integrated,
    /// A virtual GPU: a share of another machine's.
    Virtual,
    /// Not specified by the driver.
    Unknown,
    /// A software implementation on the CPU.
    Software,
}

/// A description of a GPU as data, for reports.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct AdapterDescription {
    /// The name reported by its driver.
    pub name: String,
    /// The graphics API: `vulkan`, `metal`, `dx12`.
    pub backend: String,
    /// Its kind.
    pub kind: AdapterKind,
    /// Name and version of its driver; may be empty.
    pub driver: String,
}

impl AdapterDescription {
    /// Returns `true` if it is a software implementation, which is slower than rendering on the CPU directly.
    pub fn is_software(&self) -> bool {
        self.kind == AdapterKind::Software
    }

    fn new(info: &wgpu::AdapterInfo) -> Self {
        let driver = format!("{} {}", info.driver, info.driver_info);
        Self {
            name: info.name.clone(),
            backend: info.backend.to_string(),
            kind: kind(info.device_type),
            driver: driver.trim().to_owned(),
        }
    }
}

fn kind(device: wgpu::DeviceType) -> AdapterKind {
    match device {
        wgpu::DeviceType::DiscreteGpu => AdapterKind::Discrete,
        wgpu::DeviceType::IntegratedGpu => AdapterKind::Integrated,
        wgpu::DeviceType::VirtualGpu => AdapterKind::Virtual,
        wgpu::DeviceType::Cpu => AdapterKind::Software,
        wgpu::DeviceType::Other => AdapterKind::Unknown,
    }
}

impl AdapterChoice {
    fn takes(&self, described: &AdapterDescription) -> bool {
        let name = described.name.to_lowercase();
        let named = self.name.as_ref().is_none_or(|wanted| name.contains(&wanted.to_lowercase()));
        named && !(self.hardware_only && described.is_software())
    }

    /// The index of the best adapter, if any is acceptable.
    fn best(&self, all: &[AdapterDescription]) -> Option<usize> {
        let fitting = (0..all.len()).filter(|i| self.takes(&all[*i]));
        fitting.min_by_key(|i| all[*i].kind)
    }

    fn text(&self) -> String {
        let kind = if self.hardware_only { "hardware only" } else { "hardware or software" };
        match &self.name {
            Some(name) => format!("{kind}, name containing '{name}'"),
            None => kind.to_owned(),
        }
    }
}

/// Finds the adapter for `choice`.
///
/// # Errors
/// [`GpuError::NoAdapter`].
fn find_adapter(choice: &AdapterChoice) -> Result<(wgpu::Adapter, AdapterDescription)> {
    let backends = wgpu::Instance::enabled_backend_features();
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(backends));
    let described: Vec<_> = adapters.iter().map(|a| AdapterDescription::new(&a.get_info())).collect();
    let Some(best) = choice.best(&described) else {
        let names: Vec<String> = backends.iter_names().map(|(name, _)| name.to_lowercase()).collect();
        let looked_for = format!("{}; {}", names.join(", "), choice.text());
        let software = described.into_iter().filter(|found| found.is_software()).map(|found| found.name);
        return Err(GpuError::NoAdapter { looked_for, software: software.collect() });
    };
    let found = adapters.into_iter().zip(described).nth(best);
    Ok(found.expect("it is the index of one of them"))
}

/// The result of an operation on a GPU.
pub type Result<T> = std::result::Result<T, GpuError>;

/// An error while working on a GPU. Its text is one sentence that includes what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No suitable GPU was found.
    #[error(
        "no GPU was found ({looked_for}); install the system's graphics driver (on Debian \
         mesa-vulkan-drivers, which includes a software renderer), or use the CPU"
    )]
    NoAdapter {
        /// The graphics APIs searched, and the choice.
        looked_for: String,
        /// The names of the software implementations found.
        software: Vec<String>,
    },
    /// The GPU was found but does not work.
    #[error("{adapter} cannot be used: {why}; update its driver, or use the CPU")]
    Unusable {
        /// The name of the GPU.
        adapter: String,
        /// The reason reported by its driver.
        why: String,
    },
    /// Something exceeds a limit of the GPU.
    #[error("{what}: too large for {adapter}: {size}, at most {most}; make it smaller, or use the CPU")]
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
    #[error("{what}: not supported on GPUs; leave it out, or use the CPU")]
    Unsupported {
        /// The feature.
        what: String,
    },
    /// An invalid scene or shot.
    #[error(transparent)]
    Scene(#[from] taotie_engine::Error),
}

impl From<GpuError> for taotie_engine::Error {
    fn from(error: GpuError) -> Self {
        match error {
            GpuError::Scene(error) => error,
            GpuError::TooLarge { what, adapter, size, most } => {
                let why = format!("{size}, at most {most} on {adapter}; make it smaller, or use the CPU");
                Self::limit(what, why)
            }
            error => Self::unsupported("device", error.to_string()),
        }
    }
}

/// The GPU that tests use, or `None` if there is none and the test has to be skipped, which is a failure under
/// `CI=true`.
#[cfg(test)]
pub(crate) fn found() -> Option<Gpu> {
    match Gpu::find(&AdapterChoice::default()) {
        Ok(gpu) => Some(gpu),
        Err(why) => {
            assert!(!std::env::var("CI").is_ok_and(|ci| ci == "true"), "{why}");
            #[allow(clippy::print_stderr, reason = "tests report why they are skipped")]
            {
                eprintln!("skipped: {why}");
            }
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: AdapterKind) -> AdapterDescription {
        AdapterDescription { name: name.into(), backend: "vulkan".into(), kind, driver: String::new() }
    }

    #[test]
    fn the_fastest_kind_is_taken_unless_another_is_named() {
        let all = [
            adapter("llvmpipe", AdapterKind::Software),
            adapter("Intel Arc", AdapterKind::Integrated),
            adapter("GeForce", AdapterKind::Discrete),
        ];
        let choice = |hardware_only, name: Option<&str>| {
            AdapterChoice { hardware_only, name: name.map(Into::into) }.best(&all)
        };
        assert_eq!(choice(false, None), Some(2));
        assert_eq!(choice(true, Some("arc")), Some(1));
        assert_eq!(choice(false, Some("LLVM")), Some(0));
        assert_eq!(choice(true, Some("llvm")), None);
        assert_eq!(AdapterChoice { hardware_only: true, name: None }.best(&all[..1]), None);
    }

    #[test]
    fn who_finds_none_is_told_what_to_install() {
        let choice = AdapterChoice { hardware_only: false, name: Some("no such card".into()) };
        let error = find_adapter(&choice).unwrap_err().to_string();
        assert!(error.contains("no such card") && error.contains("mesa-vulkan-drivers"), "{error}");
    }

    #[test]
    fn it_can_be_kept_and_sent_anywhere() {
        fn assert_owned<T: Send + Sync + Clone + 'static>() {}
        assert_owned::<Gpu>();
    }

    #[test]
    fn refusals_and_limits_are_errors() {
        let Some(mut gpu) = found() else { return };
        let wrong =
            wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl("fn f( {".into()) };
        let refused = gpu.checked("a shader", || gpu.device.create_shader_module(wrong)).unwrap_err();
        let text = refused.to_string();
        assert!(text.contains(" rejected a shader: ") && !text.contains('\n'), "{text}");
        gpu.limits.max_buffer_size = 64;
        let refused = gpu.buffer("the triangles of instance 3", &[0; 65], BufferUsages::INDEX).unwrap_err();
        assert!(refused.to_string().starts_with("the triangles of instance 3: too large for"), "{refused}");
        gpu.limits = wgpu::Limits { max_storage_buffer_binding_size: 32, ..gpu.limits };
        let refused = gpu.storage("the boxes of shadow rays", &[0; 36]).unwrap_err();
        assert!(refused.to_string().contains("36 bytes, at most 32 bytes"), "{refused}");
    }

    #[test]
    fn texts_are_one_line() {
        assert_eq!(one_line("a shader\n\n  is\twrong\u{1b}[31m "), "a shader is wrong [31m");
    }
}
