//! What a plan must satisfy beyond its intervals: variables that keep their values (SPEC 10), resources (SPEC 11), and
//! what plans are to be best in (SPEC 12), with amounts as integers.

use std::collections::BTreeMap;

use exact::{Rational, Scale};
use num_integer::Integer as _;
use rmpl::program::{Change, LabelMode, Measure};
use tpn::{
    ArcId, ArcKind, Extent, LabelId, LevelCondition, Network, NodeId, Plan, Quality, ResourceId, StateOrder,
    Supply, UseId, ValueId, Window, Worth,
};

use crate::conditions::Conditions;
use crate::model::Model;
use crate::state_order::in_order;
use crate::unplannable::Unplannable;

/// A variable that keeps its value, by its labels.
#[derive(Clone, Debug)]
pub(crate) struct LastingVariable {
    /// What it is at first; a network of another program may not say.
    pub(crate) initial: Option<LabelId>,
    /// What gives it a value later, in textual order.
    pub(crate) changes: Vec<LabelId>,
    /// What requires a value, in textual order.
    pub(crate) asks: Vec<LabelId>,
}

/// A resource with all its uses; amounts are whole multiples of a common unit.
#[derive(Clone, Debug)]
pub(crate) struct ResourceDemand {
    pub(crate) supply: ModelSupply,
    /// In textual order.
    pub(crate) uses: Vec<ModelUse>,
    unit: i64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum ModelSupply {
    Reusable { capacity: i64 },
    Reservoir { least: i64, greatest: i64, level: i64 },
}

/// One use of a resource.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelUse {
    pub(crate) id: UseId,
    pub(crate) arc: ArcId,
    pub(crate) start: NodeId,
    pub(crate) end: NodeId,
    pub(crate) change: Change,
    /// The maximum amount.
    pub(crate) amount: i64,
    /// The minimum amount.
    pub(crate) at_least: i64,
    /// Of a condition on a level, which changes nothing: the level that it may not fall below, or not rise above.
    pub(crate) level: Option<i64>,
}

impl ModelUse {
    /// When a reservoir is consumed from, or produced into, or a condition on its level begins to hold.
    pub(crate) fn moment(&self) -> NodeId {
        if self.change == Change::Produces && self.level.is_none() { self.end } else { self.start }
    }

    /// The last event at which it concerns a reservoir's level.
    pub(crate) fn last_moment(&self) -> NodeId {
        if self.level.is_some() { self.end } else { self.moment() }
    }

    /// Returns whether a level keeps a bound that this use can break.
    pub(crate) const fn allows(&self, level: i64, bound: i64) -> bool {
        excess(self.change, level, bound) <= 0
    }

    /// The change of a reservoir's level, in units: the greatest possible one if `is_most`, otherwise the least.
    pub(crate) const fn level_change(&self, is_most: bool) -> i64 {
        level_change(self.change, [self.at_least, self.amount], is_most)
    }
}

/// Returns how far a level is beyond a bound that this kind of change can break; not positive if it keeps the bound.
pub(crate) const fn excess(change: Change, level: i64, bound: i64) -> i64 {
    if matches!(change, Change::Produces) { level - bound } else { bound - level }
}

/// The change of a level by a use with a minimum and a maximum amount: the greatest possible one if `is_most`, otherwise the
/// least.
pub(crate) const fn level_change(change: Change, [at_least, amount]: [i64; 2], is_most: bool) -> i64 {
    match (change, is_most) {
        (Change::Produces, true) => amount,
        (Change::Produces, false) => at_least,
        (_, true) => -at_least,
        (_, false) => -amount,
    }
}

impl ResourceDemand {
    /// An amount in the mission's own terms.
    pub(crate) fn amount(&self, units: i64) -> Rational {
        Rational::new(units, self.unit).unwrap_or_default()
    }
}

/// How long a movement takes at least from one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelDeparture {
    pub(crate) from: ValueId,
    /// In ticks, rounded down; `None` if it cannot be driven.
    pub(crate) least: Option<i64>,
}

