//! The planning core in its web worker: carries jobs and answers as bytes. What waits, and when a worker is ended and
//! started again, `link` decides.

use std::{
    cell::RefCell,
    collections::VecDeque,
    rc::{Rc, Weak},
    time::Duration,
};

use js_sys::Uint8Array;
use link::wire::{self, AskerEnd};
use link::{Job, Link, LinkEvent, News, Request, Transport};
use wasm_bindgen::prelude::*;
use workbench::host::HostEvent;

use crate::glue::{CoreWorker, Glue};

/// The way to the core; clones lead to the same one.
#[derive(Clone)]
pub(crate) struct CoreLink(Rc<RefCell<Shared>>);

struct Shared {
    link: Link<Workers>,
    /// Reads the answers of the running core.
    end: AskerEnd,
    wake: egui::Context,
    events: VecDeque<HostEvent>,
}

/// Starts and ends web workers, one at a time.
struct Workers {
    glue: Glue,
    running: Option<Worker>,
    shared: Weak<RefCell<Shared>>,
}

/// A running worker with what listens to it.
struct Worker {
    core: CoreWorker,
    _listener: Closure<dyn FnMut(String, JsValue)>,
}

impl CoreLink {
    /// Starts a core; `wake` is asked for a frame whenever there is news.
    pub(crate) fn start(glue: Glue, wake: egui::Context) -> Self {
        Self(Rc::new_cyclic(|shared| {
            let workers = Workers { glue, running: None, shared: shared.clone() };
            let link = Link::start(workers, now_secs());
            RefCell::new(Shared { link, end: AskerEnd::of_core(1), wake, events: VecDeque::new() })
        }))
    }

    /// Asks the core.
    pub(crate) fn post(&self, request: Request) {
        let mut shared = self.0.borrow_mut();
        shared.link.tick(now_secs());
        shared.link.post(request);
        shared.wake_when_due();
    }

    /// Takes back everything that was asked.
    pub(crate) fn stop(&self) {
        let mut shared = self.0.borrow_mut();
        shared.link.tick(now_secs());
        shared.link.cancel_all();
        shared.wake_when_due();
    }

    /// Takes the oldest news.
    pub(crate) fn poll(&self) -> Option<HostEvent> {
        let mut shared = self.0.borrow_mut();
        shared.link.tick(now_secs());
        shared.wake_when_due();
        while let Some(event) = shared.link.next_event() {
            shared.events.push_back(match event {
                LinkEvent::Answer { response, .. } => HostEvent::Answer(response),
                LinkEvent::Failed { revision, message, .. } => HostEvent::CoreFailed { revision, message },
                LinkEvent::Restarted { message } => HostEvent::CoreRestarted { message },
            });
        }
        shared.events.pop_front()
    }

    /// From now on another window is asked for a frame whenever there is news.
    pub(crate) fn wake(&self, wake: egui::Context) {
        self.0.borrow_mut().wake = wake;
    }

    /// Adds news from elsewhere.
    pub(crate) fn happened(&self, event: HostEvent) {
        let mut shared = self.0.borrow_mut();
        shared.events.push_back(event);
        shared.wake.request_repaint();
    }
}

impl Shared {
    fn hear(&mut self, core: u32, kind: &str, payload: &JsValue) {
        if core != self.link.core() {
            return;
        }
        self.link.tick(now_secs());
        let news = match kind {
            "ready" => {
                self.end = AskerEnd::of_core(core);
                News::Ready
            }
            "alive" => News::Alive,
            "textLost" => News::TextLost,
            "answer" => {
                let text = self.link.text_under_way().cloned().unwrap_or_default();
                match self.end.read(&Uint8Array::new(payload).to_vec(), text) {
                    Ok(response) => News::Answer(response),
                    Err(reason) => News::Failed(format!("couldn't read an answer of the core: {reason}")),
                }
            }
            "finished" => News::Finished,
            _ => News::Failed(payload.as_string().unwrap_or_else(|| kind.to_owned())),
        };
        self.link.hear(core, news);
        self.wake_when_due();
        self.wake.request_repaint();
    }

    /// Asks for a frame when the link has something to do by itself.
    fn wake_when_due(&self) {
        if let Some(due_secs) = self.link.due_secs() {
            let wait_secs = (due_secs - now_secs()).max(0.0);
            self.wake.request_repaint_after(Duration::from_secs_f64(wait_secs));
        }
    }
}

impl Transport for Workers {
    fn start(&mut self, core: u32) {
        let shared = self.shared.clone();
        let listener = Closure::new(move |kind: String, payload: JsValue| {
            if let Some(shared) = shared.upgrade() {
                shared.borrow_mut().hear(core, &kind, &payload);
            }
        });
        self.running = Some(Worker { core: self.glue.start_core(&listener), _listener: listener });
    }

    fn send(&mut self, job: &Job) -> Result<(), String> {
        let bytes = wire::write_request(&job.request)
            .map_err(|reason| format!("a request cannot be written: {reason}"))?;
        if let Some(running) = &self.running {
            running.core.send(Uint8Array::from(bytes.as_slice()));
        }
        Ok(())
    }

    fn interrupt(&mut self) {
        if let Some(running) = &self.running {
            running.core.supersede();
        }
    }

    /// The worker's listener may be the one that is being called, so it is let go of only afterwards.
    fn terminate(&mut self) {
        if let Some(ended) = self.running.take() {
            ended.core.stop();
            wasm_bindgen_futures::spawn_local(async move { drop(ended) });
        }
    }

    fn patience_secs(&self) -> f64 {
        self.running.as_ref().map_or(0.0, |running| running.core.patience_millis() / 1e3)
    }
}

#[wasm_bindgen]
extern "C" {
    /// Milliseconds since the page was opened.
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    fn performance_now() -> f64;
}

fn now_secs() -> f64 {
    performance_now() / 1e3
}
