//! The find bar above the text.

use egui::{Button, Frame, Key, Margin, RichText, TextEdit, Ui};
use text_editing::Find;
use theme::icon::{self, Icon};
use theme::space;

use crate::{EditorAction, EditorView};

/// A bar at least so wide has its words beside its buttons, a narrower one below them.
const ROOM_FOR_WORDS: f32 = 520.0;
/// The room of the words beside the buttons.
const WORDS_WIDTH: f32 = 100.0;
/// How wide a field is at least and at most.
const MIN_FIELD: f32 = 72.0;
const MAX_FIELD: f32 = 320.0;
/// What is beside a field takes about so much, until that is known.
const REST_WIDTH: f32 = 260.0;

/// Shows the find bar; what changes in it is told as a whole.
pub(crate) fn show(ui: &mut Ui, view: &EditorView<'_>, find: &Find, actions: &mut Vec<EditorAction>) {
    let tokens = view.tokens;
    let mut changed = find.clone();
    changed.wants_focus = false;
    Frame::new().fill(tokens.raised).inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        let is_wide = ui.available_width() >= ROOM_FOR_WORDS;
        filled_row(ui, "query", |ui, room| {
            let sign = if find.replacing { Icon::ChevronDown } else { Icon::ChevronRight };
            let toggle = icon::button(ui, tokens, sign, "Toggle replace");
            changed.replacing ^= toggle.clicked();
            query_field(ui, find, room, &mut changed, actions);
            toggle_button(ui, "Aa", "Match case", &mut changed.case_sensitive);
            toggle_button(ui, "ab", "Match whole word", &mut changed.whole_words);
            toggle_button(ui, ".*", "Use regular expression", &mut changed.is_regex);
            if is_wide {
                show_outcome(ui, view, find, WORDS_WIDTH);
            }
            button(ui, view, Icon::Up, "Previous match", EditorAction::FindPrevious, actions);
            button(ui, view, Icon::Down, "Next match", EditorAction::FindNext, actions);
            button(ui, view, Icon::Close, "Close find bar", EditorAction::CloseFind, actions);
        });
        if find.replacing {
            filled_row(ui, "replacement", |ui, room| {
                ui.add_space(space::ROW + ui.spacing().item_spacing.x);
                let field = TextEdit::singleline(&mut changed.replacement).hint_text("Replace with");
                ui.add(field.desired_width(room)).accessible_name("Replace with");
                if ui.button("Replace").clicked() {
                    actions.push(EditorAction::ReplaceOne);
                }
                if ui.button("Replace all").clicked() {
                    actions.push(EditorAction::ReplaceAll);
                }
            });
        }
        if !is_wide && !find.query.is_empty() {
            ui.horizontal(|ui| {
                ui.add_space(space::ROW + ui.spacing().item_spacing.x);
                show_outcome(ui, view, find, ui.available_width());
            });
        }
    });
    ui.add_space(-space::XS);
    if changed != *find {
        actions.push(EditorAction::SetFind(changed));
    }
}

/// A row with one field, which has the room that the rest of the row leaves it: as much as was left in the frame before.
/// Where even that is too little, the row is broken.
fn filled_row(ui: &mut Ui, name: &str, show: impl FnOnce(&mut Ui, f32)) {
    let id = ui.scope_id().with(name);
    let available = ui.available_width();
    let taken: f32 = ui.data(|data| data.get_temp(id)).unwrap_or(REST_WIDTH);
    let room = (available - taken).clamp(MIN_FIELD, MAX_FIELD);
    let row = ui.horizontal_wrapped(|ui| show(ui, room)).response.rect;
    // A row that was broken is as wide as it could be.
    let is_broken = row.height() > 2.0 * space::ROW;
    let rest = if is_broken { taken } else { row.width() - room };
    if (rest - taken).abs() > 0.5 {
        ui.data_mut(|data| data.insert_temp(id, rest));
        ui.ctx().request_repaint();
    }
}

fn show_outcome(ui: &mut Ui, view: &EditorView<'_>, find: &Find, width: f32) {
    let words = RichText::new(outcome(view, find)).small().color(view.tokens.text_muted);
    let size = egui::vec2(width, space::ROW);
    ui.allocate_ui_with_layout(size, egui::Layout::left_to_right(egui::Align::Center), |ui| {
        ui.set_width(width);
        ui.add(egui::Label::new(words).truncate());
    });
}

fn query_field(ui: &mut Ui, find: &Find, room: f32, changed: &mut Find, actions: &mut Vec<EditorAction>) {
    let field = TextEdit::singleline(&mut changed.query).hint_text("Find").desired_width(room);
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
        (0, _) => "No results".to_owned(),
        (1, 0) => "1 match".to_owned(),
        (_, 0) => format!("{count} matches"),
        _ => format!("{current} of {count}"),
    }
}
