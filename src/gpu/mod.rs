//! The graphics device: one handle, typed buffers, reading back pixels.

mod buffer;
mod noise;
mod processor;
mod read_back;

pub(crate) use buffer::GrowingBuffer;
pub(crate) use read_back::{Layers, Pending, ReadBack};

use std::fmt;
use std::sync::{Arc, Mutex};

/// The requested graphics adapter.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The fastest adapter: a GPU if one can be used, else software.
    #[default]
    Auto,
    /// Software that draws on the processor.
    Cpu,
    /// Any GPU, never software.
    Gpu,
    /// The first adapter whose name contains this text; case does not count.
    Named(String),
}

impl std::str::FromStr for AdapterChoice {
    type Err = std::convert::Infallible;

    fn from_str(typed: &str) -> Result<Self, Self::Err> {
        Ok(match typed.trim().to_lowercase().as_str() {
            "" | "auto" => Self::Auto,
            "cpu" => Self::Cpu,
            "gpu" => Self::Gpu,
            _ => Self::Named(typed.trim().to_owned()),
        })
    }
}

impl fmt::Display for AdapterChoice {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Auto => "auto",
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
            Self::Named(name) => name,
        })
    }
}

/// A graphics adapter, described for reports and for choosing one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterDescription {
    /// Name, such as `llvmpipe (LLVM 15.0.6, 256 bits)`.
    pub name: String,
    /// The interface: `vulkan`, `metal` or `dx12`.
    pub backend: String,
    /// Name of the driver; empty if unknown.
    pub driver: String,
    /// Version of the driver in its own words; empty if unknown.
    pub driver_info: String,
    /// `cpu`, `integrated gpu`, `discrete gpu`, `virtual gpu` or `other`.
    pub device_type: String,
    /// The processor of a `cpu` adapter, on which the last bit of a pixel depends; empty if unknown.
    pub processor: String,
}

impl AdapterDescription {
    fn of(info: &wgpu::AdapterInfo) -> Self {
        let device_type = match info.device_type {
            wgpu::DeviceType::Cpu => "cpu",
            wgpu::DeviceType::IntegratedGpu => "integrated gpu",
            wgpu::DeviceType::DiscreteGpu => "discrete gpu",
            wgpu::DeviceType::VirtualGpu => "virtual gpu",
            wgpu::DeviceType::Other => "other",
        };
        Self {
            name: info.name.clone(),
            backend: info.backend.to_string(),
            driver: info.driver.clone(),
            driver_info: info.driver_info.clone(),
            device_type: device_type.to_owned(),
            processor: if info.device_type == wgpu::DeviceType::Cpu { processor::processor() } else { String::new() },
        }
    }
}

impl fmt::Display for AdapterDescription {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} ({}, {}", self.name, self.device_type, self.backend)?;
        for more in [&self.driver, &self.driver_info, &self.processor].into_iter().filter(|more| !more.is_empty()) {
            write!(out, ", {more}")?;
        }
        out.write_str(")")
    }
}

/// A reason why no graphics device can be used.
#[derive(Debug, thiserror::Error)]
pub enum InitError {
    /// The machine offers no adapter at all.
    #[error(
        "this machine has no usable graphics adapter, which bodies in space need. Without a GPU, software drawing is enough: install it with \
         `apt install mesa-vulkan-drivers` (Debian, Ubuntu) or `dnf install mesa-vulkan-drivers` (Fedora)"
    )]
    NoAdapter,
    /// No adapter fits the choice.
    #[error("no graphics adapter fits `{wanted}`; there {}", listed(.found))]
    NoSuchAdapter {
        /// The choice.
        wanted: String,
        /// The adapters of this machine.
        found: Vec<AdapterDescription>,
    },
    /// The adapter provides no device.
    #[error("the graphics adapter {adapter} cannot be used")]
    Device {
        /// The adapter.
        adapter: Box<AdapterDescription>,
        /// The error of its driver.
        #[source]
        source: Box<wgpu::RequestDeviceError>,
    },
}

