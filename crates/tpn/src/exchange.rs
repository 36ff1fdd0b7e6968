//! Plans that differ only in which of several interchangeable vehicles does what (SPEC 17).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::network::{ArcId, BlockId, BlockKind, DecisionId, Extent, LabelId, Network};
use crate::plan::{CausalLink, Choice, Ordering, Plan};

/// So many interchangeable vehicles are exchanged in all pairs, more of them only with their neighbors.
const MAX_IN_PAIRS: usize = 8;

/// So many blocks are looked at for all exchanges together; none are exchanged after that.
const MAX_BLOCKS: usize = 5_000_000;

/// What a network is made of that vehicles can be exchanged in.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Exchangeable {
    /// Interchangeable vehicles, those of each list with each other.
    pub vehicles: Vec<Vec<SmolStr>>,
    /// Blocks whose parts are copies of one statement, with the member of a group that each is for.
    pub copies: BTreeMap<BlockId, Vec<SmolStr>>,
}

/// What becomes of a plan when two interchangeable vehicles are exchanged, for several pairs.
#[derive(Clone, Debug, Default)]
pub struct Exchanges {
    exchanges: Vec<Exchange>,
}

/// What two vehicles that are exchanged do to each part of a network.
#[derive(Clone, Debug)]
struct Exchange {
    /// The decision that each becomes, if it changes, and the alternatives that change their places.
    decisions: BTreeMap<DecisionId, (DecisionId, Vec<(u32, u32)>)>,
    /// Labels that become others.
    labels: BTreeMap<LabelId, LabelId>,
}

/// What tells plans apart, in the order in which they are preferred.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Distinction {
    pub choices: Vec<Choice>,
    links: Vec<CausalLink>,
    orders: Vec<Ordering>,
    /// In each list the order of what gives a variable its values.
    producers: Vec<Vec<LabelId>>,
}

impl Exchanges {
    /// The exchanges of a network's interchangeable vehicles.
    pub fn new(network: &Network) -> Self {
        let pairs = network.exchangeable.vehicles.iter().flat_map(|vehicles| {
            vehicles.iter().enumerate().flat_map(|(at, one)| {
                let others = if vehicles.len() <= MAX_IN_PAIRS { vehicles.len() } else { at + 2 };
                vehicles.iter().take(others).skip(at + 1).map(move |other| (one, other))
            })
        });
        let most = MAX_BLOCKS / network.blocks.len().max(1);
        let exchanges = pairs.take(most).filter_map(|(one, other)| Exchange::new(network, one, other));
        Self { exchanges: exchanges.collect() }
    }

    /// Returns what tells a plan apart from those that differ in more than exchanged vehicles: the least that
    /// exchanging vehicles leads to.
    pub fn least(&self, plan: &Plan) -> Distinction {
        let mut least = Distinction::of(plan);
        while let Some(lesser) = self.exchanges.iter().find_map(|exchange| exchange.lesser(&least)) {
            least = lesser;
        }
        least
    }
}

impl Distinction {
    /// Returns what tells a plan apart from all others.
    pub fn of(plan: &Plan) -> Self {
        Self {
            choices: plan.choices.clone(),
            links: plan.causal_links.clone(),
            orders: plan.conflict_order.clone(),
            producers: plan.state_order.iter().map(|order| order.producers.clone()).collect(),
        }
        .sorted()
    }

    fn sorted(mut self) -> Self {
        self.choices.sort_unstable();
        self.links.sort_unstable();
        self.orders.sort_unstable();
        self.producers.sort_unstable();
        self
    }
}

impl Exchange {
    /// `None` if the vehicles are not exchangeable there, such as in a sequence.
    fn new(network: &Network, one: &str, other: &str) -> Option<Self> {
        let mut exchange = Self { decisions: BTreeMap::new(), labels: initial(network, one, other) };
        let root = network.root?;
        let mut open = vec![(root, root)];
        while let Some((from, to)) = open.pop() {
            let places = places(network, (from, to), (one, other))?;
            match (&network.blocks[from.index()].kind, &network.blocks[to.index()].kind) {
                (BlockKind::Leaf { arc }, BlockKind::Leaf { arc: image }) => {
                    exchange.add(network, *arc, *image);
                }
                (BlockKind::Sequence { children }, BlockKind::Sequence { children: images }) => {
                    // Who is first in a sequence is not exchanged.
                    (places.is_sorted() && children.len() == images.len()).then_some(())?;
                    open.extend(children.iter().copied().zip(images.iter().copied()));
                }
                (BlockKind::Parallel { branches }, BlockKind::Parallel { branches: images }) => {
                    open.extend(paired(branches, images, &places)?);
                }
                (
                    BlockKind::Choose { decision, alternatives },
                    BlockKind::Choose { decision: image, alternatives: images },
                ) => {
                    open.extend(paired(alternatives, images, &places)?);
                    let moved: Vec<(u32, u32)> =
                        (0..).zip(places).filter(|(place, image)| place != image).collect();
                    if decision != image || !moved.is_empty() {
                        exchange.decisions.insert(*decision, (*image, moved));
                    }
                }
                (
                    BlockKind::Scope { child, arcs, .. },
                    BlockKind::Scope { child: image, arcs: images, .. },
                ) => {
                    (arcs.len() == images.len()).then_some(())?;
                    arcs.iter().zip(images).for_each(|(&arc, &image)| exchange.add(network, arc, image));
                    open.push((*child, *image));
                }
                (BlockKind::Guard { arc, child }, BlockKind::Guard { arc: guard, child: image }) => {
                    exchange.add(network, *arc, *guard);
                    open.push((*child, *image));
                }
                _ => return None,
            }
        }
        Some(exchange)
    }

