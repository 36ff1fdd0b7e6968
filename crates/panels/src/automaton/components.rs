//! The components as cards with their state machines, and what makes them fail.

use std::sync::Arc;

use egui::{DragValue, Frame, Margin, Rect, RichText, Stroke, Ui, UiBuilder, vec2};
use plant::{ComponentId, Interval, Model};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::automaton::{AutomatonCommand, FaultSeed, PlantMoment};

use super::machine::{Machine, Standing};
use super::{hitting_sets, title};
use crate::Context;

/// The state machines of a model's components, laid out.
pub(super) struct Machines {
    model: Arc<Model>,
    machines: Vec<Machine>,
}

const CARD_PADDING: Margin = Margin { left: 8, right: 8, top: 4, bottom: 7 };
/// The height of a card's first line.
const HEAD: f32 = 24.0;
const HEAD_GAP: f32 = 5.0;
const CARD_GAP: f32 = 6.0;

impl Machines {
    /// Lays the machines of a model out.
    pub(super) fn new(ui: &Ui, model: &Arc<Model>) -> Self {
        let machines = model.components.iter().map(|component| Machine::new(ui, component)).collect();
        Self { model: Arc::clone(model), machines }
    }

    /// Returns whether they are those of `model`.
    pub(super) fn are_of(&self, model: &Arc<Model>) -> bool {
        Arc::ptr_eq(&self.model, model)
    }

    /// Shows all cards, as many beside each other as there is room for.
    pub(super) fn show(
        &self,
        ui: &mut Ui,
        context: &Context<'_>,
        plant: &PlantMoment,
        commands: &mut CommandSender,
    ) {
        title(ui, context, "Components", "shading: probability   ● true mode   dotted: fault");
        chance(ui, context, commands);
        let available = ui.available_width();
        let mut row: Vec<(ComponentId, f32)> = Vec::new();
        let mut used = 0.0;
        for (id, machine) in self.model.component_ids().zip(&self.machines) {
            let conflicts = conflicts_with(context, plant, id);
            let width = self.card_width(ui, id, machine, conflicts.as_deref()).min(available);
            if !row.is_empty() && used + CARD_GAP + width > available {
                self.row(ui, context, plant, &row, commands);
                row.clear();
                used = 0.0;
            }
            used += width + if row.is_empty() { 0.0 } else { CARD_GAP };
            row.push((id, width));
        }
        self.row(ui, context, plant, &row, commands);
    }

    fn card_width(&self, ui: &Ui, id: ComponentId, machine: &Machine, conflicts: Option<&str>) -> f32 {
        let width = |text: &str, style: egui::TextStyle| {
            let font = style.resolve(ui.style());
            ui.painter().layout_no_wrap(text.to_owned(), font, ui.visuals().text_color()).size().x
        };
        let name = self.model.component(id).map_or("", |component| component.name.as_str());
        let name = width(name, egui::TextStyle::Button) + 2.0 * ui.spacing().button_padding.x;
        let conflicts = conflicts.map_or(0.0, |text| space::S + width(text, egui::TextStyle::Small));
        (name + conflicts).max(machine.width() + 2.0) + CARD_PADDING.sum().x
    }

    /// Cards beside each other share what is left of the width.
    fn row(
        &self,
        ui: &mut Ui,
        context: &Context<'_>,
        plant: &PlantMoment,
        row: &[(ComponentId, f32)],
        commands: &mut CommandSender,
    ) {
        if row.is_empty() {
            return;
        }
        let heights = row.iter().filter_map(|(id, _)| self.machines.get(id.0 as usize)).map(Machine::height);
        let height = heights.fold(0.0, f32::max) + HEAD + HEAD_GAP + 2.0 + CARD_PADDING.sum().y;
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), egui::Sense::hover());
        let used = row.iter().map(|(_, width)| width).sum::<f32>() + CARD_GAP * (row.len() as f32 - 1.0);
        let share = (rect.width() - used).max(0.0) / row.len() as f32;
        let mut left = rect.left();
        for &(id, width) in row {
            let place = Rect::from_min_size(egui::pos2(left, rect.top()), vec2(width + share, height));
            left = place.right() + CARD_GAP;
            let mut inner = ui.new_child(UiBuilder::new().max_rect(place).id_salt(("component", id.0)));
            self.card(&mut inner, context, plant, id, commands);
        }
        ui.add_space(CARD_GAP - ui.spacing().item_spacing.y);
    }

    fn card(
        &self,
        ui: &mut Ui,
        context: &Context<'_>,
        plant: &PlantMoment,
        id: ComponentId,
        commands: &mut CommandSender,
    ) {
        let tokens = context.tokens;
        let standing = Standing::new(context, &self.model, plant, id);
        let conflicts = conflicts_with(context, plant, id);
        let outline = match (standing.injected, standing.is_right() && conflicts.is_none()) {
            (Some(_), _) => tokens.error,
            (None, true) => tokens.line,
            (None, false) => tokens.warning,
        };
        let frame = Frame::new()
            .fill(tokens.raised)
            .stroke(Stroke::new(1.0, outline))
            .corner_radius(5.0)
            .inner_margin(CARD_PADDING);
        let size = ui.max_rect().size() - CARD_PADDING.sum();
        frame.show(ui, |ui| {
            ui.set_min_size(size);
            ui.spacing_mut().item_spacing.y = HEAD_GAP;
            ui.horizontal(|ui| {
                ui.set_min_height(HEAD);
                ui.spacing_mut().item_spacing.x = space::S;
                fault_menu(ui, &self.model, id, standing.injected, commands);
                let class = self.model.component(id).map_or("", |component| component.class.as_str());
                let (note, color) = standing.injected.map_or_else(
                    || (class.to_owned(), tokens.text_faint),
                    |mode| (format!("→ {}", self.model.mode_name(id, mode)), tokens.error),
                );
                if let Some(text) = &conflicts {
                    ui.label(RichText::new(text).small().color(tokens.warning));
                }
                // The class, which the button tells too, gives way to the conflicts.
                if conflicts.is_none() || standing.injected.is_some() {
                    ui.add(egui::Label::new(RichText::new(note).small().color(color)).truncate());
                }
            });
            if let Some(machine) = self.machines.get(id.0 as usize) {
                machine.show(ui, context, &self.model, &standing, commands);
            }
        });
    }
}

