//! Asks when the mission starts, for schedules with dates.

use egui::{Button, Key, RichText, TextEdit, Ui};
use panels::Context;
use report::calendar::Calendar;
use rmpl::program::TimeUnit;
use theme::space;
use workbench::Dialog;
use workbench::command::{Command, CommandSender};
use workbench::state::documents::ScheduleForm;
use workbench::state::window::WindowCommand;

/// Shows the question.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    form: ScheduleForm,
    epoch: &str,
    commands: &mut CommandSender,
) {
    ui.set_width(340.0);
    theme::structure::mark_heading(&ui.heading(form.title()), 2);
    ui.label("Mission start (date and time, UTC)");
    let mut text = epoch.to_owned();
    let field =
        TextEdit::singleline(&mut text).hint_text("2004-01-25T05:05:00Z").desired_width(f32::INFINITY);
    let field = ui.add(field).accessible_name("Mission start (date and time, UTC)");
    let enter = ui.input(|input| input.key_pressed(Key::Enter));
    if !enter {
        field.request_focus();
    }
    let is_left_out = text.trim().is_empty() && !form.needs_epoch();
    let is_date = is_left_out || Calendar::new(text.trim(), TimeUnit::Second).is_some();
    let (note, color) = if is_left_out {
        ("Leave empty to export times relative to mission start.", context.tokens.text_muted)
    } else if is_date || text.is_empty() {
        ("Enter a date, or a date and time (UTC unless you give an offset).", context.tokens.text_muted)
    } else {
        ("Invalid date. Enter a date such as 2004-01-25 or 2004-01-25T05:05:00Z.", context.tokens.error)
    };
    ui.label(RichText::new(note).color(color));
    ui.add_space(space::M);
    let mut is_asked = enter;
    ui.horizontal(|ui| {
        is_asked |= ui.add_enabled(is_date, Button::new("Export")).clicked();
        if ui.button("Cancel").clicked() {
            commands.send(Command::Window(WindowCommand::CloseDialog));
        }
    });
    if is_asked && is_date {
        commands.send(Command::WriteSchedule { form, epoch: text.trim().to_owned() });
    } else if text != epoch {
        commands.send(Command::Window(WindowCommand::ShowDialog(Dialog::Epoch { form, epoch: text })));
    }
}
