//! Asks for a name: of the open mission, of a version of it, or of one of its files.

use egui::{Button, Key, TextEdit, Ui};
use theme::space;
use workbench::Dialog;
use workbench::command::{Command, CommandSender};
use workbench::library::LibraryCommand;
use workbench::state::files::FileCommand;
use workbench::state::window::WindowCommand;

/// What the name is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Named {
    Mission,
    Version,
    /// The file at the caret.
    File,
    NewFile,
}

/// Shows the question.
pub(super) fn show(ui: &mut Ui, named: Named, name: &str, commands: &mut CommandSender) {
    ui.set_width(320.0);
    let (question, label, done) = match named {
        Named::Mission => ("Rename mission", "Mission name", "Rename"),
        Named::Version => ("Save a version", "Version name", "Save"),
        Named::File => ("Rename file and update imports", "File name", "Rename"),
        Named::NewFile => ("Add file and import it", "File name", "Add"),
    };
    ui.label(question);
    let mut text = name.to_owned();
    let field = ui.add(TextEdit::singleline(&mut text).desired_width(f32::INFINITY)).accessible_name(label);
    super::select_all_at_first(ui, &field, text.chars().count());
    let mut is_asked = ui.input(|input| input.key_pressed(Key::Enter));
    if !is_asked {
        field.request_focus();
    }
    ui.add_space(space::S);
    ui.horizontal(|ui| {
        is_asked |= ui.add_enabled(!text.trim().is_empty(), Button::new(done)).clicked();
        if ui.button("Cancel").clicked() {
            commands.send(Command::Window(WindowCommand::CloseDialog));
        }
    });
    let dialog = |name: String| match named {
        Named::Mission => Dialog::MissionName { name },
        Named::Version => Dialog::VersionName { name },
        Named::File => Dialog::FileName { name, renames: true },
        Named::NewFile => Dialog::FileName { name, renames: false },
    };
    if is_asked && !text.trim().is_empty() {
        commands.send(Command::Window(WindowCommand::CloseDialog));
        commands.send(match named {
            Named::Mission => Command::Library(LibraryCommand::Rename { id: None, name: text }),
            Named::Version => Command::Library(LibraryCommand::KeepVersion(text)),
            Named::File => Command::Files(FileCommand::Rename(text)),
            Named::NewFile => Command::Files(FileCommand::Add(text)),
        });
    } else if text != name {
        commands.send(Command::Window(WindowCommand::ShowDialog(dialog(text))));
    }
}
