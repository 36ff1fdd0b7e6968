//! Asks for a line of the text.

use egui::{Key, RichText, TextEdit, Ui};
use panels::Context;
use workbench::Dialog;
use workbench::command::{Command, CommandSender};
use workbench::state::editor::EditorCommand;
use workbench::state::window::WindowCommand;

/// Shows the question.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, line: &str, commands: &mut CommandSender) {
    ui.set_width(260.0);
    let document = &context.state.document;
    let file = document.file_lines(document.line_at(document.caret().head));
    let lines = file.len();
    let mut text = line.to_owned();
    let field = TextEdit::singleline(&mut text)
        .hint_text(format!("Line number (1 to {lines})"))
        .desired_width(f32::INFINITY);
    let field = ui.add(field).accessible_name("Line number");
    let enter = ui.input(|input| input.key_pressed(Key::Enter));
    if !enter {
        field.request_focus();
    }
    let wanted = text.trim().parse::<usize>().ok().filter(|line| (1..=lines).contains(line));
    if !text.is_empty() && wanted.is_none() {
        let note = format!("Enter a line number from 1 to {lines}");
        ui.label(RichText::new(note).color(context.tokens.error));
    }
    match wanted.filter(|_| enter) {
        Some(line) => {
            commands.send(Command::Window(WindowCommand::CloseDialog));
            commands.send(Command::Editor(EditorCommand::GoToLine(file.start + line)));
        }
        None => commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::GoToLine { line: text }))),
    }
}
