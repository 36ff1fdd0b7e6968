//! The menu that a right click in the text opens.

use egui::accesskit::Role;
use egui::{Button, Response};

use crate::{EditorAction, EditorView};

/// Shows the menu while it is open.
pub(crate) fn show(view: &EditorView<'_>, response: &Response, actions: &mut Vec<EditorAction>) {
    response.context_menu(|ui| {
        ui.set_min_width(200.0);
        theme::structure::part(ui, Role::Menu, "Mission text");
        let mut index = 0;
        for (group, entries) in view.menu.iter().enumerate() {
            if group > 0 {
                ui.separator();
            }
            for entry in *entries {
                let button = Button::new(entry.label).shortcut_text(entry.keys);
                let mut item = ui.add_enabled(entry.unavailable.is_none(), button);
                theme::structure::role(&item, Role::MenuItem);
                if let Some(reason) = entry.unavailable {
                    item = item.on_disabled_hover_text(reason);
                }
                if item.clicked() {
                    actions.push(EditorAction::Menu(index));
                    ui.close();
                }
                index += 1;
            }
        }
    });
}
