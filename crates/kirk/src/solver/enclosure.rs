//! Whether the program's blocks alone keep a pair of intervals from ever being one before the other, whatever is chosen.
//!
//! What is outside of a block that nothing else leads out of matters to its inside only by how long the block may last. Of
//! two intervals in such a block one is before the other by a path that goes through the outside at most once: then the
//! block is as short or as long as its inside allows at most. So each choice outside of it counts in one of two networks.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use stn::{PointId, Stn};
use tpn::{ArcId, BlockId, Choice, DecisionId, LabelId, NodeId};

use crate::model::{Context, INFINITE, Model, node};
use crate::structure::{Enclosing, Structure, Within};

/// Choices inside of a block that have more different durations together are not looked into.
const MAX_NETWORKS: usize = 64;

/// Arcs of networks that may be built, for each arc of the mission.
const MAX_ARCS_PER_ARC: usize = 64;

/// What is known of a mission's blocks.
#[derive(Clone, Debug)]
pub(super) struct Enclosures<'m> {
    mission: &'m Model,
    /// What leads out of blocks, once that has been looked at; nothing if the blocks are not all that there is.
    enclosing: OnceCell<Option<Enclosing>>,
    /// By block, and by what of it two labels need: what holds in it, for all durations that its other choices may have. Empty
    /// where that is not known.
    networks: BTreeMap<(BlockId, Context, Context), Vec<Enclosed>>,
    /// How many arcs have been built into networks.
    num_arcs: usize,
}

/// The arcs of a block, with each causal link that there may be in it.
#[derive(Clone, Debug)]
struct Enclosed {
    points: BTreeMap<NodeId, PointId>,
    stn: Stn,
}

impl<'m> Enclosures<'m> {
    pub(super) const fn new(mission: &'m Model) -> Self {
        Self { mission, enclosing: OnceCell::new(), networks: BTreeMap::new(), num_arcs: 0 }
    }

    /// The mission, of which only a part may be looked at.
    pub(super) const fn mission(&self) -> &'m Model {
        self.mission
    }

    /// Returns whether no choice of alternatives and links makes one of a pair be over before the other begins. `false`
    /// if that is not known.
    pub(super) fn never_orders(&mut self, pair: (LabelId, LabelId)) -> bool {
        self.looks_unordered(pair).unwrap_or(false)
    }

    fn looks_unordered(&mut self, (left, right): (LabelId, LabelId)) -> Option<bool> {
        let Self { mission, enclosing, networks, num_arcs } = self;
        let (mission, structure) = (*mission, mission.structure.as_ref()?);
        let enclosing = enclosing.get_or_init(|| enclosing_of(mission, structure)).as_ref()?;
        let arcs = [left, right].map(|label| mission.conditions.labels[label].arc);
        let block = structure.smallest_around(enclosing, arcs[0], arcs[1])?;
        let [of_left, of_right] = arcs.map(|arc| {
            let context = mission.arcs[arc].context;
            context.filter(|choice| structure.is_inside(enclosing, choice.decision, block))
        });
        let networks = networks.entry((block, of_left, of_right)).or_insert_with(|| {
            if *num_arcs > MAX_ARCS_PER_ARC * mission.arcs.len() {
                return Vec::new();
            }
            let inside = Inside::new(mission, structure, enclosing, block, [of_left, of_right]);
            let networks = inside.networks().unwrap_or_default();
            *num_arcs += inside.within.arcs.len() + networks.iter().map(Enclosed::num_arcs).sum::<usize>();
            networks
        });
        let is_ordered = |network: &mut Enclosed| {
            network.puts_before(mission, left, right) || network.puts_before(mission, right, left)
        };
        Some(!networks.is_empty() && !networks.iter_mut().any(is_ordered))
    }
}

/// `None` if there is more than the blocks.
fn enclosing_of(mission: &Model, structure: &Structure) -> Option<Enclosing> {
    if !structure.has_all_but(mission.constraints.len()) {
        return None;
    }
    let labels = &mission.conditions.labels;
    let mut partners: Vec<(BlockId, BlockId)> = Vec::new();
    for ask in labels.keys().filter(|&ask| labels[ask].is_ask && !labels[ask].is_lasting) {
        for tell in mission.conditions.supporters(ask) {
            if labels[tell].arc != labels[ask].arc && mission.can_be_together(ask, tell) {
                let block = |label: LabelId| structure.block_of(labels[label].arc);
                partners.push((block(ask)?, block(tell)?));
            }
        }
    }
    if !mission.constraints.is_empty() {
        let blocks = structure.blocks_at_ends();
        for &constraint in &mission.constraints {
            let arc = &mission.arcs[constraint];
            partners.push((*blocks.get(&arc.from)?, *blocks.get(&arc.to)?));
        }
    }
    Some(Enclosing::new(structure, &partners))
}

