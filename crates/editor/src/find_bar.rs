//! The find bar above the text.

use egui::{Button, Frame, Key, Margin, RichText, TextEdit, Ui};
use text_editing::Find;
use theme::icon::{self, Icon};
use theme::space;

use crate::{EditorAction, EditorView};

/// Shows the find bar; what changes in it is told as a whole.
pub(crate) fn show(ui: &mut Ui, view: &EditorView<'_>, find: &Find, actions: &mut Vec<EditorAction>) {
    let tokens = view.tokens;
    let mut changed = find.clone();
    changed.wants_focus = false;
    Frame::new().fill(tokens.raised).inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        ui.horizontal(|ui| {
            let sign = if find.replacing { Icon::ChevronDown } else { Icon::ChevronRight };
            let toggle = icon::button(ui, tokens, sign, "Replace row");
            changed.replacing ^= toggle.clicked();
            query_field(ui, find, &mut changed, actions);
            toggle_button(ui, "Aa", "Match case", &mut changed.case_sensitive);
            toggle_button(ui, "ab", "Whole words", &mut changed.whole_words);
            toggle_button(ui, ".*", "Regular expression", &mut changed.is_regex);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                button(ui, view, Icon::Close, "Close find bar", EditorAction::CloseFind, actions);
                button(ui, view, Icon::Down, "Next match", EditorAction::FindNext, actions);
                button(ui, view, Icon::Up, "Previous match", EditorAction::FindPrevious, actions);
                // The words have what room is left, and never that of a button.
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let words = RichText::new(outcome(view, find)).small().color(tokens.text_muted);
                    ui.add(egui::Label::new(words).truncate());
                });
            });
        });
        if find.replacing {
            ui.horizontal(|ui| {
                ui.add_space(26.0);
                let field = TextEdit::singleline(&mut changed.replacement)
                    .hint_text("Replace by")
                    .desired_width(200.0);
                ui.add(field).accessible_name("Replace by");
                if ui.button("Replace").clicked() {
                    actions.push(EditorAction::ReplaceOne);
                }
                if ui.button("Replace all").clicked() {
                    actions.push(EditorAction::ReplaceAll);
                }
            });
        }
    });
    ui.add_space(-space::XS);
    if changed != *find {
        actions.push(EditorAction::SetFind(changed));
    }
}

fn query_field(ui: &mut Ui, find: &Find, changed: &mut Find, actions: &mut Vec<EditorAction>) {
    let field = TextEdit::singleline(&mut changed.query).hint_text("Find").desired_width(200.0);
    let field = ui.add(field).accessible_name("Find");
    if find.wants_focus {
        field.request_focus();
    }
    let (enter, shift) = ui.input(|input| (input.key_pressed(Key::Enter), input.modifiers.shift));
    if field.lost_focus() && enter {
        let step = if shift { EditorAction::FindPrevious } else { EditorAction::FindNext };
        actions.push(step);
        field.request_focus();
    }
}

fn toggle_button(ui: &mut Ui, sign: &str, name: &str, value: &mut bool) {
    let text = RichText::new(sign).monospace().small();
    let button = ui.add(Button::selectable(*value, text)).on_hover_text(name).accessible_name(name);
    *value ^= button.clicked();
}

fn button(
    ui: &mut Ui,
    view: &EditorView<'_>,
    sign: Icon,
    name: &str,
    action: EditorAction,
    actions: &mut Vec<EditorAction>,
) {
    if icon::button(ui, view.tokens, sign, name).clicked() {
        actions.push(action);
    }
}

/// "2 of 7", or what is wrong with the pattern.
fn outcome(view: &EditorView<'_>, find: &Find) -> String {
    let pattern = match find.pattern() {
        Ok(pattern) => pattern,
        Err(reason) => return reason,
    };
    let document = view.document;
    let caret = document.caret().range();
    let mut count = 0;
    let mut current = 0;
    for found in pattern.matches(document.text()) {
        count += 1;
        if found == caret {
            current = count;
        }
    }
    match (count, current) {
        (0, _) => "No matches".to_owned(),
        (1, 0) => "1 match".to_owned(),
        (_, 0) => format!("{count} matches"),
        _ => format!("{current} of {count}"),
    }
}
