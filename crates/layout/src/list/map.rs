//! A world from above as a display list: ground, obstacles, places and paths. North is up.

use display::{
    Anchor, ColorRole, Dash, DisplayList, Fit, Group, Point, Rect, Stroke, TargetKind, Text,
    approximate_text_width, text_width_at,
};
use nalgebra::{Point2, Vector2};
use rmpl::program::{ObstacleShape, World};
use smol_str::{SmolStr, format_smolstr};

/// Which part of the world is shown, in meters east and north, and where in the drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapFrame {
    low_m: Point2<f64>,
    high_m: Point2<f64>,
    /// The frame of the drawing.
    pub rect: Rect,
    /// Drawing units per metre.
    scale: f64,
}

/// A path on a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPath<'a> {
    pub name: &'a str,
    /// From point to point.
    pub points_m: Vec<Point2<f64>>,
    /// Its line, told from others by its pattern as well.
    pub stroke: Stroke,
}

/// The brightness of the ground at a point, from 0 to 255.
pub type Relief<'a> = &'a dyn Fn(Point2<f64>) -> u8;

/// Squares of shaded ground along the longer side.
const SHADES: f64 = 96.0;
/// Radius of the dot of a place, and the size of its name.
const PLACE: (f64, f64) = (4.0, 11.0);
/// Names of places in the right fifth of the map stand left of them.
const RIGHT_PART: f64 = 0.8;
/// From the corner to the scale.
const SCALE_INSET: f64 = 14.0;

impl MapFrame {
    /// Shows everything from `low_m` to `high_m` in the middle of `rect`, `margin` inside it.
    pub fn new(low_m: Point2<f64>, high_m: Point2<f64>, rect: Rect, margin: f64) -> Self {
        let size_m = (high_m - low_m).sup(&Vector2::repeat(1.0));
        let room = rect.expanded(-margin);
        let scale = (room.width() / size_m.x).min(room.height() / size_m.y).max(1e-9);
        Self { low_m, high_m, rect, scale }
    }

    /// The same ground in a drawing whose longer side has this length.
    pub fn with_side(low_m: Point2<f64>, high_m: Point2<f64>, side: f64) -> Self {
        let size_m = (high_m - low_m).sup(&Vector2::repeat(1.0));
        let scale = side / size_m.max();
        let rect = Rect::new(0.0, 0.0, size_m.x * scale, size_m.y * scale);
        Self { low_m, high_m, rect, scale }
    }

    /// Returns where a place of the world is.
    pub fn point(&self, place_m: Point2<f64>) -> Point {
        let offset = (place_m - self.middle_m()) * self.scale;
        self.rect.center().shifted(offset.x, -offset.y)
    }

    /// Returns which place of the world is at a point.
    fn place_m(&self, point: Point) -> Point2<f64> {
        let center = self.rect.center();
        self.middle_m() + Vector2::new(point.x - center.x, center.y - point.y) / self.scale
    }

    fn middle_m(&self) -> Point2<f64> {
        nalgebra::center(&self.low_m, &self.high_m)
    }
}

/// The part of the world that holds all places, obstacles and `more`, with some room around; `None` for an empty one.
pub fn extent_m(world: &World, more: impl Iterator<Item = Point2<f64>>) -> Option<[Point2<f64>; 2]> {
    let places = world.locations.iter().map(|it| Point2::from(it.position_m));
    let mut corners: Vec<Point2<f64>> = places.chain(more).collect();
    let first = *corners.first()?;
    for obstacle in &world.obstacles {
        match &obstacle.shape {
            ObstacleShape::Circle { center_m, radius_m } => {
                let reach = Vector2::repeat(*radius_m);
                corners.extend([Point2::from(*center_m) - reach, Point2::from(*center_m) + reach]);
            }
            ObstacleShape::Polygon { corners_m } => {
                corners.extend(corners_m.iter().copied().map(Point2::from));
            }
        }
    }
    let (low, high) =
        corners.iter().fold((first, first), |(low, high), corner| (low.inf(corner), high.sup(corner)));
    let margin = Vector2::repeat(0.06 * (high - low).max().max(10.0));
    Some([low - margin, high + margin])
}