/// A block, where the alternatives are chosen that two labels need.
struct Inside<'a> {
    mission: &'a Model,
    structure: &'a Structure,
    enclosing: &'a Enclosing,
    block: BlockId,
    chosen: BTreeMap<DecisionId, u32>,
    within: Within,
}

type Ends = (NodeId, NodeId);

/// Least and greatest ones, of which one counts.
type Durations = Vec<(i64, i64)>;

impl<'a> Inside<'a> {
    fn new(
        mission: &'a Model,
        structure: &'a Structure,
        enclosing: &'a Enclosing,
        block: BlockId,
        contexts: [Context; 2],
    ) -> Self {
        let (chosen, within) = (BTreeMap::new(), Within::default());
        let mut inside = Self { mission, structure, enclosing, block, chosen, within };
        for context in contexts {
            inside.chosen = inside.choices_around(context).chain(inside.chosen.clone()).collect();
        }
        inside.within = structure.within(block, &inside.chosen);
        inside
    }

    /// The choices in the block that something is part of, the innermost first.
    fn choices_around(&self, context: Context) -> impl Iterator<Item = (DecisionId, u32)> {
        let outer = |choice: &Choice| self.mission.decisions[choice.decision].context;
        let is_inside =
            |choice: &Choice| self.structure.is_inside(self.enclosing, choice.decision, self.block);
        std::iter::successors(context, outer)
            .take_while(is_inside)
            .map(|Choice { decision, alternative }| (decision, alternative))
    }

    /// Returns what holds in the block, for all durations of its open choices. `None` if that is too much.
    fn networks(&self) -> Option<Vec<Enclosed>> {
        let open = self.durations_of_open_choices()?;
        let links = if self.enclosing.has_links(self.block) { self.possible_links()? } else { Vec::new() };
        let mut network = Enclosed { points: BTreeMap::new(), stn: Stn::new(0) };
        let (start, end) = self.structure.ends(self.block);
        let (start, end) = (network.point(start), network.point(end));
        network.stn.set_origin(start);
        for &arc in &self.within.arcs {
            let arc = &self.mission.arcs[arc];
            network.bound(arc.from, arc.to, (arc.lower, arc.upper));
        }
        let mut networks = vec![network];
        for ((from, to), durations) in open {
            let longer = networks.iter().flat_map(|network| {
                durations.iter().map(move |&duration| {
                    let mut network = network.clone();
                    network.bound(from, to, duration);
                    network
                })
            });
            networks = longer.collect();
        }
        let mut settled = Vec::with_capacity(2 * networks.len());
        for mut network in networks {
            let order: Vec<PointId> = network.points.values().copied().collect();
            // A network that contradicts itself belongs to no plan.
            if network.stn.settle(&order).is_err() {
                continue;
            }
            for &((ask_start, ask_end), (tell_start, tell_end)) in &links {
                for (from, to) in [(ask_start, tell_start), (tell_end, ask_end)] {
                    let (from, to) = (network.point(from), network.point(to));
                    network.stn.insert(from, to, 0, 0).ok()?;
                }
            }
            if self.structure.is_root(self.block) {
                settled.push(network);
                continue;
            }
            let (shortest, longest) = network.between(start, end)?;
            // Where nothing inside limits how long it lasts, anything outside may make it last.
            let longest = if longest == INFINITE { self.longest()? } else { longest };
            let mut in_short = network.clone();
            in_short.stn.insert(start, end, shortest, 0).ok()?;
            network.stn.insert(end, start, -longest, 0).ok()?;
            settled.extend([in_short, network]);
        }
        Some(settled)
    }

    /// The ends of each open choice, and the durations that it may have. `None` if there are too many together.
    fn durations_of_open_choices(&self) -> Option<Vec<(Ends, Durations)>> {
        let mut num_networks = 1;
        let mut open = Vec::with_capacity(self.within.open.len());
        for &decision in &self.within.open {
            let durations = self.structure.durations(decision)?;
            num_networks *= durations.len();
            if num_networks > MAX_NETWORKS {
                return None;
            }
            let (from, to, ..) = self.structure.initial_bounds(decision);
            open.push(((from, to), durations));
        }
        Some(open)
    }

