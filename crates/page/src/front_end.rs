//! The running front end, as `web/start.js` and `web/api.js` use it.

use std::{cell::RefCell, rc::Rc};

use app::{
    Enroute,
    accessibility::{AccessibilityMirror, Act},
    chord,
};
use eframe::WebRunner;
use egui::{Key, Modifiers};
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;
use workbench::host::RefusalCode;
use workbench::host_io::Remote;

use crate::{
    core_link::CoreLink,
    glue::Glue,
    host::PageHost,
    painter,
    refusal::{from_remote, refusal, words},
};

/// Starts the front end on a canvas, as [`FrontEnd::draw_on`] continues on another one.
#[wasm_bindgen]
pub async fn start(
    canvas: HtmlCanvasElement,
    glue: Glue,
    turn: u32,
    avoids_webgpu: bool,
) -> Result<FrontEnd, JsValue> {
    let front_end = FrontEnd { runner: WebRunner::new(), glue, page: Rc::default() };
    front_end.draw_on(canvas, turn, avoids_webgpu).await?;
    Ok(front_end)
}

/// What continues when the canvas is another one.
struct Page {
    app: Enroute,
    core: CoreLink,
    egui: egui::Context,
}

impl Page {
    fn start(glue: &Glue, egui: &egui::Context, renderer: &str) -> Option<Self> {
        let host = PageHost::start(glue.clone(), egui.clone())?;
        let (core, read_dropped) = (host.core(), host.drop_reader());
        let app = Enroute::new(egui, Box::new(host), renderer).reading_dropped_files(read_dropped);
        Some(Self { app, core, egui: egui.clone() })
    }

    fn move_to(&mut self, egui: &egui::Context, renderer: &str) {
        self.app.move_to(egui, renderer);
        self.core.wake(egui.clone());
        self.egui = egui.clone();
    }
}

/// The app on one canvas, telling the page of every frame.
struct PageApp {
    page: Rc<RefCell<Option<Page>>>,
    glue: Glue,
}

impl eframe::App for PageApp {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        if let Some(page) = self.page.borrow_mut().as_mut() {
            page.app.ui(ui, frame);
        }
        self.glue.frame_drawn();
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        let page = self.page.borrow();
        page.as_ref().map_or([0.0; 4], |page| page.app.clear_color(visuals))
    }
}

/// Returns whether a key press is one of Enroute's commands, so that the browser should leave it alone. `key` and
/// `code` are what JavaScript calls it and its place on the keyboard. Keys that type are no one's business here.
#[wasm_bindgen(js_name = usesKey)]
pub fn uses_key(key: &str, code: &str, control: bool, alt: bool, shift: bool) -> bool {
    let is_function_key = key.len() > 1 && key.starts_with('F');
    let types = !control && !alt && !is_function_key;
    let modifiers = Modifiers { alt, shift, ctrl: control, command: control, ..Modifiers::NONE };
    !types && chord::is_of_command(Key::from_name(key), Key::from_name(code), modifiers)
}

/// Something typed that no frame has taken in.
#[derive(serde::Deserialize)]
#[serde(untagged)]
enum Typed {
    Text(String),
    Key { key: String },
}

impl Typed {
    fn event(self) -> Option<egui::Event> {
        match self {
            Self::Text(text) => Some(egui::Event::Text(text)),
            Self::Key { key } => Some(egui::Event::Key {
                key: Key::from_name(&key)?,
                physical_key: None,
                pressed: true,
                repeat: false,
                modifiers: Modifiers::NONE,
            }),
        }
    }
}

/// The running front end.
#[wasm_bindgen]
pub struct FrontEnd {
    runner: WebRunner,
    glue: Glue,
    page: Rc<RefCell<Option<Page>>>,
}

#[wasm_bindgen]
impl FrontEnd {
    /// Continues on another canvas, when the browser has taken the graphics of the one before away. Rejects with the code
    /// `no-graphics` when it cannot draw there; the state stays, and another try may do. `globalThis.graphicsLost` is told
    /// this `turn` when a WebGPU device is lost; `avoids_webgpu` asks for WebGL2.
    #[wasm_bindgen(js_name = drawOn)]
    pub async fn draw_on(
        &self,
        canvas: HtmlCanvasElement,
        turn: u32,
        avoids_webgpu: bool,
    ) -> Result<(), JsValue> {
        let (page, glue) = (Rc::clone(&self.page), self.glue.clone());
        let limited = canvas.clone();
        let started = self.runner.start(
            canvas,
            painter::options(avoids_webgpu),
            Box::new(move |creation| {
                let egui = &creation.egui_ctx;
                egui.add_plugin(AccessibilityMirror::default());
                painter::survive_errors(creation.wgpu_render_state.as_ref(), turn);
                painter::limit_canvas(&limited, creation.wgpu_render_state.as_ref());
                let renderer = painter::name(creation.wgpu_render_state.as_ref());
                let mut kept = page.borrow_mut();
                if let Some(page) = kept.as_mut() {
                    page.move_to(egui, renderer);
                } else {
                    *kept = Some(
                        Page::start(&glue, egui, renderer)
                            .ok_or("this document is not the page of Enroute")?,
                    );
                }
                drop(kept);
                Ok(Box::new(PageApp { page, glue }))
            }),
        );
        started.await.map_err(|reason| refusal(RefusalCode::NoGraphics, &words(&reason)))
    }

