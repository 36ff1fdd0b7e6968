//! The distances between the events of the plan, or of the step of the search that is looked at: as a graph with the
//! bounds on its edges, where a negative cycle stands out, and as a matrix of the shortest distances (SPEC 4).

mod arrange;
mod graph;
mod matrix;
mod paint;
mod part;

use std::sync::Arc;

use egui::{Rect, RichText, Role, Sense, Ui, WidgetInfo};
use kirk::CycleMember;
use snapshot::Snapshot;
use theme::space;
use tpn::{ArcId, Network, NodeId, Plan};
use workbench::PanelKind;
use workbench::ViewAction;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::window::WindowCommand;

use super::network::view::View;
use super::{Context, Panel, show_empty};
use arrange::{Arranged, arrange};
use graph::{DistanceGraph, Selected};

#[derive(Default)]
pub struct DistancesPanel {
    shows_matrix: bool,
    view: View,
    drawn: Option<Drawn>,
}

/// The graph that was made last, and of what.
struct Drawn {
    snapshot: Arc<Snapshot>,
    plan: *const Plan,
    /// Keeps the plan of a step in its place, so that no other can take it.
    _step: Option<Arc<Plan>>,
    /// What is selected, where that decides which part is drawn.
    seeds: Vec<NodeId>,
    graph: DistanceGraph,
    /// What is said of a part.
    note: Option<String>,
    arranged: Arranged,
}

/// Smaller than this no name could be read.
const MIN_ZOOM: f64 = 0.78;
/// A few vertices are not drawn larger than this.
const LARGEST_WHOLE: f64 = 1.5;
const WHEEL_ZOOM: f64 = 0.0022;
const KEY_ZOOM: f64 = 1.3;

impl Panel for DistancesPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let (Some(snapshot), Some((network, plan))) = (context.snapshot, context.plan()) else {
            let text = "No plan, so no distances. Step through the search to see the distances at a step.";
            show_empty(ui, context, text);
            return;
        };
        let step = context.step().map(|view| view.step.as_ref());
        let cycle = step.map(|step| step.cycle.as_slice()).unwrap_or_default();
        self.show_controls(ui, context, network, cycle);
        let selected = match step {
            Some(step) => (step.nodes.clone(), step.arcs.clone()),
            None => of_plan(plan),
        };
        if self.shows_matrix {
            let selected = Selected { network, nodes: &selected.0, arcs: &selected.1, plan, cycle };
            matrix::show(ui, context, &selected, commands);
            return;
        }
        self.follow(context, snapshot, network, plan, &selected, cycle);
        let Some(drawn) = &self.drawn else { return };
        if let Some(note) = &drawn.note {
            ui.horizontal_wrapped(|ui| {
                ui.add_space(space::M);
                ui.label(RichText::new(note.as_str()).small().color(context.tokens.text_muted));
            });
        }
        self.show_graph(ui, context, network, commands);
    }
}

/// The selected nodes and arcs of a plan.
fn of_plan(plan: &Plan) -> (Vec<NodeId>, Vec<ArcId>) {
    let nodes = plan.selected_nodes.iter().enumerate().filter(|(_, is_selected)| **is_selected);
    let arcs = plan.selected_arcs.iter().enumerate().filter(|(_, is_selected)| **is_selected);
    (
        nodes.map(|(id, _)| NodeId::from_index(id)).collect(),
        arcs.map(|(id, _)| ArcId::from_index(id)).collect(),
    )
}

