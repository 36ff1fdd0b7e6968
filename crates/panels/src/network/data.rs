//! What is drawn: the layout of the network and what the plan or its failure adds, kept until either changes.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use display::{DisplayList, Piece, Point, approximate_text_width};
use layout::list::network_before::{NetworkChanges, changes_list};
use layout::overlay::{causal_links, negative_cycle, orderings, threats, windows};
use layout::timeline::before::Before;
use layout::{NetworkDrawing, NetworkState, Options, OverlayCurve, TextShape};
use snapshot::{ContentKey, Planning, Snapshot};
use tpn::{BlockId, BlockKind, Network, NodeId, Plan};
use workbench::state::search::View;
use workbench::state::selection::node_name;
use workbench::state::settings::NetworkView;

use super::detail::Detail;
use super::marks::{Mark, marks};

/// A drawing with what lies over it.
#[derive(Default)]
pub(super) struct Drawn {
    network: Option<Arc<Network>>,
    /// Of the network, if it is that of a snapshot.
    key: Option<ContentKey>,
    planning: Option<Arc<Planning>>,
    /// What the search had selected at the step that is looked at.
    step: Option<Arc<Plan>>,
    detail: Detail,
    pub(super) drawing: NetworkDrawing,
    /// Causal links of the plan.
    pub(super) links: Vec<OverlayCurve>,
    /// Orderings that the plan adds.
    pub(super) orderings: Vec<OverlayCurve>,
    /// A contradiction among the bounds, if there is no plan.
    pub(super) cycle: Vec<OverlayCurve>,
    /// Pairs of conditions that leave no plan because they cannot be kept apart.
    pub(super) threats: Vec<OverlayCurve>,
    /// Problems at their places.
    pub(super) marks: Vec<Mark>,
    /// The revision and stage of the problems.
    marked: Option<(u64, snapshot::Stage)>,
    /// The pins whose windows are shown; `None` while windows are not kept up to date.
    pins: Option<u64>,
    /// The windows of the plan, while they are shown.
    pub(super) windows: Vec<TextShape>,
    /// The texts that slide along each arch, by the arch's place in the drawing.
    pub(super) sliding: BTreeMap<u32, Vec<u32>>,
    /// The lines of the overview.
    pub(super) outline: Vec<(Point, Point)>,
    /// Grows whenever the drawing changes.
    pub(super) version: u64,
    /// Grows whenever what lies over it changes.
    laid_over: u64,
    /// The display list, and what it was built for.
    pub(super) list: DisplayList,
    listed: Option<Listed>,
    /// What differs from the plan that was last approved, over the list.
    pub(super) changes: Option<DisplayList>,
}

/// The plan that was last approved, to be laid over the present one.
pub(super) struct Approved<'a> {
    /// What tells one from another.
    pub(super) key: String,
    /// When things could be in it, if it is another plan than the present one. Takes a while.
    pub(super) times: &'a dyn Fn() -> Option<Before>,
}

/// What a display list was built for: the drawing, what lies over it, whether there is a plan, and what is shown.
#[derive(PartialEq)]
struct Listed {
    version: u64,
    laid_over: u64,
    has_plan: bool,
    options: NetworkView,
    approved: Option<String>,
}