    /// More than all that the mission bounds.
    fn longest(&self) -> Option<i64> {
        let finite = |bound: i64| if bound == INFINITE { 0 } else { bound };
        self.mission.arcs.iter().try_fold(1_i64, |sum, arc| {
            sum.checked_add(finite(arc.lower))?.checked_add(finite(arc.upper)).filter(|&sum| sum < 1 << 60)
        })
    }

    /// Returns what each assertion in the block would contain if it carried all that it may carry: what is required
    /// inside a choice that is open counts as all of it, which is more. `None` where an assertion is inside such a
    /// choice, or where there are bounds between threads.
    fn possible_links(&self) -> Option<Vec<(Ends, Ends)>> {
        let conditions = &self.mission.conditions;
        if !self.mission.constraints.is_empty() {
            return None;
        }
        let labels = &conditions.labels;
        let ends = |label: LabelId| {
            let (start, end) = self.mission.interval(label);
            (node(start), node(end))
        };
        let mut links = Vec::new();
        for ask in labels.keys().filter(|&ask| labels[ask].is_ask && !labels[ask].is_lasting) {
            let asked = match self.place(labels[ask].arc) {
                Place::Nowhere => continue,
                Place::Sure => ends(ask),
                Place::InOpen(decision) => {
                    let (from, to, ..) = self.structure.initial_bounds(decision);
                    (from, to)
                }
            };
            for tell in conditions.supporters(ask).filter(|&tell| labels[tell].arc != labels[ask].arc) {
                match self.place(labels[tell].arc) {
                    Place::Nowhere => {}
                    Place::Sure => links.push((asked, ends(tell))),
                    Place::InOpen(_) => return None,
                }
            }
        }
        Some(links)
    }

    fn place(&self, arc: ArcId) -> Place {
        let is_inside = |block: BlockId| self.enclosing.has(self.block, block);
        if !self.structure.block_of(arc).is_some_and(is_inside) {
            return Place::Nowhere;
        }
        let mut place = Place::Sure;
        for (decision, alternative) in self.choices_around(self.mission.arcs[arc].context) {
            match self.chosen.get(&decision) {
                Some(&taken) if taken == alternative => {}
                Some(_) => return Place::Nowhere,
                None => place = Place::InOpen(decision),
            }
        }
        place
    }
}

/// Where an arc is, when some alternatives are chosen.
enum Place {
    /// In an alternative that is not chosen, or outside of the block.
    Nowhere,
    Sure,
    /// Inside a choice that is open.
    InOpen(DecisionId),
}

impl Enclosed {
    fn num_arcs(&self) -> usize {
        self.stn.num_edges()
    }

    fn point(&mut self, node: NodeId) -> PointId {
        let next = PointId(self.points.len() as u32);
        let point = *self.points.entry(node).or_insert(next);
        self.stn.resize(self.points.len());
        point
    }

    fn bound(&mut self, from: NodeId, to: NodeId, (lower, upper): (i64, i64)) {
        let (from, to) = (self.point(from), self.point(to));
        if upper != INFINITE {
            self.stn.push(from, to, upper, 0);
        }
        self.stn.push(to, from, -lower, 0);
    }

    /// Returns how long it is at least and at most from one point to another. `None` if that does not fit.
    fn between(&mut self, from: PointId, to: PointId) -> Option<(i64, i64)> {
        let mut row = Vec::new();
        self.stn.distances_from(to, &mut row).ok()?;
        let least = row[from.index()];
        self.stn.distances_from(from, &mut row).ok()?;
        Some((if least == INFINITE { 0 } else { -least }, row[to.index()]))
    }

    /// Returns whether an interval is over before another begins, in every schedule.
    fn puts_before(&mut self, mission: &Model, first: LabelId, then: LabelId) -> bool {
        let (end, start) = (mission.interval(first).1, mission.interval(then).0);
        let gap = mission.gap_before(then, mission.gap_after[first]);
        let (end, start) = (self.point(node(end)), self.point(node(start)));
        let times = self.stn.schedule();
        // What does not fit any more is entailed.
        times[start.index()] - times[end.index()] >= gap && self.stn.admits(end, start, gap - 1, 0).is_err()
    }
}
