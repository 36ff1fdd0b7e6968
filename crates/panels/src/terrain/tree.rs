//! The row of controls that steps the growth of a search tree.

use egui::{RichText, Ui};
use motion::PlannerKind;
use theme::icon::{self, Icon};
use theme::space;
use workbench::command::{Command, CommandSender};
use workbench::state::growth::{GrowthCommand, Shown, planner_title};
use workbench::state::terrain::TerrainCommand;

use crate::Context;

/// The row of controls, when a growth is looked at.
pub(super) fn controls(ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let growth = &context.state.terrain.growth;
    let Some(shown) = growth.shown() else { return };
    let mut send = |command| commands.send(Command::Terrain(TerrainCommand::Growth(command)));
    ui.horizontal_wrapped(|ui| {
        ui.add_space(space::S);
        ui.spacing_mut().item_spacing.x = space::S;
        let mut leg = shown.leg;
        let goal = |leg: usize| shown.goals.get(leg).map_or("", |goal| goal.as_str());
        let picker = egui::ComboBox::from_id_salt("growth-leg")
            .selected_text(format!("to {}", goal(leg)))
            .width(96.0)
            .show_ui(ui, |ui| {
                for index in 0..shown.goals.len() {
                    ui.selectable_value(&mut leg, index, format!("{}. to {}", index + 1, goal(index)));
                }
            });
        picker.response.accessible_name("Leg of the traverse").on_hover_text(shown.name.as_str());
        if leg != shown.leg {
            send(GrowthCommand::ChooseLeg(leg));
        }
        let mut planner = growth.planner;
        let picker = egui::ComboBox::from_id_salt("growth-planner")
            .selected_text(planner_title(planner))
            .width(96.0)
            .show_ui(ui, |ui| {
                use PlannerKind::{Kinodynamic, Rrt, RrtConnect, RrtStar};
                for choice in [None, Some(Rrt), Some(RrtConnect), Some(RrtStar), Some(Kinodynamic)] {
                    ui.selectable_value(&mut planner, choice, planner_title(choice));
                }
            });
        picker.response.accessible_name("Path planner");
        if planner != growth.planner {
            send(GrowthCommand::ChoosePlanner(planner));
        }
        let tokens = context.tokens;
        if icon::button(ui, tokens, Icon::ToStart, "Before the first sample").clicked() {
            send(GrowthCommand::GoTo(0));
        }
        if icon::button(ui, tokens, Icon::StepBack, "One sample back").clicked() {
            send(GrowthCommand::Step(-1));
        }
        let (sign, name) =
            if growth.is_playing { (Icon::Pause, "Stop growing") } else { (Icon::Play, "Let the tree grow") };
        if icon::button(ui, tokens, sign, name).clicked() {
            send(GrowthCommand::TogglePlaying);
        }
        if icon::button(ui, tokens, Icon::StepForward, "One sample more").clicked() {
            send(GrowthCommand::Step(1));
        }
        if icon::button(ui, tokens, Icon::ToEnd, "To the end of the search").clicked() {
            send(GrowthCommand::GoTo(shown.total));
        }
        let mut samples = shown.samples();
        ui.spacing_mut().slider_width = (ui.available_width() - 24.0).clamp(60.0, 180.0);
        let slider = egui::Slider::new(&mut samples, 0..=shown.total).show_value(false);
        if ui.add(slider).accessible_name("Samples").changed() {
            send(GrowthCommand::GoTo(samples));
        }
        ui.add(egui::Label::new(RichText::new(words(shown)).color(tokens.text_muted)).extend());
        if icon::button(ui, tokens, Icon::Close, "Hide the search tree").clicked() {
            send(GrowthCommand::Close);
        }
    });
}

/// How far the search is.
pub(super) fn words(shown: &Shown) -> String {
    if let Some(reason) = shown.refusal() {
        return reason.to_owned();
    }
    let samples = shown.samples();
    let mut text = format!("{samples} of {} samples, {} vertices", shown.total, shown.vertices());
    match shown.length_m() {
        Some(length_m) => text.push_str(&format!(", best path {length_m:.1} m")),
        None if samples == shown.total && shown.total > 0 => text.push_str(", no path found"),
        None => text.push_str(", no path yet"),
    }
    text
}
