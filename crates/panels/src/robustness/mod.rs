//! How robust the plan is: many runs with chance, how many reach the end, and what breaks the others.

use egui::accesskit;
use egui::{DragValue, Grid, ProgressBar, RichText, ScrollArea, Ui};
use exact::grouped;
use snapshot::Robustness;
use snapshot::robustness::{Others, Traverses};
use theme::{size, space, strong, structure};
use workbench::command::{Command, CommandSender};
use workbench::state::chance::{ChanceCommand, MAX_RUNS};

use crate::one_line::cut_to;
use crate::plan::section;
use crate::{Context, Panel, show_empty};

#[derive(Default)]
pub struct RobustnessPanel;

/// So many events are listed.
const MAX_LISTED: usize = 8;
/// The room for the two figures beside a name, and the least for a name, in points.
const FIGURES_WIDTH: f32 = 190.0;
/// See [`FIGURES_WIDTH`].
const MIN_NAME: f32 = 60.0;

impl Panel for RobustnessPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        if context.state.shown().and_then(|shown| shown.plan()).is_none() {
            show_empty(ui, context, "No plan to test. The Plan panel explains why.");
            return;
        }
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            egui::Frame::new().inner_margin(egui::Margin::symmetric(8, 4)).show(ui, |ui| {
                ask(ui, context, commands);
                let robustness = context.state.robustness();
                if let Some(robustness) = robustness {
                    show_result(ui, context, robustness);
                } else {
                    let text = "Run the plan many times with random durations to estimate how often it \
                                succeeds and what breaks it.";
                    ui.add_space(space::M);
                    ui.label(RichText::new(text).color(context.tokens.text_muted));
                }
            });
        });
    }
}

fn ask(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let chance = &context.state.chance;
    let mut settings = chance.settings.clone();
    ui.horizontal_wrapped(|ui| {
        let runs = ui.label(RichText::new("Runs").color(context.tokens.text_muted)).id;
        ui.add(DragValue::new(&mut settings.runs).range(1..=MAX_RUNS).speed(10.0)).labelled_by(runs);
        let seed = ui.label(RichText::new("Seed").color(context.tokens.text_muted)).id;
        ui.add(DragValue::new(&mut settings.seed)).labelled_by(seed);
        if chance.is_running() {
            if ui.button("Stop runs").clicked() {
                commands.send(Command::Chance(ChanceCommand::Stop));
            }
        } else if ui.button("Run Monte Carlo").clicked() {
            commands.send(Command::Chance(ChanceCommand::Start));
        }
    });
    let mut is_uniform = settings.uncertainty.others == Others::Uniform;
    let text = "Random durations within bounds";
    if ui.checkbox(&mut is_uniform, text).changed() {
        settings.uncertainty.others = if is_uniform { Others::Uniform } else { Others::Planned };
    }
    natures(ui, context, &mut settings.uncertainty);
    driving(ui, context, &mut settings.uncertainty);
    conditions(ui, context, &mut settings.uncertainty);
    if settings != chance.settings {
        commands.send(Command::Chance(ChanceCommand::Set(Box::new(settings))));
    }
    if chance.is_running() {
        let share = chance.runs_made() as f32 / chance.settings.runs.max(1) as f32;
        let text = format!("{} of {} runs", grouped(chance.runs_made()), grouped(chance.settings.runs));
        ui.add(ProgressBar::new(share).desired_height(16.0).text(text));
    }
}

/// Whether the environment chooses by chance, or against the plan.
fn natures(ui: &mut Ui, context: &Context<'_>, uncertainty: &mut snapshot::Uncertainty) {
    let network = context.state.shown().and_then(|shown| shown.network.as_deref());
    if network.is_none_or(|network| network.arcs.iter().all(|arc| !arc.is_contingent)) {
        return;
    }
    let text = "Worst-case durations";
    let hint = "On: each contingent duration takes an extreme of its range. Off: it is sampled from the \
                range.";
    ui.checkbox(&mut uncertainty.adversary, text).on_hover_text(hint);
}

/// Whether vehicles drive, and past how many rocks.
fn driving(ui: &mut Ui, context: &Context<'_>, uncertainty: &mut snapshot::Uncertainty) {
    if context.state.shown().is_none_or(|shown| shown.traverses.is_empty()) {
        return;
    }
    let mut drives = uncertainty.traverses == Traverses::Driven;
    let text = "Simulate each traverse (slow)";
    let hint = "Off: the duration of each traverse is sampled.";
    if ui.checkbox(&mut drives, text).on_hover_text(hint).changed() {
        uncertainty.traverses = if drives { Traverses::Driven } else { Traverses::Drawn };
    }
    if drives {
        ui.horizontal(|ui| {
            ui.add_space(space::L);
            let label = ui.label("Max. unmapped rocks per path").id;
            ui.add(DragValue::new(&mut uncertainty.rocks.most).range(0..=50)).labelled_by(label);
        });
    }
}

