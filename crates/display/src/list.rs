//! The list itself: shapes with their fill and stroke, in groups that lie over each other.

use smol_str::SmolStr;

use crate::color::Color;
use crate::geometry::{Piece, Point, Rect, curve_bounds};
use crate::index::SpatialIndex;
use crate::text::Text;

/// A drawing as shapes, in the order in which they are drawn.
#[derive(Clone, Debug, Default)]
pub struct DisplayList {
    /// Everything lies inside.
    pub frame: Rect,
    groups: Vec<Group>,
    /// The item that each group begins with.
    starts: Vec<u32>,
    items: Vec<Item>,
    pieces: Vec<Piece>,
    texts: Vec<Text>,
    /// What some items represent in words, by their place; ascending.
    titles: Vec<(u32, SmolStr)>,
    index: Option<SpatialIndex<u32>>,
}

/// Items that are drawn in the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Group {
    /// Groups of several lists are drawn in the order of their layers; in one list layers ascend.
    pub layer: u8,
    /// Nothing is drawn outside.
    pub clip: Option<Rect>,
    /// With more than this many in view, they are drawn thin and faint, and not at all from very far: a cloud of lines
    /// says nothing.
    pub crowd: Option<u32>,
    /// Whether lines lie so close where the drawing is small that full strength would make an area of them.
    pub is_dense: bool,
    /// On the screen, lines are at least so broad and circles have at least this radius, in points.
    pub min_size: f32,
}

/// A shape with its fill and its stroke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Item {
    pub shape: Shape,
    pub fill: Option<Fill>,
    pub stroke: Option<Stroke>,
    /// At which zooms it is drawn.
    pub detail: Detail,
    /// What it represents, if that can be selected.
    pub target: Option<Target>,
}

/// The form of an item.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A line through straight and curved pieces.
    Path {
        /// Where it begins.
        start: Point,
        /// Its pieces, by [`DisplayList::pieces`].
        pieces: Run,
        end: PathEnd,
    },
    /// An upright rectangle.
    Rectangle {
        rect: Rect,
        /// The radius of its corners.
        corner: f64,
    },
    Circle {
        center: Point,
        radius: f64,
    },
    /// A text, by its place; see [`DisplayList::text`].
    Text(u32),
}

/// Some pieces of a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    first: u32,
    count: u32,
}

/// How a path ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    Open,
    /// With an arrow head in the color of the line.
    Head,
    /// Where it began: a polygon.
    Closed,
}

/// What an item is filled with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fill {
    Solid(Color),
    /// Slanted lines.
    Hatched(Color),
}

/// How a line is drawn: color, width and pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    pub color: Color,
    /// Its width in drawing units.
    pub width: f64,
    pub dash: Dash,
}

/// The pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dash {
    Solid,
    Dashed,
    Dotted,
}

/// From which zoom on, and up to which, something is drawn. Files are drawn at zoom 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// The least zoom.
    pub from: f32,
    /// The zoom at which it is no longer drawn.
    pub to: f32,
}

/// What an item represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Target {
    /// What kind of thing.
    pub kind: TargetKind,
    pub id: u32,
}

/// Kinds of things that can be selected on a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TargetKind {
    /// An event of a network.
    Node,
    /// A constraint of a network.
    Arc,
    Label,
    /// A block of a program.
    Block,
    /// An activity, assertion or delay.
    Occurrence,
    /// A causal link of a plan.
    Link,
    /// An ordering that planning added.
    Ordering,
    /// A primitive location of an automaton.
    Location,
    /// A transition of an automaton.
    Transition,
    /// A composite location of an automaton.
    Composite,
    /// A mode of a component.
    Mode,
    /// A place on a map.
    Place,
    /// An obstacle on a map.
    Obstacle,
    /// A path on a map.
    Path,
}

/// Length of an arrow head.
pub const ARROW_LENGTH: f64 = 7.0;
/// Half the breadth of an arrow head.
pub const ARROW_HALF_BREADTH: f64 = 3.5;

impl DisplayList {
    /// A list with nothing in it yet; all that will be lies inside `frame`.
    pub fn new(frame: Rect) -> Self {
        Self { frame, ..Self::default() }
    }

    /// Begins a group; what is added from now on belongs to it. Its layer is not below that of the group before.
    pub fn begin(&mut self, group: Group) {
        debug_assert!(self.groups.last().is_none_or(|last| last.layer <= group.layer), "layers ascend");
        self.groups.push(group);
        self.starts.push(self.items.len() as u32);
    }

    /// Adds a line of straight and curved pieces.
    pub fn path(&mut self, start: Point, pieces: &[Piece], end: PathEnd, stroke: Stroke) -> &mut Item {
        let run = self.run(pieces.iter().copied());
        self.push(Shape::Path { start, pieces: run, end }, None, Some(stroke))
    }

    /// Adds a straight line.
    pub fn line(&mut self, from: Point, to: Point, stroke: Stroke) -> &mut Item {
        self.path(from, &[Piece::Line(to)], PathEnd::Open, stroke)
    }

