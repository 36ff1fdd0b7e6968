//! The files of a mission of several, above its text: which one the caret is in, and the way to the others.

use egui::Ui;
use rmpl::Span;
use theme::space;
use workbench::Dialog;
use workbench::command::{Command, CommandSender};
use workbench::state::editor::EditorCommand;
use workbench::state::window::WindowCommand;

use crate::Context;

pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let state = context.state;
    let document = &state.document;
    let here = state.file_at_caret();
    ui.horizontal_wrapped(|ui| {
        ui.add_space(space::S);
        for (index, name) in state.file_names().iter().enumerate() {
            let chosen = theme::structure::choice(ui, index == here, name.as_str());
            if chosen.on_hover_text("Go to this file in the text below").clicked() {
                let heading = index.checked_sub(1).and_then(|own| document.headings().get(own));
                let start = heading.map_or(0, |heading| document.line_range(heading + 1).start) as u32;
                commands.send(Command::Reveal(Span::new(start, start)));
                commands.send(Command::Editor(EditorCommand::Focus));
            }
        }
        let add = ui.button("+").on_hover_text("Add a file to the mission");
        if add.accessible_name("Add file").clicked() {
            commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::FileName {
                name: String::new(),
                renames: false,
            })));
        }
    });
    ui.separator();
}