/// How likely each condition is to be withdrawn while it should hold.
fn conditions(ui: &mut Ui, context: &Context<'_>, uncertainty: &mut snapshot::Uncertainty) {
    use snapshot::robustness::{Distribution, Incident};
    let Some(snapshot) = context.state.shown() else { return };
    let Some((network, plan)) = snapshot.network.as_deref().zip(snapshot.plan()) else { return };
    Grid::new("conditions").num_columns(2).show(ui, |ui| {
        for occurrence in &network.occurrences {
            let is_condition = occurrence.kind == tpn::OccurrenceKind::Assertion;
            let window = |node: tpn::NodeId| plan.windows.get(node.index()).copied().flatten();
            let bounds = window(occurrence.start).zip(window(occurrence.end));
            let Some((start, end)) = bounds.filter(|_| is_condition) else { continue };
            let before = uncertainty.withdrawn.get(&occurrence.name).map_or(0.0, |it| it.probability);
            let mut percent = before * 100.0;
            let label =
                ui.label(format!("Probability of withdrawal: {}", network.readable(&occurrence.name))).id;
            let field = DragValue::new(&mut percent).range(0.0..=100.0).suffix("%").max_decimals(1);
            if ui.add(field).labelled_by(label).changed() {
                let at = Distribution::Uniform(start.earliest, end.earliest);
                let incident = Incident { probability: percent / 100.0, at };
                if percent > 0.0 {
                    uncertainty.withdrawn.insert(occurrence.name.clone(), incident);
                } else {
                    uncertainty.withdrawn.remove(&occurrence.name);
                }
            }
            ui.end_row();
        }
    });
}

/// The color of a share of runs that reach their end.
pub(crate) fn share_color(tokens: &theme::Tokens, share: f64) -> egui::Color32 {
    match share {
        share if share >= 0.95 => tokens.good,
        share if share >= 0.5 => tokens.warning,
        _ => tokens.error,
    }
}

fn show_result(ui: &mut Ui, context: &Context<'_>, robustness: &Robustness) {
    let tokens = context.tokens;
    let tally = &robustness.tally;
    let (low, high) = tally.interval();
    ui.add_space(space::M);
    let color = share_color(tokens, tally.probability());
    let share = format!("{:.1}%", tally.probability() * 100.0);
    ui.label(strong(share).size(size::TITLE * 1.8).color(color));
    let text = format!(
        "of {} runs reach the end (95% confidence: {:.1}% to {:.1}%)",
        grouped(tally.runs),
        low * 100.0,
        high * 100.0
    );
    ui.label(RichText::new(text).color(tokens.text));
    if tally.runs < robustness.settings.runs && !context.state.chance.is_running() {
        let text =
            format!("Stopped after {} of {} runs", grouped(tally.runs), grouped(robustness.settings.runs));
        ui.label(RichText::new(text).color(tokens.warning));
    }
    if tally.succeeded_by_replanning > 0 {
        let share = tally.succeeded_by_replanning as f64 / tally.runs.max(1) as f64 * 100.0;
        ui.label(RichText::new(format!("{share:.1}% only by replanning")).color(tokens.text_muted));
    }
    let names_width = (ui.available_width() - FIGURES_WIDTH).max(MIN_NAME);
    if !tally.breaks.is_empty() {
        section(ui, context, "Causes of failure", "");
        Grid::new("breaks").num_columns(3).striped(true).show(ui, |ui| {
            structure::part(ui, accesskit::Role::Table, "Causes of failure");
            heading(ui, context, ["Event", "Violations", "Stopped runs"]);
            for (name, breaks) in tally.worst_events().into_iter().take(MAX_LISTED) {
                ui.label(cut_to(ui, name, names_width)).on_hover_text(&breaks.example);
                ui.label(breaks.violations.to_string());
                ui.label(breaks.stops.to_string());
                ui.end_row();
            }
        });
    }
    section(ui, context, "Slack used", "position of each event in its window (100% = latest)");
    Grid::new("slack").num_columns(3).striped(true).show(ui, |ui| {
        structure::part(ui, accesskit::Role::Table, "Slack used");
        heading(ui, context, ["Event", "Mean", "Maximum"]);
        for (name, mean, most) in tally.tightest_events().into_iter().take(MAX_LISTED) {
            ui.label(cut_to(ui, name, names_width)).on_hover_text(name.as_str());
            ui.label(format!("{:.0}%", mean * 100.0));
            ui.label(format!("{:.0}%", most * 100.0));
            ui.end_row();
        }
    });
}

fn heading(ui: &mut Ui, context: &Context<'_>, titles: [&str; 3]) {
    for title in titles {
        ui.label(RichText::new(title).small().color(context.tokens.text_muted));
    }
    ui.end_row();
}
