//! Another plan of the same mission, such as the one that was approved, laid over the drawing of a network: an outline
//! around what it does not have, dashes and a word along what it did at other times, and crossed names for what is gone.

use std::collections::BTreeMap;

use display::{
    Anchor, ColorRole, Dash, Detail, DisplayList, Fit, Group, Measure, PathEnd, Point, Rect, Stroke, Text,
    Weight, text_width_at,
};
use smol_str::SmolStr;
use tpn::{ArcId, Network, Occurrence, OccurrenceId, OccurrenceKind, Plan};

use crate::drawing::NetworkDrawing;
use crate::timeline::before::{BarChange, Before, Gone};

/// What differs of a network's plan from another plan, by the activities, assertions and delays in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetworkChanges {
    /// What is new, or was at other times, in the order of the text.
    pub changes: Vec<(OccurrenceId, BarChange)>,
    /// What is gone, in order of time.
    pub gone: Vec<Gone>,
}

/// Below this zoom, words along arcs would run together.
const FAR_ZOOM: f64 = 0.42;
/// Layers of the list: under the arcs of the network's own, and over its texts.
const LAYERS: [u8; 2] = [2, 8];
/// How broad the glow along an arc is, and how far an outline stands off its box.
const GLOW: f64 = 9.0;
const OFF_BOX: f64 = 5.0;
/// The size of words, the height of their line, and what is around them.
const WORDS: (f64, f64, f64) = (11.0, 15.0, 4.0);
/// From the drawing down to the names of what is gone, and between two of them.
const BELOW: f64 = 26.0;
const BETWEEN: f64 = 12.0;

impl NetworkChanges {
    /// Returns what differs of `plan` from `before`.
    pub fn new(before: &Before, network: &Network, plan: &Plan) -> Self {
        let mut changes = Vec::new();
        for (index, occurrence) in network.occurrences.iter().enumerate() {
            let times = times(occurrence, plan);
            let is_drawn = matches!(occurrence.kind, OccurrenceKind::Primitive | OccurrenceKind::Assertion);
            let (Some(times), true) = (times, is_drawn) else { continue };
            match before.times_of(&occurrence.name) {
                None => changes.push((OccurrenceId::from_index(index), BarChange::New)),
                Some(former) if former != times => {
                    changes.push((OccurrenceId::from_index(index), BarChange::Moved(former)));
                }
                Some(_) => {}
            }
        }
        Self { changes, gone: before.gone(network, plan) }
    }
}

/// When something of a plan can start and end, if the plan has it.
fn times(occurrence: &Occurrence, plan: &Plan) -> Option<[[f64; 2]; 2]> {
    let window = |node: tpn::NodeId| {
        let window = plan.windows.get(node.index()).copied().flatten()?;
        Some([window.earliest.to_f64(), window.latest.to_f64()])
    };
    let is_selected = plan.selected_nodes.get(occurrence.start.index()) == Some(&true);
    Some([window(occurrence.start)?, window(occurrence.end)?]).filter(|_| is_selected)
}

/// The changes as a list over that of the network. Takes time by what is near each of them, and for sorting.
pub fn changes_list(
    drawing: &NetworkDrawing,
    (network, plan): (&Network, &Plan),
    changes: &NetworkChanges,
    measure: &dyn Measure,
) -> DisplayList {
    let gone = places_of_gone(drawing.bounds, &changes.gone, measure);
    let arcs = arcs_of(network, &changes.changes);
    let words = words(drawing, (network, plan), &arcs, measure);
    let places = gone.iter().map(|place| place.expanded(WORDS.2)).chain(words.iter().map(|it| it.place));
    let mut list = DisplayList::new(places.fold(drawing.bounds, Rect::union));
    list.begin(Group { layer: LAYERS[0], ..Group::default() });
    for (arc, change) in &arcs {
        let stroke = match change {
            BarChange::New => Stroke::solid(ColorRole::Accent.faint(0.35), GLOW),
            BarChange::Moved(_) => Stroke::solid(ColorRole::TextMuted.faint(0.5), GLOW).dashed(Dash::Dashed),
        };
        if let Some(shape) = drawing.arc(*arc) {
            list.path(shape.start, drawing.pieces(shape), PathEnd::Open, stroke);
        }
    }
    boxes(drawing, network, &arcs, &mut list);
    list.begin(Group { layer: LAYERS[1], ..Group::default() });
    for Words { text, place, color, weight, title, room } in words {
        let text = Text::new(text, WORDS.0, place).anchored(Anchor::Middle, Fit::Overflow).colored(color);
        let plate = Some(ColorRole::Surface.into());
        list.write(Text { weight, plate, legible: Some(room), ..text }).at(Detail::from(FAR_ZOOM));
        list.entitle(title);
    }
    add_gone(&gone, &changes.gone, &mut list);
    list
}

