//! The activities of each vehicle that may overlap in some schedule of the plan, although the mission does not say that
//! they can (SPEC 16.1).
//!
//! Only what the mission declares keeps activities apart: an order, `unordered`, a resource. Two activities that each take
//! some resource whole say what they occupy; if these are different resources, the two are declared to go together.

use std::collections::{BTreeMap, BTreeSet};

use exact::Bound;
use rmpl::program::Change;
use smol_str::SmolStr;
use snapshot::Snapshot;
use snapshot::vehicle::moving;
use tpn::{BlockKind, Network, Occurrence, OccurrenceId, OccurrenceKind, Plan, Supply};

use super::distances::Distances;
use super::lines::Places;
use super::{Line, Status};

/// Pairs of activities whose distances are looked at in one review.
const MAX_PAIRS: usize = 20_000;

/// The lines of every vehicle that does at least two things in the plan; `checked` is how everything stands that rests on
/// the independent checker.
pub(super) fn overlaps(
    snapshot: &Snapshot,
    (network, plan): (&Network, &Plan),
    distances: &mut Distances,
    places: &Places<'_>,
    checked: Status,
) -> Vec<Line> {
    let owners = owners(snapshot, network, plan);
    let mut search = Search { network, plan, distances, occupied: occupied(network), pairs: 0 };
    let mut lines = Vec::new();
    for vehicle in &snapshot.program.world.vehicles {
        let name = &vehicle.name.text;
        let own: BTreeMap<usize, OccurrenceId> = owners
            .iter()
            .filter(|(_, vehicles)| vehicles.contains(name))
            .filter_map(|(&id, _)| Some((network.occurrences[id.index()].arc?.index(), id)))
            .collect();
        if own.len() < 2 {
            continue;
        }
        let found = search.of_vehicle(&own);
        lines.extend(found.groups().iter().map(|pairs| line(network, plan, (name, pairs), places)));
        let rest = match (found.pairs.is_empty(), found.num_declared) {
            _ if found.is_cut => Some((
                Status::Attention,
                format!("{name} has too many activities to check all pairs; there may be more overlaps"),
            )),
            (true, 0) => {
                Some((checked, format!("no activities of {name} overlap in any schedule of the plan")))
            }
            (true, _) => Some((
                checked,
                format!(
                    "no activities of {name} overlap in any schedule of the plan, except those that each use a resource \
                     entirely"
                ),
            )),
            (false, _) => None,
        };
        lines.extend(rest.map(|(status, text)| {
            places.line(status, text, Some(vehicle.name.span), vec![name.to_string()], Vec::new())
        }));
    }
    lines
}

/// Returns which vehicles each activity that the plan selects is of: those it moves, those among its arguments, and
/// those whose place or other state it needs or changes. In a mission of one vehicle, that one does everything.
pub(super) fn owners(
    snapshot: &Snapshot,
    network: &Network,
    plan: &Plan,
) -> BTreeMap<OccurrenceId, BTreeSet<SmolStr>> {
    let declared: Vec<&SmolStr> =
        snapshot.program.world.vehicles.iter().map(|vehicle| &vehicle.name.text).collect();
    let is_vehicle = |name: &str| declared.iter().any(|it| *it == name);
    let mut owners: BTreeMap<OccurrenceId, BTreeSet<SmolStr>> = BTreeMap::new();
    for (index, occurrence) in network.occurrences.iter().enumerate() {
        let is_selected =
            occurrence.arc.is_some_and(|arc| plan.selected_arcs.get(arc.index()) == Some(&true));
        if occurrence.kind != OccurrenceKind::Primitive || !is_selected {
            continue;
        }
        let mut vehicles: BTreeSet<SmolStr> = match declared.as_slice() {
            [only] => BTreeSet::from([SmolStr::clone(only)]),
            _ => occurrence.arguments.iter().filter(|it| is_vehicle(it)).cloned().collect(),
        };
        vehicles.extend(moving(&snapshot.program, occurrence).into_iter().flat_map(|it| it.vehicles));
        owners.insert(OccurrenceId::from_index(index), vehicles);
    }
    let named = network
        .labels
        .iter()
        .map(|label| (label.owner, network.variables[label.literal.variable.index()].name.as_str()));
    let used =
        network.uses.iter().map(|used| (used.owner, network.resources[used.resource.index()].name.as_str()));
    for (owner, name) in named.chain(used) {
        let Some((vehicle, _)) = name.split_once('.').filter(|(vehicle, _)| is_vehicle(vehicle)) else {
            continue;
        };
        if let Some(vehicles) = owner.and_then(|owner| owners.get_mut(&owner)) {
            vehicles.insert(vehicle.into());
        }
    }
    owners
}

