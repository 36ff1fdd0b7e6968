//! What parts of the window are, for assistive technology: landmarks, headings, tables, menus. Nothing of it is seen.

use egui::accesskit::{self, Role};
use egui::{Rect, Response, RichText, Ui};

/// Says that a part of the window that fills `ui` has a role, such as [`Role::Main`] or [`Role::Region`], and a name.
pub fn part(ui: &Ui, role: Role, name: &str) {
    part_in(ui, ui.max_rect(), role, name);
}

/// The same for a part that fills a rectangle, in points.
pub fn part_in(ui: &Ui, rect: Rect, role: Role, name: &str) {
    ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
        node.set_role(role);
        node.set_bounds(accesskit::Rect {
            x0: rect.min.x.into(),
            y0: rect.min.y.into(),
            x1: rect.max.x.into(),
            y1: rect.max.y.into(),
        });
        if !name.is_empty() {
            node.set_label(name);
        }
    });
}

/// Says that a widget has another role than its kind has.
pub fn role(response: &Response, role: Role) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_role(role));
}

/// A label that is the heading of what follows; level 1 is the window's, 2 that of a panel or dialog.
pub fn heading(ui: &mut Ui, text: impl Into<RichText>, level: usize) -> Response {
    let response = ui.label(text.into());
    mark_heading(&response, level);
    response
}

/// Says that a text is the heading of what follows.
pub fn mark_heading(response: &Response, level: usize) {
    response.ctx.accesskit_node_builder(response.id, |node| {
        node.set_role(Role::Heading);
        node.set_level(level);
    });
}
