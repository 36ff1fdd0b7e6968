//! What a panel is: what it reads, and how it is shown.

use std::cell::{Cell, RefCell};
use std::sync::Arc;

use snapshot::Snapshot;
use theme::Tokens;
use workbench::ViewAction;
use workbench::command::CommandSender;
use workbench::state::AppState;
use workbench::state::search::Focus;
use workbench::{PanelEffect, PanelEffects, PanelKind};

/// What a panel reads.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The whole state of the app.
    pub state: &'a AppState,
    /// What is to be drawn: the latest snapshot with a network, which may belong to an older text.
    pub snapshot: Option<&'a Arc<Snapshot>>,
    /// Whether `snapshot` belongs to an older text than the editor's.
    pub is_stale: bool,
    pub tokens: &'static Tokens,
    /// For panels that draw with wgpu; `None` in tests without a graphics adapter.
    pub render_state: Option<&'a eframe::egui_wgpu::RenderState>,
    /// Seconds on the host's clock at the start of this frame.
    pub now_secs: f64,
    /// The host's clock itself, for measuring.
    pub clock: &'a dyn Fn() -> f64,
    /// What panels are to do, each once: a panel takes what is meant for it.
    pub effects: &'a RefCell<PanelEffects>,
    /// Where a panel that lays out its drawing again says how long that took.
    pub layout_millis: &'a Cell<Option<f64>>,
}

impl Context<'_> {
    /// The plan that is shown, if there is one, with its network: what the search had selected at the step that is
    /// looked at, if one is; with the windows that pinned events leave, if there are any.
    pub fn plan(&self) -> Option<(&tpn::Network, &tpn::Plan)> {
        let snapshot = self.snapshot?;
        let step = self.state.search.plan(snapshot).map(std::convert::AsRef::as_ref);
        let plan = step.or_else(|| self.state.pins.plan(snapshot)).or_else(|| snapshot.plan())?;
        Some((snapshot.network.as_deref()?, plan))
    }

    /// A text with what people read for calls instead of their identifiers.
    pub fn readable(&self, text: &str) -> String {
        let network = self.snapshot.and_then(|snapshot| snapshot.network.as_deref());
        network.map_or_else(|| text.to_owned(), |network| network.readable(text))
    }

    /// The step of the search that is looked at, if one is, with what the search knew there.
    pub fn step(&self) -> Option<&workbench::state::search::View> {
        self.state.search.plan(self.snapshot?)?;
        self.state.search.shown()
    }

    /// Returns what the step that is looked at is about.
    pub fn focus(&self) -> Option<Focus> {
        let view = self.step()?;
        Some(Focus::of(view.recording.network(), view.recording.trace(), &view.step))
    }

    /// The reason why there is no plan that is looked at, if there is none and the text is the one that failed.
    pub fn reason(&self) -> Option<&kirk::Reason> {
        let planning = self.snapshot.filter(|_| !self.is_stale)?.planning.as_ref()?;
        planning.outcome.failure.as_ref()?.reasons.get(self.state.reason)
    }

    /// Returns what `panel` is to do with its view, if anything; it is the panel's to do now.
    pub fn view_action(&self, panel: PanelKind) -> Option<ViewAction> {
        self.take_last(|effect| match effect {
            PanelEffect::View(of, action) if of == panel => Some(action),
            _ => None,
        })
    }

    /// Takes the effects that `wanted` makes something of; the last of them counts.
    pub fn take_last<T>(&self, wanted: impl FnMut(PanelEffect) -> Option<T>) -> Option<T> {
        self.effects.borrow_mut().take(wanted).pop()
    }
}

/// A part of the window that shows one aspect of the state.
///
/// Its own fields hold only what concerns no one else: scroll positions, caches, cameras. Everything it wants changed
/// goes through `commands`, which are applied before the next frame.
pub trait Panel {
    /// Shows the panel, filling `ui`.
    fn show(&mut self, ui: &mut egui::Ui, context: &Context<'_>, commands: &mut CommandSender);
}
