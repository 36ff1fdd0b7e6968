//! Which lines and colors the parts of a network have: by what they are, and by what the plan says of them.

use display::{ColorRole, Dash, Stroke};
use serde::{Deserialize, Serialize};
use tpn::{ArcId, ArcKind, NodeId, Plan, Role};

use crate::drawing::{BlockForm, Item, Route};
use crate::metrics::{TextRole, VERTEX_RADIUS};
use crate::overlay::OverlayKind;

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
    /// Returns whether texts of this role are shown.
    pub const fn shows_text(self, role: TextRole) -> bool {
        match role {
            TextRole::Bounds | TextRole::Nature | TextRole::ZeroBounds => self.bounds,
            TextRole::Ask | TextRole::Tell => self.conditions,
            TextRole::Name | TextRole::Muted => self.names,
            TextRole::Node | TextRole::Title | TextRole::Window => true,
        }
    }

    /// Returns whether what the plan says this of is shown.
    pub fn shows(self, standing: Standing) -> bool {
        self.unselected || standing != Standing::Unselected
    }
}

/// Returns what `plan` says of an arc.
pub(crate) fn arc_standing(plan: Option<&Plan>, arc: ArcId) -> Standing {
    standing(plan.map(|plan| plan.selected_arcs.get(arc.index()).copied().unwrap_or(false)))
}

/// Returns what `plan` says of a node.
pub(crate) fn node_standing(plan: Option<&Plan>, node: NodeId) -> Standing {
    standing(plan.map(|plan| plan.selected_nodes.get(node.index()).copied().unwrap_or(false)))
}

/// Returns what `plan` says of what a text belongs to.
pub(crate) fn item_standing(
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
pub(crate) fn arc_stroke(kind: ArcKind, route: Route, is_natures: bool, standing: Standing) -> Stroke {
    let is_thin = route != Route::Along || kind == ArcKind::Path;
    let dash = match route {
        Route::Across => Dash::Dotted,
        _ if is_natures => Dash::Dashed,
        Route::Along | Route::Arch => Dash::Solid,
    };
    let (color, width) = match standing {
        Standing::Plain => (ColorRole::Path, if is_thin { 1.1 } else { 1.5 }),
        Standing::Selected => (ColorRole::Path, if is_thin { 1.4 } else { 2.6 }),
        Standing::Unselected => (ColorRole::PathUnselected, if is_thin { 1.0 } else { 1.2 }),
    };
    let color = if is_natures && standing != Standing::Unselected { ColorRole::Nature } else { color };
    Stroke { color: color.into(), width, dash }
}

/// The rim of a node of this role and radius.
pub(crate) fn node_stroke(role: Role, radius: f64, standing: Standing) -> Stroke {
    let color = match (standing, role) {
        (Standing::Unselected, _) => ColorRole::PathUnselected,
        (_, Role::Decision) => ColorRole::Decision,
        _ => ColorRole::Path,
    };
    let width = match standing {
        _ if radius <= VERTEX_RADIUS => 0.5,
        Standing::Selected => 2.2,
        Standing::Plain | Standing::Unselected => 1.4,
    };
    Stroke::solid(color, width)
}

/// The inside of a node of this role and radius; dots are filled.
pub(crate) fn node_fill(role: Role, radius: f64, standing: Standing) -> ColorRole {
    match standing {
        _ if role != Role::Structural && radius > VERTEX_RADIUS => ColorRole::NodeFill,
        Standing::Unselected => ColorRole::PathUnselected,
        Standing::Plain | Standing::Selected => ColorRole::Path,
    }
}

/// The color of a text.
pub(crate) fn text_color(role: TextRole, standing: Standing) -> ColorRole {
    if standing == Standing::Unselected {
        return ColorRole::TextFaint;
    }
    match role {
        TextRole::Name | TextRole::Title | TextRole::Node => ColorRole::Text,
        TextRole::Muted | TextRole::Bounds => ColorRole::TextMuted,
        TextRole::Nature => ColorRole::Nature,
        TextRole::ZeroBounds => ColorRole::TextFaint,
        TextRole::Ask => ColorRole::Ask,
        TextRole::Tell => ColorRole::Tell,
        TextRole::Window => ColorRole::Accent,
    }
}

/// The fill and the line of a block.
pub(crate) fn block_style(form: BlockForm) -> (Option<ColorRole>, Stroke) {
    match form {
        // Its fill would hide the bands that it lies in.
        BlockForm::Activity => (None, Stroke::solid(ColorRole::LineStrong, 1.0)),
        BlockForm::Lane => {
            (Some(ColorRole::Sunken), Stroke::solid(ColorRole::Line, 1.0).dashed(Dash::Dashed))
        }
        BlockForm::Alternative => {
            (Some(ColorRole::Sunken), Stroke::solid(ColorRole::LineStrong, 1.0).dashed(Dash::Dotted))
        }
        BlockForm::Collapsed => (Some(ColorRole::Raised), Stroke::solid(ColorRole::LineStrong, 1.2)),
    }
}

/// The line of an overlay curve.
pub(crate) fn overlay_stroke(kind: OverlayKind) -> Stroke {
    match kind {
        OverlayKind::CausalLink => Stroke::solid(ColorRole::Link, 1.8).dashed(Dash::Dashed),
        OverlayKind::Ordering => Stroke::solid(ColorRole::Ordering, 2.0).dashed(Dash::Dotted),
        OverlayKind::NegativeCycle => Stroke::solid(ColorRole::Threat, 2.6),
        OverlayKind::Threat => Stroke::solid(ColorRole::Threat, 2.2).dashed(Dash::Dashed),
    }
}

/// The radius of the dot in an event that has happened.
pub(crate) fn done_radius(radius: f64) -> f64 {
    if radius <= VERTEX_RADIUS { radius } else { radius * 0.42 }
}
