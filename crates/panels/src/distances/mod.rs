//! The distances between the events of the plan, or of the step of the search that is looked at: as a graph with the
//! bounds on its edges, where a negative cycle stands out, and as a matrix of the shortest distances (SPEC 4).

mod arrange;
mod graph;
mod matrix;
mod paint;

use std::sync::Arc;

use egui::{Rect, RichText, Role, Sense, Ui, WidgetInfo};
use kirk::CycleMember;
use mission::Snapshot;
use theme::space;
use tpn::{ArcId, Network, NodeId, Plan};
use workbench::PanelKind;
use workbench::command::{Command, CommandSender, ViewAction};
use workbench::state::Selection;

use super::network::view::View;
use super::{Context, Panel, show_empty};
use arrange::{Arranged, arrange};
use graph::{DistanceGraph, Selected};

/// The panel.
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
    graph: DistanceGraph,
    arranged: Arranged,
}

/// Larger graphs are not drawn: nobody could read them.
const MAX_VERTICES: usize = 60;
/// Nor are graphs of more events made, to find how many vertices they would have.
const MAX_EVENTS: usize = 2_000;
const WHEEL_ZOOM: f64 = 0.0022;
const KEY_ZOOM: f64 = 1.3;

impl Panel for DistancesPanel {
    fn show(&mut self, ui: &mut Ui, context: &Context<'_>, commands: &mut CommandSender) {
        let (Some(snapshot), Some((network, plan))) = (context.snapshot, context.plan()) else {
            let text = "There is no plan whose distances could be shown. Step through the search to see those of a step.";
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
            let parts = matrix::Parts { network, nodes: &selected.0, arcs: &selected.1, plan, cycle };
            matrix::show(ui, context, &parts, commands);
            return;
        }
        self.follow(context, snapshot, network, plan, &selected, cycle);
        let Some(drawn) = &self.drawn else { return };
        if drawn.graph.vertices.is_empty() {
            let text = format!(
                "The graph has too many events to be read: {} are selected, and it shows up to {MAX_VERTICES} points in time.",
                selected.0.len()
            );
            show_empty(ui, context, &text);
            return;
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
                        (true, _) => "the least upper bound from row to column",
                        (false, None) => "x → y: y happens at most so much after x, in the plan",
                        (false, Some(_)) => "x → y: y happens at most so much after x, at this step",
                    };
                    ui.label(RichText::new(text).small().color(tokens.text_muted));
                } else {
                    let total = exact::Time::checked_sum(cycle.iter().map(|member| member.weight));
                    let weights: Vec<String> =
                        cycle.iter().map(|member| workbench::time_text::time(member.weight)).collect();
                    let total = total.map_or_else(|| "…".to_owned(), workbench::time_text::time);
                    let text =
                        format!("✗ Negative cycle: {} = {total}", weights.join(" + ").replace("+ -", "− "));
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
        let is_current = self
            .drawn
            .as_ref()
            .is_some_and(|drawn| drawn.snapshot.shows_same(snapshot) && std::ptr::eq(drawn.plan, plan));
        if is_current {
            return;
        }
        let (nodes, arcs) = selected;
        let mut graph = DistanceGraph::default();
        if nodes.len() <= MAX_EVENTS {
            graph = DistanceGraph::new(&Selected { network, nodes, arcs, plan, cycle });
        }
        if graph.vertices.len() > MAX_VERTICES {
            graph = DistanceGraph::default();
        }
        let widths: Vec<f64> = graph.vertices.iter().map(paint::width).collect();
        let arranged = arrange(&graph, &widths);
        let step = context.step().map(|view| Arc::clone(&view.plan));
        self.drawn = Some(Drawn { snapshot: Arc::clone(snapshot), plan, _step: step, graph, arranged });
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
            let mut name = format!("Distance graph of {vertices} points in time and {edges} bounds");
            if cycle > 0 {
                name.push_str(&format!("; {cycle} of them form a negative cycle"));
            }
            WidgetInfo::labeled(Role::Image, true, name)
        });
        let action = context.view_action(PanelKind::Distances);
        move_view(&mut self.view, ui, panel, &response, action, &drawn.arranged);
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
            commands.send(Command::ViewOf(PanelKind::Distances, ViewAction::Fit));
        }
    }
}

fn move_view(
    view: &mut View,
    ui: &Ui,
    panel: Rect,
    response: &egui::Response,
    action: Option<ViewAction>,
    arranged: &Arranged,
) {
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
        None | Some(ViewAction::TopView | ViewAction::Follow) => {}
        Some(ViewAction::ZoomIn) => view.zoom_at(panel, panel.center(), KEY_ZOOM),
        Some(ViewAction::ZoomOut) => view.zoom_at(panel, panel.center(), 1.0 / KEY_ZOOM),
        Some(ViewAction::ZoomReset) => view.reset_zoom(),
        Some(ViewAction::Fit | ViewAction::FitSelection) => view.fit(panel, arranged.bounds),
    }
    if view.is_fitted() {
        view.fit(panel, arranged.bounds);
    }
}