impl DistancesPanel {
    fn show_controls(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        network: &Network,
        cycle: &[CycleMember],
    ) {
        let tokens = context.tokens;
        egui::Frame::new().inner_margin(egui::Margin::symmetric(8, 4)).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing.x = space::S;
                ui.selectable_value(&mut self.shows_matrix, false, "Graph");
                ui.selectable_value(&mut self.shows_matrix, true, "Matrix");
                ui.add_space(space::M);
                if cycle.is_empty() {
                    let text = match (self.shows_matrix, context.step()) {
                        (true, _) => "maximum time from row to column",
                        (false, None) => "x → y: maximum time from x to y, in the plan",
                        (false, Some(_)) => "x → y: maximum time from x to y, at this step",
                    };
                    ui.label(RichText::new(text).small().color(tokens.text_muted));
                } else {
                    let text = format!("✗ {}", sum_of(cycle));
                    let names: Vec<String> = cycle
                        .iter()
                        .map(|member| workbench::state::selection::node_name(network, member.from))
                        .collect();
                    ui.label(RichText::new(text).small().color(tokens.failure))
                        .on_hover_text(names.join(" → "));
                }
            });
        });
    }

    /// Makes the graph again if it is that of something else.
    fn follow(
        &mut self,
        context: &Context<'_>,
        snapshot: &Arc<Snapshot>,
        network: &Network,
        plan: &Plan,
        selected: &(Vec<NodeId>, Vec<ArcId>),
        cycle: &[CycleMember],
    ) {
        let seeds = seeds(&context.state.selection, network);
        let is_current = self.drawn.as_ref().is_some_and(|drawn| {
            drawn.snapshot.shows_same(snapshot)
                && std::ptr::eq(drawn.plan, plan)
                && (drawn.note.is_none() || !cycle.is_empty() || drawn.seeds == seeds)
        });
        if is_current {
            return;
        }
        let (nodes, arcs) = selected;
        let part::Shown { graph, left_out, stretch } =
            part::shown(&Selected { network, nodes, arcs, plan, cycle }, &seeds);
        let what = match (cycle.is_empty(), seeds.is_empty()) {
            (false, _) => "Events near the conflict",
            (true, false) => "Events near the selection",
            (true, true) => "Events near the start (select an event to see its neighborhood)",
        };
        let note = (left_out > 0).then(|| match stretch {
            1 => format!("{what}; {left_out} more are hidden."),
            _ => format!("{what}; each edge combines up to {stretch} consecutive bounds."),
        });
        if !cycle.is_empty() {
            self.view.keep_fitted();
        }
        let widths: Vec<f64> = graph.vertices.iter().map(paint::width).collect();
        let arranged = arrange(&graph, &widths);
        let step = context.step().map(|view| Arc::clone(&view.plan));
        let snapshot = Arc::clone(snapshot);
        self.drawn = Some(Drawn { snapshot, plan, _step: step, seeds, graph, note, arranged });
    }

    fn show_graph(
        &mut self,
        ui: &mut Ui,
        context: &Context<'_>,
        network: &Network,
        commands: &mut CommandSender,
    ) {
        let (panel, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let Some(drawn) = &self.drawn else { return };
        let (vertices, edges) = (drawn.graph.vertices.len(), drawn.graph.edges.len());
        let cycle = drawn.graph.edges.iter().filter(|edge| edge.is_in_cycle).count();
        response.widget_info(|| {
            let mut name = format!("Distance graph of {vertices} events and {edges} bounds");
            if cycle > 0 {
                name.push_str(&format!("; {cycle} of them form a negative cycle"));
            }
            WidgetInfo::labeled(Role::Image, true, name)
        });
        let action = context.view_action(PanelKind::Distances);
        move_view(&mut self.view, ui, panel, &response, action, drawn);
        let focus = context.focus().unwrap_or_default();
        let painter = ui.painter_at(panel);
        let scene = paint::Scene {
            painter: &painter,
            panel,
            view: &self.view,
            graph: &drawn.graph,
            arranged: &drawn.arranged,
            network,
            tokens: context.tokens,
            selection: &context.state.selection,
            focus: &focus,
        };
        let pointed = response.hover_pos().and_then(|pointer| scene.pointed(pointer));
        scene.paint(pointed);
        if let Some(pointed) = pointed {
            response.clone().on_hover_ui_at_pointer(|ui| {
                for line in scene.describe(pointed) {
                    ui.label(RichText::new(line).color(context.tokens.text));
                }
            });
        }
        if response.clicked() {
            let selection = pointed.map_or(Selection::None, |pointed| scene.selection_of(pointed));
            commands.send(Command::Select(selection));
        }
        if response.double_clicked() {
            commands.send(Command::Window(WindowCommand::ViewOf(PanelKind::Distances, ViewAction::Fit)));
        }
    }
}