/// The map of a world with paths in it. Linear in the world, the paths and, with `relief`, the squares of its ground.
pub fn map_list(
    world: &World,
    paths: &[MapPath<'_>],
    frame: &MapFrame,
    relief: Option<Relief<'_>>,
) -> DisplayList {
    let mut list = DisplayList::new(frame.rect);
    list.begin(Group { clip: Some(frame.rect), ..Group::default() });
    list.rectangle(frame.rect, 0.0, Some(ColorRole::Sunken.into()), None);
    if let Some(relief) = relief {
        add_ground(frame, relief, &mut list);
    }
    add_obstacles(world, frame, &mut list);
    for (number, path) in (0..).zip(paths) {
        let points: Vec<Point> = path.points_m.iter().map(|&point| frame.point(point)).collect();
        list.polyline(&points, path.stroke).stands_for(TargetKind::Path, number);
        list.entitle(path.name);
    }
    add_places(world, frame, &mut list);
    add_scale(frame, &mut list);
    list
}

/// The line of a path of this number: colors repeat after eight, patterns after three.
pub fn path_stroke(number: usize) -> Stroke {
    let dash = [Dash::Solid, Dash::Dashed, Dash::Dotted][number % 3];
    Stroke::solid(ColorRole::Series((number % 8) as u8), 2.5).dashed(dash)
}

/// Ground in squares. Squares of one shade that touch in a row are one rectangle.
fn add_ground(frame: &MapFrame, relief: Relief<'_>, list: &mut DisplayList) {
    let rect = frame.rect;
    let side = rect.width().max(rect.height()) / SHADES;
    let (columns, rows) = ((rect.width() / side).round() as u32, (rect.height() / side).round() as u32);
    for row in 0..rows {
        let top = rect.min.y + f64::from(row) * side;
        let shade_at = |column: u32| {
            let left = rect.min.x + f64::from(column) * side;
            relief(frame.place_m(Point::new(left + side / 2.0, top + side / 2.0)))
        };
        let mut column = 0;
        while column < columns {
            let shade = shade_at(column);
            let mut end = column + 1;
            while end < columns && shade_at(end) == shade {
                end += 1;
            }
            let left = rect.min.x + f64::from(column) * side;
            // A little overlap hides the seams between squares.
            let square = Rect::new(left, top, rect.min.x + f64::from(end) * side + 0.4, top + side + 0.4);
            list.rectangle(square, 0.0, Some(ColorRole::Relief(shade).into()), None);
            column = end;
        }
    }
}

fn add_obstacles(world: &World, frame: &MapFrame, list: &mut DisplayList) {
    for (number, obstacle) in (0..).zip(&world.obstacles) {
        // Nothing is in a keep-out area.
        let (dash, opacity) = if obstacle.is_solid() { (Dash::Solid, 0.22) } else { (Dash::Dashed, 0.08) };
        let fill = Some(ColorRole::Threat.faint(opacity).into());
        let stroke = Some(Stroke::solid(ColorRole::Threat, 1.0).dashed(dash));
        let item = match &obstacle.shape {
            ObstacleShape::Circle { center_m, radius_m } => {
                list.circle(frame.point((*center_m).into()), radius_m * frame.scale, fill, stroke)
            }
            ObstacleShape::Polygon { corners_m } => {
                let corners: Vec<Point> =
                    corners_m.iter().map(|&corner| frame.point(corner.into())).collect();
                list.polygon(&corners, fill, stroke)
            }
        };
        item.stands_for(TargetKind::Obstacle, number);
        list.entitle(obstacle.name.text.clone());
    }
}

fn add_places(world: &World, frame: &MapFrame, list: &mut DisplayList) {
    let (radius, size) = PLACE;
    for (number, location) in (0..).zip(&world.locations) {
        let at = frame.point(location.position_m.into());
        let stroke = Stroke::solid(ColorRole::Text, 1.5);
        list.circle(at, radius, Some(ColorRole::NodeFill.into()), Some(stroke))
            .stands_for(TargetKind::Place, number);
        // Names stay inside the drawing.
        let is_right = at.x > frame.rect.min.x + frame.rect.width() * RIGHT_PART;
        let width = text_width_at(&location.name.text, size, &approximate_text_width);
        let left = if is_right { at.x - radius - 4.0 - width } else { at.x + radius + 4.0 };
        write_plated(location.name.text.clone(), left, at.y - size, width, is_right, list)
            .stands_for(TargetKind::Place, number);
    }
}

fn add_scale(frame: &MapFrame, list: &mut DisplayList) {
    let length_m = round_step(frame.rect.width() / frame.scale, 6.0);
    let start = Point::new(frame.rect.min.x + SCALE_INSET, frame.rect.max.y - SCALE_INSET);
    let end = start.shifted(length_m * frame.scale, 0.0);
    list.line(start, end, Stroke::solid(ColorRole::Text, 2.0));
    let text = format_smolstr!("{length_m} m");
    let width = text_width_at(&text, PLACE.1, &approximate_text_width);
    write_plated(text, start.x, start.y - PLACE.1 - 4.0, width, false, list);
}

fn write_plated(
    text: SmolStr,
    left: f64,
    top: f64,
    width: f64,
    is_right: bool,
    list: &mut DisplayList,
) -> &mut display::Item {
    let place = Rect::new(left, top, left + width, top + PLACE.1);
    let anchor = if is_right { Anchor::End } else { Anchor::Start };
    let text = Text::new(text, PLACE.1, place).anchored(anchor, Fit::Overflow);
    list.write(Text { plate: Some(ColorRole::Surface.faint(0.8)), ..text })
}

/// A round step that divides `range` into about `wanted` parts: 1, 2 or 5 times a power of ten.
fn round_step(range: f64, wanted: f64) -> f64 {
    let rough = (range / wanted).max(f64::MIN_POSITIVE);
    let mut power = 1.0;
    while power > rough {
        power /= 10.0;
    }
    while power * 10.0 <= rough {
        power *= 10.0;
    }
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|step| *step >= rough)
        .unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        assert_eq!([round_step(800.0, 8.0), round_step(33.0, 8.0), round_step(0.9, 10.0)], [100.0, 5.0, 0.1]);
    }

    #[test]
    fn north_is_up_and_the_ground_fills_its_frame() {
        let frame = MapFrame::with_side(Point2::new(100.0, 200.0), Point2::new(300.0, 300.0), 400.0);
        assert_eq!(frame.rect, Rect::new(0.0, 0.0, 400.0, 200.0));
        assert_eq!(frame.point(Point2::new(100.0, 300.0)), Point::new(0.0, 0.0));
        assert_eq!(frame.point(Point2::new(300.0, 200.0)), Point::new(400.0, 200.0));
        let place_m = Point2::new(150.0, 220.0);
        assert_eq!(frame.place_m(frame.point(place_m)), place_m);
    }

    #[test]
    fn patterns_tell_paths_of_one_color_apart() {
        let strokes: Vec<_> = (0..24).map(path_stroke).collect();
        let differ = |one: usize, other: usize| strokes[one] != strokes[other];
        assert!((0..24).all(|one| (0..24).all(|other| one == other || differ(one, other))));
    }
}
