//! The growth of a search tree on the ground, and the row of controls that steps it.

use egui::{RichText, Ui};
use glam::Vec2;
use motion::PlannerKind;
use workbench::command::{Command, CommandSender};
use workbench::state::growth::{GrowthCommand, Shown, planner_title};
use workbench::state::terrain::TerrainCommand;

use super::scene::{SceneInput, cased_line, faded, place};
use super::shapes::{Shapes, circle_outline};
use crate::icon::{self, Icon};
use crate::panel::Context;
use crate::theme::space;

/// Draws the trees as they stand, the last sample, and the best path.
pub(super) fn draw(shapes: &mut Shapes, input: &SceneInput<'_>) {
    let Some(shown) = input.growth.shown() else { return };
    let palette = input.palette;
    let standing = shown.standing();
    let color = |tree: usize| palette.trees[tree.min(palette.trees.len() - 1)];
    for (tree, way) in &standing.edges {
        for pair in way.windows(2) {
            let ends = [place(pair[0]), place(pair[1])];
            shapes.draped_line(input.ground, ends, 3.4, faded(palette.under, 0.55));
            shapes.draped_line(input.ground, ends, 1.6, color(*tree));
        }
    }
    for (tree, &root) in standing.roots_m.iter().enumerate() {
        disc(shapes, input, place(root), color(tree));
    }
    for pair in standing.path_m.iter().flat_map(|path| path.windows(2)) {
        let ends = [place(pair[0]), place(pair[1])];
        cased_line(shapes, input.ground, ends, 3.6, palette.light, palette.under);
    }
    if let Some((sample, is_blocked)) = standing.sample {
        let (sample, arm) = (place(sample), 0.8 * input.options.vehicle_scale);
        let color = if is_blocked { palette.warning } else { palette.light };
        for side in [Vec2::new(arm, arm), Vec2::new(arm, -arm)] {
            cased_line(shapes, input.ground, [sample - side, sample + side], 2.4, color, palette.under);
        }
    }
}

fn disc(shapes: &mut Shapes, input: &SceneInput<'_>, center_m: Vec2, color: [f32; 4]) {
    let corners = circle_outline(center_m, 0.8 * input.options.vehicle_scale);
    for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        cased_line(shapes, input.ground, [from, to], 2.4, color, input.palette.under);
    }
}

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
