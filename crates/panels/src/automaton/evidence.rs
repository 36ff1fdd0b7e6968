//! What was observed, what is believed because of it, and why.

use egui::style::ScrollAnimation;
use egui::{Align2, ComboBox, FontId, Grid, Rect, RichText, Sense, Ui, pos2, vec2};
use executive::model_based::{StepOutcome, StepRecord};
use plant::{Interval, Model, State, VariableId};
use theme::{size, space};
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, PlantMoment};

use super::components::{percent, percent_between};
use super::{hitting_sets, title, trajectories};
use crate::{Context, counted};

/// How wide the number of a step is at most, in points.
const NUMBER_WIDTH: f32 = 20.0;
/// So many of the most likely states are listed.
const MAX_LISTED: usize = 6;

/// Returns whether the last step showed something that was not expected.
pub(super) fn is_surprising(plant: &PlantMoment) -> bool {
    let is_surprising =
        |record: &StepRecord| record.outcome != StepOutcome::Explained || !record.conflicts.is_empty();
    plant.record.as_ref().is_some_and(is_surprising)
}

/// Shows belief, observations, conflicts and diagnoses; `reveals` brings the conflicts into view.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    model: &Model,
    plant: &PlantMoment,
    reveals: bool,
    commands: &mut CommandSender,
) {
    belief(ui, context, model, plant);
    history(ui, context, commands);
    trajectories::show(ui, context, model, commands);
    chosen(ui, context, plant);
    asked(ui, context, plant);
    observations(ui, context, model, plant, commands);
    let place = ui.scope(|ui| {
        findings(ui, context, model, plant);
        hitting_sets::show(ui, context, model, plant, commands);
    });
    let place = place.response;
    ui.add_space(space::L);
    if reveals {
        // Without an animation: it would follow a layout that still changes.
        place.scroll_to_me_animation(None, ScrollAnimation::none());
    }
}

fn belief(ui: &mut Ui, context: &Context<'_>, model: &Model, plant: &PlantMoment) {
    let count = plant.belief.len();
    let note = match count {
        1 if plant.belief.is_exact() => "1 possible state".to_owned(),
        1 => "1 tracked state".to_owned(),
        usize::MAX => "too many possible states to count".to_owned(),
        _ if plant.belief.is_exact() => format!("{count} possible states"),
        _ => format!("{count} tracked states"),
    };
    title(ui, context, "Belief", &note);
    let listed: Vec<(State, Interval)> = plant.belief.states().take(MAX_LISTED).collect();
    for (rank, (state, probability)) in listed.iter().enumerate() {
        let text = if rank == 0 && count > 1 {
            "most likely".to_owned()
        } else if rank == 0 {
            "as estimated above".to_owned()
        } else {
            model.differences(&listed[0].0, state)
        };
        bar(ui, context, probability, &text, *state == plant.true_state, &model.describe(state));
    }
    if count > listed.len() {
        let sum = listed.iter().map(|(_, probability)| probability.to_f64().0).sum::<f64>();
        let rest = percent((1.0 - sum).max(0.0));
        let text = match count {
            usize::MAX => format!("and others, {rest}"),
            _ if plant.belief.is_exact() => format!("and {} more, {rest}", count - listed.len()),
            _ => format!("and {} more, plus untracked states, at most {rest}", count - listed.len()),
        };
        ui.label(RichText::new(text).small().color(context.tokens.text_muted));
    }
}

fn bar(ui: &mut Ui, context: &Context<'_>, probability: &Interval, text: &str, is_true: bool, state: &str) {
    let tokens = context.tokens;
    let share = percent_between(probability, 2);
    let sign = if is_true { "● " } else { "" };
    let (width, font) = (ui.available_width(), FontId::proportional(size::SMALL));
    let words = format!("{share}  {sign}{text}");
    let galley = ui.painter().layout(words, font, tokens.text, width - 12.0);
    let height = (galley.size().y + 5.0).max(space::ROW - 2.0);
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    let name = format!("{share} {text}");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &name));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 3.0, tokens.sunken);
    let part =
        Rect::from_min_size(rect.min, vec2(rect.width() * probability.to_f64().0 as f32, rect.height()));
    painter.rect_filled(part, 3.0, tokens.selection);
    let at = rect.left_center() + vec2(6.0, -0.5 * galley.size().y);
    painter.galley(at, galley, tokens.text);
    response.on_hover_text(state);
}

/// One column per step: the states that were believed possible, most likely at the bottom.
fn history(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let state = &context.state.automaton;
    let moments = state.moments();
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 44.0), Sense::click());
    let name = format!("Belief over {}", counted(moments.len() as u64, "step"));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    let painter = ui.painter_at(rect);
    let width = (rect.width() / moments.len().max(1) as f32).min(26.0);
    for (at, moment) in moments.iter().enumerate() {
        let Some(plant) = &moment.plant else { continue };
        let left = rect.left() + at as f32 * width;
        let mut bottom = rect.bottom() - 12.0;
        for (rank, (_, probability)) in plant.belief.states().take(MAX_LISTED).enumerate() {
            let height = (probability.to_f64().0 as f32 * 30.0).max(if rank == 0 { 1.0 } else { 1.5 });
            let part =
                Rect::from_min_max(pos2(left + 1.0, bottom - height), pos2(left + width - 1.0, bottom));
            painter.rect_filled(part, 0.0, tokens.series[rank % tokens.series.len()]);
            bottom -= height;
        }
        // Of numbers that would touch only some are written.
        let stride = (NUMBER_WIDTH / width).ceil().max(1.0) as usize;
        if at % stride == 0 {
            let color = if at == state.at() { tokens.accent } else { tokens.text_faint };
            let place = pos2(left + width / 2.0, rect.bottom());
            let font = FontId::proportional(size::SMALL);
            painter.text(place, Align2::CENTER_BOTTOM, (at + 1).to_string(), font, color);
        }
    }
    if response.clicked()
        && let Some(pointer) = response.interact_pointer_pos()
    {
        let at = ((pointer.x - rect.left()) / width) as usize;
        if at < moments.len() {
            commands.send(Command::Automaton(AutomatonCommand::GoTo(at)));
        }
    }
    response.on_hover_text("Most likely states before each step. Click a step to open it.");
}

