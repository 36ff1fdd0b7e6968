//! What resources hold and activities take of them, as integers: amounts multiplied by a common denominator.

use exact::Rational;
use num_integer::Integer as _;
use tpn::{LevelCondition, Network, NodeId, Plan, ResourceId, Supply, UseId};

/// A resource with its selected uses.
#[derive(Clone, Debug)]
pub(crate) struct Shared {
    pub(crate) resource: ResourceId,
    pub(crate) supply: ScaledSupply,
    pub(crate) uses: Vec<Taken>,
    scale: i128,
}

/// How much of a resource there is, scaled.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ScaledSupply {
    Reusable { capacity: i128 },
    Reservoir { least: i128, greatest: i128, level: i128 },
}

/// A selected use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taken {
    pub(crate) used: UseId,
    pub(crate) start: NodeId,
    pub(crate) end: NodeId,
    /// The maximum amount.
    pub(crate) amount: i128,
    /// The minimum amount.
    pub(crate) at_least: i128,
    /// It gives instead of taking; a condition on a level asks for no more, which what gives breaks.
    pub(crate) is_production: bool,
    /// Of a condition on a level, which changes nothing: the last level that is allowed (SPEC 17).
    pub(crate) level: Option<i128>,
}

impl Taken {
    /// When it changes the level of a reservoir: a production at its end, a consumption at its start (SPEC 11). A condition on
    /// the level begins at its start.
    pub(crate) fn moment(&self) -> NodeId {
        if self.is_production && self.level.is_none() { self.end } else { self.start }
    }

    /// When it is over with a reservoir.
    pub(crate) fn last_moment(&self) -> NodeId {
        if self.level.is_some() { self.end } else { self.moment() }
    }

    /// Returns whether it lets the level be so, if it is a condition.
    pub(crate) fn allows(&self, level: i128) -> bool {
        self.level.is_none_or(|bound| if self.is_production { level <= bound } else { level >= bound })
    }

    /// The least and the greatest change of a reservoir's level.
    pub(crate) fn changes(&self) -> [i128; 2] {
        if self.is_production { [self.at_least, self.amount] } else { [-self.amount, -self.at_least] }
    }
}

/// A selected use with its least and greatest amount, or the last level that it allows: what takes of a reusable resource takes
/// from start to end.
pub(crate) fn taken(
    network: &Network,
    used: UseId,
    [at_least, amount]: [i128; 2],
    level: Option<i128>,
) -> Taken {
    let of = &network.uses[used.index()];
    let is_production = of.change == rmpl::program::Change::Produces;
    Taken { used, start: of.start, end: of.end, amount, at_least, is_production, level }
}

/// Returns whether the plan selects a use.
pub(crate) fn is_selected(network: &Network, plan: &Plan, used: UseId) -> bool {
    plan.selected_arcs[network.uses[used.index()].arc.index()]
}

impl Shared {
    /// Every resource of the network with what the plan selects; `None` where the exact sums might not fit.
    pub(crate) fn all(network: &Network, plan: &Plan) -> Option<Vec<Self>> {
        let mut scales = Vec::with_capacity(network.resources.len());
        for resource in &network.resources {
            let amounts = match resource.supply {
                Supply::Reusable { capacity } => vec![capacity],
                Supply::Reservoir { least, greatest, level } => vec![least, greatest, level],
            };
            scales.push(amounts.into_iter().try_fold(1, common_denominator)?);
        }
        for used in &network.uses {
            let scale = &mut scales[used.resource.index()];
            *scale = [used.amount, used.at_least].into_iter().try_fold(*scale, common_denominator)?;
            if let Some(level) = used.level {
                *scale = common_denominator(*scale, level.bound)?;
            }
        }
        let mut all: Vec<Self> = (network.resources.iter().zip(scales).enumerate())
            .map(|(index, (resource, scale))| {
                let supply = match resource.supply {
                    Supply::Reusable { capacity } => {
                        ScaledSupply::Reusable { capacity: scaled(capacity, scale) }
                    }
                    Supply::Reservoir { least, greatest, level } => ScaledSupply::Reservoir {
                        least: scaled(least, scale),
                        greatest: scaled(greatest, scale),
                        level: scaled(level, scale),
                    },
                };
                Self { resource: ResourceId::from_index(index), supply, uses: Vec::new(), scale }
            })
            .collect();
        for used in (0..network.uses.len()).map(UseId::from_index) {
            if is_selected(network, plan, used) {
                let of = &network.uses[used.index()];
                let shared = &mut all[of.resource.index()];
                let amounts = [of.at_least, of.amount].map(|amount| scaled(amount, shared.scale));
                // The extremes of levels are whole multiples of the unit.
                let level = of.level.map(|LevelCondition { order, bound }| {
                    let inside = if order.is_minimum() { 1 } else { -1 };
                    scaled(bound, shared.scale) + if order.is_strict() { inside } else { 0 }
                });
                shared.uses.push(taken(network, used, amounts, level));
            }
        }
        Some(all)
    }

    /// An amount as it was before scaling, if it fits.
    pub(crate) fn unscaled(&self, amount: i128) -> Option<Rational> {
        Rational::from_wide(amount, self.scale)
    }

    /// An amount for people.
    pub(crate) fn show(&self, amount: i128) -> String {
        self.unscaled(amount).map_or_else(|| format!("{amount}/{}", self.scale), |amount| amount.to_string())
    }

    /// Returns how much of it a use takes or gives, for people: `4`, `28.5 to 40`.
    pub(crate) fn show_amount(&self, of: &Taken) -> String {
        let amount = self.show(of.amount);
        if of.at_least == of.amount { amount } else { format!("{} to {amount}", self.show(of.at_least)) }
    }

    /// The name of the resource.
    pub(crate) fn name<'network>(&self, network: &'network Network) -> &'network str {
        &network.resources[self.resource.index()].name
    }
}

/// `Radio#1 (3), Heat#1 (2) and Lamp#1 (2)`.
pub(crate) fn list(network: &Network, shared: &Shared, uses: &[Taken]) -> String {
    let parts: Vec<String> = uses
        .iter()
        .map(|it| format!("{} ({})", user_name(network, it.used), shared.show_amount(it)))
        .collect();
    match parts.split_last() {
        Some((last, others)) if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        _ => parts.concat(),
    }
}

/// Returns who uses a resource: `Radio#1`, or the use's own name.
pub(crate) fn user_name(network: &Network, used: UseId) -> String {
    let owner = network.uses[used.index()].owner;
    match owner.and_then(|owner| network.occurrences.get(owner.index())) {
        Some(owner) => owner.name.to_string(),
        None => network.use_name(used),
    }
}

/// Amounts have 63 bits and sums as many terms as there are uses; this leaves room for both.
fn common_denominator(scale: i128, amount: Rational) -> Option<i128> {
    let scale = scale.lcm(&i128::from(amount.denominator()));
    (scale <= 1 << 40).then_some(scale)
}

fn scaled(amount: Rational, scale: i128) -> i128 {
    i128::from(amount.numerator()) * (scale / i128::from(amount.denominator()))
}
