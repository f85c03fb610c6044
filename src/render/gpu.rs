//! The graphics device: which adapter, and what to say when there is none.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use thiserror::Error;

/// Environment variable that overrides the choice of adapter: `software`, or a part of the
/// adapter's name.
pub const ADAPTER_VARIABLE: &str = "HAMMERFALL_GPU";

/// Backends this program is built with on some platform.
const BACKENDS: wgpu::Backends =
    wgpu::Backends::VULKAN.union(wgpu::Backends::METAL).union(wgpu::Backends::DX12);

/// Longest wait for one picture. A software driver on a busy machine needs a second for a large
/// one; a driver that hangs never comes back.
pub(super) const TIME_LIMIT: Duration = Duration::from_secs(120);

/// Why nothing can be drawn.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum GpuError {
    /// No driver, or none that matches the wish.
    #[error("{0}")]
    NoAdapter(String),
    /// The driver refused to open the device.
    #[error("the graphics device '{adapter}' could not be opened: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The device ran out of memory.
    #[error("the graphics device ran out of memory ({0}); make the picture smaller or close other programs")]
    OutOfMemory(String),
    /// The device went away while drawing.
    #[error("the graphics device was lost ({0}); start again, or set {ADAPTER_VARIABLE}=software")]
    Lost(String),
    /// The device did not finish in time.
    #[error("the graphics device did not finish a picture within {0} s")]
    TimedOut(u64),
    /// A picture of this size cannot be drawn.
    #[error(
        "a picture of {width}x{height} pixels cannot be drawn: \
         each side must be from 1 to {limit} on the device '{adapter}'"
    )]
    BadSize {
        /// Width asked for, pixels.
        width: u32,
        /// Height asked for, pixels.
        height: u32,
        /// Longest side possible, pixels.
        limit: u32,
        /// Name of the adapter.
        adapter: String,
    },
    /// Too many triangles for one buffer of the device.
    #[error(
        "{triangles} surface triangles are too many for the device '{adapter}': \
         its buffers hold {limit}"
    )]
    TooManyTriangles {
        /// Triangles in the frame.
        triangles: usize,
        /// Triangles that fit.
        limit: usize,
        /// Name of the adapter.
        adapter: String,
    },
    /// Anything else the device reported.
    #[error("the graphics device reported an error: {0}")]
    Other(String),
}

/// Which adapter to draw with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// The fastest kind there is: discrete, integrated, virtual, then software.
    #[default]
    Fastest,
    /// A software rasterizer: the same pixels on every machine with the same driver.
    Software,
    /// An adapter whose name contains this text, whatever the case.
    Named(String),
}

impl AdapterChoice {
    /// The choice in the environment variable [`ADAPTER_VARIABLE`], or `otherwise` without one.
    #[must_use]
    pub fn from_env_or(otherwise: Self) -> Self {
        match std::env::var(ADAPTER_VARIABLE) {
            Ok(text) if !text.trim().is_empty() => Self::parse(text.trim()),
            _ => otherwise,
        }
    }

    fn parse(text: &str) -> Self {
        match text.to_ascii_lowercase().as_str() {
            "software" | "cpu" => Self::Software,
            "auto" | "fastest" => Self::Fastest,
            name => Self::Named(name.to_owned()),
        }
    }

    /// Smaller is better; `None` when the adapter does not fit the wish.
    fn rank(&self, info: &wgpu::AdapterInfo) -> Option<u8> {
        let is_software = info.device_type == wgpu::DeviceType::Cpu;
        match self {
            Self::Fastest => Some(speed_rank(info.device_type)),
            Self::Software => is_software.then_some(0),
            Self::Named(part) => info.name.to_lowercase().contains(&part.to_lowercase()).then_some(0),
        }
    }
}

fn speed_rank(device_type: wgpu::DeviceType) -> u8 {
    match device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

/// An open graphics device. Cloning shares it.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Adapter the device was opened on.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name, kind and driver of the adapter.
    pub info: wgpu::AdapterInfo,
    fault: FaultSlot,
}

/// The first fault the device reported outside of calls that return one.
#[derive(Clone, Debug, Default)]
struct FaultSlot(Arc<Mutex<Option<GpuError>>>);

impl FaultSlot {
    fn put(&self, fault: GpuError) {
        let mut slot = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        slot.get_or_insert(fault);
    }

