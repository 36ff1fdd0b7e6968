//! A mission under execution: the clock, what is under way and waited for, disturbances by hand, and the log.
//!
//! Network, timeline and terrain show the same run at the same time.

mod components;
mod disturb;
mod log;
mod now;
pub(crate) mod story;
mod vehicles;

use egui::{Frame, Margin, RichText, ScrollArea, Ui};
use snapshot::Execution;
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::Status;
use workbench::state::execution::{ExecutionCommand, Moment};

use crate::timeline::controls;
use crate::{Context, Panel, show_empty};

/// The panel, with how much longer or later a disturbance makes things.
#[derive(Default)]
pub struct ExecutionPanel {
    disturb: disturb::Disturb,
}

/// What the parts of the panel show.
#[derive(Clone, Copy)]
struct Shown<'a> {
    run: &'a Execution,
    moment: &'a Moment,
    network: &'a tpn::Network,
}

/// The share of the panel that the log has at first. The disturbances above it stay in view.
const LOG_SHARE: f32 = 0.25;

impl Panel for ExecutionPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let state = &context.state.execution;
        let network = context.snapshot.and_then(|snapshot| snapshot.network.as_deref());
        let is_shown = context.state.is_executing();
        let parts = state.run().filter(|_| is_shown).zip(state.moment()).zip(network);
        let Some(((run, moment), network)) = parts else {
            show_empty(ui, context, &why_not(context));
            return;
        };
        let shown = Shown { run, moment, network };
        bar(ui, context, commands);
        now::banner(ui, context, shown);
        let frame = Frame::new().fill(context.tokens.surface).inner_margin(Margin::symmetric(8, 2));
        let height = (ui.available_height() * LOG_SHARE).min(220.0);
        egui::Panel::bottom("execution-log").resizable(true).default_size(height).frame(frame).show(
            ui,
            |ui| {
                log::show(ui, context, shown, commands);
            },
        );
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                self.disturb.show(ui, context, shown, commands);
                now::show(ui, context, shown, commands);
                now::upcoming(ui, context, shown, commands);
                ui.add_space(space::L);
            });
        });
    }
}

fn why_not(context: &Context<'_>) -> String {
    let state = context.state;
    if let Some(trouble) = state.execution.trouble() {
        return format!("Cannot execute this mission: {trouble}.");
    }
    let text = match state.status() {
        Status::Program => "Open the Automaton panel to run a control program.",
        Status::Broken => "The mission has errors. See the Problems panel.",
        Status::NoPlan => "No plan to execute. The Plan panel explains why.",
        Status::Empty => "No mission to execute.",
        Status::Plan if state.window.workspace == workbench::workspace::Workspace::Execute => "Simulating…",
        Status::Plan => "Open the Execute workspace to run this mission.",
        Status::Working => "Planning…",
        Status::Undecided => "Planning was stopped. Choose Plan again in the Plan panel.",
    };
    text.to_owned()
}

/// The clock and what moves it.
fn bar(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    Frame::new().inner_margin(Margin::symmetric(8, 3)).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = space::XS;
            controls::playing(ui, context, commands);
            ui.add_space(space::M);
            controls::clock(ui, context);
            ui.add_space(space::M);
            controls::rate(ui, context, commands);
        });
        ui.horizontal_wrapped(|ui| {
            let buttons = [
                ("Restart", "Restart the run without disturbances", ExecutionCommand::Reset),
                ("Save run…", "Save disturbances and log to a replayable file", ExecutionCommand::Save),
                ("Replay…", "Open a saved run, replay it, and compare the logs", ExecutionCommand::Open),
            ];
            for (name, hint, command) in buttons {
                if ui.button(name).on_hover_text(hint).clicked() {
                    commands.send(Command::Execution(command));
                }
            }
            if context.state.execution.is_replay() {
                let text = "replaying a saved run; Restart ends the replay";
                ui.label(RichText::new(text).small().color(context.tokens.text_muted));
            }
            if context.state.execution.is_working() {
                ui.label(RichText::new("simulating…").small().color(context.tokens.text_muted));
            }
        });
    });
}
