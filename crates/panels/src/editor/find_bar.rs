//! The find bar above the text.

use egui::{Button, Frame, Key, Margin, RichText, TextEdit, Ui};
use theme::icon::{self, Icon};
use theme::space;
use workbench::command::{Command, CommandSender, EditorCommand};
use workbench::state::editor::Find;

use crate::Context;

/// Shows the find bar; what changes in it is sent as a whole.
pub(crate) fn show(ui: &mut Ui, context: &Context<'_>, find: &Find, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let mut changed = find.clone();
    changed.wants_focus = false;
    Frame::new().fill(tokens.raised).inner_margin(Margin::symmetric(8, 6)).show(ui, |ui| {
        ui.horizontal(|ui| {
            let sign = if find.replacing { Icon::ChevronDown } else { Icon::ChevronRight };
            let toggle = icon::button(ui, tokens, sign, "Replace row");
            changed.replacing ^= toggle.clicked();
            query_field(ui, find, &mut changed, commands);
            toggle_button(ui, "Aa", "Match case", &mut changed.case_sensitive);
            toggle_button(ui, "ab", "Whole words", &mut changed.whole_words);
            toggle_button(ui, ".*", "Regular expression", &mut changed.is_regex);
            ui.label(RichText::new(outcome(context, find)).small().color(tokens.text_muted));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                button(ui, context, Icon::Close, "Close find bar", EditorCommand::CloseFind, commands);
                button(ui, context, Icon::Down, "Next match", EditorCommand::FindNext, commands);
                button(ui, context, Icon::Up, "Previous match", EditorCommand::FindPrevious, commands);
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
                    commands.send(Command::Editor(EditorCommand::ReplaceOne));
                }
                if ui.button("Replace all").clicked() {
                    commands.send(Command::Editor(EditorCommand::ReplaceAll));
                }
            });
        }
    });
    ui.add_space(-space::XS);
    if changed != *find {
        commands.send(Command::Editor(EditorCommand::SetFind(changed)));
    }
}

fn query_field(ui: &mut Ui, find: &Find, changed: &mut Find, commands: &mut CommandSender) {
    let field = TextEdit::singleline(&mut changed.query).hint_text("Find").desired_width(200.0);
    let field = ui.add(field).accessible_name("Find");
    if find.wants_focus {
        field.request_focus();
    }
    let (enter, shift) = ui.input(|input| (input.key_pressed(Key::Enter), input.modifiers.shift));
    if field.lost_focus() && enter {
        let step = if shift { EditorCommand::FindPrevious } else { EditorCommand::FindNext };
        commands.send(Command::Editor(step));
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
    context: &Context<'_>,
    sign: Icon,
    name: &str,
    command: EditorCommand,
    commands: &mut CommandSender,
) {
    if icon::button(ui, context.tokens, sign, name).clicked() {
        commands.send(Command::Editor(command));
    }
}

/// "2 of 7", or what is wrong with the pattern.
fn outcome(context: &Context<'_>, find: &Find) -> String {
    let pattern = match find.pattern() {
        Ok(pattern) => pattern,
        Err(reason) => return reason,
    };
    let document = &context.state.document;
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
