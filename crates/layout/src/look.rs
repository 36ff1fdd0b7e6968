//! How shapes look, in terms of named inks: shared by the page's painter and the SVG export, so that both agree.

use serde::{Deserialize, Serialize};
use tpn::{ArcId, ArcKind, NodeId, Plan, Role};

use crate::drawing::{BlockForm, Item, Route};
use crate::geometry::Point;
use crate::metrics::{ARROW_HALF_BREADTH, ARROW_LENGTH, TextRole, VERTEX_RADIUS};
use crate::overlay::OverlayKind;

/// A colour by its meaning; painters bring the colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Ink {
    /// What is drawn upon.
    Surface,
    /// What is sunk into it: lanes.
    Sunken,
    /// What is raised from it: boxes.
    Raised,
    /// Quiet lines.
    Line,
    /// Outlines that must be seen.
    LineStrong,
    /// Text.
    Text,
    /// Text that matters less.
    TextMuted,
    /// Text that hardly matters.
    TextFaint,
    /// What the plan selects.
    Path,
    /// What it does not.
    PathUnselected,
    /// The inside of nodes.
    NodeFill,
    /// Decisions.
    Decision,
    /// Asserted conditions.
    Tell,
    /// Required conditions.
    Ask,
    /// Causal links.
    Link,
    /// Added orderings.
    Ordering,
    /// Threats and negative cycles.
    Threat,
    /// Time windows.
    Slack,
    /// The present.
    Now,
    /// Swim lanes.
    Lane,
}

/// The pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Dash {
    /// Unbroken.
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// A line.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stroke {
    /// Its colour.
    pub ink: Ink,
    /// Its width in drawing units.
    pub width: f64,
    /// Its pattern.
    pub dash: Dash,
}

/// What a plan says of a node or arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Standing {
    /// There is no plan.
    Plain,
    /// The plan selects it.
    Selected,
    /// The plan does without it.
    Unselected,
}

impl Stroke {
    /// An unbroken line.
    pub const fn solid(ink: Ink, width: f64) -> Self {
        Self { ink, width, dash: Dash::Solid }
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

/// Which parts of a drawing are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Parts {
    /// Names of activities.
    pub names: bool,
    /// Bounds on the arcs.
    pub bounds: bool,
    /// Asked and told conditions.
    pub conditions: bool,
    /// What the plan does without.
    pub unselected: bool,
    /// Outlines of activities, lanes of branches.
    pub structure: bool,
    /// A named band for every parallel branch.
    pub lanes: bool,
}

impl Default for Parts {
    fn default() -> Self {
        Self { names: true, bounds: true, conditions: true, unselected: true, structure: true, lanes: false }
    }
}

impl Parts {
    /// Whether texts of this role are shown.
    pub const fn shows_text(self, role: TextRole) -> bool {
        match role {
            TextRole::Bounds | TextRole::ZeroBounds => self.bounds,
            TextRole::Ask | TextRole::Tell => self.conditions,
            TextRole::Name | TextRole::Quiet => self.names,
            TextRole::Node | TextRole::Title | TextRole::Window => true,
        }
    }