/// A goal as a sum that is to be as small as possible.
#[derive(Clone, Debug)]
pub(crate) struct ModelGoal {
    /// What each selected arc adds, in the goal's unit.
    pub(crate) by_arc: Vec<(ArcId, i64)>,
    /// What each movement adds that starts at a place: meters, and what each of them costs as long as no path has told.
    pub(crate) by_departure: BTreeMap<(LabelId, ValueId), i64>,
    /// What each tick of the scenario's end adds.
    pub(crate) per_tick: i64,
    /// How many of the goal's units one of the mission's is.
    unit: i64,
    is_maximized: bool,
    /// Whether the sum is all that the goal measures, so that no plan is better where none has a smaller one: meters are
    /// bounded from below, where they are known at all, and the end is the earliest one.
    pub(crate) is_exact: bool,
}

impl ModelGoal {
    /// Returns what the goal is of a plan.
    pub(crate) fn sum(&self, model: &Model, plan: &Plan) -> Result<i64, Unplannable> {
        let selected = self.by_arc.iter().filter(|(arc, _)| plan.selected_arcs[arc.index()]);
        let by_arc: i64 = selected.map(|&(_, weight)| weight).sum();
        let overflow = |_| Unplannable::at(model.demands.end);
        let end = model.units(plan.quality.end).map_err(overflow)?;
        let by_departure: i64 = if self.by_departure.is_empty() {
            0
        } else {
            let departures = model.demands.departures_of(model, plan);
            departures.iter().filter_map(|departure| self.by_departure.get(departure)).sum()
        };
        let sum = i128::from(by_arc) + i128::from(by_departure) + i128::from(end) * i128::from(self.per_tick);
        i64::try_from(sum).map_err(|_| Unplannable::at(model.demands.end))
    }

