//! The planning core as a wasm module for a web worker. Nothing is planned here: the mission crate is the core, and
//! `web/core-worker.js` passes requests and answers between it and the page.
#![cfg(target_arch = "wasm32")]

use std::panic;

use js_sys::Uint8Array;
use link::Response;
use link::wire::CoreEnd;
use mission::{Core, CoreHost};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// What `web/core-worker.js` does for the core.
    #[derive(Clone)]
    pub type WorkerHost;

    /// Returns whether the page waits for something newer.
    #[wasm_bindgen(method, js_name = isSuperseded)]
    fn is_superseded(this: &WorkerHost) -> bool;

    /// Takes the bytes of an answer.
    #[wasm_bindgen(method)]
    fn answer(this: &WorkerHost, answer: Uint8Array);

    /// Hears that the core does not have the text that a job edits.
    #[wasm_bindgen(method, js_name = textLost)]
    fn text_lost(this: &WorkerHost);

    /// Hears that the core continues with a long job.
    #[wasm_bindgen(method)]
    fn alive(this: &WorkerHost);

    /// Milliseconds, as exactly as the browser tells.
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    fn performance_now() -> f64;
}

#[wasm_bindgen]
extern "C" {
    /// Hears why the core is about to stop.
    #[wasm_bindgen(js_namespace = globalThis, js_name = corePanicked)]
    fn core_panicked(message: &str);
}

/// How often a long job says that it continues.
const ALIVE_MILLIS: f64 = 5000.0;

/// One planning core, fed by messages.
#[wasm_bindgen]
pub struct PlanningCore {
    core: Core,
    page: Page,
}

#[wasm_bindgen]
impl PlanningCore {
    /// A core that knows nothing yet.
    #[wasm_bindgen(constructor)]
    pub fn new(host: WorkerHost) -> Self {
        panic::set_hook(Box::new(|panic| core_panicked(&panic.to_string())));
        Self { core: Core::default(), page: Page { host, end: CoreEnd::default(), told_millis: 0.0 } }
    }

    /// Does one job, given as the bytes of a [`link::Request`]; answers go out while it works.
    pub fn handle(&mut self, request: &[u8]) -> Result<(), JsError> {
        let Some(request) = self.page.end.read(request)? else {
            self.page.host.text_lost();
            return Ok(());
        };
        self.page.told_millis = performance_now();
        self.core.handle(request, &mut self.page);
        Ok(())
    }
}

struct Page {
    host: WorkerHost,
    /// Knows what the page holds and what it told.
    end: CoreEnd,
    /// When the page last heard something.
    told_millis: f64,
}

impl CoreHost for Page {
    fn now_millis(&self) -> f64 {
        performance_now()
    }

    fn is_superseded(&mut self) -> bool {
        let now_millis = performance_now();
        if now_millis - self.told_millis > ALIVE_MILLIS {
            self.told_millis = now_millis;
            self.host.alive();
        }
        self.host.is_superseded()
    }

    fn answer(&mut self, response: Response) {
        self.told_millis = performance_now();
        match self.end.write(response) {
            Ok(bytes) => self.host.answer(Uint8Array::from(bytes.as_slice())),
            Err(reason) => core_panicked(&format!("an answer cannot be written: {reason}")),
        }
    }
}
