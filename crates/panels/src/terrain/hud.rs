//! What is written over the ground: names, scale bar, north arrow, coordinates, legends, and what a tool waits for.

use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, StrokeKind, pos2, vec2};
use glam::{Vec2, Vec3};
use snapshot::Snapshot;
use terrain_view::camera::Camera;
use terrain_view::decal::AMPLE_M;
use terrain_view::ground::Ground;
use terrain_view::scale::{round_step, vehicle_scale};
use terrain_view::scene;
use terrain_view::volume::Volume;
use theme::{Tokens, size};
use workbench::state::Selection;
use workbench::state::settings::{Coloring, TerrainView};

use super::MARGIN;
use super::labels::{self, Label, Rank};
use crate::Context;

/// Everything the overlay needs.
pub struct Overlay<'a> {
    /// Paints inside the image only.
    pub painter: &'a egui::Painter,
    pub rect: Rect,
    pub camera: &'a Camera,
    pub ground: &'a Ground,
    pub snapshot: &'a Snapshot,
    pub context: &'a Context<'a>,
    /// What is shown.
    pub view: &'a TerrainView,
}

impl Overlay<'_> {
    /// Paints everything; answers the plates of names with what they name. `clearance_of` is the vehicle model whose
    /// clearance map is shown.
    pub fn paint(
        &self,
        pointer: Option<Pos2>,
        hint: Option<&str>,
        clearance_of: Option<&str>,
    ) -> Vec<(Rect, Selection)> {
        let images = self.vehicle_images();
        let labels = if self.view.names { self.labels(&images) } else { Vec::new() };
        let corner = Rect::from_min_size(self.rect.right_top() - vec2(52.0, 0.0), vec2(52.0, 52.0));
        let taken: Vec<Rect> = images.into_iter().flatten().chain([corner]).collect();
        let plates = labels::paint(self.painter, self.tokens(), self.rect.shrink(2.0), &labels, &taken);
        if self.rect.width() > 160.0 && self.rect.height() > 120.0 {
            self.scale_bar();
            self.north_arrow();
            self.legends(clearance_of);
        }
        if let Some(hint) = hint {
            self.hint(hint);
        }
        if let Some(pointer) = pointer {
            self.coordinates(pointer);
        }
        plates
    }

    fn tokens(&self) -> &'static Tokens {
        self.context.tokens
    }

    /// Returns where a place appears in the window.
    pub fn at(&self, point_m: Vec3) -> Option<Pos2> {
        let size = Vec2::new(self.rect.width(), self.rect.height());
        let point = self.camera.project(point_m, size)?;
        Some(self.rect.min + vec2(point.x, point.y))
    }

    /// Returns where the images of vehicles are in the window, by their index; `None` for those that are not seen.
    fn vehicle_images(&self) -> Vec<Option<Rect>> {
        let image = |vehicle| {
            let corners_m = scene::vehicle_box_m(&scene::VehicleBox {
                snapshot: self.snapshot,
                ground: self.ground,
                vehicle,
                time: self.context.state.playback.time,
                vehicle_scale: vehicle_scale(self.camera.distance_m),
            })?;
            let corners: Option<Vec<Pos2>> = corners_m.into_iter().map(|corner| self.at(corner)).collect();
            Some(Rect::from_points(&corners?).intersect(self.rect)).filter(Rect::is_positive)
        };
        (0..self.snapshot.program.world.vehicles.len()).map(image).collect()
    }

    /// The names that are to be written, in the window.
    fn labels(&self, images: &[Option<Rect>]) -> Vec<Label> {
        let world = &self.snapshot.program.world;
        let state = self.context.state;
        let mut labels = Vec::new();
        let mut add = |around: Rect, text: &str, color: Color32, rank: Rank, names: Selection| {
            let is_selected = state.selection == names;
            let is_chosen = is_selected || state.hovered == names;
            labels.push(Label {
                around,
                text: text.to_owned(),
                color: if is_selected { self.tokens().accent } else { color },
                rank: if is_chosen { Rank::Chosen } else { rank },
                names,
            });
        };
        for (index, (vehicle, image)) in world.vehicles.iter().zip(images).enumerate() {
            let Some(image) = image else { continue };
            let name = &vehicle.name.text;
            let color = self.tokens().series(index);
            add(*image, name, color, Rank::Vehicle, Selection::Vehicle(name.clone()));
        }
        let point = |at_m: Vec3| self.at(at_m).map(Rect::from_pos);
        let driven: Vec<&str> = self
            .snapshot
            .traverses
            .iter()
            .flat_map(|traverse| &traverse.legs)
            .map(|leg| leg.to.as_str())
            .collect();
        for location in &world.locations {
            let name = &location.name.text;
            let rank = if driven.contains(&name.as_str()) { Rank::OnPath } else { Rank::Place };
            let place_m = scene::place(location.position_m);
            let (top, foot) =
                (point(self.ground.drape(place_m, scene::POST_M)), point(self.ground.drape(place_m, 0.0)));
            let Some(top) = top else { continue };
            // Where a vehicle stands at the location, the name goes beside the vehicle.
            let stands_there = |image: &&Rect| foot.is_some_and(|foot| image.contains(foot.center()));
            let around = images.iter().flatten().find(stands_there).copied().unwrap_or(top);
            add(around, name, self.tokens().text, rank, Selection::Location(name.clone()));
        }
        let obstacles = world.obstacles.iter().filter(|_| self.view.obstacles);
        for obstacle in obstacles {
            let name = &obstacle.name.text;
            let top_m = Volume::new(scene::outline(&obstacle.shape)).top_m(self.ground);
            let Some(top) = point(top_m) else { continue };
            add(top, name, self.tokens().text_muted, Rank::Obstacle, Selection::Obstacle(name.clone()));
        }
        labels
    }

    /// What a tool waits for, on a plate at the top.
    fn hint(&self, text: &str) {
        let font = FontId::proportional(size::BODY);
        let width = self.rect.width() - 4.0 * MARGIN;
        let galley = self.painter.layout(text.to_owned(), font, self.tokens().text, width);
        let top = self.rect.center_top() + vec2(-galley.size().x / 2.0, MARGIN * 1.5);
        let plate = Rect::from_min_size(top, galley.size()).expand2(vec2(10.0, 5.0));
        let tokens = self.tokens();
        self.painter.rect(plate, 6.0, tokens.raised, Stroke::new(1.0, tokens.accent), StrokeKind::Inside);
        self.painter.galley(top, galley, tokens.text);
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

    /// The legends of what the colors of the ground mean.
    fn legends(&self, clearance_of: Option<&str>) {
        let mut left = self.rect.left() + MARGIN;
        let [low, high] = self.ground.range_m.map(|height| height / self.view.height_scale);
        let own = match self.view.coloring {
            Coloring::Natural => None,
            Coloring::Slope => Some(("Slope".to_owned(), "0°".to_owned(), "34°".to_owned(), false)),
            Coloring::Height => {
                Some(("Height".to_owned(), format!("{low:.1} m"), format!("{high:.1} m"), false))
            }
        };
        let room = clearance_of.map(|model| {
            (format!("Clearance for {model}"), "0 m".to_owned(), format!("{AMPLE_M:.0} m or more"), true)
        });
        for (title, low, high, has_none) in own.into_iter().chain(room) {
            left += self.legend(left, &title, &low, &high, has_none) + MARGIN;
        }
    }

    /// A color ramp with its ends named; answers how wide it is. `has_none` adds the color of places without room.
    fn legend(&self, left: f32, title: &str, low: &str, high: &str, has_none: bool) -> f32 {
        const NONE: &str = "no clearance";
        let tokens = self.tokens();
        let font = FontId::proportional(size::SMALL);
        let galley = |text: &str| self.painter.layout_no_wrap(text.to_owned(), font.clone(), tokens.text);
        let texts = [galley(title), galley(low), galley(high), galley(NONE)];
        let [title_text, low_text, high_text, none_text] = texts;
        let words =
            low_text.size().x.max(high_text.size().x).max(if has_none { none_text.size().x } else { 0.0 });
        let width = (title_text.size().x).max(18.0 + words) + 2.0 * MARGIN;
        let tall = (self.rect.height() * 0.3).clamp(48.0, 110.0);
        let top = self.rect.top() + MARGIN;
        let bar = Rect::from_min_size(pos2(left + MARGIN, top + 22.0), vec2(12.0, tall));
        let bottom = bar.bottom() + if has_none { 24.0 } else { 7.0 };
        self.plate(Rect::from_min_max(pos2(left, top), pos2(left + width, bottom)));
        let steps = 24;
        for step in 0..steps {
            let part = step as f32 / steps as f32;
            let cell_top = bar.bottom() - (part + 1.0 / steps as f32) * bar.height();
            let size = vec2(bar.width(), bar.height() / steps as f32 + 0.5);
            let cell = Rect::from_min_size(pos2(bar.left(), cell_top), size);
            self.painter.rect_filled(cell, 0.0, Tokens::ramp(part));
        }
        self.painter.galley(pos2(left + MARGIN, top + 4.0), title_text, tokens.text);
        let beside = bar.right() + 6.0;
        self.painter.galley(pos2(beside, bar.top() - 2.0), high_text, tokens.text);
        self.painter.galley(pos2(beside, bar.bottom() - 13.0), low_text, tokens.text);
        if has_none {
            let swatch = Rect::from_min_size(pos2(bar.left(), bar.bottom() + 6.0), vec2(12.0, 12.0));
            self.painter.rect(
                swatch,
                0.0,
                Tokens::NO_ROOM,
                Stroke::new(1.0, tokens.line_strong),
                StrokeKind::Inside,
            );
            self.painter.galley(pos2(beside, swatch.top() - 1.0), none_text, tokens.text);
        }
        width
    }
}
