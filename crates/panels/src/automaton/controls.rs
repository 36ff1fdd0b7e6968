//! The row of buttons above the automaton: stepping, playing, jumping, and zoom.

use egui::{Align, Frame, Layout, Margin, RichText, Slider, Ui};
use theme::icon::{self, Icon};
use theme::space;
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, Program};
use workbench::state::window::WindowCommand;

use crate::Context;
use crate::one_line::in_one_line;

/// Shows the row.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    Frame::new().inner_margin(Margin::symmetric(8, 3)).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = space::XS;
            stepping(ui, context, commands);
            ui.add_space(space::M);
            jump(ui, context, commands);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let zoom = [
                    (Icon::Fit, "Zoom to fit", ViewAction::Fit),
                    (Icon::Plus, "Zoom in", ViewAction::ZoomIn),
                    (Icon::Minus, "Zoom out", ViewAction::ZoomOut),
                ];
                for (sign, name, action) in zoom {
                    if icon::button(ui, context.tokens, sign, name).clicked() {
                        commands.send(Command::Window(WindowCommand::ViewOf(PanelKind::Automaton, action)));
                    }
                }
                if matches!(context.state.automaton.program(), Some(Program::Unbound(_))) {
                    let text = RichText::new("No plant model: enter observations by hand").small();
                    let galley = in_one_line(ui, text.color(context.tokens.text_muted));
                    // Beside the controls, where there is room; the panel *What is known* says it as well.
                    if galley.size().x <= ui.available_width() {
                        ui.label(galley);
                    }
                }
            });
        });
    });
    if let Some(error) = &context.state.automaton.error {
        ui.label(RichText::new(format!("✗ This step failed: {error}")).color(context.tokens.error));
    }
}

fn stepping(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let state = &context.state.automaton;
    let (sign, name) =
        if state.is_playing { (Icon::Pause, "Pause program") } else { (Icon::Play, "Run program") };
    let buttons = [
        (Icon::ToStart, "Go to the first step", AutomatonCommand::GoTo(0), state.at() > 0),
        (Icon::StepBack, "Step back", AutomatonCommand::Step(-1), state.at() > 0),
        (sign, name, AutomatonCommand::TogglePlaying, true),
        (Icon::StepForward, "Step", AutomatonCommand::Step(1), state.can_step()),
    ];
    for (sign, name, command, is_enabled) in buttons {
        let is_on = sign == Icon::Pause;
        let pressed = ui.add_enabled_ui(is_enabled, |ui| {
            icon::lit_button(ui, context.tokens, sign, name, is_on).clicked()
        });
        if pressed.inner {
            commands.send(Command::Window(WindowCommand::Activate(PanelKind::Automaton)));
            commands.send(Command::Automaton(command));
        }
    }
    let reset = ui.button("Reset").on_hover_text("Discard all steps, faults and changed observations");
    if reset.clicked() {
        commands.send(Command::Automaton(AutomatonCommand::Reset));
    }
}

fn jump(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let state = &context.state.automaton;
    let last = state.moments().len().max(1);
    let mut step = state.at() + 1;
    let name = ui.label(RichText::new("Step").color(context.tokens.text_muted)).id;
    // The slider's handle stands out to the left.
    ui.add_space(space::M);
    let slider = ui.add(Slider::new(&mut step, 1..=last.max(2))).labelled_by(name);
    if slider.changed() {
        commands.send(Command::Automaton(AutomatonCommand::GoTo(step.saturating_sub(1))));
    }
    let note = match state.moment() {
        Some(moment) if moment.marking.is_empty() => "ended".to_owned(),
        Some(moment) => format!("{} active", moment.marking.len()),
        None => String::new(),
    };
    ui.add_space(space::S);
    ui.label(RichText::new(note).color(context.tokens.text_muted));
}