    /// Whether what the plan says this of is shown.
    pub fn shows(self, standing: Standing) -> bool {
        self.unselected || standing != Standing::Unselected
    }
}

/// What `plan` says of an arc.
pub fn arc_standing(plan: Option<&Plan>, arc: ArcId) -> Standing {
    standing(plan.map(|plan| plan.selected_arcs.get(arc.index()).copied().unwrap_or(false)))
}

/// What `plan` says of a node.
pub fn node_standing(plan: Option<&Plan>, node: NodeId) -> Standing {
    standing(plan.map(|plan| plan.selected_nodes.get(node.index()).copied().unwrap_or(false)))
}

/// What `plan` says of what a text belongs to.
pub fn item_standing(
    plan: Option<&Plan>,
    item: Item,
    arc_of_label: impl Fn(tpn::LabelId) -> ArcId,
) -> Standing {
    match item {
        Item::Node(node) => node_standing(plan, node),
        Item::Arc(arc) => arc_standing(plan, arc),
        Item::Label(label) => arc_standing(plan, arc_of_label(label)),
        Item::Block(_) => Standing::Plain,
    }
}

fn standing(is_selected: Option<bool>) -> Standing {
    match is_selected {
        None => Standing::Plain,
        Some(true) => Standing::Selected,
        Some(false) => Standing::Unselected,
    }
}

/// The line of an arc.
pub fn arc_stroke(kind: ArcKind, route: Route, standing: Standing) -> Stroke {
    let is_quiet = route != Route::Along || kind == ArcKind::Path;
    let dash = if route == Route::Across { Dash::Dotted } else { Dash::Solid };
    let (ink, width) = match standing {
        Standing::Plain => (Ink::Path, if is_quiet { 1.1 } else { 1.5 }),
        Standing::Selected => (Ink::Path, if is_quiet { 1.4 } else { 2.6 }),
        Standing::Unselected => (Ink::PathUnselected, if is_quiet { 1.0 } else { 1.2 }),
    };
    Stroke { ink, width, dash }
}

/// The rim of a node of this role and radius.
pub fn node_stroke(role: Role, radius: f64, standing: Standing) -> Stroke {
    let ink = match (standing, role) {
        (Standing::Unselected, _) => Ink::PathUnselected,
        (_, Role::Decision) => Ink::Decision,
        _ => Ink::Path,
    };
    let width = match standing {
        _ if radius <= VERTEX_RADIUS => 0.5,
        Standing::Selected => 2.2,
        Standing::Plain | Standing::Unselected => 1.4,
    };
    Stroke::solid(ink, width)
}

/// The inside of a node of this role and radius; dots are filled.
pub fn node_fill(role: Role, radius: f64, standing: Standing) -> Ink {
    match standing {
        _ if role != Role::Structural && radius > VERTEX_RADIUS => Ink::NodeFill,
        Standing::Unselected => Ink::PathUnselected,
        Standing::Plain | Standing::Selected => Ink::Path,
    }
}

/// The colour of a text.
pub fn text_ink(role: TextRole, standing: Standing) -> Ink {
    if standing == Standing::Unselected {
        return Ink::TextFaint;
    }
    match role {
        TextRole::Name | TextRole::Title | TextRole::Node => Ink::Text,
        TextRole::Quiet | TextRole::Bounds => Ink::TextMuted,
        TextRole::ZeroBounds => Ink::TextFaint,
        TextRole::Ask => Ink::Ask,
        TextRole::Tell => Ink::Tell,
        TextRole::Window => Ink::Slack,
    }
}

/// The fill and the line of a block.
pub fn block_look(form: BlockForm) -> (Ink, Stroke) {
    match form {
        BlockForm::Activity => (Ink::Surface, Stroke::solid(Ink::LineStrong, 1.0)),
        BlockForm::Lane => (Ink::Sunken, Stroke { dash: Dash::Dashed, ..Stroke::solid(Ink::Line, 1.0) }),
        BlockForm::Alternative => {
            (Ink::Sunken, Stroke { dash: Dash::Dotted, ..Stroke::solid(Ink::LineStrong, 1.0) })
        }
        BlockForm::Collapsed => (Ink::Raised, Stroke::solid(Ink::LineStrong, 1.2)),
    }
}

/// The line of an overlay curve.
pub fn overlay_stroke(kind: OverlayKind) -> Stroke {
    match kind {
        OverlayKind::CausalLink => Stroke { ink: Ink::Link, width: 1.8, dash: Dash::Dashed },
        OverlayKind::Ordering => Stroke { ink: Ink::Ordering, width: 2.0, dash: Dash::Dotted },
        OverlayKind::NegativeCycle => Stroke::solid(Ink::Threat, 2.6),
        OverlayKind::Threat => Stroke { ink: Ink::Threat, width: 2.2, dash: Dash::Dashed },
    }
}

/// The line over what time has passed of an arc.
pub fn elapsed_stroke() -> Stroke {
    Stroke::solid(Ink::Now, 4.0)
}

/// The radius of the dot in an event that has happened.
pub fn done_radius(radius: f64) -> f64 {
    if radius <= VERTEX_RADIUS { radius } else { radius * 0.42 }
}

/// The fill and the line of a swim lane. Neighbours alternate.
pub fn lane_look(number: usize) -> (Option<Ink>, Stroke) {
    (number.is_multiple_of(2).then_some(Ink::Lane), Stroke::solid(Ink::Line, 1.0))
}

/// The corners of an arrow head at `tip` for a line that comes from `before`.
pub fn arrow_head(tip: Point, before: Point) -> [Point; 3] {
    let direction = before.direction_to(tip);
    let base = tip.shifted(-direction.x * ARROW_LENGTH, -direction.y * ARROW_LENGTH);
    let (across_x, across_y) = (-direction.y * ARROW_HALF_BREADTH, direction.x * ARROW_HALF_BREADTH);
    [tip, base.shifted(across_x, across_y), base.shifted(-across_x, -across_y)]
}
