//! Short messages that go away by themselves.

/// A short message that appears for a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Toast {
    /// What it is about.
    pub kind: ToastKind,
    pub text: String,
    /// When it goes away, in seconds on the host's clock; set when it is first shown.
    pub until_secs: Option<f64>,
}

/// What a message is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToastKind {
    /// Something was done.
    Done,
    /// Worth knowing.
    Info,
    /// Something could not be done.
    Failed,
}

/// The messages on screen, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Toasts {
    shown: Vec<Toast>,
}

const SHOWN_SECS: f64 = 5.0;
const MAX_SHOWN: usize = 4;

impl Toasts {
    /// Shows a message; the same message again only stays longer.
    pub fn add(&mut self, kind: ToastKind, text: impl Into<String>) {
        let text = text.into();
        self.shown.retain(|toast| toast.text != text);
        self.shown.push(Toast { kind, text, until_secs: None });
        if self.shown.len() > MAX_SHOWN {
            self.shown.remove(0);
        }
    }

    /// Drops the messages whose time is over, and starts the time of new ones. Answers the seconds until the next
    /// goes.
    pub fn advance(&mut self, now_secs: f64) -> Option<f64> {
        for toast in &mut self.shown {
            toast.until_secs.get_or_insert(now_secs + SHOWN_SECS);
        }
        let left = |toast: &Toast| toast.until_secs.map_or(SHOWN_SECS, |until| until - now_secs);
        self.shown.retain(|toast| left(toast) > 0.0);
        self.shown.iter().map(left).reduce(f64::min)
    }

    /// Drops one message.
    pub fn dismiss(&mut self, index: usize) {
        if index < self.shown.len() {
            self.shown.remove(index);
        }
    }

    /// The messages, oldest first.
    pub fn shown(&self) -> &[Toast] {
        &self.shown
    }
}
