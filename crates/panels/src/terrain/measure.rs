//! The measuring tool: distances, the height profile and the line of sight between two places.

use egui::{Color32, Pos2, Rect, RichText, Sense, Shape, Stroke, Ui, pos2, vec2};
use glam::Vec3;
use nalgebra::{Point2, Point3, distance};
use terrain::{GroundProfile, LineOfSight, Terrain};
use terrain_view::ground::Ground;
use terrain_view::scene::{Sketch, place};
use theme::{Tokens, space};

/// What was measured between two places.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// The two places.
    pub ends_m: [Point2<f64>; 2],
    /// The ground between them.
    pub profile: GroundProfile,
    /// Whether they see each other.
    pub sight: LineOfSight,
}

/// How high the eyes are over the ground: as high as the cameras on a rover's mast.
pub const EYE_HEIGHT_M: f64 = 1.5;

impl Measurement {
    /// Measures between two places; `None` when one of them is not on the map.
    pub fn new(map: &Terrain, ends_m: [Point2<f64>; 2]) -> Option<Self> {
        let [from, to] = ends_m;
        Some(Self {
            ends_m,
            profile: map.profile(from, to)?,
            sight: map.line_of_sight(from, to, [EYE_HEIGHT_M; 2])?,
        })
    }

    /// The rows of the card: what, and how much.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let profile = &self.profile;
        let [up, down] = profile.climb_m;
        vec![
            ("Surface distance", meters(profile.ground_m)),
            ("Straight-line distance", meters(profile.straight_m)),
            ("Ascent, descent", format!("{up:.1} m, {down:.1} m")),
            ("Steepest slope", format!("{:.0}°", profile.slope_max_rad.to_degrees())),
            ("Line of sight", self.sight_words()),
        ]
    }

    /// Whether the ends see each other, and what is in the way.
    pub fn sight_words(&self) -> String {
        match self.blocked() {
            None => "clear".to_owned(),
            Some((away_m, _)) => format!("blocked after {}", meters(away_m)),
        }
    }

    /// Returns how far along the line the view is blocked, and where.
    fn blocked(&self) -> Option<(f64, Point3<f64>)> {
        let at = self.sight.blocked_at_m?;
        let [from, _] = self.ends_m;
        Some((distance(&from, &at.xy()), at))
    }

    /// Returns what to draw on the ground.
    pub fn sketch(&self, ground: &Ground, height_scale: f32) -> Sketch {
        let ends = self.ends_m.map(place);
        let eyes = ends.map(|end| ground.drape(end, EYE_HEIGHT_M as f32 * height_scale));
        Sketch {
            lines: vec![ends],
            sights: vec![(eyes[0], eyes[1], self.sight.blocked_at_m.is_none())],
            marks: ends.to_vec(),
            blocked: self.blocked().map(|(_, at)| {
                let at = place(at.xy());
                Vec3::new(at.x, at.y, ground.height_at(at))
            }),
            disc: None,
        }
    }
}

/// A distance as people read it.
pub fn meters(value: f64) -> String {
    match value {
        value if value >= 10_000.0 => format!("{:.2} km", value / 1000.0),
        value if value >= 100.0 => format!("{value:.0} m"),
        value => format!("{value:.1} m"),
    }
}

/// The rows of a card: what on the left, how much on the right, each read as one by assistive technologies.
pub fn show_rows(ui: &mut Ui, tokens: &Tokens, rows: &[(&'static str, String)]) {
    ui.spacing_mut().interact_size.y = 15.0;
    for (what, how_much) in rows {
        ui.horizontal(|ui| {
            ui.label(RichText::new(*what).small().color(tokens.text_muted));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(how_much).small().color(tokens.text));
            });
        });
    }
}