fn listed(adapters: &[AdapterDescription]) -> String {
    let names: Vec<_> =
        adapters.iter().map(|adapter| format!("`{}` ({})", adapter.name, adapter.device_type)).collect();
    match names.len() {
        1 => format!("is {}", names[0]),
        _ => format!("are {}", names.join(", ")),
    }
}

/// A failure of an open device.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// The device has too little memory.
    #[error("the graphics device is out of memory; a smaller picture needs less")]
    OutOfMemory,
    /// The device is lost, for instance after a reset of the driver.
    #[error("the graphics device was lost ({0}), as when its driver is reset; run the command again")]
    Lost(String),
    /// The device refused a command: a mistake in this program.
    #[error("the graphics device refused a command: {0}")]
    Refused(String),
}

/// A graphics device with its queue, cheap to clone. There is no global device.
#[derive(Clone, Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    description: AdapterDescription,
    trouble: Arc<Mutex<Option<GpuError>>>,
}

/// The name of a device's adapter in the metadata of files.
pub(crate) fn adapter_name(gpu: Option<&Gpu>) -> String {
    gpu.map_or_else(|| "none".to_owned(), |gpu| gpu.description().to_string())
}

impl Gpu {
    /// Opens a device on the adapter that fits `choice`.
    ///
    /// On Unix, standard error of the whole process is buffered meanwhile. Lines that other threads write appear once
    /// the device is open, without the complaints of drivers about the lack of a window. [`adapters`] does the same.
    ///
    /// # Errors
    /// No adapter exists, none fits, or the fitting one cannot be used.
    pub fn new(choice: &AdapterChoice) -> Result<Self, InitError> {
        noise::hushed(|| Self::open(choice))
    }

    fn open(choice: &AdapterChoice) -> Result<Self, InitError> {
        let adapters = enumerate();
        let described: Vec<_> = adapters.iter().map(|adapter| AdapterDescription::of(&adapter.get_info())).collect();
        let at = choose(choice, &described)?;
        let (adapter, description) = (&adapters[at], described[at].clone());
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("localshape"),
            required_limits: wgpu::Limits {
                max_texture_dimension_2d: adapter.limits().max_texture_dimension_2d,
                max_buffer_size: adapter.limits().max_buffer_size,
                ..wgpu::Limits::downlevel_defaults()
            },
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|source| InitError::Device { adapter: Box::new(description.clone()), source: Box::new(source) })?;
        let trouble = Arc::new(Mutex::new(None));
        let keep = Arc::clone(&trouble);
        device.on_uncaptured_error(Arc::new(move |error| note(&keep, translate(error))));
        let keep = Arc::clone(&trouble);
        device.set_device_lost_callback(move |_, message| note(&keep, lost(&message)));
        Ok(Self { device, queue, description, trouble })
    }

    /// The device.
    pub(crate) fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue of the device.
    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// The adapter.
    pub fn description(&self) -> &AdapterDescription {
        &self.description
    }

    /// The longest side of pictures that the device can draw and read back (px); less for a size with too many pixels.
    pub(crate) fn longest_side(&self, size: [u32; 2]) -> u32 {
        let limits = self.device.limits();
        let longest = limits.max_texture_dimension_2d;
        read_back::longest_side(size, limits.max_buffer_size).map_or(longest, |other| longest.min(other))
    }

    /// The first error of the device since the last call. Commands fail asynchronously, so check before using their
    /// results.
    ///
    /// # Errors
    /// The first failed command, or a lost device.
    pub(crate) fn check(&self) -> Result<(), GpuError> {
        let mut trouble = self.trouble.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        match &*trouble {
            // A lost device stays lost.
            Some(GpuError::Lost(_)) => trouble.clone().map_or(Ok(()), Err),
            _ => trouble.take().map_or(Ok(()), Err),
        }
    }
}

/// A lost device, in one line.
fn lost(message: &str) -> GpuError {
    let words: Vec<_> = message.split_whitespace().collect();
    let words = words.join(" ");
    GpuError::Lost(if words.is_empty() { "its driver gives no reason".to_owned() } else { words })
}