fn move_view(
    view: &mut View,
    ui: &Ui,
    panel: Rect,
    response: &egui::Response,
    action: Option<ViewAction>,
    drawn: &Drawn,
) {
    let bounds = drawn.arranged.bounds;
    if response.dragged() {
        view.pan(response.drag_delta());
    }
    if let Some(pointer) = response.hover_pos() {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta(), input.zoom_delta()));
        let factor = if pinch == 1.0 { (f64::from(scroll.y) * WHEEL_ZOOM).exp() } else { f64::from(pinch) };
        if factor != 1.0 {
            view.zoom_at(panel, pointer, factor);
        }
    }
    match action {
        None | Some(ViewAction::TopView | ViewAction::Follow | ViewAction::Tour) => {}
        Some(ViewAction::ZoomIn) => view.zoom_at(panel, panel.center(), KEY_ZOOM),
        Some(ViewAction::ZoomOut) => view.zoom_at(panel, panel.center(), 1.0 / KEY_ZOOM),
        Some(ViewAction::ZoomReset) => view.reset_zoom(),
        Some(ViewAction::Fit) => view.show(panel, bounds, LARGEST_WHOLE),
        Some(ViewAction::FitSelection) => view.keep_fitted(),
    }
    if view.is_fitted() {
        view.fit_legibly(panel, bounds, part_that_matters(drawn), MIN_ZOOM);
    }
}

/// Returns where the contradiction is, or what is selected.
fn part_that_matters(drawn: &Drawn) -> Option<display::Rect> {
    let Drawn { graph, arranged, seeds, .. } = drawn;
    let edges = graph.edges.iter().filter(|edge| edge.is_in_cycle);
    let mut vertices: Vec<usize> = edges.flat_map(|edge| [edge.from, edge.to]).collect();
    if vertices.is_empty() {
        let is_selected = |vertex: &graph::Vertex| vertex.nodes.iter().any(|node| seeds.contains(node));
        vertices = (0..graph.vertices.len()).filter(|&at| is_selected(&graph.vertices[at])).collect();
    }
    let places = vertices.iter().filter_map(|&vertex| arranged.places.get(vertex));
    let areas = places.map(|&place| display::Rect { min: place, max: place }.expanded(40.0));
    areas.reduce(display::Rect::union)
}

/// A contradiction of more bounds is told by its two sides: all that has to pass, and all that may.
const MAX_WEIGHTS: usize = 12;

/// The weights of a contradiction, and what they come to.
fn sum_of(cycle: &[CycleMember]) -> String {
    let words = |sum: Option<exact::Time>| sum.map_or_else(|| "…".to_owned(), workbench::time_text::time);
    let total = words(exact::Time::checked_sum(cycle.iter().map(|member| member.weight)));
    if cycle.len() <= MAX_WEIGHTS {
        let weights: Vec<String> =
            cycle.iter().map(|member| workbench::time_text::time(member.weight)).collect();
        return format!("Negative cycle: {} = {total}", weights.join(" + ").replace("+ -", "− "));
    }
    let side = |is_negative: bool| {
        let weights = cycle.iter().map(|member| member.weight);
        exact::Time::checked_sum(weights.filter(move |weight| weight.is_negative() == is_negative))
    };
    let needed = side(true).and_then(exact::Time::checked_neg);
    format!("Negative cycle of {} bounds: {} − {} = {total}", cycle.len(), words(side(false)), words(needed))
}

/// The events of what is selected.
fn seeds(selection: &Selection, network: &Network) -> Vec<NodeId> {
    if let Selection::Node(node) = selection {
        return vec![*node];
    }
    let occurrence = selection.occurrence(network).and_then(|id| network.occurrences.get(id.index()));
    occurrence.map_or_else(Vec::new, |occurrence| vec![occurrence.start, occurrence.end])
}
