//! How likely the program is to reach its end: many runs with chance, and what came of them.

use egui::{
    Align2, DragValue, FontId, Grid, ProgressBar, Rect, RichText, Role, Sense, Stroke, Ui, WidgetInfo, pos2,
    vec2,
};
use executive::model_based::ProgramTally;
use theme::{size, space, strong};
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::AutomatonCommand;
use workbench::state::chance::ChanceCommand;
use workbench::state::program_chance::{MAX_RUNS, MAX_STEPS_OF_RUN, ProgramChanceCommand};

use super::components::percent;
use super::title;
use crate::{Context, counted};

/// So many faults, and so many locations, are listed.
const MAX_LISTED: usize = 8;

/// Shows what is asked for and what was found.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    title(ui, context, "Monte Carlo", "random faults, with the probabilities in the plant model");
    ask(ui, context, commands);
    let chance = &context.state.automaton.chance;
    if let Some(trouble) = &chance.trouble {
        ui.label(RichText::new(format!("✗ {trouble}")).color(context.tokens.error));
    }
    let tally = chance.tally(context.state.document.revision());
    if let Some(tally) = tally {
        answer(ui, context, tally);
        ends(ui, context, tally);
        faults(ui, context, tally);
        stuck(ui, context, tally, commands);
    } else {
        let text = "Run the program many times with random faults to see how often it reaches its end, \
                    which faults occurred, and where other runs got stuck.";
        ui.add_space(space::M);
        ui.label(RichText::new(text).color(context.tokens.text_muted));
    }
    ui.add_space(space::L);
}

fn ask(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let state = &context.state.automaton;
    let chance = &state.chance;
    let mut settings = chance.settings;
    let muted = |text: &str| RichText::new(text).color(context.tokens.text_muted);
    ui.horizontal_wrapped(|ui| {
        let label = ui.label(muted("Runs")).id;
        ui.add(DragValue::new(&mut settings.runs).range(1..=MAX_RUNS).speed(10.0)).labelled_by(label);
        let label = ui.label(muted("Seed")).id;
        ui.add(DragValue::new(&mut settings.seed).speed(0.1)).labelled_by(label);
        let label = ui.label(muted("Maximum steps")).id;
        let steps = DragValue::new(&mut settings.most_steps).range(1..=MAX_STEPS_OF_RUN);
        ui.add(steps).labelled_by(label).on_hover_text("A longer run counts as not finished");
    });
    let injected = state.injected();
    if !injected.is_empty() {
        let faults: Vec<String> = injected
            .iter()
            .flat_map(|(step, modes)| {
                modes.iter().map(move |(name, mode)| format!("{name}={mode} in step {step}"))
            })
            .collect();
        let text = format!("Always inject {}", faults.join(", "));
        ui.checkbox(&mut settings.keeps_injected, text);
    }
    if chance.is_running() {
        if ui.button("Stop runs").clicked() {
            commands.send(Command::Chance(ChanceCommand::Stop));
        }
    } else if ui.button("Run Monte Carlo").clicked() {
        commands.send(Command::Chance(ChanceCommand::Start));
    }
    if settings != chance.settings {
        commands.send(Command::ProgramChance(ProgramChanceCommand::Set(settings)));
    }
    let asked = chance.asked().map_or(0, |asked| asked.runs);
    let made = chance.tally(context.state.document.revision()).map_or(0, |tally| tally.runs);
    if chance.is_running() || (made > 0 && made < asked) {
        let share = made as f32 / asked.max(1) as f32;
        let standing = if chance.is_running() { "" } else { ", stopped" };
        let text = format!("{made} of {asked} runs{standing}");
        ui.add(ProgressBar::new(share).desired_height(16.0).text(text));
    }
}

