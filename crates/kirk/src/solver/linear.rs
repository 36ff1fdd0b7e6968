//! Weighted sums of Booleans and times that must stay below a limit: goals during the search for a better plan,
//! goals that have reached their optimum, and what is taken of a reservoir in all.

use typed_index_collections::TiVec;

use super::literal::{Literal, Variable};
use super::premise::Premise;
use super::queue::PropagationQueue;
use super::trail::{Conflict, Trail};
use crate::ids::LinearId;

/// `Σ weight · value ≤ most`. All variables exist in every plan.
#[derive(Clone, Debug)]
struct Linear {
    terms: Vec<(i64, Variable)>,
    most: i64,
    kind: LinearKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LinearKind {
    /// It limits a goal.
    Goal,
    /// It follows from what reservoirs have, or from how much time there is.
    Amounts,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Linears {
    all: TiVec<LinearId, Linear>,
    pub(super) queue: PropagationQueue<LinearId>,
}

impl Linears {
    /// Adds a sum. Weights are not 0.
    pub(crate) fn add(&mut self, terms: Vec<(i64, Variable)>, most: i64, kind: LinearKind) -> LinearId {
        let sides = terms.iter().map(
            |&(weight, variable)| {
                if weight > 0 { variable.lower() } else { variable.upper() }
            },
        );
        self.queue.add(sides);
        self.all.push_and_get_key(Linear { terms, most, kind })
    }

    /// Lowers the limit of a sum. At the root.
    pub(crate) fn lower(&mut self, id: LinearId, by: i64) {
        let most = &mut self.all[id].most;
        *most = most.saturating_sub(by);
        self.queue.push(id);
    }

    /// A conflict comes with the kind of the sum that it is one with.
    pub(crate) fn propagate(&mut self, trail: &mut Trail) -> Result<(), (LinearKind, Conflict)> {
        while let Some(id) = self.queue.pop() {
            let linear = &self.all[id];
            linear.propagate(trail).map_err(|conflict| (linear.kind, conflict))?;
        }
        Ok(())
    }
}

impl Linear {
    fn propagate(&self, trail: &mut Trail) -> Result<(), Conflict> {
        let Self { terms, most, kind } = self;
        trail.premise = Premise::Unknown;
        let least: i128 = terms.iter().map(|&term| least(trail, term)).sum();
        let room = i128::from(*most) - least;
        if room < 0 {
            return Err(reason(trail, terms, None));
        }
        for (position, &(weight, variable)) in terms.iter().enumerate() {
            let range = trail.most(variable) - trail.least(variable);
            let steps = room / i128::from(weight.unsigned_abs());
            let Ok(steps) = i64::try_from(steps) else { continue };
            if steps >= range {
                continue;
            }
            let literal = if weight > 0 {
                Literal::new(variable.upper(), trail.least(variable) + steps)
            } else {
                Literal::new(variable.lower(), steps - trail.most(variable))
            };
            let cause = reason(trail, terms, Some(position));
            let cause = match kind {
                LinearKind::Goal => trail.note_of_goal(cause),
                LinearKind::Amounts => trail.note(cause),
            };
            trail.set(literal, cause)?;
        }
        Ok(())
    }
}

/// The least that a term adds.
pub(super) fn least(trail: &Trail, (weight, variable): (i64, Variable)) -> i128 {
    let value = if weight > 0 { trail.least(variable) } else { trail.most(variable) };
    i128::from(weight) * i128::from(value)
}

/// The bounds that the least sum rests on, but for one term's.
fn reason(trail: &Trail, terms: &[(i64, Variable)], without: Option<usize>) -> Conflict {
    let others = terms.iter().enumerate().filter(|&(position, _)| Some(position) != without);
    others
        .map(|(_, &(weight, variable))| {
            let side = if weight > 0 { variable.lower() } else { variable.upper() };
            Literal::new(side, trail.bound(side))
        })
        .collect()
}
