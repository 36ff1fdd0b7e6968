//! The planning core in its web worker: sends requests one at a time, and starts the worker anew when it fails or
//! works too long on a text that was replaced.

use std::{
    cell::RefCell,
    collections::VecDeque,
    rc::{Rc, Weak},
};

use js_sys::Uint8Array;
use mission::Request;
use wasm_bindgen::prelude::*;
use workbench::{
    core_queue::{CoreQueue, revision},
    host::HostEvent,
};

use crate::glue::{CoreWorker, Glue};

/// The way to the core; clones lead to the same one.
#[derive(Clone)]
pub(crate) struct CoreLink(Rc<RefCell<Link>>);

struct Link {
    glue: Glue,
    wake: egui::Context,
    queue: CoreQueue,
    worker: Option<Worker>,
    events: VecDeque<HostEvent>,
    /// Counts the workers, so that what a stopped one still said is not taken for the word of its successor.
    workers_started: u32,
    myself: Weak<RefCell<Link>>,
}

/// A running worker with what listens to it.
struct Worker {
    core: CoreWorker,
    is_ready: bool,
    _listener: Closure<dyn FnMut(String, JsValue)>,
}

impl CoreLink {
    /// Starts a core; `wake` is asked for a frame whenever there is news.
    pub(crate) fn start(glue: Glue, wake: egui::Context) -> Self {
        let link = Rc::new_cyclic(|myself| {
            RefCell::new(Link {
                glue,
                wake,
                queue: CoreQueue::default(),
                worker: None,
                events: VecDeque::new(),
                workers_started: 0,
                myself: myself.clone(),
            })
        });
        link.borrow_mut().start_worker();
        Self(link)
    }

    /// Asks the core.
    pub(crate) fn post(&self, request: Request) {
        let mut link = self.0.borrow_mut();
        link.queue.post(request);
        link.push_on();
    }

    /// Takes the oldest news.
    pub(crate) fn poll(&self) -> Option<HostEvent> {
        self.0.borrow_mut().events.pop_front()
    }

    /// Adds news from elsewhere.
    pub(crate) fn happened(&self, event: HostEvent) {
        let mut link = self.0.borrow_mut();
        link.events.push_back(event);
        link.wake.request_repaint();
    }
}

impl Link {
    fn start_worker(&mut self) {
        self.workers_started += 1;
        let number = self.workers_started;
        let link = self.myself.clone();
        let listener = Closure::new(move |kind: String, payload: JsValue| {
            if let Some(link) = link.upgrade() {
                link.borrow_mut().hear(number, &kind, &payload);
            }
        });
        self.worker =
            Some(Worker { core: self.glue.start_core(&listener), is_ready: false, _listener: listener });
    }

    /// Ends the worker. Its listener may be the one that is being called, so it is let go of only afterwards.
    fn stop_worker(&mut self) {
        if let Some(stopped) = self.worker.take() {
            stopped.core.stop();
            wasm_bindgen_futures::spawn_local(async move { drop(stopped) });
        }
    }

    /// Sends what can be sent, and tells the core if it works in vain.
    fn push_on(&mut self) {
        if self.worker.is_none() {
            self.start_worker();
        }
        let Some(worker) = &self.worker else { return };
        if let Some(request) = self.queue.start_next() {
            match postcard::to_allocvec(request) {
                Ok(bytes) => worker.core.send(Uint8Array::from(bytes.as_slice())),
                Err(reason) => self.give_up(&format!("a request cannot be written: {reason}")),
            }
        } else if self.queue.is_superseded() {
            worker.core.supersede();
        }
    }

    fn hear(&mut self, number: u32, kind: &str, payload: &JsValue) {
        if number != self.workers_started {
            return;
        }
        match kind {
            "ready" => {
                if let Some(worker) = &mut self.worker {
                    worker.is_ready = true;
                }
            }
            "answer" => match postcard::from_bytes(&Uint8Array::new(payload).to_vec()) {
                Ok(response) => self.events.push_back(HostEvent::Answer(response)),
                Err(reason) => self.give_up(&format!("an answer cannot be read: {reason}")),
            },
            "finished" => {
                self.queue.finished();
                self.push_on();
            }
            "overdue" => {
                if self.queue.is_superseded() {
                    self.stop_worker();
                    self.queue.restarted();
                    self.push_on();
                }
            }
            _ => self.give_up(&payload.as_string().unwrap_or_else(|| kind.to_owned())),
        }
        self.wake.request_repaint();
    }

    /// The core is not to be trusted any more. A new one takes over, unless this one never came up: then the next
    /// request tries again.
    fn give_up(&mut self, message: &str) {
        let was_ready = self.worker.as_ref().is_some_and(|worker| worker.is_ready);
        self.stop_worker();
        let given_up = self.queue.restarted();
        self.events.push_back(HostEvent::CoreFailed {
            revision: given_up.as_ref().and_then(revision),
            message: message.to_owned(),
        });
        if was_ready {
            self.push_on();
        }
    }
}