/// The activities that take some resource whole, so that nothing else can be done with it.
pub(super) fn occupied(network: &Network) -> BTreeSet<OccurrenceId> {
    let whole = network.uses.iter().filter(|used| {
        let resource = &network.resources[used.resource.index()];
        // Orders, such as that of the parts of `unordered`, are not resources of the mission.
        let takes_all = matches!(resource.supply, Supply::Reusable { capacity } if used.amount == capacity);
        used.change == Change::Uses && takes_all && !resource.name.contains('#')
    });
    whole.filter_map(|used| used.owner).collect()
}

/// Looks for activities of one vehicle that may overlap.
struct Search<'a> {
    network: &'a Network,
    plan: &'a Plan,
    distances: &'a mut Distances,
    occupied: BTreeSet<OccurrenceId>,
    /// How many pairs were looked at.
    pairs: usize,
}

/// What was found of one vehicle.
#[derive(Default)]
struct Found {
    /// The pairs that may overlap, by the names of their activities.
    pairs: BTreeMap<[SmolStr; 2], Vec<Pair>>,
    /// How many pairs may overlap because the mission declares it.
    num_declared: usize,
    /// Whether some pairs were not looked at.
    is_cut: bool,
}

/// Two activities that may overlap.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Pair {
    first: OccurrenceId,
    second: OccurrenceId,
}

impl Found {
    /// Returns the pairs in order, those of the same two activities together.
    fn groups(&self) -> Vec<Vec<Pair>> {
        let mut groups: Vec<Vec<Pair>> = self.pairs.values().cloned().collect();
        for pairs in &mut groups {
            pairs.sort_unstable();
        }
        groups.sort_unstable();
        groups
    }
}

