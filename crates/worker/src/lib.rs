//! The planning core as a wasm module for a web worker. Nothing is planned here: the mission crate is the core, and
//! `web/core-worker.js` passes requests and answers between it and the page.
#![cfg(target_arch = "wasm32")]

use std::panic;

use js_sys::Uint8Array;
use mission::{Core, Response};
use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// What `web/core-worker.js` does for the core.
    #[derive(Clone)]
    pub type Surroundings;

    /// Whether the page waits for something newer.
    #[wasm_bindgen(method, js_name = isSuperseded)]
    fn is_superseded(this: &Surroundings) -> bool;

    /// Takes the bytes of an answer.
    #[wasm_bindgen(method)]
    fn answer(this: &Surroundings, answer: Uint8Array);

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

/// One planning core, fed by messages.
#[wasm_bindgen]
pub struct PlanningCore {
    core: Core,
    surroundings: Surroundings,
}

#[wasm_bindgen]
impl PlanningCore {
    /// A core that knows nothing yet.
    #[wasm_bindgen(constructor)]
    pub fn new(surroundings: Surroundings) -> Self {
        panic::set_hook(Box::new(|panic| core_panicked(&panic.to_string())));
        Self { core: Core::default(), surroundings }
    }

    /// Works one request out, given as the bytes of a [`mission::Request`]; answers go out while it works.
    pub fn handle(&mut self, request: &[u8]) -> Result<(), JsError> {
        let request = postcard::from_bytes(request)?;
        self.core.handle(request, &mut Page { surroundings: &self.surroundings });
        Ok(())
    }
}

struct Page<'a> {
    surroundings: &'a Surroundings,
}

impl mission::Surroundings for Page<'_> {
    fn now_millis(&self) -> f64 {
        performance_now()
    }

    fn is_superseded(&mut self) -> bool {
        self.surroundings.is_superseded()
    }

    fn answer(&mut self, response: Response) {
        match postcard::to_allocvec(&response) {
            Ok(bytes) => self.surroundings.answer(Uint8Array::from(bytes.as_slice())),
            Err(reason) => core_panicked(&format!("an answer cannot be written: {reason}")),
        }
    }
}
