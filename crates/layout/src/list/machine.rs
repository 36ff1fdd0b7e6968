//! A component's state machine as a display list: modes shaded by how likely they are, faults dashed.

use display::{
    Anchor, ColorRole, Dash, DisplayList, Fit, Group, PathEnd, Rect, Stroke, TargetKind, Text, Weight,
};
use smol_str::SmolStr;

use crate::machine::{MODE_HEIGHT, MachineArc, MachineDrawing};

/// How things stand with a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeState {
    pub name: SmolStr,
    /// How likely it is, from 0 to 1.
    pub likelihood: f64,
    /// The same in words.
    pub percent: SmolStr,
    /// Whether it is the most likely one.
    pub is_estimate: bool,
    pub is_true: bool,
    /// Whether the component will be brought into it.
    pub is_injected: bool,
}

/// Size of a mode's name.
pub const NAME_SIZE: f64 = 12.0;
/// Size of a percentage.
const PERCENT_SIZE: f64 = 9.5;
/// How far a name is above the middle, and a percentage below it, where there are both.
const LIFTS: (f64, f64) = (5.0, 6.5);
/// How much of the accent the most certain mode has in its fill.
const STRONGEST_FILL: f64 = 0.5;

/// The display list of a state machine with its modes; `taken` is the arc that was taken last, by its modes.
pub fn machine_list(
    drawing: &MachineDrawing,
    arcs: &[MachineArc],
    modes: &[ModeState],
    taken: Option<(usize, usize)>,
) -> DisplayList {
    let mut list = DisplayList::new(drawing.bounds);
    list.begin(Group::default());
    for (arc, shape) in arcs.iter().zip(&drawing.arcs) {
        let is_taken = taken == Some((arc.from, arc.to));
        let role = match (is_taken, arc.is_fault) {
            (true, true) => ColorRole::Error,
            (true, false) => ColorRole::Accent,
            (false, true) => ColorRole::Warning,
            (false, false) => ColorRole::TextMuted,
        };
        let dash = if arc.is_fault { Dash::Dotted } else { Dash::Solid };
        let stroke = Stroke::solid(role, if is_taken { 2.2 } else { 1.1 }).dashed(dash);
        list.path(shape.start, &shape.pieces, PathEnd::Head, stroke);
    }
    for ((number, mode), &rect) in (0..).zip(modes).zip(&drawing.modes) {
        add_mode(number, mode, rect, &mut list);
    }
    list
}

fn add_mode(number: u32, mode: &ModeState, rect: Rect, list: &mut DisplayList) {
    let (role, width) = match (mode.is_injected, mode.is_estimate) {
        (true, _) => (ColorRole::Error, 2.0),
        (false, true) => (ColorRole::Accent, 2.0),
        (false, false) => (ColorRole::LineStrong, 1.0),
    };
    let fill = ColorRole::Accent.mixed((STRONGEST_FILL * mode.likelihood) as f32);
    list.rectangle(
        rect.expanded(-width / 2.0),
        MODE_HEIGHT / 2.0,
        Some(fill.into()),
        Some(Stroke::solid(role, width)),
    )
    .stands_for(TargetKind::Mode, number);
    let color = if mode.likelihood > 0.0 { ColorRole::Text } else { ColorRole::TextMuted };
    let is_open = mode.likelihood > 0.0 && mode.likelihood < 1.0;
    let (name_lift, percent_drop) = if is_open { LIFTS } else { (0.0, 0.0) };
    let moved = |by: f64| Rect { min: rect.min.shifted(0.0, by), max: rect.max.shifted(0.0, by) };
    let write = |list: &mut DisplayList, text: &SmolStr, size: f64, by: f64, weight: Weight| {
        let text = Text::new(text.clone(), size, moved(by)).anchored(Anchor::Middle, Fit::Overflow);
        list.write(Text { weight, ..text.colored(color) });
    };
    let weight = if mode.is_estimate { Weight::Strong } else { Weight::Regular };
    write(list, &mode.name, NAME_SIZE, -name_lift, weight);
    if is_open {
        write(list, &mode.percent, PERCENT_SIZE, percent_drop, Weight::Regular);
    }
    if mode.is_true {
        let role = if mode.is_estimate { ColorRole::Text } else { ColorRole::Warning };
        let center = display::Point::new(rect.max.x - 5.0, rect.min.y + 4.0);
        let rim = Stroke::solid(ColorRole::Raised, 1.5);
        list.circle(center, 4.0, Some(role.into()), Some(rim));
    }
}