impl Search<'_> {
    /// `own` are the activities of a vehicle, by their arcs.
    fn of_vehicle(&mut self, own: &BTreeMap<usize, OccurrenceId>) -> Found {
        let network = self.network;
        let mut found = Found::default();
        // Blocks come after what is in them.
        let mut inside: Vec<Vec<OccurrenceId>> = Vec::with_capacity(network.blocks.len());
        for block in &network.blocks {
            let mut all = Vec::new();
            let parts = match &block.kind {
                BlockKind::Leaf { arc } => {
                    all.extend(own.get(&arc.index()));
                    &[]
                }
                BlockKind::Sequence { children: parts }
                | BlockKind::Choose { alternatives: parts, .. }
                | BlockKind::Parallel { branches: parts } => parts.as_slice(),
                BlockKind::Scope { child, .. } | BlockKind::Guard { child, .. } => {
                    std::slice::from_ref(child)
                }
            };
            let is_parallel = matches!(block.kind, BlockKind::Parallel { .. });
            for part in parts {
                let part = inside.get_mut(part.index()).map(std::mem::take).unwrap_or_default();
                if is_parallel {
                    self.between(&all, &part, &mut found);
                }
                all.extend(part);
            }
            inside.push(all);
        }
        found
    }

    /// Looks at each of the first activities with each of the second ones, which are in other branches.
    fn between(&mut self, first: &[OccurrenceId], second: &[OccurrenceId], found: &mut Found) {
        let network = self.network;
        for &first in first {
            for &second in second {
                let [one, other] = [first, second].map(|id| &network.occurrences[id.index()]);
                let mut names = [one.activity.clone(), other.activity.clone()];
                names.sort();
                if !self.windows_meet(one, other) {
                    continue;
                }
                let is_declared = self.occupied.contains(&first) && self.occupied.contains(&second);
                if self.pairs >= MAX_PAIRS {
                    found.is_cut = true;
                    return;
                }
                self.pairs += 1;
                if !self.may_overlap(one, other) {
                    continue;
                }
                if is_declared {
                    found.num_declared += 1;
                    continue;
                }
                let pair = Pair { first: first.min(second), second: first.max(second) };
                found.pairs.entry(names).or_default().push(pair);
            }
        }
    }

    /// Returns whether both can be under way at some time as far as their windows say.
    fn windows_meet(&self, one: &Occurrence, other: &Occurrence) -> bool {
        let meets = |start: &Occurrence, end: &Occurrence| {
            let windows =
                [start.start, end.end].map(|node| self.plan.windows.get(node.index()).copied().flatten());
            let [Some(start), Some(end)] = windows else { return false };
            Bound::Finite(start.earliest) < end.latest
        };
        meets(one, other) && meets(other, one)
    }

    /// Returns whether some schedule of the plan has a time at which both are under way. One schedule has all of it if
    /// each part can be, because no part is about more than two events of a cycle (SPEC 16.1).
    fn may_overlap(&mut self, one: &Occurrence, other: &Occurrence) -> bool {
        let mut can_follow = |from, to| self.distances.can_follow(from, to);
        can_follow(one.start, other.end)
            && can_follow(other.start, one.end)
            && can_follow(one.start, one.end)
            && can_follow(other.start, other.end)
    }
}

/// The item about all pairs of the same two activities. An acknowledgment of it covers each pair, in its place.
fn line(network: &Network, plan: &Plan, (vehicle, pairs): (&str, &[Pair]), places: &Places<'_>) -> Line {
    let occurrence = |id: OccurrenceId| &network.occurrences[id.index()];
    let Pair { first, second } = pairs[0];
    let [one, other] = [first, second].map(occurrence);
    let who = if one.activity == other.activity {
        format!("two of {}", one.activity)
    } else {
        format!("{} and {}", one.activity, other.activity)
    };
    let window = |node: tpn::NodeId| plan.windows.get(node.index()).copied().flatten();
    let from = [one.start, other.start].into_iter().filter_map(window).map(|it| it.earliest).max();
    let to = [one.end, other.end].into_iter().filter_map(window).map(|it| it.latest).min();
    let when = match (from, to) {
        (Some(from), Some(Bound::Finite(to))) => format!(" from {} to {}", from.readable(), to.readable()),
        (Some(from), _) => format!(" from {} on", from.readable()),
        _ => String::new(),
    };
    let more = match pairs.len() - 1 {
        0 => String::new(),
        1 => "; another pair may overlap, too".to_owned(),
        count => format!("; {count} other pairs may overlap, too"),
    };
    let text = format!(
        "{who} may overlap on {vehicle}: in some schedule of the plan, {} and {} are in progress at the same time{when}{more}",
        one.name, other.name
    );
    let mut named = vec![first, second];
    let mut seen = BTreeSet::from([first, second]);
    named.extend(pairs.iter().flat_map(|pair| [pair.first, pair.second]).filter(|id| seen.insert(*id)));
    let mut names: Vec<String> = named.iter().map(|&id| occurrence(id).name.to_string()).collect();
    names.insert(2, vehicle.to_owned());
    let nodes = named.iter().flat_map(|&id| [occurrence(id).start, occurrence(id).end]).collect();
    places.line(Status::Attention, text, one.span, names, nodes)
}