fn note(trouble: &Mutex<Option<GpuError>>, error: GpuError) {
    trouble.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).get_or_insert(error);
}

fn translate(error: wgpu::Error) -> GpuError {
    match error {
        wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory,
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            GpuError::Refused(description)
        }
    }
}

/// Every graphics adapter of this machine, and the one that [`AdapterChoice::Auto`] would take. Opens no device.
pub fn adapters() -> (Vec<AdapterDescription>, Option<usize>) {
    let found = noise::hushed(enumerate);
    let described: Vec<_> = found.iter().map(|adapter| AdapterDescription::of(&adapter.get_info())).collect();
    let chosen = choose(&AdapterChoice::Auto, &described).ok();
    (described, chosen)
}

fn enumerate() -> Vec<wgpu::Adapter> {
    // No validation layers: they are slow and write to standard error. Tests check the shaders.
    let descriptor = wgpu::InstanceDescriptor {
        backends: wgpu::Backends::PRIMARY,
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    };
    pollster::block_on(wgpu::Instance::new(descriptor).enumerate_adapters(wgpu::Backends::PRIMARY))
}

/// The described adapter that fits a choice.
fn choose(choice: &AdapterChoice, found: &[AdapterDescription]) -> Result<usize, InitError> {
    let speed = |adapter: &AdapterDescription| match adapter.device_type.as_str() {
        "discrete gpu" => 0,
        "integrated gpu" => 1,
        "virtual gpu" => 2,
        "other" => 3,
        _ => 4,
    };
    let fits = |adapter: &AdapterDescription| match choice {
        AdapterChoice::Auto => true,
        AdapterChoice::Cpu => adapter.device_type == "cpu",
        AdapterChoice::Gpu => adapter.device_type != "cpu",
        AdapterChoice::Named(name) => adapter.name.to_lowercase().contains(&name.to_lowercase()),
    };
    if found.is_empty() {
        return Err(InitError::NoAdapter);
    }
    let fitting = found.iter().enumerate().filter(|(_, adapter)| fits(adapter));
    match fitting.min_by_key(|(at, adapter)| (speed(adapter), *at)) {
        Some((at, _)) => Ok(at),
        None => Err(InitError::NoSuchAdapter { wanted: choice.to_string(), found: found.to_vec() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, device_type: &str) -> AdapterDescription {
        AdapterDescription {
            name: name.into(),
            backend: "vulkan".into(),
            driver: "driver".into(),
            driver_info: String::new(),
            device_type: device_type.into(),
            processor: String::new(),
        }
    }

    #[test]
    fn a_choice_takes_the_fastest_adapter_that_fits() {
        let found = [adapter("llvmpipe", "cpu"), adapter("Arc", "integrated gpu"), adapter("RTX", "discrete gpu")];
        let chosen = |choice: &str| choose(&choice.parse().unwrap(), &found).ok();
        assert_eq!(chosen("auto"), Some(2));
        assert_eq!(chosen("cpu"), Some(0));
        assert_eq!(chosen("gpu"), Some(2));
        assert_eq!(chosen("arc"), Some(1));
        assert_eq!(chosen("Voodoo"), None);
    }

    #[test]
    fn an_unknown_name_is_answered_with_what_there_is() {
        let error = choose(&AdapterChoice::Named("Voodoo".into()), &[adapter("llvmpipe", "cpu")]).unwrap_err();
        assert_eq!(error.to_string(), "no graphics adapter fits `Voodoo`; there is `llvmpipe` (cpu)");
    }

    #[test]
    fn without_any_adapter_the_message_names_the_package() {
        let message = choose(&AdapterChoice::Auto, &[]).unwrap_err().to_string();
        assert!(message.contains("apt install mesa-vulkan-drivers"), "{message}");
        assert!(message.contains("dnf install mesa-vulkan-drivers"), "{message}");
    }

    #[test]
    fn a_description_leaves_out_what_is_not_known() {
        assert_eq!(adapter("llvmpipe", "cpu").to_string(), "llvmpipe (cpu, vulkan, driver)");
    }
}
