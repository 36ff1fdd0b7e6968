//! Puts the drawing on the screen: the display list of the network, and over it what changes with time and with what is
//! selected and pointed at.

use display::ColorRole;
use egui::{Align2, Color32, FontId, Rect, Stroke, StrokeKind, vec2};
use layout::list::network::{Emphasis, emphasis_list, progress_list};
use layout::{NetworkState, OverlayCurve, OverlayKind, Progress};
use theme::Tokens;
use tpn::{LabelId, Network, Plan};
use workbench::state::search::Focus;
use workbench::state::settings::NetworkView;

use super::data::Drawn;
use super::highlight::Highlight;
use crate::painter::DisplayPainter;

/// How strong what stands out is: the step of the search, what is pointed at, what is selected.
const STRENGTHS: [f32; 3] = [0.40, 0.22, 0.45];

/// What lies over the network's display list.
pub(super) struct Scene<'a> {
    /// The drawing and its list.
    pub(super) drawn: &'a Drawn,
    pub(super) network: &'a Network,
    /// The plan, if there is one for this network.
    pub(super) plan: Option<&'a Plan>,
    /// What is shown.
    pub(super) options: &'a NetworkView,
    pub(super) selected: &'a Highlight,
    /// What the pointer is over, here or in another panel.
    pub(super) hovered: &'a Highlight,
    /// What the step of the search that is looked at is about.
    pub(super) focus: Option<&'a Focus>,
    /// What has happened at the time shown, if that is shown.
    pub(super) progress: Option<&'a Progress>,
}

impl Scene<'_> {
    /// Paints everything; names leave `marks` free.
    pub(super) fn paint(&self, painter: &DisplayPainter<'_>, marks: Vec<Rect>) {
        let drawing = &self.drawn.drawing;
        let state = NetworkState { plan: self.plan, parts: self.options.parts(), ..NetworkState::default() };
        let area = Some((painter.visible(), painter.min_size()));
        let progress = self.progress.map(|it| progress_list(drawing, self.network, &state, it, area));
        let step = self.focus.map(|focus| Highlight::of_focus(focus, self.network)).unwrap_or_default();
        let is_failure = self.focus.is_some_and(|focus| focus.is_failure);
        // Two glows over each other would be of neither color: what failed keeps its own.
        let selected = if is_failure { &self.selected.without(&step) } else { self.selected };
        let step_role = if is_failure { ColorRole::Error } else { ColorRole::Decision };
        let marked = [
            (&step, step_role, None),
            (self.hovered, ColorRole::Accent, Some(ColorRole::Hover)),
            (selected, ColorRole::Accent, Some(ColorRole::Selection)),
        ];
        let emphases = marked.into_iter().zip(STRENGTHS).map(|((shapes, role, plate), strength)| Emphasis {
            nodes: &shapes.nodes,
            arcs: &shapes.arcs,
            labels: &shapes.labels,
            occurrence: shapes.occurrence,
            color: (role, strength),
            plate,
        });
        let emphases: Vec<Emphasis<'_>> = emphases.collect();
        let emphasis = emphasis_list(drawing, self.network, &state, &emphases, &self.chosen());
        let lists: Vec<_> =
            [&self.drawn.list, &emphasis].into_iter().chain(&progress).chain(&self.drawn.changes).collect();
        painter.paint(&lists, marks);
    }

    /// The curves that belong to what is selected or pointed at.
    fn chosen(&self) -> Vec<&OverlayCurve> {
        if self.selected.arcs.is_empty() && self.hovered.arcs.is_empty() {
            return Vec::new();
        }
        let links = self.options.links.then_some(&self.drawn.links);
        let orderings = self.options.orderings.then_some(&self.drawn.orderings);
        links.into_iter().chain(orderings).flatten().filter(|curve| self.is_chosen(curve)).collect()
    }

    fn is_chosen(&self, curve: &OverlayCurve) -> bool {
        let Some(plan) = self.plan else { return false };
        let number = curve.number as usize;
        let labels = match curve.kind {
            OverlayKind::CausalLink => plan.causal_links.get(number).map(|link| [link.ask, link.tell]),
            OverlayKind::Ordering => plan.orderings_added.get(number).map(|order| [order.first, order.then]),
            OverlayKind::NegativeCycle | OverlayKind::Threat => None,
        };
        let arc = |label: LabelId| self.network.labels.get(label.index()).map(|label| label.arc);
        let mut arcs = labels.into_iter().flatten().filter_map(arc);
        arcs.any(|arc| self.selected.arcs.contains(&arc) || self.hovered.arcs.contains(&arc))
    }
}

/// A short message in a corner of the panel, with a sign that does not depend on color.
pub(super) fn badge(
    painter: &egui::Painter,
    corner: egui::Pos2,
    text: &str,
    color: Color32,
    tokens: &Tokens,
    width: f32,
) {
    let font = FontId::proportional(theme::size::SMALL);
    let mut job = egui::text::LayoutJob::simple(text.to_owned(), font, color, width);
    job.wrap.max_rows = 2;
    let galley = painter.layout_job(job);
    let rect = Align2::LEFT_TOP.anchor_size(corner, galley.size() + vec2(16.0, 8.0));
    painter.rect(rect, 5.0, tokens.raised, Stroke::new(1.0, color.gamma_multiply(0.6)), StrokeKind::Inside);
    painter.galley(rect.min + vec2(8.0, 4.0), galley, color);
}
