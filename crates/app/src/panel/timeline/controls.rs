//! The row of buttons above the timeline: playing, the time, what is shown, zoom.

use egui::{Align, Button, ComboBox, Frame, Layout, Margin, RichText, Ui};

use rmpl::program::TimeUnit;

use crate::command::{Command, CommandSender, ViewAction};
use crate::icon::{self, Icon};
use crate::panel::{Context, PanelKind};
use crate::theme::space;
use crate::time_text;

/// Shows the row.
pub(crate) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let frame = Frame::new().inner_margin(Margin::symmetric(8, 3));
    frame.show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = space::XS;
            playing(ui, context, commands);
            ui.add_space(space::M);
            clock(ui, context);
            ui.add_space(space::M);
            rate(ui, context, commands);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                zoom(ui, context, commands);
                ui.add_space(space::M);
                switches(ui, context, commands);
            });
        });
    });
}

fn playing(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let playback = context.state.playback;
    let (sign, name) = if playback.is_playing { (Icon::Pause, "Pause") } else { (Icon::Play, "Play") };
    let buttons = [
        (Icon::ToStart, "To the start", Command::Seek(0.0)),
        (Icon::StepBack, "Previous event", Command::StepTime(false)),
        (sign, name, Command::TogglePlaying),
        (Icon::StepForward, "Next event", Command::StepTime(true)),
        (Icon::ToEnd, "To the end", Command::Seek(playback.end)),
    ];
    for (sign, name, command) in buttons {
        let is_on = sign == Icon::Pause;
        if icon::toggle(ui, context.tokens, sign, name, is_on).clicked() {
            commands.send(command);
        }
    }
}

fn clock(ui: &mut Ui, context: &Context<'_>) {
    let unit = context.snapshot.map_or(TimeUnit::Minute, |snapshot| snapshot.program.options.time_unit);
    let time = context.state.playback.time;
    let text = format!("{time:.1} {}", time_text::unit(unit));
    ui.label(RichText::new(text).monospace().color(context.tokens.text));
    ui.add_space(space::M);
    ui.label(RichText::new(time_text::clock(time, unit)).small().color(context.tokens.text_muted));
}

fn rate(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let rate = context.state.playback.rate;
    ComboBox::from_id_salt("rate")
        .selected_text(format!("×{rate}"))
        .width(56.0)
        .show_ui(ui, |ui| {
            for choice in [0.25, 0.5, 1.0, 2.0, 4.0, 8.0] {
                if ui.selectable_label(rate == choice, format!("×{choice}")).clicked() {
                    commands.send(Command::SetRate(choice));
                }
            }
        })
        .response
        .accessible_name("Speed");
}

fn switches(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let mut views = context.state.settings.views.clone();
    let view = &mut views.timeline;
    let mut changed = false;
    for (value, name) in
        [(&mut view.delays, "Delays"), (&mut view.conditions, "Conditions"), (&mut view.links, "Links")]
    {
        if ui.add(Button::selectable(*value, RichText::new(name).small())).clicked() {
            *value = !*value;
            changed = true;
        }
    }
    if changed {
        commands.send(Command::SetViews(Box::new(views)));
    }
}

fn zoom(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    for (sign, name, action) in [
        (Icon::Fit, "Fit the timeline", ViewAction::Fit),
        (Icon::Plus, "Zoom into the timeline", ViewAction::ZoomIn),
        (Icon::Minus, "Zoom out of the timeline", ViewAction::ZoomOut),
    ] {
        if icon::button(ui, context.tokens, sign, name).clicked() {
            commands.send(Command::ViewOf(PanelKind::Timeline, action));
        }
    }
}
