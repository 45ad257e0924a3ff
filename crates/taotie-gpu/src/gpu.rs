//! An opened GPU.

use crate::adapter::{self, AdapterChoice, AdapterDescription, AdapterKind};
use crate::error::{GpuError, Result};
use crate::texture_format::TextureSupport;
use wgpu::{Buffer, BufferUsages, ErrorFilter, Features};

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
        let (adapter, description) = adapter::find(choice)?;
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
        let is_coarse = self.description.kind == AdapterKind::Software;
        TextureSupport { features: self.features, is_coarse }
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
        let size = (bytes.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT).max(16);
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
        let mut padded = bytes.to_vec();
        padded.resize(size as usize, 0);
        self.checked(what, || {
            let buffer = self.device.create_buffer(&descriptor);
            self.queue.write_buffer(&buffer, 0, &padded);
            buffer
        })
    }
}

/// The text with every run of whitespace and control characters replaced by one space: texts of drivers and names in
/// files have many.
fn one_line(text: &str) -> String {
    let words = text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join(" ")
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
