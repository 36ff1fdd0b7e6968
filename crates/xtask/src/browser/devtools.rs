//! The `DevTools` protocol: calls with answers, and events, as JSON over a web socket.
//!
//! Synchronous on purpose: a test does one thing after the other. The protocol is described at
//! <https://chromedevtools.github.io/devtools-protocol/>. The crates `chromiumoxide` and `headless_chrome` would replace this
//! file alone, speak to no Firefox, and generate and compile types of the whole protocol.

use std::{
    collections::VecDeque,
    net::TcpStream,
    time::{Duration, Instant},
};

use anyhow::{Context as _, Result, anyhow, bail};
use serde_json::{Value, json};
use tungstenite::{Message, WebSocket};

/// How long a call may take; software rendering and compiling a page's wasm on a busy machine are slow.
const CALL_LIMIT: Duration = Duration::from_mins(3);

/// A connection to a browser.
pub(super) struct Connection {
    socket: WebSocket<TcpStream>,
    last_id: u64,
    events: VecDeque<Event>,
}

/// Something that the browser told without being asked.
pub(super) struct Event {
    /// The tab it belongs to.
    pub(super) session: Option<String>,
    /// Its name, such as `Runtime.exceptionThrown`.
    pub(super) method: String,
    pub(super) params: Value,
}

impl Connection {
    /// Connects to `ws://host:port/path`.
    pub(super) fn open(address: &str) -> Result<Self> {
        let host = address
            .strip_prefix("ws://")
            .and_then(|rest| rest.split('/').next())
            .with_context(|| format!("not a web socket's address: {address}"))?;
        let stream = TcpStream::connect(host).with_context(|| format!("connecting to {host}"))?;
        stream.set_read_timeout(Some(CALL_LIMIT))?;
        stream.set_nodelay(true)?;
        let (socket, _) = tungstenite::client(address, stream)
            .map_err(|reason| anyhow!("connecting to {address}: {reason}"))?;
        Ok(Self { socket, last_id: 0, events: VecDeque::new() })
    }

    /// Calls a method and waits for its answer; `session` is the tab it is meant for.
    pub(super) fn call(&mut self, session: Option<&str>, method: &str, params: &Value) -> Result<Value> {
        self.last_id += 1;
        let id = self.last_id;
        let mut message = json!({ "id": id, "method": method, "params": params });
        if let Some(session) = session {
            message["sessionId"] = session.into();
        }
        self.socket.send(Message::text(message.to_string()))?;
        let end = Instant::now() + CALL_LIMIT;
        while Instant::now() < end {
            let mut received = self.receive().with_context(|| format!("waiting for {method}"))?;
            if received["id"] == id {
                if let Some(reason) = received.get("error") {
                    bail!(
                        "{method}: {}",
                        reason["message"].as_str().or(received["message"].as_str()).unwrap_or("refused")
                    );
                }
                return Ok(received["result"].take());
            }
            self.note_event(received);
        }
        bail!("{method} was not answered within {} s", CALL_LIMIT.as_secs());
    }

    /// The next event, of any tab; waits for one.
    pub(super) fn next_event(&mut self) -> Result<Event> {
        loop {
            if let Some(event) = self.take_event() {
                return Ok(event);
            }
            let received = self.receive()?;
            self.note_event(received);
        }
    }

    /// The first of the events that arrived so far.
    pub(super) fn take_event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    /// Takes the events of a tab that arrived so far.
    pub(super) fn take_events(&mut self, session: &str) -> Vec<Event> {
        let (taken, kept) = self
            .events
            .drain(..)
            .partition::<Vec<Event>, _>(|event| event.session.as_deref() == Some(session));
        self.events = kept.into();
        taken
    }

    fn note_event(&mut self, mut received: Value) {
        if let Some(method) = received["method"].as_str() {
            self.events.push_back(Event {
                session: received["sessionId"].as_str().map(str::to_owned),
                method: method.to_owned(),
                params: received["params"].take(),
            });
        }
    }

    fn receive(&mut self) -> Result<Value> {
        loop {
            let message = self.socket.read().context("the browser has ended or does not answer")?;
            if let Message::Text(text) = message {
                return serde_json::from_str(&text).context("the browser sent no JSON");
            }
        }
    }
}
