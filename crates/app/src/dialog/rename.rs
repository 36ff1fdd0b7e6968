//! Asks for a new name of the name at the caret.

use egui::{Key, RichText, TextEdit, Ui};
use panels::Context;
use workbench::Dialog;
use workbench::command::{Command, CommandSender};
use workbench::state::editor::EditorCommand;
use workbench::state::window::WindowCommand;

/// Shows the question.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, old: &str, name: &str, commands: &mut CommandSender) {
    ui.set_width(300.0);
    ui.label(format!("Rename all occurrences of {old}"));
    let mut text = name.to_owned();
    let field =
        ui.add(TextEdit::singleline(&mut text).desired_width(f32::INFINITY)).accessible_name("New name");
    super::select_all_at_first(ui, &field, text.chars().count());
    let enter = ui.input(|input| input.key_pressed(Key::Enter));
    if !enter {
        field.request_focus();
    }
    let state = context.state;
    let place = state.document.caret().range().start as u32;
    let refusal = state.language.parse().and_then(|parse| rmpl::editor::rename(parse, place, &text).err());
    if let Some(refusal) = refusal.as_ref().filter(|_| text != old) {
        ui.label(RichText::new(refusal.to_string()).color(context.tokens.error));
    }
    if enter && refusal.is_none() {
        commands.send(Command::Window(WindowCommand::CloseDialog));
        commands.send(Command::Editor(EditorCommand::RenameTo(text)));
    } else {
        commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::Rename {
            old: old.to_owned(),
            name: text,
        })));
    }
}
