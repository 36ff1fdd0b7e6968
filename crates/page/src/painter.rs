//! Which of the browser's interfaces to the graphics card draws the canvas.

use eframe::{
    WebOptions,
    egui_wgpu::{RenderState, WgpuSetup},
    wgpu::{Backend, Backends},
};

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

/// What draws, for [`State`](workbench::host::Remote::state).
pub(crate) fn name(render_state: Option<&RenderState>) -> &'static str {
    match render_state.map(|state| state.adapter.get_info().backend) {
        Some(Backend::BrowserWebGpu) => "webgpu",
        Some(Backend::Gl) => "webgl2",
        _ => "",
    }
}
