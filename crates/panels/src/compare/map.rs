//! The paths of both plans from above: the first dashed, the second solid.

use egui::{Align2, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo};
use mission::compare::{Comparison, Way};
use rmpl::program::{ObstacleShape, World};
use theme::space;

use crate::Context;

/// The drawing is at most this wide and high.
const LARGEST: [f32; 2] = [560.0, 320.0];

/// Shows the paths.
pub(super) fn show(ui: &mut Ui, context: &Context<'_>, comparison: &Comparison) {
    let Some(snapshot) = context.snapshot else { return };
    let world = &snapshot.program.world;
    let ways = comparison.paths.iter().flat_map(|pair| pair.before.iter().chain(&pair.after));
    let mut points: Vec<[f64; 2]> = ways.flat_map(|way| way.points_m.iter().copied()).collect();
    points.extend(world.locations.iter().map(|location| location.position_m));
    let Some(extent) = Extent::of(&points) else { return };
    ui.add_space(space::S);
    let width = ui.available_width().min(LARGEST[0]);
    let height = (width * extent.height_per_width()).clamp(120.0, LARGEST[1]);
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, height), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, words(comparison)));
    if !ui.is_rect_visible(rect) {
        return;
    }
    let tokens = context.tokens;
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.rect_filled(rect, 4.0, tokens.sunken);
    let view = View { rect: rect.shrink(22.0), extent };
    obstacles(&painter, context, world, &view);
    for pair in &comparison.paths {
        if let Some(way) = &pair.before {
            let line = view.line(way);
            painter.extend(Shape::dashed_line(&line, Stroke::new(2.0, tokens.text_muted), 6.0, 5.0));
        }
        if let Some(way) = &pair.after {
            painter.add(Shape::line(view.line(way), Stroke::new(2.0, tokens.slack)));
        }
    }
    let font = TextStyle::Small.resolve(ui.style());
    for location in &world.locations {
        let at = view.at(location.position_m);
        painter.circle(at, 3.0, tokens.surface, Stroke::new(1.5, tokens.text));
        let is_right = at.x > rect.right() - 90.0;
        let (offset, align) =
            if is_right { (-6.0, Align2::RIGHT_BOTTOM) } else { (6.0, Align2::LEFT_BOTTOM) };
        let name = &location.name.text;
        painter.text(at + egui::vec2(offset, -2.0), align, name, font.clone(), tokens.text_muted);
    }
    painter.rect_stroke(rect, 4.0, Stroke::new(1.0, tokens.line), StrokeKind::Inside);
    let note = "Dashed: before. Solid: after. North is up.";
    ui.label(egui::RichText::new(note).small().color(tokens.text_muted));
}

fn obstacles(painter: &egui::Painter, context: &Context<'_>, world: &World, view: &View) {
    let tokens = context.tokens;
    let (fill, stroke) =
        (tokens.mixed(tokens.threat, 0.15), Stroke::new(1.0, tokens.mixed(tokens.threat, 0.5)));
    for obstacle in &world.obstacles {
        match &obstacle.shape {
            ObstacleShape::Circle { center_m, radius_m } => {
                painter.circle(view.at(*center_m), (radius_m * view.scale()) as f32, fill, stroke);
            }
            ObstacleShape::Polygon { corners_m } => {
                let points: Vec<Pos2> = corners_m.iter().map(|&corner| view.at(corner)).collect();
                painter.add(Shape::closed_line(points, stroke));
            }
        }
    }
}

/// The ground that is shown, in metres.
#[derive(Clone, Copy)]
struct Extent {
    low_m: [f64; 2],
    high_m: [f64; 2],
}

impl Extent {
    fn of(points_m: &[[f64; 2]]) -> Option<Self> {
        let first = *points_m.first()?;
        let (low_m, high_m) = points_m.iter().fold((first, first), |(low, high), point| {
            ([low[0].min(point[0]), low[1].min(point[1])], [high[0].max(point[0]), high[1].max(point[1])])
        });
        Some(Self { low_m, high_m })
    }

    fn size_m(self) -> [f64; 2] {
        [0, 1].map(|axis| (self.high_m[axis] - self.low_m[axis]).max(1.0))
    }

    fn height_per_width(self) -> f32 {
        let [width, height] = self.size_m();
        (height / width) as f32
    }
}

struct View {
    rect: Rect,
    extent: Extent,
}

impl View {
    /// Points per metre.
    fn scale(&self) -> f64 {
        let [width, height] = self.extent.size_m();
        (f64::from(self.rect.width()) / width).min(f64::from(self.rect.height()) / height)
    }

    fn at(&self, [east, north]: [f64; 2]) -> Pos2 {
        let middle = [0, 1].map(|axis| f64::midpoint(self.extent.low_m[axis], self.extent.high_m[axis]));
        let offset = egui::vec2(
            ((east - middle[0]) * self.scale()) as f32,
            ((middle[1] - north) * self.scale()) as f32,
        );
        self.rect.center() + offset
    }

    fn line(&self, way: &Way) -> Vec<Pos2> {
        way.points_m.iter().map(|&point| self.at(point)).collect()
    }
}

fn words(comparison: &Comparison) -> String {
    let lengths: Vec<String> = comparison
        .paths
        .iter()
        .map(|pair| {
            let length = |way: &Option<Way>| {
                way.as_ref().map_or_else(|| "none".to_owned(), |way| format!("{:.1} m", way.length_m))
            };
            format!("{}: before {}, after {}", pair.name, length(&pair.before), length(&pair.after))
        })
        .collect();
    format!("Paths of both plans from above. {}", lengths.join(". "))
}