/// Returns which of the last step's conflicts assume a mode of this component, by their numbers in the list of
/// conflicts.
fn conflicts_with(context: &Context<'_>, plant: &PlantMoment, id: ComponentId) -> Option<String> {
    let conflicts = (1_usize..).zip(hitting_sets::conflicts(context, plant));
    let of_component =
        conflicts.filter(|(_, conflict)| conflict.modes.iter().any(|&(component, _)| component == id));
    let numbers: Vec<String> = of_component.map(|(number, _)| number.to_string()).collect();
    (!numbers.is_empty()).then(|| format!("conflict {}", numbers.join(", ")))
}

/// Whether components fail by chance, and with which seed.
fn chance(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let fault_seed = context.state.automaton.fault_seed();
    let usual = FaultSeed { seed: context.state.automaton.chance.settings.seed, run: None };
    ui.horizontal_wrapped(|ui| {
        let mut is_on = fault_seed.is_some();
        if ui.checkbox(&mut is_on, "Random component faults").changed() {
            commands.send(Command::Automaton(AutomatonCommand::SetFaultSeed(is_on.then_some(usual))));
        }
        match fault_seed {
            Some(FaultSeed { mut seed, run: None }) => {
                let label = ui.label(RichText::new("Fault seed").color(context.tokens.text_muted)).id;
                let field = DragValue::new(&mut seed).speed(0.1);
                let field = ui.add(field).labelled_by(label);
                if field.on_hover_text("The same seed gives the same faults").changed() {
                    let changed = Some(FaultSeed { seed, run: None });
                    commands.send(Command::Automaton(AutomatonCommand::SetFaultSeed(changed)));
                }
            }
            Some(FaultSeed { seed, run: Some(run) }) => {
                let text = format!("as in Monte Carlo run {}, seed {seed}", run + 1);
                ui.label(RichText::new(text).color(context.tokens.text_muted));
            }
            None => {}
        }
    });
}

fn fault_menu(
    ui: &mut Ui,
    model: &Model,
    id: ComponentId,
    injected: Option<u8>,
    commands: &mut CommandSender,
) {
    let Some(component) = model.component(id) else { return };
    let menu = ui.menu_button(component.name.as_str(), |ui| {
        ui.label(RichText::new("Force mode in this step:").small());
        for (mode, data) in (0..=u8::MAX).zip(&component.modes) {
            if theme::structure::choice(ui, injected == Some(mode), data.name.as_str()).clicked() {
                commands.send(Command::Automaton(AutomatonCommand::Inject(id, Some(mode))));
                ui.close();
            }
        }
        ui.separator();
        if theme::structure::choice(ui, injected.is_none(), "Clear fault").clicked() {
            commands.send(Command::Automaton(AutomatonCommand::Inject(id, None)));
            ui.close();
        }
    });
    menu.response.on_hover_text(format!("Inject a fault into {} ({})", component.name, component.class));
}

/// A probability for reading, as an interval where it is not known exactly, with at most this many decimals then.
pub(super) fn percent_between(probability: &Interval, most_decimals: u32) -> String {
    if probability.exact().is_some() {
        return percent(probability.to_f64().0);
    }
    let (low, high) = probability.percents(most_decimals);
    format!("{low}–{high}%")
}

/// A probability for reading: never rounded to certainty.
pub(super) fn percent(probability: f64) -> String {
    let percent = probability * 100.0;
    match percent {
        _ if percent >= 99.995 && probability < 1.0 => ">99.99%".to_owned(),
        _ if percent > 0.0 && percent < 0.005 => "<0.01%".to_owned(),
        _ if percent == 0.0 || percent == 100.0 => format!("{percent:.0}%"),
        _ if (10.0..99.0).contains(&percent) => format!("{percent:.1}%"),
        _ => format!("{percent:.2}%"),
    }
}
