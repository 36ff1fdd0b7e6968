//! The native window.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> eframe::Result {
    let viewport = egui::ViewportBuilder::default()
        .with_title("Enroute")
        .with_app_id("enroute")
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([800.0, 500.0]);
    let options = eframe::NativeOptions { viewport, ..eframe::NativeOptions::default() };
    let create = |creation: &eframe::CreationContext<'_>| {
        let host = app::native::NativeHost::start(creation.egui_ctx.clone());
        let adapter = creation.wgpu_render_state.as_ref().map(|state| state.adapter.get_info());
        let renderer = adapter.map(|adapter| adapter.backend.to_string()).unwrap_or_default();
        let read_dropped = host.drop_reader();
        let app = app::Enroute::new(&creation.egui_ctx, Box::new(host), &renderer)
            .reading_dropped_files(read_dropped);
        Ok(Box::new(app) as Box<dyn eframe::App>)
    };
    eframe::run_native("enroute", options, Box::new(create))
}

/// The page has its own entry, in the `page` crate.
#[cfg(target_arch = "wasm32")]
fn main() {}