/// The height profile as a small chart, with the line of sight and where it is blocked.
pub fn show_chart(ui: &mut Ui, tokens: &Tokens, measurement: &Measurement) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 62.0), Sense::hover());
    let points = &measurement.profile.points_m;
    let heights = || points.iter().map(|point| point.y);
    let (low, high) = heights().fold((f64::MAX, f64::MIN), |(low, high), up| (low.min(up), high.max(up)));
    let name = format!("Height profile: {low:.1} m to {high:.1} m over {}", meters(last_of(points)));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &name));
    let chart = Chart {
        rect: rect.shrink2(vec2(0.0, space::S)),
        length_m: last_of(points).max(1e-6),
        heights_m: [low, (high + EYE_HEIGHT_M).max(low + 1.0)],
    };
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 4.0, tokens.sunken);
    let line: Vec<Pos2> = points.iter().map(|point| chart.at(point.x, point.y)).collect();
    for pair in line.windows(2) {
        let floor = chart.rect.bottom() + space::S;
        let corners = vec![pair[0], pair[1], pos2(pair[1].x, floor), pos2(pair[0].x, floor)];
        painter.add(Shape::convex_polygon(corners, ground_color(tokens), Stroke::NONE));
    }
    painter.add(Shape::line(line, Stroke::new(1.6, tokens.text)));
    if let (Some(first), Some(last)) = (points.first(), points.last()) {
        let eyes = [first, last].map(|point| chart.at(point.x, point.y + EYE_HEIGHT_M));
        let blocked = measurement.blocked();
        let color = if blocked.is_some() { tokens.warning } else { tokens.good };
        painter.extend(Shape::dashed_line(&eyes, Stroke::new(1.4, color), 4.0, 3.0));
        if let Some((along, at)) = blocked {
            painter.circle_filled(chart.at(along, at.z), 3.5, tokens.warning);
        }
    }
    let written = |at: Pos2, align, text: String| {
        let font = egui::FontId::proportional(theme::size::SMALL);
        painter.text(at, align, text, font, tokens.text_muted);
    };
    written(rect.left_top() + vec2(4.0, 1.0), egui::Align2::LEFT_TOP, format!("{high:.1} m"));
    written(rect.left_bottom() + vec2(4.0, -1.0), egui::Align2::LEFT_BOTTOM, format!("{low:.1} m"));
}

struct Chart {
    rect: Rect,
    length_m: f64,
    heights_m: [f64; 2],
}

impl Chart {
    fn at(&self, along_m: f64, up_m: f64) -> Pos2 {
        let [low, high] = self.heights_m;
        let right = (along_m / self.length_m) as f32;
        let up = ((up_m - low) / (high - low)) as f32;
        pos2(self.rect.left() + right * self.rect.width(), self.rect.bottom() - up * self.rect.height())
    }
}

fn last_of(points: &[Point2<f64>]) -> f64 {
    points.last().map_or(0.0, |point| point.x)
}

fn ground_color(tokens: &Tokens) -> Color32 {
    tokens.mixed(tokens.text_muted, 0.35)
}

#[cfg(test)]
mod tests {
    use terrain::GridFrame;

    use super::*;

    #[test]
    fn a_measurement_says_distances_and_what_blocks_the_view() {
        let wall = |index: u32| if (48..52).contains(&(index % 100)) { 10.0 } else { 0.0 };
        let map = Terrain::new(GridFrame::new(100, 100, 1.0), (0..100 * 100).map(wall).collect());
        let measured =
            Measurement::new(&map, [Point2::new(20.5, 50.5), Point2::new(80.5, 50.5)]).expect("on the map");
        let rows = measured.rows();
        assert!(rows.contains(&("Straight-line distance", "60.0 m".to_owned())), "{rows:?}");
        assert!(rows.contains(&("Ascent, descent", "10.0 m, 10.0 m".to_owned())), "{rows:?}");
        let (_, sight) = rows.last().expect("the view");
        assert!(sight.starts_with("blocked after 27") || sight.starts_with("blocked after 28"), "{sight}");
        let beside =
            Measurement::new(&map, [Point2::new(20.5, 50.5), Point2::new(20.5, 80.5)]).expect("on the map");
        assert_eq!(beside.sight_words(), "clear");
        assert!(Measurement::new(&map, [Point2::new(20.5, 50.5), Point2::new(200.0, 50.5)]).is_none());
    }
}
