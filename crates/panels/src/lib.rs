//! The panels: each shows one aspect of the workbench's state and sends commands; none changes anything else.

mod automaton;
mod carry;
mod compare;
mod distances;
mod draw_menu;
mod empty;
mod execution;
mod inline_code;
pub mod keyboard_navigation;
mod lesson;
mod manual;
mod mission_text;
mod network;
mod one_line;
mod outline;
mod painter;
mod panel;
mod plan;
mod problems;
mod registry;
mod review;
mod robustness;
mod search;
mod strategy;
mod terrain;
mod timeline;

pub use empty::{show_empty, show_stale};
pub use exact::counted;
pub use inline_code::without_backticks;
pub use mission_text::{editor_id, typed_ahead, typed_text};
pub use panel::{Context, Panel};
pub use registry::Panels;

/// The tokens of the theme that is shown.
pub fn tokens(state: &workbench::state::AppState) -> &'static theme::Tokens {
    if state.is_dark() { &theme::DARK } else { &theme::LIGHT }
}

/// Returns whether the pointer went down here, though it may be up again: where frames are slow, one frame sees both.
pub(crate) fn is_pressed(response: &egui::Response) -> bool {
    response.is_pointer_button_down_on() || response.clicked()
}

/// The widget id of a panel as a whole: who has the keyboard while someone has turned to it and to nothing in it.
pub fn region_id(panel: workbench::PanelKind) -> egui::Id {
    egui::Id::unique(("panel", panel.name()))
}

/// Notes whether a drawing has the keyboard. A drawing does not use Space itself, so that Space plays there as elsewhere.
pub(crate) fn note_drawing(response: &egui::Response) {
    if response.has_focus() {
        response.ctx.data_mut(|data| data.insert_temp(focused_drawing(), response.id));
    }
}

/// Returns whether a drawing has the keyboard.
pub fn is_drawing_focused(context: &egui::Context) -> bool {
    let focused = context.memory(egui::Memory::focused);
    focused.is_some() && focused == context.data(|data| data.get_temp(focused_drawing()))
}

fn focused_drawing() -> egui::Id {
    egui::Id::unique("the drawing that has the keyboard")
}

/// Returns whether a panel as a whole has the keyboard.
pub fn is_region_focused(context: &egui::Context) -> bool {
    let focused = context.memory(egui::Memory::focused);
    focused.is_some_and(|id| workbench::PanelKind::ALL.iter().any(|&panel| region_id(panel) == id))
}