/// What is said along an arc.
struct Words {
    text: String,
    place: Rect,
    color: ColorRole,
    weight: Weight,
    title: &'static str,
    /// How wide the arc is.
    room: f64,
}

/// Returns what is said of each arc, on its line or as near to it as nothing else is written.
fn words(
    drawing: &NetworkDrawing,
    (network, plan): (&Network, &Plan),
    arcs: &[(ArcId, BarChange)],
    measure: &dyn Measure,
) -> Vec<Words> {
    let circle =
        |node: &crate::drawing::NodeShape| Rect { min: node.center, max: node.center }.expanded(node.radius);
    let mut taken: Vec<Rect> =
        drawing.texts.iter().map(|text| text.rect).chain(drawing.nodes.iter().map(circle)).collect();
    taken.sort_by(|one, other| one.min.y.total_cmp(&other.min.y));
    let lines = level_parts(drawing);
    let mut words = Vec::new();
    // What has been written, by rows that are higher than words.
    let mut written: BTreeMap<i64, Vec<Rect>> = BTreeMap::new();
    let row = |y: f64| (y / (2.0 * WORDS.1)).floor() as i64;
    for (arc, change) in arcs {
        let Some(shape) = drawing.arc(*arc) else { continue };
        let (text, color, weight, title) = match change {
            BarChange::New => {
                ("new".to_owned(), ColorRole::Accent, Weight::Strong, "not in the approved plan")
            }
            BarChange::Moved(former) => {
                let (words, title) = moved(*former, starts_of(network, plan, *arc));
                (words, ColorRole::Text, Weight::Regular, title)
            }
        };
        // As high as its letters, so that it fits between two lines.
        let (half, height) = (text_width_at(&text, WORDS.0, measure) / 2.0 + WORDS.2, WORDS.0 + 1.0);
        let (middle, line) = (shape.bounds.center().x, height_at_middle(drawing, shape));
        let at = |off: f64| {
            let top = line + off - height / 2.0;
            Rect::new(middle - half, top, middle + half, top + height)
        };
        // Texts and circles are lower than the steps that are tried together.
        let (from, to) = (line - 2.0 * MAX_OFF, line + 2.0 * MAX_OFF);
        let near = taken.partition_point(|it| it.min.y < from)..taken.partition_point(|it| it.min.y < to);
        let near_lines =
            lines.partition_point(|(_, it)| it.min.y < from)..lines.partition_point(|(_, it)| it.min.y < to);
        let is_free = |place: &Rect| {
            let (first, last) = (row(place.min.y), row(place.max.y));
            !taken[near.clone()].iter().any(|it| it.overlaps(*place))
                && !written.range(first - 1..=last).any(|(_, all)| all.iter().any(|it| it.overlaps(*place)))
        };
        // Over another arc it would be taken for what is said of that one.
        let is_apart = |place: &Rect| {
            is_free(place)
                && !lines[near_lines.clone()].iter().any(|(id, it)| id != arc && it.overlaps(*place))
        };
        let steps = (1..).map(|step| f64::from(step) * STEP_OFF).take_while(|off| *off <= MAX_OFF);
        let offs = std::iter::once(0.0).chain(steps.flat_map(|off| [off, -off]));
        let places: Vec<Rect> = offs.map(at).collect();
        let place = places.iter().copied().find(is_apart);
        let place = place.or_else(|| places.into_iter().find(is_free)).unwrap_or_else(|| at(0.0));
        written.entry(row(place.min.y)).or_default().push(place);
        words.push(Words { text, place, color, weight, title, room: shape.bounds.width() });
    }
    words
}

/// The parts of arcs that are level or nearly so, from top to bottom; what rises steeply is passed soon.
fn level_parts(drawing: &NetworkDrawing) -> Vec<(ArcId, Rect)> {
    let mut parts = Vec::new();
    for shape in &drawing.arcs {
        let points = display::geometry::flatten(shape.start, drawing.pieces(shape));
        let rects = points.windows(2).map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            Rect::new(from.x.min(to.x), from.y.min(to.y), from.x.max(to.x), from.y.max(to.y)).expanded(1.0)
        });
        parts.extend(rects.filter(|rect| rect.height() < WORDS.1).map(|rect| (shape.id, rect)));
    }
    parts.sort_by(|(_, one), (_, other)| one.min.y.total_cmp(&other.min.y));
    parts
}

/// How far from its arc a word is written at most, and in which steps a free place is looked for.
const MAX_OFF: f64 = 72.0;
const STEP_OFF: f64 = 2.0;

/// When what an arc represents can start in the plan.
fn starts_of(network: &Network, plan: &Plan, arc: ArcId) -> Option<[f64; 2]> {
    let window = plan.windows.get(network.arcs[arc.index()].from.index()).copied().flatten()?;
    Some([window.earliest.to_f64(), window.latest.to_f64()])
}