    /// Adds what is on an arc.
    fn add(&mut self, network: &Network, arc: ArcId, image: ArcId) {
        if arc != image {
            let labels = |arc: ArcId| network.arcs[arc.index()].labels.iter().copied();
            self.labels.extend(labels(arc).zip(labels(image)));
        }
    }

    /// Returns what tells the plan with exchanged vehicles apart, if that is less.
    fn lesser(&self, plan: &Distinction) -> Option<Distinction> {
        let choice = |choice: &Choice| {
            let Some((decision, moved)) = self.decisions.get(&choice.decision) else { return *choice };
            let place = moved.iter().find(|(place, _)| *place == choice.alternative);
            Choice { decision: *decision, alternative: place.map_or(choice.alternative, |(_, image)| *image) }
        };
        let mut choices: Vec<Choice> = plan.choices.iter().map(choice).collect();
        choices.sort_unstable();
        // Most exchanges make the choices greater.
        if choices > plan.choices {
            return None;
        }
        let label = |label: LabelId| self.labels.get(&label).copied().unwrap_or(label);
        let exchanged = Distinction {
            choices,
            links: (plan.links.iter())
                .map(|link| CausalLink { tell: label(link.tell), ask: label(link.ask) })
                .collect(),
            orders: (plan.orders.iter())
                .map(|order| Ordering { first: label(order.first), then: label(order.then) })
                .collect(),
            producers: (plan.producers.iter())
                .map(|producers| producers.iter().map(|&it| label(it)).collect())
                .collect(),
        }
        .sorted();
        (exchanged < *plan).then_some(exchanged)
    }
}

/// Returns what holds at first of two vehicles that are exchanged.
fn initial(network: &Network, one: &str, other: &str) -> BTreeMap<LabelId, LabelId> {
    let of = |vehicle: &str| -> BTreeMap<&str, LabelId> {
        let labels = network.labels.iter().enumerate().filter(|(_, label)| label.extent == Extent::Initial);
        let own = labels.filter_map(|(at, label)| {
            let name = network.variables[label.literal.variable.index()].name.as_str();
            Some((name.strip_prefix(vehicle)?.strip_prefix('.')?, LabelId::from_index(at)))
        });
        own.collect()
    };
    let (ones, others) = (of(one), of(other));
    let pairs = ones.iter().filter_map(|(name, &label)| Some([label, *others.get(name)?]));
    pairs.flat_map(|[one, other]| [(one, other), (other, one)]).collect()
}

/// The place among the parts of a block that each part of its counterpart has.
fn places(network: &Network, (from, to): (BlockId, BlockId), (one, other): (&str, &str)) -> Option<Vec<u32>> {
    let parts = match &network.blocks[from.index()].kind {
        BlockKind::Sequence { children } => children.len(),
        BlockKind::Parallel { branches } => branches.len(),
        BlockKind::Choose { alternatives, .. } => alternatives.len(),
        BlockKind::Leaf { .. } | BlockKind::Scope { .. } | BlockKind::Guard { .. } => 0,
    };
    let copies = &network.exchangeable.copies;
    match (copies.get(&from), copies.get(&to)) {
        (None, None) => Some((0..parts as u32).collect()),
        (Some(members), Some(images)) => {
            let places: BTreeMap<&str, u32> = images.iter().map(SmolStr::as_str).zip(0..).collect();
            let place = |member: &SmolStr| {
                let image = match member.as_str() {
                    it if it == one => other,
                    it if it == other => one,
                    it => it,
                };
                places.get(image).copied()
            };
            members.iter().map(place).collect()
        }
        _ => None,
    }
}

/// Parts with their counterparts.
fn paired(parts: &[BlockId], images: &[BlockId], places: &[u32]) -> Option<Vec<(BlockId, BlockId)>> {
    (parts.len() == images.len() && parts.len() == places.len()).then_some(())?;
    parts.iter().zip(places).map(|(&part, &place)| Some((part, *images.get(place as usize)?))).collect()
}