/// The choices by rewards that led into the last step.
fn chosen(ui: &mut Ui, context: &Context<'_>, plant: &PlantMoment) {
    let Some(record) = plant.record.as_ref().filter(|record| !record.chosen.is_empty()) else { return };
    title(ui, context, "Choices", "by the expected sum of rewards");
    for made in &record.chosen {
        let color = if made.is_shortened { context.tokens.warning } else { context.tokens.text };
        ui.label(RichText::new(made.describe()).color(color));
    }
}

/// What the program asked for in the last step, if it names a probability from which on conditions are known.
fn asked(ui: &mut Ui, context: &Context<'_>, plant: &PlantMoment) {
    let Some(record) = plant.record.as_ref().filter(|record| !record.asked.is_empty()) else { return };
    title(ui, context, "Known", "conditions that the program asked for");
    for asked in &record.asked {
        let (word, color) = if asked.is_entailed {
            ("known", context.tokens.text)
        } else {
            ("not known", context.tokens.text_muted)
        };
        let share = percent_between(&asked.probability, 2);
        ui.label(RichText::new(format!("{}: {share}, {word}", asked.condition)).color(color));
    }
}

fn observations(
    ui: &mut Ui,
    context: &Context<'_>,
    model: &Model,
    plant: &PlantMoment,
    commands: &mut CommandSender,
) {
    let Some(record) = &plant.record else {
        title(ui, context, "Observations", "made at the end of each step");
        return;
    };
    title(
        ui,
        context,
        &format!("Observed in step {}", record.trace.step),
        "change a value to update the estimate",
    );
    Grid::new("automaton-observations").num_columns(3).show(ui, |ui| {
        for (&id, &value) in &record.observation.0 {
            let Some(variable) = model.variables.get(id.0 as usize) else { continue };
            let is_changed = record.input.observed.contains_key(&id);
            let color = if is_changed { context.tokens.warning } else { context.tokens.text };
            ui.label(RichText::new(variable.name.as_str()).color(color));
            observation(ui, id, &variable.name, &variable.values, value, commands);
            let reset = is_changed.then(|| {
                let reset = ui.button("Reset").on_hover_text("Restore the value that the plant produced");
                reset.accessible_name(format!("Reset {}", variable.name))
            });
            if reset.is_some_and(|reset| reset.clicked()) {
                commands.send(Command::Automaton(AutomatonCommand::Observe(id, None)));
            }
            ui.end_row();
        }
    });
}

fn observation(
    ui: &mut Ui,
    id: VariableId,
    name: &str,
    values: &[smol_str::SmolStr],
    now: u8,
    commands: &mut CommandSender,
) {
    let text = values.get(usize::from(now)).map_or("?", |value| value.as_str());
    let combo = ComboBox::from_id_salt(("observed", id.0)).selected_text(text).show_ui(ui, |ui| {
        theme::structure::options(ui, "Observed value");
        for (value, text) in (0..=u8::MAX).zip(values) {
            if theme::structure::option(ui, value == now, text.as_str()).clicked() && value != now {
                commands.send(Command::Automaton(AutomatonCommand::Observe(id, Some(value))));
            }
        }
    });
    combo.response.accessible_name(format!("Observed value of {name}"));
}

/// What the observations say of the estimate as a whole.
fn findings(ui: &mut Ui, context: &Context<'_>, model: &Model, plant: &PlantMoment) {
    let Some(record) = &plant.record else { return };
    let tokens = context.tokens;
    let ended = match &record.outcome {
        StepOutcome::Explained => None,
        StepOutcome::Refuted { conflict } => {
            let names = model.observation_names(conflict);
            let names: Vec<String> = names.iter().map(|(name, value)| format!("{name}={value}")).collect();
            Some(format!("No state of the plant explains {}. The estimate is invalid.", names.join(", ")))
        }
        StepOutcome::LimitReached => {
            Some("The observation doesn't match any tracked state; it was ignored.".to_owned())
        }
    };
    let is_as_expected = record.conflicts.is_empty() && ended.is_none();
    let is_mistaken = plant.belief.most_likely() != &plant.true_state;
    if ended.is_some() || record.is_uncertain || is_as_expected || is_mistaken {
        title(ui, context, "Result", "");
    }
    if let Some(text) = &ended {
        ui.label(RichText::new(text).color(tokens.error));
    }
    if record.is_uncertain {
        let text = "Uncertain: the estimator tracks only some of the possible states.";
        ui.label(RichText::new(text).color(tokens.warning));
    }
    if is_as_expected {
        ui.label(RichText::new("No conflicts: the observations are as expected.").color(tokens.good));
    }
    if is_mistaken {
        let text =
            format!("True state: {}", model.differences(plant.belief.most_likely(), &plant.true_state));
        ui.label(RichText::new(text).small().color(tokens.text_muted));
    }
}