    /// The fault, forgotten unless the device is gone for good.
    fn take(&self) -> Option<GpuError> {
        let mut slot = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*slot {
            Some(GpuError::Lost(_)) => slot.clone(),
            _ => slot.take(),
        }
    }
}

/// A wgpu instance with the backends of this program and no validation layers.
#[must_use]
pub fn new_instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: BACKENDS,
        // Driver-side validation layers are a developer's tool; wgpu checks all calls itself.
        flags: wgpu::InstanceFlags::empty().with_env(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    })
}

impl Gpu {
    /// Opens a device that needs no window, as the environment variable [`ADAPTER_VARIABLE`]
    /// says, else the fastest one.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] (its text names the package to install) and
    /// [`GpuError::NoDevice`].
    pub fn headless() -> Result<Self, GpuError> {
        Self::headless_with(&AdapterChoice::from_env_or(AdapterChoice::Fastest))
    }

    /// Opens a device that needs no window, chosen as told.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] and [`GpuError::NoDevice`].
    pub fn headless_with(choice: &AdapterChoice) -> Result<Self, GpuError> {
        Self::open(&new_instance(), None, choice)
    }

    /// Opens a device that can show on `surface`, chosen as told.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] and [`GpuError::NoDevice`].
    pub fn for_surface(
        instance: &wgpu::Instance,
        surface: &wgpu::Surface<'_>,
        choice: &AdapterChoice,
    ) -> Result<Self, GpuError> {
        Self::open(instance, Some(surface), choice)
    }

    /// Takes the device away, as a driver might: to test what becomes of the rest.
    pub fn lose(&self) {
        self.fault.put(GpuError::Lost("taken away by a test".to_owned()));
        self.device.destroy();
    }

    fn open(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
        choice: &AdapterChoice,
    ) -> Result<Self, GpuError> {
        let adapter = choose_adapter(instance, surface, choice)?;
        let info = adapter.get_info();
        let request = adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("hammerfall"),
            required_limits: needed_limits(&adapter.limits()),
            ..Default::default()
        });
        let (device, queue) = pollster::block_on(request)
            .map_err(|error| GpuError::NoDevice { adapter: info.name.clone(), reason: error.to_string() })?;
        let fault = watch_faults(&device);
        Ok(Self { adapter, device, queue, info, fault })
    }

    /// What went wrong on the device since the last check, if anything.
    ///
    /// # Errors
    /// The first fault: lost device (told at every check from then on), out of memory, or a
    /// rejected call.
    pub fn check(&self) -> Result<(), GpuError> {
        self.fault.take().map_or(Ok(()), Err)
    }

    /// Waits until the device is done with a submission, or with all.
    ///
    /// # Errors
    /// As [`Gpu::check`]; [`GpuError::TimedOut`] from a driver that hangs.
    pub fn wait(&self, submission_index: Option<wgpu::SubmissionIndex>) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::Wait { submission_index, timeout: Some(TIME_LIMIT) });
        self.check()?;
        waited.map(|_| ()).map_err(|_| GpuError::TimedOut(TIME_LIMIT.as_secs()))
    }

    /// Checks that a picture of this size, in pixels, can be drawn.
    ///
    /// # Errors
    /// [`GpuError::BadSize`].
    pub fn check_size(&self, [width, height]: [u32; 2]) -> Result<(), GpuError> {
        let limit = self.device.limits().max_texture_dimension_2d;
        if (1..=limit).contains(&width) && (1..=limit).contains(&height) {
            return Ok(());
        }
        Err(GpuError::BadSize { width, height, limit, adapter: self.info.name.clone() })
    }
}

/// Modest limits that every driver has, except for the sizes of textures and buffers.
fn needed_limits(available: &wgpu::Limits) -> wgpu::Limits {
    let mut limits = wgpu::Limits::downlevel_defaults().using_resolution(available.clone());
    limits.max_buffer_size = available.max_buffer_size;
    limits
}

/// An error with all that led to it, in one line.
fn with_causes(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    causes.map(|cause| cause.to_string().replace('\n', " ")).collect::<Vec<_>>().join(": ")
}

