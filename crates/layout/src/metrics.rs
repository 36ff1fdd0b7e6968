//! The sizes that drawings are made of, in drawing units (at zoom 1, a unit is a point of the screen).
//!
//! Widths of text come from the caller's `measure`; everything else is here.

use serde::{Deserialize, Serialize};
use tpn::{ArcId, ArcKind, Network, Node, Role};

/// Radius of the circle of an event.
pub const EVENT_RADIUS: f64 = 11.0;
/// Radius of the outer circle of a decision.
pub const DECISION_RADIUS: f64 = 14.0;
/// Radius of the dot of a vertex of a traverse's path.
pub const VERTEX_RADIUS: f64 = 2.5;
/// How far the inner circle of a decision lies inside the outer one.
pub const DECISION_INSET: f64 = 3.0;
/// Radius of the dot of a fork, join or merge.
pub const STRUCTURAL_RADIUS: f64 = 4.0;

/// Free space beside a text.
pub(crate) const TEXT_PAD: f64 = 5.0;
/// Between a line and the text that is on it or hangs from it.
pub(crate) const TEXT_LIFT: f64 = 3.0;
/// Between two texts on one line.
pub(crate) const WORD_GAP: f64 = 7.0;
/// Shortest visible run of an arc.
pub(crate) const SHORTEST_RUN: f64 = 22.0;
/// Between the branches of a fork.
pub(crate) const LANE_GAP: f64 = 14.0;
/// Between an arch and what it spans.
pub(crate) const ARCH_GAP: f64 = 6.0;
/// How far from its node the first arch stands upright.
pub(crate) const ARCH_FIRST: f64 = 6.0;
/// How much further every next one.
pub(crate) const ARCH_STEP: f64 = 8.0;
/// How high above a node its arches have become upright.
pub(crate) const ARCH_FOOT: f64 = 20.0;
/// Radius of an arch's corners.
pub(crate) const ARCH_CORNER: f64 = 10.0;
/// Between the outline of an activity and what it holds.
pub(crate) const OUTLINE_PAD: f64 = 5.0;
/// Above and below the lines in the box of a collapsed block.
pub(crate) const COLLAPSED_PAD: f64 = 4.0;
/// Narrowest and widest space in which the arcs of a fork spread.
pub(crate) const GUTTER: (f64, f64) = (22.0, 60.0);
/// Between the rows of a series that is broken into rows.
pub(crate) const ROW_GAP: f64 = 22.0;
/// How far right of the line back to it each row but the first begins: past the outline of an activity.
pub(crate) const ROW_INDENT: f64 = 40.0;
/// How far right of a row's last node the line turns.
pub(crate) const ROW_TURN: f64 = 36.0;
/// Radius of the turns.
pub(crate) const ROW_CORNER: f64 = 10.0;
/// Between the vertices of a path.
pub(crate) const BEAD_STEP: f64 = 12.0;
/// Around the whole drawing.
pub(crate) const MARGIN: f64 = 12.0;

/// What a text is for; decides its size, and its color when painted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum TextRole {
    /// The name of an activity.
    Name,
    /// A name of less weight: a delay.
    Muted,
    /// Bounds of a duration.
    Bounds,
    /// The range of a duration that the environment chooses.
    Nature,
    /// Bounds that say nothing but "at once": `[0,0]`.
    ZeroBounds,
    /// A condition that an arc requires.
    Ask,
    /// A condition that an arc asserts.
    Tell,
    /// The number or name inside a node.
    Node,
    /// The heading of a collapsed block or a composite location.
    Title,
    /// The time window of an event.
    Window,
}

impl TextRole {
    /// The size of the text.
    pub const fn size(self) -> f64 {
        match self {
            Self::Name | Self::Title => 13.0,
            Self::Muted | Self::Node => 12.0,
            Self::Bounds | Self::Nature | Self::Ask | Self::Tell => 11.5,
            Self::Window | Self::ZeroBounds => 11.0,
        }
    }

    /// The height of a line of it.
    pub const fn line_height(self) -> f64 {
        match self {
            Self::Name | Self::Title => 17.0,
            Self::Muted => 16.0,
            Self::Bounds | Self::Nature | Self::Ask | Self::Tell => 15.0,
            Self::Window => 14.0,
            Self::Node | Self::ZeroBounds => 13.0,
        }
    }
}

/// The radius of a node. Vertices of a traverse's path (SPEC 7.3) are many and mean little by themselves: dots.
pub fn node_radius(network: &Network, node: &Node) -> f64 {
    let is_path = |arc: &ArcId| network.arcs[arc.index()].kind == ArcKind::Path;
    let mut arcs = node.in_arcs.iter().chain(&node.out_arcs);
    if !node.in_arcs.is_empty() && !node.out_arcs.is_empty() && arcs.all(is_path) {
        return VERTEX_RADIUS;
    }
    match node.role {
        Role::Event => EVENT_RADIUS,
        Role::Structural => STRUCTURAL_RADIUS,
        Role::Decision => DECISION_RADIUS,
    }
}

/// `length` rounded up to a whole unit.
pub(crate) fn rounded_up(length: f64) -> f64 {
    length.ceil()
}
