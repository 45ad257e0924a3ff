//! The choice of a GPU.

use crate::error::{GpuError, Result};
use serde::Serialize;

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
        named && !(self.hardware_only && described.kind == AdapterKind::Software)
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
pub(crate) fn find(choice: &AdapterChoice) -> Result<(wgpu::Adapter, AdapterDescription)> {
    let backends = wgpu::Instance::enabled_backend_features();
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends,
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapters = pollster::block_on(instance.enumerate_adapters(backends));
    let described: Vec<_> = adapters.iter().map(|a| AdapterDescription::new(&a.get_info())).collect();
    let best = choice.best(&described).and_then(|best| adapters.into_iter().zip(described).nth(best));
    best.ok_or_else(|| {
        let names: Vec<String> = backends.iter_names().map(|(name, _)| name.to_lowercase()).collect();
        GpuError::NoAdapter { looked_for: format!("{}; {}", names.join(", "), choice.text()) }
    })
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
        let error = find(&choice).unwrap_err().to_string();
        assert!(error.contains("no such card") && error.contains("mesa-vulkan-drivers"), "{error}");
    }
}
