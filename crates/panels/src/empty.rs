//! Says that there is nothing to show, and why.

use egui::text::LayoutJob;
use egui::{Align, RichText, Role, Sense, TextStyle, Ui, WidgetInfo, vec2};
use text_editing::EditKind;
use theme::icon::{self, Icon};
use theme::space;
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::state::Status;
use workbench::state::drawing::{self, DrawCommand};

use crate::Context;

/// A muted sentence in the middle of a panel.
pub fn show_empty(ui: &mut Ui, context: &Context<'_>, text: &str) {
    ui.centered_and_justified(|ui| {
        // A label of its own accord would stretch its lines from edge to edge.
        let width = (ui.available_width() - 2.0 * space::L).max(1.0);
        let font = TextStyle::Body.resolve(ui.style());
        let mut job = LayoutJob::simple(text.to_owned(), font, context.tokens.text_muted, width);
        job.halign = Align::Center;
        let galley = ui.painter().layout_job(job);
        ui.label(galley);
    });
}

/// Marks the tab of a panel whose drawing is out of date. The mark is beside the tab, so that the drawing does not move.
/// While Enroute plans, which mostly takes a moment, there is no mark.
pub fn show_stale(ui: &mut Ui, context: &Context<'_>, panel: PanelKind) {
    let now = match context.state.status() {
        Status::Broken => "the current text has errors",
        Status::Empty => "the current text has nothing to plan",
        Status::Undecided => "planning was stopped",
        _ => return,
    };
    if !panel.is_marked_when_stale() || !context.is_stale || context.snapshot.is_none() {
        return;
    }
    let (rect, mark) = ui.allocate_exact_size(vec2(space::ROW, space::ROW), Sense::hover());
    let text = format!("Out of date: {now}");
    mark.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
    icon::paint(ui.painter(), Icon::Warning, rect, 14.0, context.tokens.warning);
    mark.on_hover_text(&text);
}

/// Returns what is missing, where nothing is planned yet; `then` is what comes of it once it is there, as a main
/// clause.
pub(crate) fn missing(context: &Context<'_>, then: &str) -> String {
    match context.state.status() {
        _ if context.state.snapshots.lacks_a_scenario() => {
            format!("This mission has no scenario yet. With one, {then}.")
        }
        Status::Broken => format!("The text has errors: see the Problems panel. Without them, {then}."),
        Status::Empty => format!("This text has no scenario. With one, {then}."),
        _ => "Loading the mission…".to_owned(),
    }
}

/// Says what is missing, with a button that writes a scenario where that is all.
pub(crate) fn show_missing(ui: &mut Ui, context: &Context<'_>, then: &str, commands: &mut CommandSender) {
    const SCENARIO: &str = "scenario Mission[0,60] = {\n  delay[1,5]\n}\n";
    let is_code = context.state.automaton.program().is_none();
    let is_begun = context.state.snapshots.lacks_a_scenario() || context.state.status() == Status::Empty;
    if !is_code || !is_begun {
        show_empty(ui, context, &missing(context, then));
        return;
    }
    ui.vertical_centered(|ui| {
        ui.add_space((ui.available_height() * 0.3).max(space::L));
        ui.set_max_width(ui.available_width().min(380.0));
        ui.label(RichText::new(missing(context, then)).color(context.tokens.text_muted));
        ui.add_space(space::M);
        if ui.button("Add activity").clicked() {
            commands.send(Command::Draw(DrawCommand::Add));
        }
        ui.add_space(space::S);
        if ui.button("Add scenario").clicked() {
            // At the end of the mission's first file.
            let document = &context.state.document;
            let end = document.file_range(0).end;
            let before = &document.text()[..end];
            let gap = drawing::gap(before);
            let span = rmpl::Span::new(end as u32, end as u32);
            let edit = rmpl::Edit { span, text: format!("{gap}{SCENARIO}") };
            commands.send(Command::Edit { edits: vec![edit], kind: EditKind::Single });
        }
    });
}
