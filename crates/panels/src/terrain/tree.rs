//! The controls that step the growth of search trees, what the last sample did in words, and how planners compare.

use egui::{Rect, RichText, Sense, Stroke, Ui, pos2, vec2};
use glam::Vec2;
use terrain_view::dash::{DASHES, dashed};
use theme::icon::{self, Icon};
use theme::{Tokens, size, space};
use workbench::command::{Command, CommandSender};
use workbench::state::growth::{Counts, GrowthCommand, Planners, Shown};
use workbench::state::terrain::TerrainCommand;

use crate::Context;
use crate::one_line::in_one_line;

/// The controls, when a growth is looked at.
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
                theme::structure::options(ui, "Leg of the traverse");
                for index in 0..shown.goals.len() {
                    let text = format!("{}. to {}", index + 1, goal(index));
                    theme::structure::option_value(ui, &mut leg, index, text);
                }
            });
        picker.response.accessible_name("Leg of the traverse").on_hover_text(shown.name.as_str());
        if leg != shown.leg {
            send(GrowthCommand::ChooseLeg(leg));
        }
        let mut planners = growth.planners;
        let picker = egui::ComboBox::from_id_salt("growth-planner")
            .selected_text(planners.title())
            .width(96.0)
            .show_ui(ui, |ui| {
                theme::structure::options(ui, "Path planner");
                for choice in Planners::ALL {
                    theme::structure::option_value(ui, &mut planners, choice, choice.title());
                }
            });
        picker.response.accessible_name("Path planner");
        if planners != growth.planners {
            send(GrowthCommand::Choose(planners));
        }
        let tokens = context.tokens;
        if icon::button(ui, tokens, Icon::ToStart, "Before the first sample").clicked() {
            send(GrowthCommand::GoTo(0));
        }
        if icon::button(ui, tokens, Icon::StepBack, "Previous sample").clicked() {
            send(GrowthCommand::Step(-1));
        }
        let (sign, name) = if growth.is_playing { (Icon::Pause, "Pause") } else { (Icon::Play, "Play") };
        if icon::button(ui, tokens, sign, name).clicked() {
            send(GrowthCommand::TogglePlaying);
        }
        if icon::button(ui, tokens, Icon::StepForward, "Next sample").clicked() {
            send(GrowthCommand::Step(1));
        }
        if icon::button(ui, tokens, Icon::ToEnd, "Go to last sample").clicked() {
            send(GrowthCommand::GoTo(shown.total()));
        }
        let mut samples = shown.samples();
        ui.spacing_mut().slider_width = (ui.available_width() - 48.0).clamp(60.0, 180.0);
        let slider = egui::Slider::new(&mut samples, 0..=shown.total()).show_value(false);
        if ui.add(slider).accessible_name("Samples").changed() {
            send(GrowthCommand::GoTo(samples));
        }
        // Before the words, which may have no room in this row: alone in the next one no one would know what it closes.
        if icon::button(ui, tokens, Icon::Close, "Hide search tree").clicked() {
            send(GrowthCommand::Close);
        }
        let words = in_one_line(ui, RichText::new(shown.words()).color(tokens.text_muted));
        if words.size().x > ui.available_size_before_wrap().x {
            ui.end_row();
            ui.add_space(space::S);
        }
        ui.label(words);
    });
    if shown.is_race() {
        race(ui, context, shown, commands);
    } else if shown.refusal().is_none() {
        last_sample(ui, context, shown);
    }
}

/// Characters of the longest sentence about a sample, and how wide one is at most, in parts of its size.
const SENTENCE_CHARS: f32 = 170.0;
const CHAR_WIDTH: f32 = 0.55;

