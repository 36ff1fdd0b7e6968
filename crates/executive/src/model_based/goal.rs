//! From asserted constraints to goals that the reactive planner takes.

use plant::{Goal, Model, Planner, State};
use rmpl::control::{Constraint, ConstraintKind};

/// A constraint with more ways to be satisfied is pursued by its first ones only.
const MOST_WAYS: usize = 64;

/// The ways in which an asserted constraint can come true.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Wish {
    /// Each a conjunction of goals; empty for a constraint that can never hold.
    ways: Vec<Vec<Goal>>,
}

impl Wish {
    /// The goals to pursue from a state: of the ways already taken, then of those in reach, the first.
    ///
    /// `None` for a constraint that can never hold.
    pub(super) fn goals(&self, planner: &Planner, state: &State) -> Option<&[Goal]> {
        let met = |way: &&Vec<Goal>| way.iter().all(|goal| goal.modes >> state.mode(goal.component) & 1 == 1);
        let reachable = |way: &&Vec<Goal>| way.iter().all(|goal| planner.may_reach(state, goal));
        let way = match self.ways.as_slice() {
            [only] => Some(only),
            ways => ways.iter().find(met).or_else(|| ways.iter().find(reachable)).or(ways.first()),
        };
        way.map(Vec::as_slice)
    }
}

/// Reads a constraint once, when the program is compiled.
pub(super) fn wish(planner: &Planner, constraint: &Constraint) -> Wish {
    Wish { ways: ways(planner.model(), planner, constraint, true) }
}

fn ways(model: &Model, planner: &Planner, constraint: &Constraint, wanted: bool) -> Vec<Vec<Goal>> {
    match &constraint.kind {
        ConstraintKind::Not(inner) => ways(model, planner, inner, !wanted),
        ConstraintKind::And(parts) if wanted => all(model, planner, parts, wanted),
        ConstraintKind::Or(parts) if !wanted => all(model, planner, parts, wanted),
        ConstraintKind::And(parts) | ConstraintKind::Or(parts) => {
            parts.iter().flat_map(|part| ways(model, planner, part, wanted)).take(MOST_WAYS).collect()
        }
        ConstraintKind::Equals { variable, value } => {
            let goal = if let Some(component) = model.component_named(&variable.text) {
                let modes = model.component(component).map_or(0, |data| data.modes.len());
                let set = model.mode_named(component, &value.text).map_or(0, |mode| 1_u64 << mode);
                Goal { component, modes: chosen(set, modes, wanted) }
            } else if let Some(id) = model.variable_named(&variable.text) {
                let values =
                    model.variables.get(id.0 as usize).map_or(&[][..], |data| data.values.as_slice());
                let set = values.iter().position(|known| *known == value.text).map_or(0, |at| 1_u64 << at);
                let (component, modes) = planner.modes_ensuring(id, chosen(set, values.len(), wanted));
                Goal { component, modes }
            } else {
                // A variable of the program's own comes true by being asserted.
                return vec![Vec::new()];
            };
            if goal.modes == 0 { Vec::new() } else { vec![vec![goal]] }
        }
        ConstraintKind::True => {
            if wanted {
                vec![Vec::new()]
            } else {
                Vec::new()
            }
        }
        _ => {
            if wanted {
                Vec::new()
            } else {
                vec![Vec::new()]
            }
        }
    }
}

fn chosen(set: u64, count: usize, wanted: bool) -> u64 {
    let full = if count >= 64 { u64::MAX } else { (1 << count) - 1 };
    if wanted { set } else { full & !set }
}

fn all(model: &Model, planner: &Planner, parts: &[Constraint], wanted: bool) -> Vec<Vec<Goal>> {
    let mut joined: Vec<Vec<Goal>> = vec![Vec::new()];
    for part in parts {
        let inner = ways(model, planner, part, wanted);
        joined = joined
            .iter()
            .flat_map(|left| inner.iter().map(|right| left.iter().chain(right).copied().collect()))
            .take(MOST_WAYS)
            .collect();
    }
    joined
}
