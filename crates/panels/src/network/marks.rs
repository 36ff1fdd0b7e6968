//! Problems of the text as marks on the drawing, which may belong to an older text than they do.

use display::Point;
use egui::{Align2, FontId, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use layout::{Item, NetworkDrawing};
use rmpl::{Severity, Span};
use snapshot::Snapshot;
use theme::Tokens;
use tpn::{ArcId, Network, NodeId, OccurrenceKind};
use workbench::command::{Command, CommandSender};

use super::view::View;

/// A problem at its place on the drawing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) at: Point,
    /// How far below that the texts of its arc reach, in units of the drawing.
    pub(super) below: f64,
    /// The arc that it is about, if it is about one.
    pub(super) arc: Option<ArcId>,
    /// How grave it is.
    pub(super) severity: Severity,
    pub(super) message: String,
    /// Where it is in the latest text.
    pub(super) span: Span,
}

impl Mark {
    fn word(&self) -> &'static str {
        if self.severity == Severity::Error { "Error" } else { "Warning" }
    }

    fn told(&self) -> String {
        format!("{}: {}", self.word(), self.message)
    }
}

/// With more problems than this, the list of problems serves better.
const MAX_MARKS: usize = 40;
/// What shares less than this part of its text with a problem is not what the problem is about.
const MIN_SHARE: f64 = 0.02;
/// From the line of an arc to where a mark hangs, in units of the drawing.
const OUTSIDE: f32 = 14.0;
/// The size of a mark, in points of the screen.
const RADIUS: f32 = 8.0;
/// From one mark to the next at least, with room for a count, in points of the screen.
const ROOM: f32 = 32.0;
/// How wide a count beside a mark is, in points of the screen.
const COUNT: f32 = 18.0;
/// A tooltip tells the messages of this many problems.
const MAX_TOLD: usize = 5;

/// The marks of the problems of `latest` on a drawing of `network`, which was made from the text `source`.
pub(super) fn marks(
    drawing: &NetworkDrawing,
    network: &Network,
    source: &str,
    latest: &Snapshot,
) -> Vec<Mark> {
    let places = places(network);
    let worth = latest.problems.iter().filter(|it| it.severity != Severity::Note).take(MAX_MARKS);
    worth
        .filter_map(|problem| {
            let span = carried(problem.span, &latest.source, source);
            let (_, place) = places
                .iter()
                .map(|&(own, place)| (share(own, span), place))
                .filter(|(share, _)| *share >= MIN_SHARE)
                .max_by(|left, right| left.0.total_cmp(&right.0))?;
            let (at, arc) = match place {
                Place::Arc(arc) => (place_on(drawing, network, arc), Some(arc)),
                Place::Node(node) => (drawing.anchor(node), None),
            };
            let below = arc.map_or(0.0, |arc| texts_below(drawing, network, arc, at));
            let (severity, message) = (problem.severity, crate::without_backticks(&problem.message));
            Some(Mark { at, below, arc, severity, message, span: problem.span })
        })
        .collect()
}

/// The marks in view, those that would cover each other as one.
pub(super) struct Groups(Vec<(Pos2, Vec<usize>)>);

impl Groups {
    /// Those of `marks` that are in view.
    pub(super) fn new(panel: Rect, view: &View, marks: &[Mark]) -> Self {
        Self(grouped(panel, view, marks))
    }

    /// Returns what each covers on the screen.
    pub(super) fn rects(&self) -> impl Iterator<Item = Rect> {
        self.0.iter().map(|(center, members)| {
            let mark = Rect::from_center_size(*center, vec2(2.0 * RADIUS, 2.0 * RADIUS));
            Rect { max: mark.max + vec2(if members.len() > 1 { COUNT } else { 0.0 }, 0.0), ..mark }
        })
    }
}

