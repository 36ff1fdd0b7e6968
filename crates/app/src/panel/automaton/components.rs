//! The components as cards: their modes, the one that is believed, the true one, and the menu that makes one fail.

use egui::{Color32, Frame, Margin, RichText, Stroke, Ui};
use num_traits::ToPrimitive;
use plant::{ComponentId, Model};

use super::title;
use crate::command::{Command, CommandSender};
use crate::panel::Context;
use crate::state::automaton::{AutomatonCommand, PlantMoment};
use crate::theme::space;

/// Shows all cards.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    model: &Model,
    plant: &PlantMoment,
    commands: &mut CommandSender,
) {
    title(ui, context, "Components", "◆ estimated   ● true; press a name to inject a fault");
    for id in model.component_ids() {
        card(ui, context, model, plant, id, commands);
    }
}

fn card(
    ui: &mut Ui,
    context: &Context<'_>,
    model: &Model,
    plant: &PlantMoment,
    id: ComponentId,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let Some(component) = model.component(id) else { return };
    let estimate = plant.belief.most_likely().mode(id);
    let truth = plant.true_state.mode(id);
    let injected = context.state.automaton.next_input().plant.injected.get(&id).copied();
    let likelihoods = plant.belief.marginal(model, id);
    let outline = if estimate == truth { tokens.line } else { tokens.warning };
    let frame = Frame::new()
        .fill(tokens.raised)
        .stroke(Stroke::new(1.0, outline))
        .corner_radius(4.0)
        .inner_margin(Margin::symmetric(6, 3));
    frame.show(ui, |ui| {
        ui.set_min_width(ui.available_width());
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = space::S;
            fault_menu(ui, model, id, injected, commands);
            for (mode, data) in (0_u8..).zip(&component.modes) {
                let likelihood =
                    likelihoods.get(usize::from(mode)).and_then(ToPrimitive::to_f64).unwrap_or(0.0);
                let text = mode_text(&data.name, mode == estimate, mode == truth, likelihood);
                let (color, fill) = match (mode == estimate, mode == truth) {
                    (true, _) => (tokens.text, tokens.accent_soft),
                    (false, true) => (tokens.warning, Color32::TRANSPARENT),
                    _ => (tokens.text_faint, Color32::TRANSPARENT),
                };
                let chip = RichText::new(text).small().color(color).background_color(fill);
                ui.label(chip).on_hover_ui(|ui| transitions(ui, context, model, id, mode));
            }
            if let Some(mode) = injected {
                let text = format!("→ {} in this step", model.mode_name(id, mode));
                ui.label(RichText::new(text).small().color(tokens.error));
            }
        });
    });
}

fn mode_text(name: &str, is_estimate: bool, is_true: bool, likelihood: f64) -> String {
    let mut text = String::new();
    if is_estimate {
        text.push_str("◆ ");
    }
    if is_true {
        text.push_str("● ");
    }
    text.push_str(name);
    if likelihood > 0.0 && likelihood < 1.0 {
        text.push_str(&format!(" {}", percent(likelihood)));
    }
    text
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
        ui.label(RichText::new("In this step, whatever is commanded, it comes into").small());
        for (mode, data) in (0_u8..).zip(&component.modes) {
            if ui.selectable_label(injected == Some(mode), data.name.as_str()).clicked() {
                commands.send(Command::Automaton(AutomatonCommand::Inject(id, Some(mode))));
                ui.close();
            }
        }
        ui.separator();
        if ui.selectable_label(injected.is_none(), "Let it behave").clicked() {
            commands.send(Command::Automaton(AutomatonCommand::Inject(id, None)));
            ui.close();
        }
    });
    menu.response.on_hover_text(format!("{}, a {}: inject a fault", component.name, component.class));
}

/// Where a mode leads.
fn transitions(ui: &mut Ui, context: &Context<'_>, model: &Model, id: ComponentId, mode: u8) {
    let Some(data) = model.component(id).and_then(|component| component.modes.get(usize::from(mode))) else {
        return;
    };
    let tokens = context.tokens;
    ui.label(crate::theme::strong(data.name.as_str()).color(tokens.text));
    for transition in &data.transitions {
        let text = format!("→ {} when {}", model.mode_name(id, transition.to), transition.label);
        ui.label(RichText::new(text).color(tokens.text_muted));
    }
    for fault in &data.faults {
        let text = format!("→ {} with probability {} per step", model.mode_name(id, fault.to), fault.label);
        ui.label(RichText::new(text).color(tokens.warning));
    }
}

/// A probability for reading: never rounded to certainty.
pub(super) fn percent(probability: f64) -> String {
    let percent = probability * 100.0;
    match percent {
        _ if percent >= 99.995 && probability < 1.0 => ">99.99 %".to_owned(),
        _ if percent > 0.0 && percent < 0.005 => "<0.01 %".to_owned(),
        _ if (10.0..99.0).contains(&percent) => format!("{percent:.1} %"),
        _ => format!("{percent:.2} %"),
    }
}
