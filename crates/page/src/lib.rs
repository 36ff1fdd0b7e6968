//! The front end as a wasm module for the page. Nothing is decided here: the app crate is the front end.
#![cfg(target_arch = "wasm32")]

use wasm_bindgen::prelude::*;

struct Minimal {
    text: String,
    revision: u64,
}

impl eframe::App for Minimal {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        egui::CentralPanel::default().show(ui, |ui| {
            ui.heading("Enroute");
            if ui.text_edit_multiline(&mut self.text).changed() {
                self.revision += 1;
            }
        });
    }

    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(&mut *self)
    }
}

/// Starts the front end on a canvas.
#[wasm_bindgen]
pub async fn start(canvas: web_sys::HtmlCanvasElement) -> Result<(), JsValue> {
    eframe::WebRunner::new()
        .start(
            canvas,
            eframe::WebOptions::default(),
            Box::new(|_| Ok(Box::new(Minimal { text: String::new(), revision: 0 }))),
        )
        .await
}
