//! The rows of controls above the search tree: stepping, playing, breakpoints, and which search runs.

use egui::{ComboBox, Slider, Ui};
use kirk::Search as SearchKind;
use theme::icon::{self, Icon};
use theme::space;
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::state::search::{Recording, SearchCommand};
use workbench::state::settings::SettingsCommand;
use workbench::state::window::WindowCommand;

use super::{kind_help, kind_name};
use crate::Context;

/// Speeds that can be chosen, in steps a second.
const SPEEDS: [f64; 8] = [1.0, 2.0, 4.0, 10.0, 30.0, 100.0, 1_000.0, 10_000.0];

/// Shows the controls.
pub fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    recordings: &[Recording],
    [folds_failed, merges]: [&mut bool; 2],
    commands: &mut CommandSender,
) {
    egui::Frame::new().inner_margin(egui::Margin::symmetric(8, 4)).show(ui, |ui| {
        ui.spacing_mut().item_spacing = egui::vec2(space::XS, space::XS);
        ui.horizontal_wrapped(|ui| show_steps(ui, context, recordings, commands));
        ui.horizontal_wrapped(|ui| {
            show_choices(ui, context, [folds_failed, merges], commands);
            show_breakpoints(ui, context, commands);
        });
    });
}

fn show_steps(ui: &mut Ui, context: &Context<'_>, recordings: &[Recording], commands: &mut CommandSender) {
    let tokens = context.tokens;
    let search = &context.state.search;
    let (sign, play) =
        if search.is_playing { (Icon::Pause, "Stop (Space)") } else { (Icon::Play, "Play (Space)") };
    for (sign, name, command) in [
        (Icon::ToStart, "First step (Home)", SearchCommand::GoTo(0)),
        (Icon::RunBack, "Previous breakpoint ([)", SearchCommand::Run(false)),
        (Icon::StepBack, "Step back (,)", SearchCommand::Step(-1)),
        (sign, play, SearchCommand::TogglePlaying),
        (Icon::StepForward, "Step forward (.)", SearchCommand::Step(1)),
        (Icon::Run, "Next breakpoint (])", SearchCommand::Run(true)),
        (Icon::ToEnd, "Last step (End)", SearchCommand::GoTo(usize::MAX)),
    ] {
        if icon::lit_button(ui, tokens, sign, name, sign == Icon::Pause).clicked() {
            commands.send(Command::Window(WindowCommand::Activate(PanelKind::Search)));
            commands.send(Command::Search(command));
        }
    }
    show_speed(ui, context, commands);
    let longest = recordings.iter().map(Recording::steps).max().unwrap_or(1).max(1);
    let steps = match (search.is_linked(), recordings.get(search.side())) {
        (false, Some(recording)) => recording.steps(),
        _ => longest,
    };
    let mut step = search.step().map_or(steps, |step| step.step + 1);
    let rest = ui.available_size_before_wrap().x;
    if rest < 140.0 {
        ui.end_row();
    }
    let room = if rest < 140.0 { ui.available_width() } else { rest };
    ui.spacing_mut().slider_width = (room - 80.0).clamp(60.0, 180.0);
    let slider = ui.add(Slider::new(&mut step, 1..=steps)).accessible_name("Search step");
    if slider.changed() {
        commands.send(Command::Search(SearchCommand::GoTo(step - 1)));
    }
    if search.step().is_some() {
        let close = ui.button("Show plan").on_hover_text("Close the search and show the plan (Esc)");
        if close.clicked() {
            commands.send(Command::Search(SearchCommand::Close));
        }
    }
}

fn show_speed(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let now = context.state.search.steps_per_sec;
    let mut speed = now;
    ComboBox::from_id_salt("search-speed")
        .selected_text(format!("{now}/s"))
        .width(58.0)
        .show_ui(ui, |ui| {
            theme::structure::options(ui, "Speed");
            for choice in SPEEDS {
                let text = format!("{choice} steps per second");
                theme::structure::option_value(ui, &mut speed, choice, text);
            }
        })
        .response
        .accessible_name("Speed");
    if speed != now {
        commands.send(Command::Search(SearchCommand::SetSpeed(speed)));
    }
}

fn show_choices(
    ui: &mut Ui,
    context: &Context<'_>,
    [folds_failed, merges]: [&mut bool; 2],
    commands: &mut CommandSender,
) {
    let search = &context.state.search;
    if !search.compares() {
        show_kind(ui, context, commands);
    }
    ui.menu_button("Show", |ui| {
        let mut only_key = search.only_key();
        ui.checkbox(&mut only_key, "Key steps only").on_hover_text("Step only through choices and failures");
        if only_key != search.only_key() {
            commands.send(Command::Search(SearchCommand::OnlyKey(only_key)));
        }
        ui.checkbox(folds_failed, "Collapse failed branches").on_hover_text("Collapse branches that fail");
        let mut compares = search.compares();
        ui.checkbox(&mut compares, "Compare").on_hover_text("Show both searches side by side");
        if compares != search.compares() {
            commands.send(Command::Search(SearchCommand::Compare(compares)));
        }
        if search.compares() {
            let mut is_linked = search.is_linked();
            ui.checkbox(&mut is_linked, "Step together").on_hover_text("Step both searches together");
            if is_linked != search.is_linked() {
                commands.send(Command::Search(SearchCommand::Link(is_linked)));
            }
            let help = "Draw both trees as one; shared states appear once";
            ui.checkbox(merges, "Merge trees").on_hover_text(help);
        }
    });
}

fn show_breakpoints(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let search = &context.state.search;
    let mut breakpoints = search.breakpoints;
    ui.menu_button("Stop at", |ui| {
        for (value, name, help) in [
            (&mut breakpoints.decision, "Decisions", "Stop at decisions"),
            (&mut breakpoints.failure, "Failures", "Stop at failures"),
            (&mut breakpoints.threat, "Threats", "Stop at threats (conflicting intervals that may overlap)"),
            (&mut breakpoints.solution, "Plans", "Stop at plans"),
        ] {
            ui.checkbox(value, name).on_hover_text(help);
        }
    });
    if breakpoints != search.breakpoints {
        commands.send(Command::Search(SearchCommand::SetBreakpoints(breakpoints)));
    }
}

fn show_kind(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let recorded = context.state.settings.plan.recorded();
    let mut kind = recorded;
    ComboBox::from_id_salt("search-kind")
        .selected_text(kind_name(kind))
        .show_ui(ui, |ui| {
            theme::structure::options(ui, "Search");
            for choice in SearchKind::ALL {
                theme::structure::option_value(ui, &mut kind, choice, kind_name(choice))
                    .on_hover_text(kind_help(choice));
            }
        })
        .response
        .accessible_name("Search");
    if kind != recorded {
        commands.send(Command::Settings(SettingsCommand::SetSearch(kind)));
    }
}