    /// Draws nothing from here on until [`FrontEnd::draw_on`] is called: what it draws on is gone.
    pub fn pause(&self) {
        self.runner.destroy();
    }

    /// Returns what draws: `webgpu` or `webgl2`; empty if that is not known.
    pub fn renderer(&self) -> String {
        let page = self.page.borrow();
        page.as_ref().map(|page| page.app.app_state().frame.renderer.clone()).unwrap_or_default()
    }

    /// Opens an example mission.
    pub fn open(&self, name: &str) -> Result<(), JsValue> {
        self.with(|page| page.app.open(name))?.map_err(from_remote)
    }

    /// Replaces the whole text.
    #[wasm_bindgen(js_name = setSource)]
    pub fn set_source(&self, text: &str) -> Result<(), JsValue> {
        self.with(|page| page.app.set_source(text))
    }

    /// The text as it stands.
    pub fn source(&self) -> Result<String, JsValue> {
        self.with(|page| page.app.source())
    }

    /// Runs a command with arguments given as JSON.
    pub fn dispatch(&self, command: &str, arguments: &str) -> Result<(), JsValue> {
        let arguments = serde_json::from_str(arguments)
            .map_err(|reason| refusal(RefusalCode::BadArguments, &reason.to_string()))?;
        self.with(|page| page.app.dispatch(command, &arguments))?.map_err(from_remote)
    }

    /// The state as JSON.
    pub fn state(&self) -> Result<String, JsValue> {
        let state = self.with(|page| serde_json::to_string(&page.app.state()))?;
        state.map_err(|reason| refusal(RefusalCode::Stopped, &reason.to_string()))
    }

    /// Grows whenever the state may have changed.
    #[wasm_bindgen(js_name = stateVersion)]
    pub fn state_version(&self) -> Result<f64, JsValue> {
        self.with(|page| page.app.state_version() as f64)
    }

    /// Writes down whatever is not written yet: the page is about to close. `typed` is what was typed since the last
    /// frame, as JSON: texts, and keys by their names as `{"key":…}`.
    #[wasm_bindgen(js_name = keepNow)]
    pub fn keep_now(&self, typed: &str) -> Result<(), JsValue> {
        let typed: Vec<Typed> = serde_json::from_str(typed).unwrap_or_default();
        self.with(|page| {
            if !typed.is_empty() {
                let events = typed.into_iter().filter_map(Typed::event).collect();
                let input = egui::RawInput { events, focused: true, ..egui::RawInput::default() };
                // No one sees this frame; it takes in what was typed.
                let _ = page.egui.clone().run_ui(input, |ui| page.app.show(ui, None));
            }
            page.app.keep_now();
        })
    }

    /// Writes down `typed`, as for [`FrontEnd::keep_now`], before a frame takes it in.
    #[wasm_bindgen(js_name = keepAhead)]
    pub fn keep_ahead(&self, typed: &str) -> Result<(), JsValue> {
        let typed: Vec<Typed> = serde_json::from_str(typed).unwrap_or_default();
        let events: Vec<egui::Event> = typed.into_iter().filter_map(Typed::event).collect();
        self.with(|page| page.app.keep_ahead(&page.egui, &events))
    }

    /// Returns what changed in the accessible document since the last call, as JSON, if anything did.
    #[wasm_bindgen(js_name = takeAccessibilityChange)]
    pub fn take_accessibility_change(&self) -> Result<Option<String>, JsValue> {
        let change = self.with(|page| page.egui.plugin_opt::<AccessibilityMirror>()?.lock().take_change())?;
        change
            .map(|change| serde_json::to_string(&change))
            .transpose()
            .map_err(|reason| refusal(RefusalCode::Stopped, &reason.to_string()))
    }

    /// Does something to an element of the accessible document; `act` is JSON.
    pub fn act(&self, element: &str, act: &str) -> Result<(), JsValue> {
        let bad = |reason: String| refusal(RefusalCode::BadArguments, &reason);
        let element: u64 = element.parse().map_err(|_| bad(format!("no element {element}")))?;
        let act: Act = serde_json::from_str(act).map_err(|reason| bad(reason.to_string()))?;
        self.with(|page| {
            if let Some(mirror) = page.egui.plugin_opt::<AccessibilityMirror>() {
                mirror.lock().act(element, act);
                page.egui.request_repaint();
            }
        })
    }

    /// Uses the app between frames, and asks for a frame that shows what came of it.
    fn with<T>(&self, act: impl FnOnce(&mut Page) -> T) -> Result<T, JsValue> {
        let mut page = self.page.try_borrow_mut().ok().filter(|_| !self.runner.has_panicked());
        match page.as_mut().and_then(|page| page.as_mut()) {
            Some(page) => Ok(act(page)),
            None => Err(refusal(RefusalCode::Stopped, "Enroute has stopped, or is just drawing a frame")),
        }
    }
}
