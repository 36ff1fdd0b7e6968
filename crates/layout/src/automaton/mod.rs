//! The drawing of an automaton: composites as nested boxes, locations as rounded boxes, transitions with their guards.
//!
//! Parallel children stand below each other, and what a location starts stands to its right. A sequence runs from left to
//! right, or from top to bottom where that would be wide. Long conditions are broken into lines before their connectives.
//! Linear in the automaton and its texts.

mod arrange;

use display::geometry::distance_point_curve;
use display::{Measure, Piece, Point, Rect};
use hca::{Automaton, CompositeId, CompositeKind, LocationId, LocationKind, TransitionId};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::metrics::TextRole;

/// What is said of a composite that was preempted, on its lower border.
pub(crate) const PREEMPTED: &str = "✗ preempted in last step";

/// How large that is written.
pub(crate) const NOTE_SIZE: f64 = 11.5;

/// An automaton as shapes. Composites are in the order of their ids: outer ones first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AutomatonDrawing {
    /// Everything lies inside.
    pub bounds: Rect,
    /// The boxes of composites.
    pub composites: Vec<CompositeShape>,
    /// The boxes of primitive locations, in the order of their ids.
    pub locations: Vec<LocationShape>,
    /// The transitions, in the order of their ids.
    pub transitions: Vec<TransitionShape>,
    /// From each child of a sequence to the next.
    pub successions: Vec<(Point, Point)>,
    pub texts: Vec<AutomatonText>,
}

/// Where a composite is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CompositeShape {
    pub id: CompositeId,
    pub rect: Rect,
    /// Which form it comes from.
    pub kind: CompositeKind,
    /// Whether it has a maintenance condition, and so can be preempted.
    pub is_watching: bool,
}

/// A primitive location.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LocationShape {
    pub id: LocationId,
    pub rect: Rect,
    pub kind: LocationKind,
    /// Whether it is marked when the whole program starts.
    pub is_start: bool,
}

/// Where a transition is drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TransitionShape {
    pub id: TransitionId,
    /// Where the curve begins.
    pub start: Point,
    pub pieces: Vec<Piece>,
}

/// A text in the rectangle that is reserved for it alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AutomatonText {
    /// What it says, in lines of one height.
    pub lines: Vec<SmolStr>,
    /// What it is for: titles of composites, names of locations, guards as bounds.
    pub role: TextRole,
    pub rect: Rect,
    /// What it belongs to.
    pub owner: AutomatonItem,
}

/// Something on the drawing that can be pointed at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AutomatonItem {
    /// A primitive location.
    Location(LocationId),
    Transition(TransitionId),
    Composite(CompositeId),
}

/// Draws an automaton; `measure` as for [`crate::network`].
pub fn automaton(automaton: &Automaton, measure: &dyn Measure) -> AutomatonDrawing {
    arrange::arrange(automaton, measure)
}

impl AutomatonDrawing {
    /// Returns what lies at `point`, or at most `tolerance` beside it: a location before a transition before the
    /// innermost composite.
    pub fn pick(&self, point: Point, tolerance: f64) -> Option<AutomatonItem> {
        let location = self.locations.iter().find(|location| location.rect.contains(point));
        if let Some(location) = location {
            return Some(AutomatonItem::Location(location.id));
        }
        let text = self.texts.iter().find(|text| text.rect.contains(point));
        if let Some(text) = text {
            return Some(text.owner);
        }
        let near =
            |shape: &&TransitionShape| distance_point_curve(point, shape.start, &shape.pieces) <= tolerance;
        if let Some(transition) = self.transitions.iter().find(near) {
            return Some(AutomatonItem::Transition(transition.id));
        }
        let around = self.composites.iter().rev().find(|composite| composite.rect.contains(point));
        around.map(|composite| AutomatonItem::Composite(composite.id))
    }
}