/// When something could start in the other plan, or end if its starts are the same, and what that means.
fn moved([starts, ends]: [[f64; 2]; 2], now: Option<[f64; 2]>) -> (String, &'static str) {
    if now == Some(starts) {
        (format!("end was {}", span(ends)), "end in the approved plan")
    } else {
        (format!("was {}", span(starts)), "start in the approved plan")
    }
}

/// The arcs that represent what has changed.
fn arcs_of(network: &Network, changes: &[(OccurrenceId, BarChange)]) -> Vec<(ArcId, BarChange)> {
    let change_of = |id: OccurrenceId| {
        let at = changes.binary_search_by_key(&id, |(id, _)| *id).ok()?;
        Some(changes[at].1)
    };
    let arcs = network.arcs.iter().enumerate().filter_map(|(index, arc)| {
        let occurrence = network.occurrences.get(arc.occurrence?.index())?;
        // The arc that is the whole of it, and not a part of its path.
        let is_complete = (arc.from, arc.to) == (occurrence.start, occurrence.end);
        Some((ArcId::from_index(index), change_of(arc.occurrence?).filter(|_| is_complete)?))
    });
    arcs.collect()
}

/// Outlines around the boxes that changed arcs are inside of.
fn boxes(drawing: &NetworkDrawing, network: &Network, arcs: &[(ArcId, BarChange)], list: &mut DisplayList) {
    let hidden = arcs.iter().filter(|(arc, _)| drawing.arc(*arc).is_none());
    let mut rects: Vec<Rect> = Vec::new();
    for shape in hidden.filter_map(|(arc, _)| drawing.box_of(network.arcs[arc.index()].from)) {
        if !rects.contains(&shape.rect) {
            rects.push(shape.rect);
        }
    }
    for rect in rects {
        let dashed = Stroke::solid(ColorRole::Accent, 1.6).dashed(Dash::Dashed);
        list.rectangle(rect.expanded(OFF_BOX), 8.0, None, Some(dashed));
        list.entitle("differs from the approved plan");
    }
}

/// Returns how high an arc is where its middle is.
fn height_at_middle(drawing: &NetworkDrawing, shape: &crate::drawing::ArcShape) -> f64 {
    let middle = shape.bounds.center();
    let points = display::geometry::flatten(shape.start, drawing.pieces(shape));
    let crossing = points.windows(2).find_map(|pair| {
        let (from, to) = (pair[0], pair[1]);
        let share = (middle.x - from.x) / (to.x - from.x);
        (0.0..=1.0).contains(&share).then_some(from.y + share * (to.y - from.y))
    });
    crossing.unwrap_or(middle.y)
}

/// Returns where the names of what is gone stand: in rows below the drawing.
fn places_of_gone(bounds: Rect, gone: &[Gone], measure: &dyn Measure) -> Vec<Rect> {
    let mut places = Vec::new();
    let (mut left, mut top) = (bounds.min.x, bounds.max.y + BELOW);
    for it in gone {
        let width = text_width_at(&it.name, WORDS.0, measure) + 4.0 * WORDS.2;
        if left > bounds.min.x && left + width > bounds.max.x {
            (left, top) = (bounds.min.x, top + 2.0 * WORDS.1);
        }
        places.push(Rect::new(left, top, left + width, top + WORDS.1 + 2.0 * WORDS.2));
        left += width + BETWEEN;
    }
    places
}

fn add_gone(places: &[Rect], gone: &[Gone], list: &mut DisplayList) {
    let Some(first) = places.first() else { return };
    let heading = Rect::new(first.min.x, first.min.y - WORDS.1 - 2.0, first.min.x + 160.0, first.min.y - 2.0);
    let text = Text::new("Removed from the plan", WORDS.0, heading).anchored(Anchor::Start, Fit::Overflow);
    list.write(text.colored(ColorRole::TextMuted));
    for (place, Gone { name, times }) in places.iter().zip(gone) {
        let dashed = Stroke::solid(ColorRole::TextMuted, 1.2).dashed(Dash::Dashed);
        list.rectangle(*place, 3.0, None, Some(dashed));
        list.entitle(format!("{name}: start {} in the approved plan", span(times[0])));
        let text = Text::new(name.clone(), WORDS.0, *place).anchored(Anchor::Middle, Fit::Overflow);
        list.write(text.colored(ColorRole::TextMuted));
        let middle = place.center().y;
        let ends = [place.min.x + WORDS.2, place.max.x - WORDS.2].map(|x| Point::new(x, middle));
        list.line(ends[0], ends[1], Stroke::solid(ColorRole::TextMuted, 1.0));
    }
}

/// `5` or `5–9`.
fn span([from, to]: [f64; 2]) -> SmolStr {
    let rounded = |time: f64| (time * 1000.0).round() / 1000.0;
    match from == to {
        true => smol_str::format_smolstr!("{}", rounded(from)),
        false if to.is_infinite() => smol_str::format_smolstr!("{}–∞", rounded(from)),
        false => smol_str::format_smolstr!("{}–{}", rounded(from), rounded(to)),
    }
}
