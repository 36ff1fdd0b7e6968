//! Disturbances of what drives: a vehicle slows down or stops, and something stands in the way.

use egui::{DragValue, RichText, Ui};
use exact::Rational;
use workbench::command::{Command, CommandSender};
use workbench::state::execution::{ExecutionCommand, exact_time};
use workbench::state::terrain::{TerrainCommand, Tool};
use workbench::time_text;

use super::disturb::{BUTTON, name_cell, suffix};
use crate::Context;
use crate::plan::section;

/// How much slower a vehicle becomes, and for how long.
pub(super) struct Vehicles {
    percent: f64,
    duration: f64,
}

impl Default for Vehicles {
    fn default() -> Self {
        Self { percent: 30.0, duration: 20.0 }
    }
}

impl Vehicles {
    pub(super) fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let Some(snapshot) = context.snapshot else { return };
        let declared = &snapshot.program.world.vehicles;
        if snapshot.traverses.is_empty() || declared.is_empty() {
            return;
        }
        let unit = time_text::unit(snapshot.program.options.time_unit);
        let muted = context.tokens.text_muted;
        section(ui, context, "Vehicles and obstacles", "apply only during a traverse");
        ui.horizontal_wrapped(|ui| {
            let name = ui.label(RichText::new("Slow to").color(muted)).id;
            let field = DragValue::new(&mut self.percent).range(1.0..=99.0).speed(0.5).max_decimals(0);
            ui.add(field.suffix("%")).labelled_by(name);
            let name = ui.label(RichText::new("for").color(muted)).id;
            let field = DragValue::new(&mut self.duration).range(0.1..=1e6).speed(0.5).max_decimals(1);
            ui.add(field.suffix(suffix(Some(unit)))).labelled_by(name);
        });
        let duration = exact_time(self.duration);
        for vehicle in declared {
            ui.horizontal(|ui| {
                name_cell(ui, &vehicle.name.text);
                for (text, percent) in [("Stop", 0.0), ("Slow", self.percent)] {
                    let response = ui.add(egui::Button::new(text).min_size(BUTTON));
                    let name = format!("{text} {}", vehicle.name.text);
                    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                    if response.clicked() {
                        let vehicle = vehicle.name.text.clone();
                        let factor = Rational::from_f64_up(percent / 100.0 - 1e-9, 1000).unwrap_or_default();
                        let slower = ExecutionCommand::SlowDown { vehicle, factor, duration };
                        commands.send(Command::Execution(slower));
                    }
                }
            });
        }
        let is_placing = context.state.terrain.tool == Tool::Appear;
        let button = egui::Button::new("Add obstacle…").selected(is_placing).min_size(BUTTON);
        let hint = "Click the map, or drag from the obstacle's center outwards";
        if ui.add(button).on_hover_text(hint).clicked() {
            commands.send(Command::Terrain(TerrainCommand::Take(Tool::Appear)));
        }
    }
}
