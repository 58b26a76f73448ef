//! The graphics device, and the report of its loss.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use thiserror::Error;

/// Called when the device is lost, with the reason ("unknown" or "destroyed") and the driver's
/// message.
pub type OnLost = Arc<dyn Fn(&str, &str) + Send + Sync>;
/// Called with the device's message when it rejects a call.
pub type OnError = Arc<dyn Fn(&str) + Send + Sync>;

/// Callbacks for asynchronous reports of the graphics device.
#[derive(Clone)]
pub struct Callbacks {
    /// Called when the device is lost, at most once.
    pub on_lost: OnLost,
    /// Called when the device rejects a call. The picture may then be incomplete.
    pub on_error: OnError,
}

/// Why no renderer could be created.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CreateError {
    /// The canvas provides no graphics context: the browser supports none, or the canvas already
    /// has a context of another kind.
    #[error("the canvas gives no graphics context: {0}")]
    Surface(#[from] wgpu::CreateSurfaceError),
    /// There is no graphics adapter.
    #[error("no graphics adapter: {0}")]
    Adapter(#[from] wgpu::RequestAdapterError),
    /// The adapter provides no device.
    #[error("no graphics device: {0}")]
    Device(#[from] wgpu::RequestDeviceError),
    /// The adapter cannot draw on this surface in 8-bit sRGB.
    #[error("the adapter cannot draw on the canvas")]
    Format,
}

/// A graphics device.
pub(super) struct Gpu {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    lost: Arc<AtomicBool>,
    callbacks: Callbacks,
}

impl Gpu {
    /// Opens a device that can draw on `surface`, with `features` of its adapter. Returns the
    /// device and the adapter.
    pub(super) async fn open(
        instance: &wgpu::Instance,
        surface: Option<&wgpu::Surface<'_>>,
        features: impl FnOnce(&wgpu::Adapter) -> wgpu::Features,
        callbacks: Callbacks,
    ) -> Result<(Self, wgpu::Adapter), CreateError> {
        let adapter = instance
            .request_adapter(&wgpu::RequestAdapterOptions {
                power_preference: wgpu::PowerPreference::HighPerformance,
                compatible_surface: surface,
                ..wgpu::RequestAdapterOptions::default()
            })
            .await?;
        let info = adapter.get_info();
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("particles"),
                required_features: features(&adapter),
                required_limits: wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
                ..wgpu::DeviceDescriptor::default()
            })
            .await?;
        let lost = Arc::new(AtomicBool::new(false));
        device.set_device_lost_callback({
            let (lost, on_lost) = (Arc::clone(&lost), Arc::clone(&callbacks.on_lost));
            move |reason, message| {
                let reason = match reason {
                    wgpu::DeviceLostReason::Destroyed => "destroyed",
                    wgpu::DeviceLostReason::Unknown => "unknown",
                };
                if !lost.swap(true, Ordering::Relaxed) {
                    on_lost(reason, &message);
                }
            }
        });
        device.on_uncaptured_error({
            let on_error = Arc::clone(&callbacks.on_error);
            Arc::new(move |error: wgpu::Error| on_error(&error.to_string()))
        });
        Ok((Self { device, queue, info, lost, callbacks }, adapter))
    }

    /// Name of the back end: "webgpu", "webgl2" or a native one.
    pub(super) fn backend(&self) -> &'static str {
        match self.info.backend {
            wgpu::Backend::BrowserWebGpu => "webgpu",
            wgpu::Backend::Gl if cfg!(target_arch = "wasm32") => "webgl2",
            other => other.to_str(),
        }
    }

    /// Name of the adapter. It may be empty, because browsers hide it.
    pub(super) fn adapter(&self) -> &str {
        [&self.info.name, &self.info.driver, &self.info.driver_info]
            .into_iter()
            .find(|words| !words.is_empty())
            .map_or("", String::as_str)
    }

    /// Whether the device is lost.
    pub(super) fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// Records the loss of the device, if it is not yet recorded.
    pub(super) fn mark_lost(&self, reason: &str, message: &str) {
        if !self.lost.swap(true, Ordering::Relaxed) {
            (self.callbacks.on_lost)(reason, message);
        }
    }
}