impl Drawn {
    /// Draws what `snapshot` holds, as far as it has changed. Returns whether the drawing is new. `windows_of` are the
    /// pins whose windows are written, and the plan with them; `None` while windows are not shown.
    pub(super) fn follow(
        &mut self,
        snapshot: &Snapshot,
        network: &Arc<Network>,
        step: Option<&View>,
        detail: &Detail,
        latest: Option<&Snapshot>,
        windows_of: Option<(u64, Option<&Plan>)>,
    ) -> bool {
        let same = |one: &Option<Arc<Network>>| one.as_ref().is_some_and(|one| Arc::ptr_eq(one, network));
        // A network whose places in the text have moved is drawn as it was.
        let key = same(&snapshot.network)
            .then_some(snapshot.keys.network)
            .filter(|&key| key != ContentKey::default());
        let is_same = same(&self.network) || key.is_some() && self.key == key;
        let is_new = !is_same || self.detail != *detail;
        self.key = key;
        if !is_new {
            self.network = Some(Arc::clone(network));
        }
        if is_new {
            self.drawing = detail.drawing(network);
            self.sliding = sliding_texts(&self.drawing);
            self.outline = outline(&self.drawing, network);
            self.network = Some(Arc::clone(network));
            self.detail.clone_from(detail);
            self.version += 1;
        }
        let same_planning = match (&self.planning, &snapshot.planning) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (None, None) => true,
            _ => false,
        };
        let same_step = match (&self.step, step) {
            (Some(one), Some(view)) => Arc::ptr_eq(one, &view.plan),
            (None, None) => true,
            _ => false,
        };
        if is_new || !same_planning || !same_step {
            self.planning.clone_from(&snapshot.planning);
            self.step = step.map(|view| Arc::clone(&view.plan));
            self.lay_over(network, snapshot, step);
        }
        match windows_of {
            None => self.pins = None,
            Some((pins, pinned)) => {
                if is_new || !same_planning || !same_step || self.pins != Some(pins) {
                    self.pins = Some(pins);
                    self.laid_over += 1;
                    let plan = step.map(|view| view.plan.as_ref()).or(pinned).or_else(|| snapshot.plan());
                    let plan = plan.filter(|plan| fits(plan, network));
                    let width = Options::default().window_width;
                    let measure = &approximate_text_width;
                    self.windows =
                        plan.map(|plan| windows(&self.drawing, plan, width, measure)).unwrap_or_default();
                }
            }
        }
        let problems = latest.map(|latest| (latest.revision, latest.stage));
        if is_new || self.marked != problems {
            self.marked = problems;
            self.marks = latest
                .map(|latest| marks(&self.drawing, network, &snapshot.source, latest))
                .unwrap_or_default();
        }
        is_new
    }

    /// Builds the display list, unless it is that of the same content. `plan` is the one that was followed.
    pub(super) fn list(
        &mut self,
        network: &Network,
        plan: Option<&Plan>,
        options: &NetworkView,
        approved: Option<&Approved<'_>>,
    ) {
        let (version, laid_over) = (self.version, self.laid_over);
        let key = approved.map(|approved| approved.key.clone());
        let wanted =
            Listed { version, laid_over, has_plan: plan.is_some(), options: options.clone(), approved: key };
        if self.listed.as_ref() == Some(&wanted) {
            return;
        }
        let links = options.links.then_some(&self.links);
        let orderings = options.orderings.then_some(&self.orderings);
        let curves = links.into_iter().chain(orderings).chain([&self.cycle, &self.threats]);
        let overlays: Vec<OverlayCurve> = curves.flatten().cloned().collect();
        let notes = if options.windows { self.windows.as_slice() } else { &[] };
        let state = NetworkState { plan, overlays: &overlays, notes, parts: options.parts() };
        self.list = layout::network_list(&self.drawing, network, &state).indexed();
        let before = approved.and_then(|approved| (approved.times)());
        self.changes = before.zip(plan).map(|(before, plan)| {
            let changes = NetworkChanges::new(&before, network, plan);
            changes_list(&self.drawing, (network, plan), &changes, &approximate_text_width)
        });
        self.listed = Some(wanted);
    }

    /// The area of the drawing, with what is laid over it.
    pub(super) fn frame(&self) -> display::Rect {
        self.changes.as_ref().map_or(self.drawing.bounds, |changes| changes.frame)
    }

    fn lay_over(&mut self, network: &Network, snapshot: &Snapshot, step: Option<&View>) {
        self.laid_over += 1;
        self.links.clear();
        self.orderings.clear();
        self.threats.clear();
        self.cycle.clear();
        let plan = step.map(|view| view.plan.as_ref()).or_else(|| snapshot.plan());
        if let Some(plan) = plan.filter(|plan| fits(plan, network)) {
            self.links = causal_links(&self.drawing, network, plan);
            self.orderings = orderings(&self.drawing, network, plan);
            let cycle: Vec<NodeId> =
                step.iter().flat_map(|view| &view.step.cycle).map(|member| member.from).collect();
            self.cycle = negative_cycle(&self.drawing, network, &cycle);
        } else if let Some(events) = cycle_events(snapshot) {
            self.cycle = negative_cycle(&self.drawing, network, &events);
        } else {
            self.threats = threats(&self.drawing, network, &unresolved_threats(snapshot));
        }
    }
}

/// Returns whether a plan speaks of this network: one snapshot's always does, but a drawing must not rely on it.
pub(super) fn fits(plan: &Plan, network: &Network) -> bool {
    plan.selected_nodes.len() == network.nodes.len() && plan.selected_arcs.len() == network.arcs.len()
}

