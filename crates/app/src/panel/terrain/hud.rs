//! What is written over the ground: names, scale bar, north arrow, coordinates, legend; and the row of switches.

use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, StrokeKind, pos2, vec2};
use glam::{Vec2, Vec3};
use mission::Snapshot;

use super::MARGIN;
use super::camera::Camera;
use super::ground::Ground;
use super::scene;
use crate::panel::Context;
use crate::state::Selection;
use crate::state::settings::{Coloring, TerrainView};
use crate::theme::{Tokens, size};

/// Everything the overlay needs.
pub struct Overlay<'a> {
    /// Paints inside the image only.
    pub painter: &'a egui::Painter,
    /// The image.
    pub rect: Rect,
    /// The view.
    pub camera: &'a Camera,
    /// The ground.
    pub ground: &'a Ground,
    /// The mission.
    pub snapshot: &'a Snapshot,
    /// The state.
    pub context: &'a Context<'a>,
    /// What is shown.
    pub view: &'a TerrainView,
}

/// A colour as the shaders want it.
pub fn rgba(color: Color32) -> [f32; 4] {
    color.to_array().map(|channel| f32::from(channel) / 255.0)
}

/// How much larger than life vehicles are drawn: so large that they can be seen.
pub fn vehicle_scale(distance_m: f32) -> f32 {
    (distance_m / 45.0).clamp(1.0, 12.0)
}

/// Metres between grid lines.
pub fn grid_spacing_m(distance_m: f32) -> f32 {
    round_step(distance_m / 6.0)
}

/// The largest of 1, 2, 5, 10, … that is not above `value`.
fn round_step(value: f32) -> f32 {
    let power = 10.0_f32.powf(value.max(1e-3).log10().floor());
    let factor = [5.0, 2.0].into_iter().find(|factor| power * factor <= value).unwrap_or(1.0);
    power * factor
}

/// A message in place of the image.
pub fn message(ui: &mut egui::Ui, tokens: &Tokens, text: &str) {
    ui.centered_and_justified(|ui| ui.label(egui::RichText::new(text).color(tokens.text_muted)));
}

/// The switches above the image.
pub fn toolbar(
    ui: &mut egui::Ui,
    view: &mut TerrainView,
    camera: Option<&mut Camera>,
    follow: &mut Option<usize>,
    snapshot: &Snapshot,
) {
    ui.horizontal_wrapped(|ui| {
        egui::ComboBox::from_id_salt("terrain-coloring")
            .selected_text(coloring_name(view.coloring))
            .show_ui(ui, |ui| {
                for coloring in [Coloring::Natural, Coloring::Height, Coloring::Slope] {
                    ui.selectable_value(&mut view.coloring, coloring, coloring_name(coloring));
                }
            })
            .response
            .accessible_name("Colours of the ground")
            .on_hover_text("What the colours of the ground mean");
        ui.menu_button("Show", |ui| {
            for (value, name, help) in [
                (&mut view.paths, "Paths", "The paths of the plan's traverses"),
                (&mut view.trees, "Search trees", "The trees that found the paths"),
                (&mut view.names, "Names", "Names of places and vehicles"),
                (&mut view.obstacles, "Obstacles", "Declared obstacles"),
                (&mut view.contours, "Contours", "Lines of equal height"),
                (&mut view.grid, "Grid", "A grid in mission coordinates"),
            ] {
                ui.checkbox(value, name).on_hover_text(help);
            }
        });
        if let Some(camera) = camera
            && ui.button("Top view").on_hover_text("Look straight down, north up").clicked()
        {
            *camera = camera.top_view();
        }
        let vehicles = &snapshot.program.world.vehicles;
        if !vehicles.is_empty() {
            let name = |index: usize| vehicles.get(index).map_or("", |vehicle| vehicle.name.text.as_str());
            let shown =
                follow.map_or_else(|| "Free camera".to_owned(), |index| format!("Follow {}", name(index)));
            let picker =
                egui::ComboBox::from_id_salt("terrain-follow").selected_text(shown).show_ui(ui, |ui| {
                    ui.selectable_value(follow, None, "Free camera");
                    for index in 0..vehicles.len() {
                        ui.selectable_value(follow, Some(index), format!("Follow {}", name(index)));
                    }
                });
            picker.response.accessible_name("Camera");
        }
    });
}

const fn coloring_name(coloring: Coloring) -> &'static str {
    match coloring {
        Coloring::Natural => "Natural",
        Coloring::Height => "Height",
        Coloring::Slope => "Slope",
    }
}

