//! Which of the browser's interfaces to the graphics card draws the canvas, and what is asked of it.

use std::sync::Arc;

use eframe::{
    WebOptions,
    egui_wgpu::{RenderState, WgpuSetup},
    wgpu::{Adapter, Backend, Backends, DeviceDescriptor, DeviceLostReason, Limits},
};
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

#[wasm_bindgen]
extern "C" {
    /// Hears that the graphics card is gone that drew in this turn. See `web/graphics.js`.
    #[wasm_bindgen(js_namespace = globalThis, js_name = graphicsLost)]
    fn graphics_lost(turn: u32);

    #[wasm_bindgen(js_namespace = console, js_name = error)]
    fn log_error(message: &str);
}

/// The side of the largest texture that is asked for where the graphics card has it: enough for a window on a large screen.
const LARGEST_TEXTURE: u32 = 8192;

/// Lets the page continue when something cannot be drawn, and hear when nothing can be any more.
pub(crate) fn survive_errors(render_state: Option<&RenderState>, turn: u32) {
    let Some(state) = render_state else { return };
    state.device.on_uncaptured_error(Arc::new(|error| {
        log_error(&format!("a part of the frame is not drawn: {error}"));
    }));
    state.device.set_device_lost_callback(move |reason, _| {
        // What is destroyed on purpose is none.
        if reason == DeviceLostReason::Unknown {
            graphics_lost(turn);
        }
    });
}

/// Keeps the canvas as small as the largest texture: nothing could be drawn on a larger one.
pub(crate) fn limit_canvas(canvas: &HtmlCanvasElement, render_state: Option<&RenderState>) {
    let Some(state) = render_state else { return };
    let side = state.device.limits().max_texture_dimension_2d;
    // `web/page.css` knows how many pixels of the screen a CSS pixel has.
    let _ = canvas.style().set_property("--largest-side", &side.to_string());
}

/// Options for eframe: WebGPU where it really works, else WebGL2. `?renderer=webgl2` in the address asks for the
/// latter, for comparing and for drivers whose WebGPU is broken; so does `avoids_webgpu`.
pub(crate) fn options(avoids_webgpu: bool) -> WebOptions {
    let mut options = WebOptions::default();
    let asked = web_sys::window().and_then(|window| window.location().search().ok()).unwrap_or_default();
    if let WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
        setup.instance_descriptor.backends = if avoids_webgpu || asked.contains("renderer=webgl2") {
            Backends::GL
        } else {
            Backends::BROWSER_WEBGPU | Backends::GL
        };
        setup.device_descriptor = Arc::new(device);
    }
    options
}

/// Returns what is asked of the graphics card: never more than it has, or it gives nothing.
fn device(adapter: &Adapter) -> DeviceDescriptor<'static> {
    let usual = if adapter.get_info().backend == Backend::Gl {
        Limits::downlevel_webgl2_defaults()
    } else {
        Limits::default()
    };
    let wanted = Limits { max_texture_dimension_2d: LARGEST_TEXTURE, ..usual };
    DeviceDescriptor {
        label: Some("enroute"),
        required_limits: wanted.or_worse_values_from(&adapter.limits()),
        ..DeviceDescriptor::default()
    }
}

/// Returns what draws, for [`State`](workbench::host_io::Remote::state).
pub(crate) fn name(render_state: Option<&RenderState>) -> &'static str {
    match render_state.map(|state| state.adapter.get_info().backend) {
        Some(Backend::BrowserWebGpu) => "webgpu",
        Some(Backend::Gl) => "webgl2",
        _ => "",
    }
}