/// The events of the first contradiction among the bounds that the planner reports.
fn cycle_events(snapshot: &Snapshot) -> Option<Vec<NodeId>> {
    let failure = snapshot.planning.as_ref()?.outcome.failure.as_ref()?;
    let reason = failure.reasons.iter().find(|reason| !reason.cycle.is_empty())?;
    Some(reason.cycle.iter().map(|member| member.from).collect())
}

/// The pairs of conditions that, by the planner's reasons, cannot be kept apart.
fn unresolved_threats(snapshot: &Snapshot) -> Vec<[tpn::LabelId; 2]> {
    let failure = snapshot.planning.as_ref().and_then(|planning| planning.outcome.failure.as_ref());
    let reasons = failure.into_iter().flat_map(|failure| &failure.reasons);
    reasons
        .filter(|reason| reason.kind == kirk::FailureKind::Threat)
        .filter_map(|reason| {
            let mut conditions = reason.conflict.iter().filter_map(|member| match member {
                kirk::Member::Condition(label) => Some(*label),
                kirk::Member::Use(_) | kirk::Member::Bound(_) => None,
            });
            Some([conditions.next()?, conditions.next()?])
        })
        .collect()
}

/// The names of the outermost activities inside the mission.
pub(super) fn outermost_activities(network: &Network) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut pending: Vec<BlockId> = network.root.into_iter().collect();
    while let Some(id) = pending.pop() {
        let Some(block) = network.blocks.get(id.index()) else { continue };
        let occurrence = match block.kind {
            BlockKind::Scope { occurrence, .. } => occurrence,
            _ => None,
        };
        let kind = occurrence.and_then(|it| network.occurrences.get(it.index())).map(|it| it.kind);
        if kind == Some(tpn::OccurrenceKind::Activity) && is_collapsible(network, id) {
            found.extend(block_key(network, id));
        } else {
            pending.extend(layout::block_children(&block.kind));
        }
    }
    found
}

/// Names a block so that it is found again after an edit.
pub(super) fn block_key(network: &Network, block: BlockId) -> Option<String> {
    let block = network.blocks.get(block.index())?;
    if let BlockKind::Scope { occurrence: Some(occurrence), .. } = block.kind {
        return Some(network.occurrences.get(occurrence.index())?.name.to_string());
    }
    let [start, end] = [block.start, block.end].map(|node| node_name(network, node));
    Some(format!("{}@{start}…{end}", layout::text::structure_name(&block.kind)))
}

/// Returns whether a block can be collapsed: single arcs cannot, nor can the whole mission.
pub(super) fn is_collapsible(network: &Network, block: BlockId) -> bool {
    let is_part = |kind: &BlockKind| !matches!(kind, BlockKind::Leaf { .. });
    network.root != Some(block) && network.blocks.get(block.index()).is_some_and(|block| is_part(&block.kind))
}

pub(super) fn collapsed_blocks(network: &Network, keys: &BTreeSet<String>) -> BTreeSet<BlockId> {
    if keys.is_empty() {
        return BTreeSet::new();
    }
    let blocks = (0..network.blocks.len()).map(BlockId::from_index);
    blocks
        .filter(|&block| is_collapsible(network, block))
        .filter(|&block| block_key(network, block).is_some_and(|key| keys.contains(&key)))
        .collect()
}

fn sliding_texts(drawing: &NetworkDrawing) -> BTreeMap<u32, Vec<u32>> {
    let slots: BTreeMap<_, _> = drawing
        .arcs
        .iter()
        .enumerate()
        .filter(|(_, arc)| arc.route == layout::Route::Arch)
        .collect::<Vec<_>>()
        .into_iter()
        .map(|(slot, arc)| (arc.id, slot as u32))
        .collect();
    let mut sliding: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (at, text) in drawing.texts.iter().enumerate() {
        if let Some(&slot) = text.slide.and_then(|slide| slots.get(&slide.arc)) {
            sliding.entry(slot).or_default().push(at as u32);
        }
    }
    sliding
}

/// The activities as level lines: enough to recognize a drawing by when it is very small.
fn outline(drawing: &NetworkDrawing, network: &Network) -> Vec<(Point, Point)> {
    let arcs = drawing
        .arcs
        .iter()
        .filter(|arc| arc.route == layout::Route::Along && network.arcs[arc.id.index()].occurrence.is_some());
    arcs.filter_map(|arc| match drawing.pieces(arc) {
        [Piece::Line(end)] => Some((arc.start, *end)),
        _ => None,
    })
    .collect()
}