fn answer(ui: &mut Ui, context: &Context<'_>, tally: &ProgramTally) {
    let tokens = context.tokens;
    let (low, high) = tally.interval();
    ui.add_space(space::M);
    let color = crate::robustness::share_color(tokens, tally.probability());
    let share = percent(tally.probability());
    ui.label(strong(&share).size(size::TITLE * 1.8).color(color));
    let text = format!(
        "{} of {} runs reach the end (95% confidence: {} to {})",
        tally.reached,
        tally.runs,
        percent(low),
        percent(high)
    );
    ui.label(RichText::new(text).color(tokens.text));
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 14.0), Sense::hover());
    let name = format!("Success rate between {} and {}", percent(low), percent(high));
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
    let painter = ui.painter_at(rect);
    let track = Rect::from_center_size(rect.center(), vec2(rect.width() - 2.0, 6.0));
    let x = |share: f64| track.left() + track.width() * share as f32;
    painter.rect_filled(track, 3.0, tokens.sunken);
    let band = Rect::from_min_max(pos2(x(low), track.top()), pos2(x(high).max(x(low) + 2.0), track.bottom()));
    painter.rect_filled(band, 2.0, tokens.selection);
    let at = x(tally.probability()).clamp(track.left() + 1.0, track.right() - 1.0);
    painter.vline(at, rect.y_range(), Stroke::new(2.0, color));
    response.on_hover_text(name);
}

/// How many runs ended after how many steps.
fn ends(ui: &mut Ui, context: &Context<'_>, tally: &ProgramTally) {
    let Some((&first, &last)) = tally.ends.keys().next().zip(tally.ends.keys().last()) else { return };
    let tokens = context.tokens;
    let mean = format!("{:.2} on average", tally.mean_steps());
    title(ui, context, "Steps to the end", &mean);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 64.0), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("Steps to the end: {mean}")));
    let painter = ui.painter_at(rect);
    let count = (last - first + 1) as f32;
    let width = (rect.width() / count).min(44.0);
    let most = tally.ends.values().copied().max().unwrap_or(1) as f32;
    let (top, bottom) = (rect.top() + 14.0, rect.bottom() - 14.0);
    painter.hline(rect.left()..=rect.left() + count * width, bottom, Stroke::new(1.0, tokens.line));
    for (&steps, &runs) in &tally.ends {
        let left = rect.left() + (steps - first) as f32 * width;
        let height = ((bottom - top) * runs as f32 / most).max(1.5);
        let bar = Rect::from_min_max(pos2(left + 2.0, bottom - height), pos2(left + width - 2.0, bottom));
        painter.rect_filled(bar, 2.0, tokens.accent);
        if width >= 26.0 {
            let font = FontId::proportional(size::SMALL);
            let at = bar.center_top() - vec2(0.0, 1.0);
            painter.text(at, Align2::CENTER_BOTTOM, runs.to_string(), font, tokens.text_muted);
        }
        if width >= 14.0 || steps == first || steps == last {
            let at = pos2(left + width / 2.0, rect.bottom());
            let font = FontId::proportional(size::SMALL);
            painter.text(at, Align2::CENTER_BOTTOM, steps.to_string(), font, tokens.text_muted);
        }
    }
}

fn faults(ui: &mut Ui, context: &Context<'_>, tally: &ProgramTally) {
    title(ui, context, "Random faults", "and the share of these runs that still reached the end");
    if tally.faults.is_empty() {
        ui.label(RichText::new("None").color(context.tokens.text_muted));
    }
    let mut faults: Vec<_> = tally.faults.iter().collect();
    faults.sort_by_key(|(name, tally)| (std::cmp::Reverse(tally.runs), name.as_str()));
    Grid::new("automaton-faults").num_columns(3).striped(true).show(ui, |ui| {
        for (name, tally) in faults.into_iter().take(MAX_LISTED) {
            ui.label(name.as_str());
            ui.label(counted(tally.runs, "run"));
            ui.label(format!("{} reached the end", percent(tally.reached as f64 / tally.runs as f64)));
            ui.end_row();
        }
    });
}

fn stuck(ui: &mut Ui, context: &Context<'_>, tally: &ProgramTally, commands: &mut CommandSender) {
    let Some(number) = tally.first_stuck else { return };
    title(ui, context, "Still active in the other runs", "");
    let mut stuck: Vec<_> = tally.stuck.iter().collect();
    stuck.sort_by_key(|(label, runs)| (std::cmp::Reverse(**runs), label.as_str()));
    for (label, runs) in stuck.into_iter().take(MAX_LISTED) {
        ui.label(format!("{runs} × {label}"));
    }
    ui.add_space(space::S);
    let button = ui.button(format!("Step through run {}", number + 1));
    if button.on_hover_text("Replay the first unfinished run with its fault seed").clicked() {
        commands.send(Command::ProgramChance(ProgramChanceCommand::StepThrough(number)));
        commands.send(Command::Automaton(AutomatonCommand::GoTo(0)));
    }
}