    /// Adds lines from point to point.
    pub fn polyline(&mut self, points: &[Point], stroke: Stroke) -> &mut Item {
        let run = self.run(points.iter().skip(1).map(|&point| Piece::Line(point)));
        let start = points.first().copied().unwrap_or_default();
        self.push(Shape::Path { start, pieces: run, end: PathEnd::Open }, None, Some(stroke))
    }

    /// Adds a polygon.
    pub fn polygon(&mut self, corners: &[Point], fill: Option<Fill>, stroke: Option<Stroke>) -> &mut Item {
        let run = self.run(corners.iter().skip(1).map(|&point| Piece::Line(point)));
        let start = corners.first().copied().unwrap_or_default();
        self.push(Shape::Path { start, pieces: run, end: PathEnd::Closed }, fill, stroke)
    }

    /// Adds a rectangle.
    pub fn rectangle(
        &mut self,
        rect: Rect,
        corner: f64,
        fill: Option<Fill>,
        stroke: Option<Stroke>,
    ) -> &mut Item {
        self.push(Shape::Rectangle { rect, corner }, fill, stroke)
    }

    /// Adds a circle.
    pub fn circle(
        &mut self,
        center: Point,
        radius: f64,
        fill: Option<Fill>,
        stroke: Option<Stroke>,
    ) -> &mut Item {
        self.push(Shape::Circle { center, radius }, fill, stroke)
    }

    /// Adds a text on top of what there is.
    pub fn write(&mut self, text: Text) -> &mut Item {
        let place = self.texts.len() as u32;
        self.texts.push(text);
        self.push(Shape::Text(place), None, None)
    }

    /// Says in words what the item that was added last represents.
    pub fn entitle(&mut self, title: impl Into<SmolStr>) {
        if let Some(last) = self.items.len().checked_sub(1) {
            self.titles.push((last as u32, title.into()));
        }
    }

    /// The list with an index by place. Linear in its items.
    #[must_use]
    pub fn indexed(mut self) -> Self {
        let all = (0..self.items.len() as u32).map(|at| (self.bounds_of(&self.items[at as usize]), at));
        let all: Vec<(Rect, u32)> = all.collect();
        // What sticks out of the frame is found all the same.
        self.index = Some(SpatialIndex::new(self.frame, all));
        self
    }

    /// All items, in the order in which they are drawn.
    pub fn items(&self) -> &[Item] {
        &self.items
    }

    /// The groups with the places of their items.
    pub fn groups(&self) -> impl Iterator<Item = (&Group, std::ops::Range<usize>)> {
        let ends = self.starts.iter().skip(1).map(|&end| end as usize).chain([self.items.len()]);
        let ranges = self.starts.iter().zip(ends).map(|(&start, end)| start as usize..end);
        self.groups.iter().zip(ranges)
    }

    /// The pieces of a path.
    pub fn pieces(&self, run: Run) -> &[Piece] {
        let first = run.first as usize;
        self.pieces.get(first..first + run.count as usize).unwrap_or(&[])
    }

    /// The text of a [`Shape::Text`].
    pub fn text(&self, place: u32) -> &Text {
        &self.texts[place as usize]
    }

    /// All texts, in the order in which they were added.
    pub fn texts(&self) -> &[Text] {
        &self.texts
    }

    /// Returns what the item at `place` represents, in words.
    pub fn title(&self, place: usize) -> Option<&str> {
        let found = self.titles.binary_search_by_key(&(place as u32), |(place, _)| *place).ok()?;
        self.titles.get(found).map(|(_, title)| title.as_str())
    }

    /// Everything that an item covers, but for half the width of its line.
    pub fn bounds_of(&self, item: &Item) -> Rect {
        match item.shape {
            Shape::Path { start, pieces, .. } => curve_bounds(start, self.pieces(pieces)),
            Shape::Rectangle { rect, .. } => rect,
            Shape::Circle { center, radius } => Rect::around(center, radius),
            Shape::Text(place) => self.text(place).bounds(),
        }
    }

    /// Calls `visit` with the place of every item that touches `area`, in no particular order. With an index it takes time
    /// in proportion to what is found, and leaves out what is less than `min_size` wide and high.
    pub fn visit(&self, area: Rect, min_size: f64, visit: &mut dyn FnMut(u32)) {
        if let Some(index) = &self.index {
            index.visit(area, min_size, visit);
            return;
        }
        let is_seen = |at: &u32| self.bounds_of(&self.items[*at as usize]).touches(area);
        (0..self.items.len() as u32).filter(is_seen).for_each(visit);
    }

    fn run(&mut self, pieces: impl Iterator<Item = Piece>) -> Run {
        let first = self.pieces.len() as u32;
        self.pieces.extend(pieces);
        Run { first, count: self.pieces.len() as u32 - first }
    }

    fn push(&mut self, shape: Shape, fill: Option<Fill>, stroke: Option<Stroke>) -> &mut Item {
        if self.groups.is_empty() {
            self.begin(Group::default());
        }
        let at = self.items.len();
        self.items.push(Item { shape, fill, stroke, detail: Detail::ALWAYS, target: None });
        &mut self.items[at]
    }
}

