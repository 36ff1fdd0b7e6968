//! Whose lane an activity is in: a vehicle's, a resource's, a state's, or the mission's.

use std::collections::BTreeMap;

use rmpl::program::{Change, LabelMode, PrimitiveDecl, Program};
use smol_str::SmolStr;
use tpn::{Network, Occurrence, OccurrenceId, OccurrenceKind};

use super::profile::is_named;

/// Who has a lane, in the order of lanes.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Owner {
    /// What belongs to no one else.
    Mission,
    /// Vehicles, ascending by their declarations; several where one activity moves them together.
    Vehicles(Vec<usize>),
    /// The resource of this number.
    Resource(usize),
    /// The state variable of this number.
    State(usize),
}

/// Who owns what in a network.
#[derive(Clone, Debug)]
pub(super) struct Owners {
    /// By occurrence.
    pub(super) occurrences: Vec<Owner>,
    /// By resource: the vehicles that alone use it, or itself.
    pub(super) resources: Vec<Owner>,
    /// By variable: the vehicle whose place it is, the owner of all that set it, or itself.
    pub(super) variables: Vec<Owner>,
}

impl Owner {
    /// Returns what its lane is called.
    pub(super) fn name(&self, program: &Program, network: &Network) -> SmolStr {
        match self {
            Self::Mission => SmolStr::new_static("Mission"),
            Self::Vehicles(vehicles) => {
                let names = vehicles.iter().filter_map(|&at| program.world.vehicles.get(at));
                names.map(|it| it.name.text.as_str()).collect::<Vec<_>>().join(", ").into()
            }
            Self::Resource(at) => network.resources.get(*at).map(|it| it.name.clone()).unwrap_or_default(),
            Self::State(at) => network.variables.get(*at).map(|it| it.name.clone()).unwrap_or_default(),
        }
    }
}

impl Owners {
    /// An activity belongs to the vehicles that it moves; otherwise to the vehicle whose place it requires or sets, or
    /// that it, or what it is part of, is called with; otherwise to the resource that it uses, otherwise to the state that
    /// it sets, otherwise to the mission. `is_shown` says which occurrences are in the plan: what has others inside belongs
    /// to the owner of all of these. Near-linear in the network.
    pub(super) fn new(program: &Program, network: &Network, is_shown: &dyn Fn(OccurrenceId) -> bool) -> Self {
        let vehicles = Vehicles::new(program, network);
        let mut found = vehicles.of_occurrences(network);
        let of_resource = resources(network, &found);
        // What is taken for its time is closer to an activity than what it consumes.
        for wanted in [true, false] {
            let is_wanted =
                |used: &&tpn::Use| used.level.is_none() && (used.change == Change::Uses) == wanted;
            for used in network.uses.iter().filter(is_wanted) {
                let resource = used.resource.index();
                let owner = used.owner.and_then(|owner| found.get_mut(owner.index()));
                if let Some(owner) = owner.filter(|_| is_named(&network.resources[resource])) {
                    owner.get_or_insert_with(|| of_resource[resource].clone());
                }
            }
        }
        let of_variable = vehicles.variables(network, &found);
        for label in network.labels.iter().filter(|label| label.mode == LabelMode::Tell) {
            let variable = label.literal.variable.index();
            let owner = label.owner.filter(|_| network.variables[variable].is_lasting);
            if let Some(owner) = owner.and_then(|owner| found.get_mut(owner.index())) {
                owner.get_or_insert_with(|| of_variable[variable].clone());
            }
        }
        let occurrences = inherited(network, found, is_shown);
        Self { occurrences, resources: of_resource, variables: of_variable }
    }
}

/// The vehicles of a program, by what speaks of them.
struct Vehicles<'a> {
    by_name: BTreeMap<&'a str, usize>,
    /// The primitives that move some.
    movers: BTreeMap<&'a str, &'a PrimitiveDecl>,
    /// By variable: the vehicle whose place it is.
    places: Vec<Option<usize>>,
}

impl<'a> Vehicles<'a> {
    fn new(program: &'a Program, network: &Network) -> Self {
        let vehicles = program.world.vehicles.iter().enumerate();
        let by_name: BTreeMap<&str, usize> =
            vehicles.map(|(at, vehicle)| (vehicle.name.text.as_str(), at)).collect();
        let movers = program.primitives.iter().filter(|it| it.moves.is_some());
        let places = network.variables.iter().map(|variable| {
            let vehicle = variable.name.strip_suffix(".at")?;
            by_name.get(vehicle).copied()
        });
        let places = places.collect();
        Self { movers: movers.map(|it| (it.name.text.as_str(), it)).collect(), by_name, places }
    }

