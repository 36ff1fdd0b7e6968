//! What a plan is worth, and how far it uses each resource in all its schedules.

use egui::{RichText, Ui};
use exact::Rational;
use snapshot::Planning;
use theme::icon::{self, Icon};
use tpn::worth;
use tpn::{Levels, Network, Plan, Supply};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;

use super::{rows, section, selectable_row};
use crate::Context;

/// The width of a resource's bar, in points.
const BAR_WIDTH: f32 = 120.0;

/// What the plan costs and gives, and whether a better one is possible, where the mission counts anything.
pub(super) fn worth(ui: &mut Ui, context: &Context<'_>, network: &Network, plan: &Plan, planning: &Planning) {
    let figures: Vec<String> =
        worth::measures(network).into_iter().map(|measure| worth::figure(plan, measure)).collect();
    if figures.is_empty() {
        return;
    }
    let tokens = context.tokens;
    section(ui, context, "Objective", "");
    ui.horizontal_wrapped(|ui| {
        for figure in figures {
            ui.label(RichText::new(figure).strong().color(tokens.text));
            ui.add_space(theme::space::M);
        }
    });
    match plan.quality.is_optimal {
        None => {}
        Some(true) => {
            ui.horizontal_wrapped(|ui| {
                icon::label(ui, Icon::Check, tokens.good);
                ui.label(RichText::new("Optimal: no better plan exists.").color(tokens.good));
            });
        }
        Some(false) => {
            let mut text = if context.state.is_improving() {
                "Best plan so far. Searching for a better one.".to_owned()
            } else {
                "Best plan found. Planning stopped before proving it optimal.".to_owned()
            };
            if let Some(bound) = planning.outcome.bound {
                text.push_str(&format!(" No plan can be better than {}.", bound.readable()));
            }
            ui.horizontal_wrapped(|ui| {
                icon::label(ui, Icon::Warning, tokens.warning);
                ui.label(RichText::new(text).color(tokens.warning));
            });
        }
    }
}

/// The uses that planning ordered; then each resource with how far it is used at most, or between which levels it stays.
pub(super) fn resources(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    plan: &Plan,
    commands: &mut CommandSender,
) {
    show_orders(ui, context, network, plan, commands);
    let named = network.resources.iter().zip(&plan.levels).filter(|(it, _)| !it.name.contains('#'));
    let named: Vec<_> = named.collect();
    if !named.is_empty() {
        section(ui, context, "Resources", "over all schedules of the plan");
        for (resource, &levels) in named {
            let Some((text, range)) = figures(resource.supply, levels) else { continue };
            ui.horizontal(|ui| {
                let button = egui::Button::new(RichText::new(resource.name.as_str()).strong());
                let button = ui.add(button.frame_when_inactive(false)).on_hover_text("Go to declaration");
                if let Some(span) = resource.span.filter(|_| button.clicked()) {
                    commands.send(Command::Reveal(span));
                }
                bar(ui, context, range);
                ui.label(RichText::new(text).color(context.tokens.text_muted));
            });
        }
    }
}

fn show_orders(
    ui: &mut Ui,
    context: &Context<'_>,
    network: &Network,
    plan: &Plan,
    commands: &mut CommandSender,
) {
    if plan.uses_ordered.is_empty() {
        return;
    }
    section(ui, context, "Resource orderings", "added by the planner");
    rows(ui, "uses", plan.uses_ordered.len(), |ui, index| {
        let ordering = plan.uses_ordered[index];
        let text = format!("{} before {}", network.use_name(ordering.first), network.use_name(ordering.then));
        let later = network.uses.get(ordering.then.index()).and_then(|used| used.owner);
        let selection = later.map_or(Selection::None, Selection::Occurrence);
        let text = RichText::new(network.readable(&text)).color(context.tokens.ordering);
        selectable_row(ui, context, &selection, text, commands);
    });
}

/// Returns how far a resource is used in words, and as parts of what there is: from, to.
fn figures(supply: Supply, levels: Levels) -> Option<(String, [f32; 2])> {
    match (supply, levels) {
        (Supply::Reusable { capacity }, Levels::Peak(peak)) => {
            let text = format!("peak {} of {}", peak.readable(), capacity.readable());
            Some((text, [0.0, part(peak, [Rational::ZERO, capacity])]))
        }
        (Supply::Reservoir { least, greatest, .. }, Levels::Range { low, high }) => {
            let [from, to, first, last] = [low, high, least, greatest].map(Rational::readable);
            let text = format!("{from} to {to} (allowed {first} to {last})");
            Some((text, [low, high].map(|level| part(level, [least, greatest]))))
        }
        _ => None,
    }
}

fn part(level: Rational, [low, high]: [Rational; 2]) -> f32 {
    let span = high.to_f64() - low.to_f64();
    if span > 0.0 { ((level.to_f64() - low.to_f64()) / span).clamp(0.0, 1.0) as f32 } else { 0.0 }
}

/// The part of what there is that a resource's levels cover.
fn bar(ui: &mut Ui, context: &Context<'_>, [from, to]: [f32; 2]) {
    let tokens = context.tokens;
    let height = 8.0;
    let (rect, _) = ui.allocate_exact_size(egui::vec2(BAR_WIDTH, height), egui::Sense::hover());
    let painter = ui.painter();
    painter.rect_filled(rect, 2.0, tokens.sunken);
    let x = |part: f32| rect.left() + part * rect.width();
    let filled = egui::Rect::from_x_y_ranges(x(from)..=x(to).max(x(from) + 2.0), rect.y_range());
    painter.rect_filled(filled, 2.0, tokens.slack);
    let outline = egui::Stroke::new(1.0, tokens.line_strong);
    painter.rect_stroke(rect, 2.0, outline, egui::StrokeKind::Inside);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resource_is_told_in_words_and_as_a_part_of_what_there_is() {
        let power = Supply::Reusable { capacity: 4.into() };
        let told = figures(power, Levels::Peak(3.into()));
        assert_eq!(told, Some(("peak 3 of 4".to_owned(), [0.0, 0.75])));
        let battery = Supply::Reservoir { least: 20.into(), greatest: 100.into(), level: 80.into() };
        let told = figures(battery, Levels::Range { low: 40.into(), high: 100.into() });
        assert_eq!(told, Some(("40 to 100 (allowed 20 to 100)".to_owned(), [0.25, 1.0])));
        assert_eq!(figures(battery, Levels::Peak(1.into())), None);
    }
}
