//! Says that there is nothing to show, and why.

use egui::{RichText, Ui};
use text_editing::EditKind;
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::Status;

use crate::Context;

/// A quiet sentence in the middle of a panel.
pub fn show_empty(ui: &mut Ui, context: &Context<'_>, text: &str) {
    ui.centered_and_justified(|ui| {
        ui.label(RichText::new(text).color(context.tokens.text_muted));
    });
}

/// What is missing, where nothing is planned yet; `then` is what comes of it once it is there, as a main clause.
pub(crate) fn missing(context: &Context<'_>, then: &str) -> String {
    match context.state.status() {
        _ if context.state.snapshots.lacks_a_scenario() => {
            format!("This mission has no scenario yet. With one, {then}.")
        }
        Status::Broken => format!("The text has errors: see the problems. Without them, {then}."),
        Status::Empty => format!("There is nothing to plan in this text. With a scenario, {then}."),
        _ => "The mission is being read…".to_owned(),
    }
}

/// Says what is missing, with a button that writes a scenario where that is all.
pub(crate) fn show_missing(ui: &mut Ui, context: &Context<'_>, then: &str, commands: &mut CommandSender) {
    const SCENARIO: &str = "scenario Mission[0,60] = {\n  delay[1,5]\n}\n";
    let is_code = context.state.automaton.program().is_none();
    if !is_code || !context.state.snapshots.lacks_a_scenario() {
        show_empty(ui, context, &missing(context, then));
        return;
    }
    ui.vertical_centered(|ui| {
        ui.add_space((ui.available_height() * 0.3).max(space::L));
        ui.set_max_width(ui.available_width().min(380.0));
        ui.label(RichText::new(missing(context, then)).color(context.tokens.text_muted));
        ui.add_space(space::M);
        if ui.button("Add a scenario").clicked() {
            // At the end of the mission's first file.
            let document = &context.state.document;
            let end = document.file_range(0).end;
            let before = &document.text()[..end];
            let gap = if before.trim().is_empty() || before.ends_with("\n\n") {
                ""
            } else if before.ends_with('\n') {
                "\n"
            } else {
                "\n\n"
            };
            let span = rmpl::Span::new(end as u32, end as u32);
            let edit = rmpl::Edit { span, text: format!("{gap}{SCENARIO}") };
            commands.send(Command::Edit { edits: vec![edit], kind: EditKind::Single });
        }
    });
}