/// Shows the marks in view; a click goes to the gravest problem's place in the text.
pub(super) fn show(
    ui: &Ui,
    panel: Rect,
    groups: &Groups,
    marks: &[Mark],
    tokens: &Tokens,
    commands: &mut CommandSender,
) {
    let painter = ui.painter_at(panel);
    for (center, members) in &groups.0 {
        let center = *center;
        let [first, others @ ..] = members.as_slice() else { continue };
        let (number, mark) = (*first, &marks[*first]);
        let color = if mark.severity == Severity::Error { tokens.error } else { tokens.warning };
        let area = Rect::from_center_size(center, vec2(2.0 * RADIUS, 2.0 * RADIUS));
        let response =
            ui.interact(area.intersect(panel), ui.scope_id().with(("mark", number)), Sense::click());
        response.widget_info(|| {
            let more =
                if others.is_empty() { String::new() } else { format!(", and {} more here", others.len()) };
            WidgetInfo::labeled(
                Role::Button,
                true,
                format!("{} on the network: {}{more}", mark.word(), mark.message),
            )
        });
        let rim = Stroke::new(1.5, tokens.surface);
        if mark.severity == Severity::Error {
            painter.circle(center, RADIUS, color, rim);
        } else {
            let corner = |angle: f32| center + RADIUS * 1.15 * vec2(angle.sin(), -angle.cos());
            let third = std::f32::consts::TAU / 3.0;
            let corners = vec![corner(0.0), corner(third), corner(2.0 * third)];
            painter.add(Shape::convex_polygon(corners, color, rim));
        }
        let at = pos2(center.x, center.y + if mark.severity == Severity::Error { 0.0 } else { 1.0 });
        let font = FontId::new(11.0, theme::strong_family());
        painter.text(at, Align2::CENTER_CENTER, "!", font.clone(), tokens.surface);
        if !others.is_empty() {
            let at = pos2(center.x + RADIUS + 3.0, center.y);
            let galley = painter.layout_no_wrap(members.len().to_string(), font, color);
            let place = Align2::LEFT_CENTER.anchor_size(at, galley.size());
            painter.rect_filled(place.expand2(vec2(2.0, 0.0)), 3.0, tokens.surface.gamma_multiply(0.85));
            painter.galley(place.min, galley, color);
        }
        if response.clicked() {
            commands.send(Command::Reveal(mark.span));
        }
        let told = members.iter().take(MAX_TOLD).map(|&member| marks[member].told());
        let mut told: Vec<String> = told.collect();
        if members.len() > MAX_TOLD {
            told.push(format!("and {} more", members.len() - MAX_TOLD));
        }
        response.on_hover_text_at_pointer(told.join("\n"));
    }
}

/// The marks in view by position, the gravest of each group first, and where each group is on the screen.
fn grouped(panel: Rect, view: &View, marks: &[Mark]) -> Vec<(Pos2, Vec<usize>)> {
    // Below the line and its texts: names are above it, and what is clicked is on it.
    let below = |mark: &Mark| match view.zoom() {
        zoom if zoom > 0.3 => OUTSIDE.max(mark.below as f32) * zoom as f32,
        _ => 0.0,
    };
    let mut order: Vec<usize> = (0..marks.len()).collect();
    order.sort_by_key(|&number| marks[number].severity);
    let mut groups: Vec<(Pos2, Vec<usize>)> = Vec::new();
    for number in order {
        let mark = &marks[number];
        let center = view.screen_point(panel, mark.at) + vec2(0.0, below(mark) + RADIUS + 3.0);
        if !panel.expand(RADIUS).contains(center) {
            continue;
        }
        match groups.iter_mut().find(|(at, _)| at.distance(center) < ROOM) {
            Some((_, members)) => members.push(number),
            None => groups.push((center, vec![number])),
        }
    }
    groups
}

#[derive(Clone, Copy, Debug)]
enum Place {
    Arc(ArcId),
    Node(NodeId),
}

/// Everything on the drawing that is written somewhere.
fn places(network: &Network) -> Vec<(Span, Place)> {
    let arcs = network.arcs.iter().enumerate();
    let arcs = arcs.filter_map(|(at, arc)| Some((arc.span?, Place::Arc(ArcId::from_index(at)))));
    let labels = network.labels.iter().filter_map(|label| Some((label.span?, Place::Arc(label.arc))));
    let occurrences = network.occurrences.iter().filter(|it| it.kind != OccurrenceKind::Scenario);
    let occurrences =
        occurrences.filter_map(|it| Some((it.span?, it.arc.map_or(Place::Node(it.start), Place::Arc))));
    let decisions = network.decisions.iter().filter_map(|it| Some((it.span?, Place::Node(it.node))));
    arcs.chain(labels).chain(occurrences).chain(decisions).collect()
}

