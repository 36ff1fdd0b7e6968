//! What parts of the window are, for assistive technology: landmarks, headings, tables, menus. Nothing of it is seen.

use egui::accesskit::{self, AriaCurrent, Role, SortDirection};
use egui::{Rect, Response, RichText, Ui, WidgetInfo};

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

/// Names a button that selects something, such as a row of a list or a bar of a drawing, and says whether that is selected
/// now. It does not stay pressed as a toggle button does.
pub fn item(response: &Response, is_current: bool, name: &str) {
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    mark_current(response, is_current);
}

/// Says of a button that selects something whether that is selected now.
pub fn mark_current(response: &Response, is_current: bool) {
    response.ctx.accesskit_node_builder(response.id, |node| {
        node.clear_toggled();
        if is_current {
            node.set_aria_current(AriaCurrent::True);
        } else {
            node.clear_aria_current();
        }
    });
}

/// Names the heading of a section that folds, and says whether its content is shown.
pub fn folding(response: &Response, is_open: bool, name: &str) {
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response.ctx.accesskit_node_builder(response.id, |node| node.set_expanded(is_open));
}

/// Names a button that sorts a table by a column, and says whether and how the table is sorted by it.
pub fn sorting(response: &Response, descending: Option<bool>, name: &str) {
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    response.ctx.accesskit_node_builder(response.id, |node| match descending {
        Some(true) => node.set_sort_direction(SortDirection::Descending),
        Some(false) => node.set_sort_direction(SortDirection::Ascending),
        None => node.clear_sort_direction(),
    });
}

/// A button among several, one of which is chosen.
pub fn choice<'a>(ui: &mut Ui, is_chosen: bool, text: impl egui::IntoAtoms<'a>) -> Response {
    let response = ui.selectable_label(is_chosen, text);
    mark_current(&response, is_chosen);
    response
}

/// An option of the list that a box opens; [`options`] names the list.
pub fn option<'a>(ui: &mut Ui, is_chosen: bool, text: impl egui::IntoAtoms<'a>) -> Response {
    let response = ui.selectable_label(is_chosen, text);
    role(&response, Role::ListBoxOption);
    response
}

/// An option that sets a value when it is chosen.
pub fn option_value<'a, T: PartialEq>(
    ui: &mut Ui,
    value: &mut T,
    of_option: T,
    text: impl egui::IntoAtoms<'a>,
) -> Response {
    let response = ui.selectable_value(value, of_option, text);
    role(&response, Role::ListBoxOption);
    response
}

/// Says that `ui` holds the options of a list.
pub fn options(ui: &Ui, name: &str) {
    part(ui, Role::ListBox, name);
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