fn watch_faults(device: &wgpu::Device) -> FaultSlot {
    let fault = FaultSlot::default();
    let slot = fault.clone();
    device.on_uncaptured_error(Arc::new(move |error| {
        slot.put(match error {
            wgpu::Error::OutOfMemory { source } => GpuError::OutOfMemory(with_causes(&*source)),
            other => GpuError::Other(other.to_string()),
        });
    }));
    let slot = fault.clone();
    device.set_device_lost_callback(move |reason, message| {
        if reason != wgpu::DeviceLostReason::Destroyed {
            slot.put(GpuError::Lost(message));
        }
    });
    fault
}

/// The best adapter for the wish. Ties are broken by name and driver, so that the same machine
/// gives the same adapter every time.
fn choose_adapter(
    instance: &wgpu::Instance,
    surface: Option<&wgpu::Surface<'_>>,
    choice: &AdapterChoice,
) -> Result<wgpu::Adapter, GpuError> {
    let all = pollster::block_on(instance.enumerate_adapters(BACKENDS));
    let names: Vec<String> = all.iter().map(|a| a.get_info().name).collect();
    all.into_iter()
        .filter(|adapter| surface.is_none_or(|s| adapter.is_surface_supported(s)))
        .filter_map(|adapter| {
            let info = adapter.get_info();
            let rank = choice.rank(&info)?;
            Some(((rank, info.name, info.driver, info.device_pci_bus_id), adapter))
        })
        .min_by(|a, b| a.0.cmp(&b.0))
        .map(|(_, adapter)| adapter)
        .ok_or_else(|| GpuError::NoAdapter(no_adapter_message(choice, &names)))
}

fn no_adapter_message(choice: &AdapterChoice, found: &[String]) -> String {
    let wish = match choice {
        AdapterChoice::Fastest if found.is_empty() => {
            "no graphics driver was found (not even a software one)".to_owned()
        }
        AdapterChoice::Fastest => "no graphics adapter can show on this window".to_owned(),
        AdapterChoice::Software => "no software graphics driver was found".to_owned(),
        AdapterChoice::Named(name) => format!("no usable graphics adapter is called '{name}'"),
    };
    if found.is_empty() {
        return format!("{wish}.\n{INSTALL_HINT}");
    }
    let others = found.join(", ");
    match choice {
        AdapterChoice::Named(_) => {
            format!("{wish}; there is: {others}. Change or unset {ADAPTER_VARIABLE}.")
        }
        _ => format!("{wish}; there is: {others}.\n{INSTALL_HINT}"),
    }
}

/// How to get a driver that needs no graphics card.
const INSTALL_HINT: &str = if cfg!(target_os = "linux") {
    "Install a Vulkan driver; the one that needs no graphics card is in these packages:\n  \
     Debian, Ubuntu: apt install mesa-vulkan-drivers\n  \
     Fedora: dnf install mesa-vulkan-drivers\n  \
     Arch: pacman -S vulkan-swrast\n  \
     Alpine: apk add mesa-vulkan-swrast\n  \
     openSUSE: zypper install Mesa-vulkan-drivers libvulkan_lvp"
} else {
    "Install or update the graphics driver of this machine."
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_driver_message_names_the_package() {
        let text = no_adapter_message(&AdapterChoice::Fastest, &[]);
        assert!(text.contains("no graphics driver"), "{text}");
        if cfg!(target_os = "linux") {
            assert!(text.contains("apt install mesa-vulkan-drivers"), "{text}");
        }
    }

    #[test]
    fn unmatched_wish_lists_what_there_is() {
        let wish = AdapterChoice::Named("voodoo".into());
        let text = no_adapter_message(&wish, &["llvmpipe".into()]);
        assert!(text.contains("'voodoo'") && text.contains("there is: llvmpipe"), "{text}");
    }

    #[test]
    fn environment_words_are_understood() {
        assert_eq!(AdapterChoice::parse("Software"), AdapterChoice::Software);
        assert_eq!(AdapterChoice::parse("auto"), AdapterChoice::Fastest);
        assert_eq!(AdapterChoice::parse("Arc"), AdapterChoice::Named("arc".into()));
    }

    #[test]
    fn first_fault_is_told_once_but_a_lost_device_always() {
        let slot = FaultSlot::default();
        slot.put(GpuError::OutOfMemory("for what".into()));
        slot.put(GpuError::Other("a consequence".into()));
        assert_eq!(slot.take(), Some(GpuError::OutOfMemory("for what".into())));
        assert_eq!(slot.take(), None);
        slot.put(GpuError::Lost("gone".into()));
        assert_eq!(slot.take(), slot.take());
        assert!(slot.take().is_some());
    }
}