impl Overlay<'_> {
    /// Paints everything.
    pub fn paint(&self, pointer: Option<Pos2>) {
        if self.view.names {
            self.names();
        }
        self.scale_bar();
        self.north_arrow();
        if self.view.coloring != Coloring::Natural {
            self.legend();
        }
        if let Some(pointer) = pointer {
            self.coordinates(pointer);
        }
    }

    fn tokens(&self) -> &'static Tokens {
        self.context.tokens
    }

    /// Where a place appears in the window.
    pub fn at(&self, point_m: Vec3) -> Option<Pos2> {
        let size = Vec2::new(self.rect.width(), self.rect.height());
        let point = self.camera.project(point_m, size)?;
        Some(self.rect.min + vec2(point.x, point.y))
    }

    fn names(&self) {
        let world = &self.snapshot.program.world;
        let selection = &self.context.state.selection;
        let mut taken: Vec<Rect> = Vec::new();
        let time = self.context.state.playback.time;
        for (index, vehicle) in world.vehicles.iter().enumerate() {
            let Some((place, _)) = scene::vehicle_pose(self.snapshot, index, time) else { continue };
            let lift = 2.0 * vehicle_scale(self.camera.distance_m);
            let selected = *selection == Selection::Vehicle(vehicle.name.text.clone());
            let color = if selected { self.tokens().accent } else { self.tokens().series(index) };
            self.tag(self.ground.drape(place, lift), &vehicle.name.text, color, true, &mut taken);
        }
        for location in &world.locations {
            let selected = *selection == Selection::Location(location.name.text.clone());
            let color = if selected { self.tokens().accent } else { self.tokens().text };
            let top = self.ground.drape(scene::place(location.position_m), 7.5);
            self.tag(top, &location.name.text, color, selected, &mut taken);
        }
        if !self.view.obstacles {
            return;
        }
        for obstacle in &world.obstacles {
            let selected = *selection == Selection::Obstacle(obstacle.name.text.clone());
            let outline = scene::outline(&obstacle.shape);
            let middle = outline.iter().copied().sum::<Vec2>() / outline.len().max(1) as f32;
            let color = if selected { self.tokens().accent } else { self.tokens().text_muted };
            self.tag(self.ground.drape(middle, 4.0), &obstacle.name.text, color, selected, &mut taken);
        }
    }

    /// A name on a small plate above its place; names that would cover others are left out, unless they matter.
    fn tag(&self, point_m: Vec3, text: &str, color: Color32, matters: bool, taken: &mut Vec<Rect>) {
        let Some(at) = self.at(point_m).filter(|at| self.rect.contains(*at)) else { return };
        let galley = self.painter.layout_no_wrap(text.to_owned(), FontId::proportional(size::SMALL), color);
        let mut plate = Rect::from_center_size(at - vec2(0.0, 9.0), galley.size() + vec2(8.0, 3.0));
        if !matters && taken.iter().any(|other| other.intersects(plate)) {
            return;
        }
        // Names that matter are stacked instead.
        while let Some(other) = taken.iter().find(|other| other.intersects(plate)) {
            plate = plate.translate(vec2(0.0, other.top() - plate.bottom() - 2.0));
        }
        taken.push(plate);
        let tokens = self.tokens();
        self.painter.rect(
            plate,
            4.0,
            tokens.surface.gamma_multiply(0.86),
            Stroke::new(1.0, tokens.line),
            StrokeKind::Outside,
        );
        self.painter.galley(plate.center() - galley.size() / 2.0, galley, color);
    }

    fn plate(&self, rect: Rect) {
        let tokens = self.tokens();
        self.painter.rect_filled(rect, 4.0, tokens.surface.gamma_multiply(0.82));
    }

    fn scale_bar(&self) {
        let target = self.camera.target_m;
        let right = Vec3::new(self.camera.yaw_rad.sin(), -self.camera.yaw_rad.cos(), 0.0);
        let (Some(middle), Some(aside)) = (self.at(target), self.at(target + right)) else { return };
        let points_per_m = (aside - middle).length().max(1e-4);
        let length_m = round_step(self.rect.width() * 0.22 / points_per_m);
        let width = length_m * points_per_m;
        let right_end = self.rect.right_bottom() - vec2(MARGIN * 2.0, MARGIN * 2.0);
        let left_end = right_end - vec2(width, 0.0);
        let label =
            if length_m >= 1000.0 { format!("{} km", length_m / 1000.0) } else { format!("{length_m} m") };
        let plate = Rect::from_min_max(left_end - vec2(MARGIN, 18.0), right_end + vec2(MARGIN, 7.0));
        self.plate(plate);
        let stroke = Stroke::new(1.5, self.tokens().text);
        self.painter.line_segment([left_end, right_end], stroke);
        for end in [left_end, right_end] {
            self.painter.line_segment([end - vec2(0.0, 4.0), end + vec2(0.0, 1.0)], stroke);
        }
        let font = FontId::proportional(size::SMALL);
        let above = pos2(f32::midpoint(left_end.x, right_end.x), left_end.y - 3.0);
        self.painter.text(above, Align2::CENTER_BOTTOM, label, font, self.tokens().text);
    }

    fn north_arrow(&self) {
        let center = self.rect.right_top() + vec2(-26.0, 26.0);
        let north = vec2(-self.camera.yaw_rad.cos(), -self.camera.yaw_rad.sin());
        let ahead = vec2(north.x, north.y * self.camera.pitch_rad.sin().max(0.35));
        self.painter.circle_filled(center, 17.0, self.tokens().surface.gamma_multiply(0.82));
        let tip = center + ahead * 11.0;
        let across = vec2(-ahead.y, ahead.x).normalized() * 4.5;
        let tail = center - ahead * 6.0;
        let color = self.tokens().text;
        self.painter.add(egui::Shape::convex_polygon(
            vec![tip, tail + across, tail - across],
            color,
            Stroke::NONE,
        ));
        let label = center + ahead * 11.0 + ahead.normalized() * 7.0;
        self.painter.text(label, Align2::CENTER_CENTER, "N", FontId::proportional(size::SMALL), color);
    }

    fn coordinates(&self, pointer: Pos2) {
        let size_points = Vec2::new(self.rect.width(), self.rect.height());
        let inside = pointer - self.rect.min;
        let (origin, direction) = self.camera.ray(Vec2::new(inside.x, inside.y), size_points);
        let Some(hit) = self.ground.hit(origin, direction) else { return };
        let normal = self.ground.normal_at(hit.truncate(), self.ground.cell_m);
        let steepness = (normal.truncate().length() / normal.z / self.view.height_scale).atan().to_degrees();
        let height = hit.z / self.view.height_scale;
        let text = format!("E {:.1}  N {:.1}   {height:.2} m   slope {steepness:.0}°", hit.x, hit.y);
        let font = FontId::monospace(size::SMALL);
        let galley = self.painter.layout_no_wrap(text, font, self.tokens().text);
        let corner = self.rect.left_bottom() + vec2(MARGIN, -MARGIN - galley.size().y);
        self.plate(Rect::from_min_size(corner, galley.size()).expand(4.0));
        self.painter.galley(corner, galley, self.tokens().text);
    }

    fn legend(&self) {
        let tokens = self.tokens();
        let bar = Rect::from_min_size(self.rect.left_top() + vec2(MARGIN * 2.0, 26.0), vec2(12.0, 110.0));
        let (title, low, high) = match self.view.coloring {
            Coloring::Slope => ("Slope", "0°".to_owned(), "34°".to_owned()),
            _ => {
                let [low, high] = self.ground.range_m.map(|height| height / self.view.height_scale);
                ("Height", format!("{low:.1} m"), format!("{high:.1} m"))
            }
        };
        self.plate(Rect::from_min_max(bar.min - vec2(8.0, 20.0), bar.max + vec2(52.0, 10.0)));
        let steps = 22;
        for step in 0..steps {
            let part = step as f32 / steps as f32;
            let top = bar.bottom() - (part + 1.0 / steps as f32) * bar.height();
            let cell = Rect::from_min_size(
                pos2(bar.left(), top),
                vec2(bar.width(), bar.height() / steps as f32 + 0.5),
            );
            self.painter.rect_filled(cell, 0.0, Tokens::ramp(part));
        }
        let font = FontId::proportional(size::SMALL);
        let write = |at: Pos2, align, text: &str| {
            self.painter.text(at, align, text, font.clone(), tokens.text);
        };
        write(bar.left_top() - vec2(2.0, 4.0), Align2::LEFT_BOTTOM, title);
        write(bar.right_top() + vec2(6.0, 0.0), Align2::LEFT_TOP, &high);
        write(bar.right_bottom() + vec2(6.0, 0.0), Align2::LEFT_BOTTOM, &low);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_numbers_below_the_value() {
        for (value, expected) in
            [(1.0, 1.0), (3.0, 2.0), (7.0, 5.0), (49.0, 20.0), (0.7, 0.5), (900.0, 500.0)]
        {
            assert!((round_step(value) - expected).abs() < 1e-4, "{value}: {}", round_step(value));
        }
    }
}
