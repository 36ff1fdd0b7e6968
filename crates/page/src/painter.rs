//! Which of the browser's interfaces to the graphics card draws the canvas.

use std::sync::Arc;

use eframe::{
    WebOptions,
    egui_wgpu::{RenderState, WgpuSetup},
    wgpu::{Backend, Backends, DeviceLostReason},
};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// Hears that the graphics card is gone. See `web/graphics.js`.
    #[wasm_bindgen(js_namespace = globalThis, js_name = graphicsLost)]
    fn graphics_lost();

    #[wasm_bindgen(js_namespace = console, js_name = error)]
    fn log_error(message: &str);
}

/// Lets the page go on when something cannot be drawn, and hear when nothing can be any more.
pub(crate) fn survive_errors(render_state: Option<&RenderState>) {
    let Some(state) = render_state else { return };
    state.device.on_uncaptured_error(Arc::new(|error| {
        log_error(&format!("a part of the frame is not drawn: {error}"));
    }));
    state.device.set_device_lost_callback(|reason, _| {
        // What is destroyed on purpose is none.
        if reason == DeviceLostReason::Unknown {
            graphics_lost();
        }
    });
}

/// Options for eframe: WebGPU where it really works, else WebGL2. `?renderer=webgl2` in the address asks for the
/// latter, for comparing and for drivers whose WebGPU is broken.
pub(crate) fn options() -> WebOptions {
    let mut options = WebOptions::default();
    let asked = web_sys::window().and_then(|window| window.location().search().ok()).unwrap_or_default();
    if let WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
        setup.instance_descriptor.backends = if asked.contains("renderer=webgl2") {
            Backends::GL
        } else {
            Backends::BROWSER_WEBGPU | Backends::GL
        };
    }
    options
}

/// What draws, for [`State`](workbench::outside::Remote::state).
pub(crate) fn name(render_state: Option<&RenderState>) -> &'static str {
    match render_state.map(|state| state.adapter.get_info().backend) {
        Some(Backend::BrowserWebGpu) => "webgpu",
        Some(Backend::Gl) => "webgl2",
        _ => "",
    }
}