/// What the last sample did. It has the room of the longest sentence, so that the ground does not jump as samples come.
fn last_sample(ui: &mut Ui, context: &Context<'_>, shown: &Shown) {
    let width = (ui.available_width() - 2.0 * space::S).max(1.0);
    let lines = (SENTENCE_CHARS * CHAR_WIDTH * size::BODY / width).ceil().clamp(1.0, 4.0);
    let height = lines * ui.text_style_height(&egui::TextStyle::Body);
    let sentence = shown.sentence().unwrap_or_else(|| "Before the first sample.".to_owned());
    ui.horizontal(|ui| {
        ui.add_space(space::S);
        ui.allocate_ui(vec2(width, height), |ui| {
            ui.set_min_height(height);
            ui.vertical(|ui| ui.label(RichText::new(sentence).color(context.tokens.text)));
        });
    });
}

/// A row for each planner: its line on the ground, and what it has done by the sample that is looked at.
fn race(ui: &mut Ui, context: &Context<'_>, shown: &Shown, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let most_height = (0.5 * ui.available_height()).max(60.0);
    egui::ScrollArea::both().id_salt("race").max_height(most_height).show(ui, |ui| {
        let grid = egui::Grid::new("race").num_columns(6).spacing(vec2(space::L, space::XS)).striped(true);
        ui.horizontal(|ui| {
            ui.add_space(space::S);
            grid.show(ui, |ui| {
                for (head, help) in HEADS {
                    let text = RichText::new(head).color(tokens.text_muted);
                    ui.label(text).on_hover_text(help);
                }
                ui.end_row();
                for (at, search) in shown.searches.iter().enumerate() {
                    let planners = search.planner.map_or(Planners::AsPlanned, Planners::One);
                    ui.horizontal(|ui| {
                        swatch(ui, at);
                        if ui.link(planners.title()).on_hover_text("Show only this planner").clicked() {
                            let command = TerrainCommand::Growth(GrowthCommand::Choose(planners));
                            commands.send(Command::Terrain(command));
                        }
                    });
                    if let Some(reason) = search.refusal() {
                        ui.label(reason);
                        ui.end_row();
                        continue;
                    }
                    let Counts { samples, vertices, checks, length_m } = shown.counts_of(at);
                    let is_over = search.is_complete() && samples == search.known();
                    ui.label(if is_over { format!("{samples}, done") } else { samples.to_string() });
                    ui.label(vertices.to_string());
                    ui.label(checks.to_string());
                    ui.label(match length_m {
                        Some(length_m) => format!("{length_m:.1} m"),
                        None if is_over => "not found".to_owned(),
                        None => "not yet".to_owned(),
                    });
                    ui.label(match search.total_millis() {
                        Some(millis) if millis < 10.0 => format!("{millis:.1} ms"),
                        Some(millis) => format!("{millis:.0} ms"),
                        None => "searching".to_owned(),
                    });
                    ui.end_row();
                }
            });
        });
    });
}

/// The columns of a race, and what they count.
const HEADS: [(&str, &str); 6] = [
    ("Planner", "Same terrain, start, goal and seed for all planners"),
    ("Samples", "Random samples drawn"),
    ("Vertices", "Vertices in the search trees"),
    ("Checks", "Segments collision-checked (the dominant cost)"),
    ("Path", "Length of the best path so far, before smoothing"),
    ("Search time", "Total run time on this machine"),
];

/// The line of a planner's path as it is on the ground, which is as dark in both themes.
fn swatch(ui: &mut Ui, search: usize) {
    let (rect, _) = ui.allocate_exact_size(vec2(30.0, 12.0), Sense::hover());
    let Rect { min, max } = rect;
    let line = [Vec2::new(min.x, rect.center().y), Vec2::new(max.x, rect.center().y)];
    let strokes = [Stroke::new(5.0, Tokens::UNDER_LINES), Stroke::new(2.6, theme::DARK.series(search))];
    for stroke in strokes {
        for [from, to] in dashed(&line, DASHES[search % DASHES.len()], 3.0) {
            ui.painter().line_segment([pos2(from.x, from.y), pos2(to.x, to.y)], stroke);
        }
    }
}