/// Near the end of an arc, where its texts are over.
fn place_on(drawing: &NetworkDrawing, network: &Network, arc: ArcId) -> Point {
    let Some(shape) = drawing.arc(arc) else {
        return network.arcs.get(arc.index()).map_or(Point::default(), |arc| drawing.anchor(arc.from));
    };
    let most = display::geometry::first_part(shape.start, drawing.pieces(shape), 0.8);
    most.last().map_or(shape.start, |piece| piece.end())
}

/// Returns how far the texts of an arc reach below a place on it, where a mark there would cover them.
fn texts_below(drawing: &NetworkDrawing, network: &Network, arc: ArcId, at: Point) -> f64 {
    let is_own = |owner: Item| match owner {
        Item::Arc(owner) => owner == arc,
        Item::Label(label) => network.labels.get(label.index()).is_some_and(|label| label.arc == arc),
        _ => false,
    };
    let beside = f64::from(RADIUS) + 4.0;
    let is_there = |rect: &display::Rect| rect.min.x - beside < at.x && at.x < rect.max.x + beside;
    let own = drawing.texts.iter().filter(|text| is_own(text.owner) && is_there(&text.rect));
    own.map(|text| text.rect.max.y - at.y).fold(0.0, f64::max)
}

/// Returns how much of what either covers both cover; an empty span counts as one character.
fn share(one: Span, other: Span) -> f64 {
    let end = |span: Span| span.end.max(span.start + 1);
    let common = end(one).min(end(other)).saturating_sub(one.start.max(other.start));
    let all = end(one).max(end(other)) - one.start.min(other.start);
    f64::from(common) / f64::from(all.max(1))
}

/// A span of one text in another that differs from it in one place: what lies in that place is all of it.
fn carried(span: Span, from: &str, to: &str) -> Span {
    if from == to {
        return span;
    }
    let same = |(left, right): (u8, u8)| left == right;
    let shorter = from.len().min(to.len());
    let before = from.bytes().zip(to.bytes()).take_while(|&pair| same(pair)).count();
    let behind = from.bytes().rev().zip(to.bytes().rev()).take_while(|&pair| same(pair)).count();
    let behind = behind.min(shorter - before);
    let moved = |offset: u32, otherwise: usize| match offset as usize {
        offset if offset <= before => offset as u32,
        offset if offset >= from.len() - behind => (offset + to.len() - from.len()) as u32,
        _ => otherwise as u32,
    };
    let start = moved(span.start, before);
    Span::new(start, moved(span.end, to.len() - behind).max(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_that_would_cover_each_other_are_one_with_the_gravest_first() {
        let mark = |x: f32, severity: Severity| Mark {
            at: Point { x: x.into(), y: 10.0 },
            below: 0.0,
            arc: None,
            severity,
            message: String::new(),
            span: Span::new(0, 1),
        };
        let panel = Rect::from_min_size(Pos2::ZERO, vec2(1000.0, 400.0));
        let view = View::default();
        let marks =
            [mark(0.0, Severity::Warning), mark(5.0, Severity::Error), mark(300.0, Severity::Warning)];
        let groups = grouped(panel, &view, &marks);
        let members: Vec<_> = groups.into_iter().map(|(_, members)| members).collect();
        assert_eq!(members, [vec![1, 0], vec![2]]);
    }

    #[test]
    fn places_are_found_in_an_older_text() {
        let (old, new) = ("a = { b; c }", "a = { b; b; c }");
        let at = |text: &str, word: &str| {
            let start = text.rfind(word).expect("it is there") as u32;
            Span::new(start, start + word.len() as u32)
        };
        assert_eq!(carried(at(new, "c }"), new, old), at(old, "c }"));
        assert_eq!(carried(Span::new(0, 1), new, old), Span::new(0, 1));
        let inside = carried(Span::new(9, 10), new, old);
        assert!(inside.start <= inside.end && inside.end <= old.len() as u32, "{inside:?}");
    }
}