    /// By occurrence: the vehicles that it belongs to, if there are any.
    fn of_occurrences(&self, network: &Network) -> Vec<Option<Owner>> {
        let mut visited: Vec<Option<usize>> = vec![None; network.occurrences.len()];
        for label in &network.labels {
            let place = self.places[label.literal.variable.index()];
            if let (Some(vehicle), Some(owner)) = (place, label.owner) {
                visited[owner.index()].get_or_insert(vehicle);
            }
        }
        // By occurrence, the vehicle that it or what it is part of is called with: parents come first.
        let mut called: Vec<Option<usize>> = Vec::with_capacity(network.occurrences.len());
        let mut found = Vec::with_capacity(network.occurrences.len());
        for (occurrence, visited) in network.occurrences.iter().zip(visited) {
            let above = occurrence.parent.and_then(|parent| called.get(parent.index()).copied().flatten());
            let own = occurrence.arguments.iter().find_map(|it| self.by_name.get(it.as_str()).copied());
            called.push(own.or(above));
            let moved = self.moved(occurrence);
            let one = visited.or(own).or(above).map(|vehicle| vec![vehicle]);
            found.push(moved.or(one).map(Owner::Vehicles));
        }
        found
    }

    /// The vehicles that an occurrence moves.
    fn moved(&self, occurrence: &Occurrence) -> Option<Vec<usize>> {
        let primitive = self.movers.get(occurrence.activity.as_str())?;
        let moved = primitive.moved(&occurrence.arguments);
        let named = moved.filter_map(|name| self.by_name.get(name.as_str()).copied());
        let mut vehicles: Vec<usize> = named.collect();
        vehicles.sort_unstable();
        vehicles.dedup();
        (!vehicles.is_empty()).then_some(vehicles)
    }

    fn variables(&self, network: &Network, found: &[Option<Owner>]) -> Vec<Owner> {
        let setters =
            network.labels.iter().filter(|label| label.mode == LabelMode::Tell).filter_map(|label| {
                Some((label.literal.variable.index(), found[label.owner?.index()].as_ref()?))
            });
        let mut owners = only_owners(setters, network.variables.len(), Owner::State);
        for (owner, place) in owners.iter_mut().zip(&self.places) {
            if let Some(vehicle) = *place {
                *owner = Owner::Vehicles(vec![vehicle]);
            }
        }
        owners
    }
}

/// By resource: the vehicles that alone use it, or itself.
fn resources(network: &Network, found: &[Option<Owner>]) -> Vec<Owner> {
    let takers = network.uses.iter().filter(|used| used.level.is_none()).filter_map(|used| {
        let owner = found[used.owner?.index()].as_ref()?;
        Some((used.resource.index(), owner))
    });
    only_owners(takers, network.resources.len(), Owner::Resource)
}

/// For each of `count` things the owner that all its pairs name, or else its own lane.
fn only_owners<'a>(
    pairs: impl Iterator<Item = (usize, &'a Owner)>,
    count: usize,
    own: impl Fn(usize) -> Owner,
) -> Vec<Owner> {
    let mut owners: Vec<Option<Owner>> = vec![None; count];
    for (at, owner) in pairs {
        match &owners[at] {
            None => owners[at] = Some(owner.clone()),
            Some(other) if other != owner => owners[at] = Some(own(at)),
            Some(_) => {}
        }
    }
    owners.into_iter().enumerate().map(|(at, owner)| owner.unwrap_or_else(|| own(at))).collect()
}

/// The owner of every occurrence: what has others inside belongs to the owner of all of them, or to the mission.
fn inherited(
    network: &Network,
    mut found: Vec<Option<Owner>>,
    is_shown: &dyn Fn(OccurrenceId) -> bool,
) -> Vec<Owner> {
    for (at, occurrence) in network.occurrences.iter().enumerate().rev() {
        let id = OccurrenceId::from_index(at);
        let counts = occurrence.kind == OccurrenceKind::Primitive && is_shown(id);
        if counts && found[at].is_none() {
            found[at] = Some(Owner::Mission);
        }
        let is_inside = counts || occurrence.kind != OccurrenceKind::Primitive;
        let Some(parent) = occurrence.parent.map(OccurrenceId::index).filter(|&it| it < at && is_inside)
        else {
            continue;
        };
        let (above, below) = found.split_at_mut(at);
        let Some(owner) = &below[0] else { continue };
        match &above[parent] {
            None => above[parent] = Some(owner.clone()),
            Some(other) if other != owner => above[parent] = Some(Owner::Mission),
            Some(_) => {}
        }
    }
    found.into_iter().map(|owner| owner.unwrap_or(Owner::Mission)).collect()
}
