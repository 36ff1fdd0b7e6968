//! The bars above and below the panels, and the titles of tabs.

mod badge;
pub mod bottom;
mod mission;
pub mod tab;
pub mod top;

use egui::RichText;
use panels::Context;
use rmpl::Severity;
use workbench::PanelKind;

/// The title of a panel's tab, with what the user should know while the panel is hidden.
pub fn tab_title(context: &Context<'_>, panel: PanelKind) -> RichText {
    let title = panel.title();
    let text = match panel {
        PanelKind::Problems => {
            let problems = context.state.snapshots.problems();
            let count = problems.iter().filter(|it| it.severity != Severity::Note).count();
            if count == 0 { title.to_owned() } else { format!("{title} {count}") }
        }
        PanelKind::Editor if context.state.document.is_modified() => format!("{title} •"),
        _ => title.to_owned(),
    };
    RichText::new(text)
}