impl Item {
    /// Draws it only at these zooms.
    pub fn at(&mut self, detail: Detail) -> &mut Self {
        self.detail = detail;
        self
    }

    /// Says what it represents.
    pub fn stands_for(&mut self, kind: TargetKind, id: u32) -> &mut Self {
        self.target = Some(Target { kind, id });
        self
    }
}

impl Detail {
    /// Drawn at all zooms.
    pub const ALWAYS: Self = Self { from: 0.0, to: f32::INFINITY };

    /// From this zoom on.
    pub const fn from(zoom: f64) -> Self {
        Self { from: zoom as f32, to: f32::INFINITY }
    }

    /// Below this zoom.
    pub const fn below(zoom: f64) -> Self {
        Self { from: 0.0, to: zoom as f32 }
    }

    /// Returns whether something is drawn at this zoom.
    pub fn holds(self, zoom: f64) -> bool {
        let zoom = zoom as f32;
        self.from <= zoom && zoom < self.to
    }
}

impl Fill {
    /// The color, with or without a pattern.
    pub const fn color(self) -> Color {
        match self {
            Self::Solid(color) | Self::Hatched(color) => color,
        }
    }
}

impl<C: Into<Color>> From<C> for Fill {
    fn from(color: C) -> Self {
        Self::Solid(color.into())
    }
}

impl Stroke {
    /// An unbroken line.
    pub fn solid(color: impl Into<Color>, width: f64) -> Self {
        Self { color: color.into(), width, dash: Dash::Solid }
    }

    /// The same line in this pattern.
    #[must_use]
    pub fn dashed(self, dash: Dash) -> Self {
        Self { dash, ..self }
    }
}

impl Dash {
    /// Lengths of a mark and of a gap; `None` for an unbroken line.
    pub const fn lengths(self) -> Option<(f64, f64)> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some((7.0, 4.0)),
            Self::Dotted => Some((2.0, 3.5)),
        }
    }
}

/// The tip of a path's head and the point that it comes from.
pub fn tip(start: Point, pieces: &[Piece]) -> Option<(Point, Point)> {
    let (last, before) = pieces.split_last()?;
    let start = before.last().map_or(start, |piece| piece.end());
    Some((last.end(), last.before_end(start)))
}

/// The corners of an arrow head at `tip` for a line that comes from `before`.
pub fn arrow_head(tip: Point, before: Point) -> [Point; 3] {
    let direction = before.direction_to(tip);
    let base = tip.shifted(-direction.x * ARROW_LENGTH, -direction.y * ARROW_LENGTH);
    let (across_x, across_y) = (-direction.y * ARROW_HALF_BREADTH, direction.x * ARROW_HALF_BREADTH);
    [tip, base.shifted(across_x, across_y), base.shifted(-across_x, -across_y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::ColorRole;

    fn list() -> DisplayList {
        let mut list = DisplayList::new(Rect::new(0.0, 0.0, 1000.0, 500.0));
        list.begin(Group::default());
        list.rectangle(list.frame, 0.0, Some(ColorRole::Sunken.into()), None);
        list.begin(Group { layer: 3, ..Group::default() });
        for at in 0..100 {
            list.circle(Point::new(f64::from(at) * 10.0, 20.0), 4.0, None, None)
                .stands_for(TargetKind::Node, at);
        }
        list.entitle("the last");
        list
    }

    #[test]
    fn groups_hold_what_was_added_after_they_began() {
        let list = list();
        let groups: Vec<_> = list.groups().map(|(group, range)| (group.layer, range)).collect();
        assert_eq!(groups, [(0, 0..1), (3, 1..101)]);
        assert_eq!((list.title(100), list.title(3)), (Some("the last"), None));
    }

    #[test]
    fn the_index_finds_what_all_items_looked_at_one_by_one_do() {
        let list = list().indexed();
        let area = Rect::new(203.0, 0.0, 251.0, 30.0);
        let mut found = Vec::new();
        list.visit(area, 2.0, &mut |at| found.push(at as usize));
        found.sort_unstable();
        let touching = |at: &usize| list.bounds_of(&list.items()[*at]).touches(area);
        assert_eq!(found, (0..list.items().len()).filter(touching).collect::<Vec<_>>());
        let mut large = Vec::new();
        list.visit(area, 9.0, &mut |at| large.push(at));
        assert_eq!(large, [0], "the circles are too small");
    }

    #[test]
    fn detail_is_a_range_of_zooms_with_its_lower_end() {
        let detail = Detail { from: 0.5, to: 2.0 };
        assert!(!detail.holds(0.49) && detail.holds(0.5) && detail.holds(1.0) && !detail.holds(2.0));
        assert!(Detail::below(0.3).holds(0.0) && !Detail::below(0.3).holds(1.0));
    }

    #[test]
    fn an_arrow_head_points_along_the_end_of_its_line() {
        let [tip, left, right] = arrow_head(Point::new(10.0, 0.0), Point::default());
        assert_eq!(tip, Point::new(10.0, 0.0));
        assert_eq!((left.x, right.x), (3.0, 3.0));
        assert_eq!(left.y, -right.y);
    }
}
