//! The row of buttons above the timeline: playing, the time, what is shown, zoom.

use egui::{ComboBox, Frame, Margin, RichText, Ui};

use layout::timeline::Grouping;
use rmpl::program::TimeUnit;
use theme::icon::{self, Icon};
use theme::space;
use tpn::{Network, OccurrenceKind};
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::PinCommand;
use workbench::state::playback::TransportCommand;
use workbench::state::settings::{SettingsCommand, TimelineView};
use workbench::state::window::WindowCommand;
use workbench::time_text;
use workbench::workspace::Workspace;

use super::handle;
use crate::Context;

/// Shows the row.
pub(crate) fn show(ui: &mut Ui, context: &Context<'_>, network: &Network, commands: &mut CommandSender) {
    let frame = Frame::new().inner_margin(Margin::symmetric(8, 3));
    frame.show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = egui::vec2(space::XS, space::XS);
            playing(ui, context, commands);
            ui.add_space(space::M);
            clock(ui, context);
            ui.add_space(space::M);
            rate(ui, context, commands);
            ui.add_space(space::M);
            grouping(ui, context, commands);
            switches(ui, context, commands);
            ui.add_space(space::M);
            zoom(ui, context, commands);
            ui.add_space(space::M);
            pins(ui, context, commands);
            range(ui, context, network, commands);
        });
    });
}

/// How many events are pinned, and the way back.
fn pins(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let Some(text) = handle::summary(context) else { return };
    ui.label(RichText::new(text).small().color(context.tokens.accent));
    let button = ui.button(RichText::new("Unpin").small());
    if button.on_hover_text("Unpin all events (Esc)").clicked() {
        commands.send(Command::Pins(PinCommand::ReleaseAll));
    }
}

/// The range of times that is selected, and what lies in it.
fn range(ui: &mut Ui, context: &Context<'_>, network: &Network, commands: &mut CommandSender) {
    let (Some([from, to]), Some((_, plan))) = (context.state.time_range, context.plan()) else { return };
    let mut counts = [0_usize; 2];
    for occurrence in network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive) {
        let Some([start, end]) = layout::timeline::times(plan, [occurrence.start, occurrence.end]) else {
            continue;
        };
        counts[0] += usize::from(start[0] <= to && end[1] >= from);
        counts[1] += usize::from(start[1] <= to && end[0] >= from);
    }
    let text = format!(
        "{from} to {to} ({}): at least {} activities, at most {}",
        ((to - from) * 1000.0).round() / 1000.0,
        counts[1],
        counts[0]
    );
    ui.label(RichText::new(text).small().color(context.tokens.accent));
    if ui.button(RichText::new("Zoom").small()).on_hover_text("Zoom to this range").clicked() {
        commands.send(Command::Window(WindowCommand::ViewOf(PanelKind::Timeline, ViewAction::FitSelection)));
    }
    if ui.button(RichText::new("Clear").small()).on_hover_text("Clear the range (Esc)").clicked() {
        commands.send(Command::SelectTimes(None));
    }
}

fn grouping(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let chosen = context.state.settings.views.timeline.grouping;
    ComboBox::from_id_salt("grouping")
        .selected_text(chosen.title())
        .width(96.0)
        .show_ui(ui, |ui| {
            theme::structure::options(ui, "Group rows by");
            for choice in Grouping::ALL {
                if theme::structure::option(ui, chosen == choice, choice.title()).clicked() {
                    let mut views = context.state.settings.views.clone();
                    views.timeline.grouping = choice;
                    commands.send(Command::Settings(SettingsCommand::SetViews(Box::new(views))));
                }
            }
        })
        .response
        .accessible_name("Group rows by");
}

/// The buttons that move time.
pub(crate) fn playing(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let playback = *context.state.playback;
    let (sign, name) = if playback.is_playing { (Icon::Pause, "Pause") } else { (Icon::Play, "Play") };
    let buttons = [
        (Icon::ToStart, "Go to start", Command::Seek(0.0)),
        (Icon::StepBack, "Previous event", Command::Transport(TransportCommand::Step(false))),
        (sign, name, Command::Transport(TransportCommand::TogglePlaying)),
        (Icon::StepForward, "Next event", Command::Transport(TransportCommand::Step(true))),
        (Icon::ToEnd, "Go to end", Command::Seek(playback.end)),
    ];
    for (sign, name, command) in buttons {
        let is_on = sign == Icon::Pause;
        if icon::lit_button(ui, context.tokens, sign, name, is_on).clicked() {
            commands.send(command);
        }
    }
}

pub(crate) fn clock(ui: &mut Ui, context: &Context<'_>) {
    let unit = context.snapshot.map_or(TimeUnit::Minute, |snapshot| snapshot.program.options.time_unit);
    let time = context.state.playback.time;
    let text = format!("{time:.1} {}", time_text::unit(unit));
    ui.label(RichText::new(text).monospace().color(context.tokens.text));
    ui.add_space(space::M);
    ui.label(RichText::new(time_text::clock(time, unit)).small().color(context.tokens.text_muted));
}

/// How fast time runs.
pub(crate) fn rate(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let rate = context.state.playback.rate;
    ComboBox::from_id_salt("rate")
        .selected_text(format!("×{rate}"))
        .width(56.0)
        .show_ui(ui, |ui| {
            theme::structure::options(ui, "Speed");
            for choice in [0.25, 0.5, 1.0, 2.0, 4.0, 8.0] {
                if theme::structure::option(ui, rate == choice, format!("×{choice}")).clicked() {
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
    let has_approved = context.state.window.workspace == Workspace::Review
        && context.state.review.record().last_approval().is_some();
    ui.menu_button(RichText::new("Show").small(), |ui| {
        if has_approved {
            let help = "Show the last approved plan here and on the network";
            changed |= ui.checkbox(&mut view.approved, "Approved plan").on_hover_text(help).changed();
        }
        if context.state.is_executing() {
            let help = "Dashed outlines of the plan that the run started with";
            changed |= ui.checkbox(&mut view.planned, "Original plan").on_hover_text(help).changed();
        }
        for (value, name, help) in all(view) {
            changed |= ui.checkbox(value, name).on_hover_text(help).changed();
        }
    });
    if changed {
        commands.send(Command::Settings(SettingsCommand::SetViews(Box::new(views))));
    }
}

/// Returns what can be switched on and off, with its name and what it means.
fn all(view: &mut TimelineView) -> [(&mut bool, &'static str, &'static str); 5] {
    [
        (&mut view.delays, "Delays", "Delays as bars"),
        (&mut view.conditions, "Conditions", "Required and asserted conditions"),
        (&mut view.states, "States", "Values of state variables"),
        (&mut view.resources, "Resources", "Use of resources"),
        (&mut view.links, "Links", "All causal links and orderings; otherwise those of the selection"),
    ]
}

fn zoom(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let buttons = [
        (Icon::Fit, "Zoom timeline to fit", ViewAction::Fit),
        (Icon::Plus, "Zoom in on timeline", ViewAction::ZoomIn),
        (Icon::Minus, "Zoom out of timeline", ViewAction::ZoomOut),
    ];
    // They stay together where the row is broken.
    let width = buttons.len() as f32 * (space::ROW + ui.spacing().item_spacing.x);
    if ui.available_size_before_wrap().x < width {
        ui.end_row();
    }
    for (sign, name, action) in buttons {
        if icon::button(ui, context.tokens, sign, name).clicked() {
            commands.send(Command::Window(WindowCommand::ViewOf(PanelKind::Timeline, action)));
        }
    }
}