    /// A sum as the goal measures it.
    pub(crate) fn value(&self, units: i64) -> Rational {
        let value = Rational::new(units, self.unit).unwrap_or_default();
        if self.is_maximized { value.checked_neg().unwrap_or_default() } else { value }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Demands {
    /// Those that something changes or requires.
    pub(crate) variables: Vec<LastingVariable>,
    pub(crate) resources: Vec<ResourceDemand>,
    /// By movement: how long it takes at least from each place that is known.
    pub(crate) departures: BTreeMap<LabelId, Vec<ModelDeparture>>,
    pub(crate) goals: Vec<ModelGoal>,
    /// The last event.
    pub(crate) end: NodeId,
    worths: Vec<Worth>,
}

impl LastingVariable {
    /// The order of the selected changes, by which of two that exclude each other comes first; `None` if there are none.
    pub(crate) fn in_order(
        &self,
        conditions: &Conditions,
        changes: &[LabelId],
        is_before: impl Fn(LabelId, LabelId) -> bool,
    ) -> Option<StateOrder> {
        let variable = conditions.labels[*changes.first()?].variable;
        let producers = self.initial.into_iter().chain(in_order(conditions, changes, is_before)).collect();
        Some(StateOrder { variable, producers })
    }
}

impl Demands {
    /// Returns what the selected activities are worth, and the earliest end.
    pub(crate) fn quality(&self, selected_arcs: &[bool], windows: &[Option<Window>]) -> Quality {
        let mut quality = Quality::default();
        for worth in self.worths.iter().filter(|worth| selected_arcs[worth.arc.index()]) {
            quality.cost = quality.cost.checked_add(worth.cost).unwrap_or(quality.cost);
            quality.reward = quality.reward.checked_add(worth.reward).unwrap_or(quality.reward);
        }
        if let Some(window) = windows[self.end.index()] {
            quality.end = window.earliest;
        }
        quality
    }

    /// The selected movements of a plan, each with the place where it starts.
    fn departures_of(&self, model: &Model, plan: &Plan) -> Vec<(LabelId, ValueId)> {
        let labels = &model.conditions.labels;
        let neighbors = plan.state_order.iter().flat_map(|order| order.producers.array_windows());
        let departures = neighbors.filter(|[_, movement]| self.departures.contains_key(movement));
        departures.filter_map(|&[before, movement]| Some((movement, labels[before].value?))).collect()
    }

    /// Returns how many uses the network has.
    pub(crate) fn num_uses(&self) -> usize {
        self.resources.iter().map(|resource| resource.uses.len()).sum()
    }

    /// Returns whether alternatives of the same shape and bounds may still be different.
    pub(crate) fn tells_alternatives_apart(&self) -> bool {
        !self.variables.is_empty() || !self.resources.is_empty() || !self.goals.is_empty()
    }

    /// Of a network whose times are counted in the ticks of `scale`.
    pub(crate) fn new(network: &Network, scale: Scale) -> Result<Self, Unplannable> {
        let overflow = || Unplannable::at(network.start);
        let ticks = scale.ticks_per_unit();
        Ok(Self {
            variables: lasting_variables(network),
            departures: departures(network, ticks).ok_or_else(overflow)?,
            resources: resources(network)?,
            goals: goals(network, ticks).ok_or_else(overflow)?,
            end: network.end,
            worths: network.worths.clone(),
        })
    }
}

/// Those that something changes or requires.
pub(crate) fn lasting_variables(network: &Network) -> Vec<LastingVariable> {
    let blank = LastingVariable { initial: None, changes: Vec::new(), asks: Vec::new() };
    let mut variables = vec![blank; network.variables.len()];
    for (index, label) in network.labels.iter().enumerate() {
        let id = LabelId::from_index(index);
        if !network.is_lasting(id) {
            continue;
        }
        let variable = &mut variables[label.literal.variable.index()];
        match (label.mode, label.extent) {
            (LabelMode::Tell, Extent::Initial) => variable.initial = Some(id),
            (LabelMode::Tell, _) => variable.changes.push(id),
            (LabelMode::Ask, _) => variable.asks.push(id),
        }
    }
    variables.retain(|variable| !variable.changes.is_empty() || !variable.asks.is_empty());
    variables
}

fn resources(network: &Network) -> Result<Vec<ResourceDemand>, Unplannable> {
    let mut demands = Vec::new();
    for (index, resource) in network.resources.iter().enumerate() {
        let id = ResourceId::from_index(index);
        let used = || network.uses.iter().enumerate().filter(move |(_, used)| used.resource == id);
        let supply = match resource.supply {
            Supply::Reusable { capacity } => vec![capacity],
            Supply::Reservoir { least, greatest, level } => vec![least, greatest, level],
        };
        let amounts = used().flat_map(|(_, used)| {
            [used.at_least, used.amount, used.level.map_or(Rational::ZERO, |level| level.bound)]
        });
        let Some(unit) = common_unit(supply.into_iter().chain(amounts)) else {
            return Err(Unplannable::at(network.start));
        };
        let units = |amount: Rational, at: NodeId| units(amount, unit).ok_or_else(|| Unplannable::at(at));
        let start = network.start;
        let supply = match resource.supply {
            Supply::Reusable { capacity } => ModelSupply::Reusable { capacity: units(capacity, start)? },
            Supply::Reservoir { least, greatest, level } => ModelSupply::Reservoir {
                least: units(least, start)?,
                greatest: units(greatest, start)?,
                level: units(level, start)?,
            },
        };
        let mut uses = Vec::new();
        for (position, used) in used() {
            uses.push(ModelUse {
                id: UseId::from_index(position),
                arc: used.arc,
                start: used.start,
                end: used.end,
                change: used.change,
                amount: units(used.amount, used.start)?,
                at_least: units(used.at_least, used.start)?,
                level: match used.level {
                    None => None,
                    Some(LevelCondition { order, bound }) => {
                        let bound = units(bound, used.start)?;
                        // Levels are whole multiples of the unit.
                        let inside = if order.is_minimum() { 1 } else { -1 };
                        Some(if order.is_strict() { bound + inside } else { bound })
                    }
                },
            });
        }
        demands.push(ResourceDemand { supply, uses, unit });
    }
    Ok(demands)
}

fn departures(network: &Network, ticks: i64) -> Option<BTreeMap<LabelId, Vec<ModelDeparture>>> {
    let mut departures: BTreeMap<LabelId, Vec<ModelDeparture>> = BTreeMap::new();
    for departure in &network.departures {
        let least = match departure.least {
            None => None,
            Some(least) => Some(least.checked_mul(Rational::from_integer(ticks))?.units().floor()),
        };
        departures.entry(departure.arrival).or_default().push(ModelDeparture { from: departure.from, least });
    }
    Some(departures)
}

fn goals(network: &Network, ticks: i64) -> Option<Vec<ModelGoal>> {
    network
        .objective
        .iter()
        .map(|goal| {
            let factor = |wanted: Measure| {
                let of_measure = goal.terms.iter().filter(|(_, measure)| *measure == wanted);
                of_measure.map(|(factor, _)| *factor).try_fold(Rational::default(), Rational::checked_add)
            };
            let sign = Rational::from_integer(if goal.is_maximized { -1 } else { 1 });
            let (cost, reward) = (factor(Measure::Cost)?, factor(Measure::Reward)?);
            let per_tick =
                factor(Measure::End)?.checked_mul(sign)?.checked_div(Rational::from_integer(ticks))?;
            let mut by_arc = Vec::new();
            for worth in &network.worths {
                let weight = cost.checked_mul(worth.cost)?.checked_add(reward.checked_mul(worth.reward)?)?;
                by_arc.push((worth.arc, weight.checked_mul(sign)?));
            }
            let mut by_departure: BTreeMap<(LabelId, ValueId), Rational> = BTreeMap::new();
            let per_meter = factor(Measure::Length)?;
            for distance in &network.distances {
                let weight =
                    per_meter.checked_add(cost.checked_mul(cost_per_meter(network, distance.arrival)?)?)?;
                let weight = weight.checked_mul(sign)?.checked_mul(distance.meters)?;
                by_departure.insert((distance.arrival, distance.from), weight);
            }
            // Of what is better the longer it is, the least length tells nothing.
            let is_bounded =
                !network.distances.is_empty() && by_departure.values().all(|it| !it.is_negative());
            by_departure.retain(|_, weight| weight.is_positive());
            let weights = by_arc.iter().map(|&(_, weight)| weight).chain(by_departure.values().copied());
            let unit = common_unit(weights.chain([per_tick]))?;
            let by_arc = by_arc.into_iter().map(|(arc, weight)| Some((arc, units(weight, unit)?)));
            let is_driven = !factor(Measure::Length)?.is_zero()
                || (!cost.is_zero() && network.worths.iter().any(|worth| !worth.cost_per_meter.is_zero()));
            Some(ModelGoal {
                is_exact: (!is_driven || is_bounded) && !per_tick.is_negative(),
                by_departure: (by_departure.into_iter())
                    .map(|(departure, weight)| Some((departure, units(weight, unit)?)))
                    .collect::<Option<_>>()?,
                by_arc: by_arc.collect::<Option<_>>()?,
                per_tick: units(per_tick, unit)?,
                unit,
                is_maximized: goal.is_maximized,
            })
        })
        .collect()
}

/// Returns what each meter of a movement costs that is not counted in its worth yet, as it is once its path is known.
fn cost_per_meter(network: &Network, arrival: LabelId) -> Option<Rational> {
    let movement = network.labels[arrival.index()].arc;
    if network.arcs[movement.index()].kind == ArcKind::Span {
        return Some(Rational::ZERO);
    }
    let own = network.worths.iter().filter(|worth| worth.arc == movement);
    own.map(|worth| worth.cost_per_meter).try_fold(Rational::ZERO, Rational::checked_add)
}

/// The least number that makes all amounts whole, when they are multiplied by it.
fn common_unit(amounts: impl IntoIterator<Item = Rational>) -> Option<i64> {
    amounts.into_iter().try_fold(1_i64, |common, amount| {
        let denominator = amount.denominator();
        common.checked_mul(denominator / common.gcd(&denominator))
    })
}

fn units(amount: Rational, unit: i64) -> Option<i64> {
    let units = amount.numerator().checked_mul(unit / amount.denominator())?;
    // Sums of many of them still fit.
    (units.unsigned_abs() < 1 << 40).then_some(units)
}
