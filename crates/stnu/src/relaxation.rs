//! What would make a network controllable: the least change of one constraint or of one side of one link.

use crate::checker::{Stop, Undecided, Verdict, check};
use crate::conflict::{Conflict, Part, conflict_among};
use crate::network::{Edge, Network};

/// A change of one part: a constraint's weight rises, a link's lower bound rises, or its upper bound falls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Relaxation {
    pub part: Part,
    /// What it was: a weight or a bound.
    pub old: i64,
    /// The value that is least different and resolves this conflict, nothing but its members considered; `None` if no
    /// value of this part does.
    pub resolving: Option<i64>,
    /// The value that is least different and makes the whole network controllable; `None` if no value of this part
    /// does.
    pub sufficient: Option<i64>,
}

/// The relaxations of each member of a conflict of `network`, in the order of its members. Takes as many checks for
/// each as the change has binary digits, and a few.
pub fn relaxations(
    network: &Network,
    conflict: &Conflict,
    stop: Stop<'_>,
) -> Result<Vec<Relaxation>, Undecided> {
    let parts: Vec<Part> = conflict.members.iter().map(|member| member.part).collect();
    parts
        .iter()
        .map(|&part| {
            let mut among = |changed: &Network| conflict_among(changed, &parts, stop);
            let resolving = least(network, part, &mut among)?;
            let mut whole = |changed: &Network| match check(changed, stop)? {
                Verdict::Controllable => Ok(None),
                Verdict::Uncontrollable(conflict) => Ok(Some(conflict)),
            };
            let sufficient = if resolving.is_some() { least(network, part, &mut whole)? } else { None };
            Ok(Relaxation { part, old: value(network, part), resolving, sufficient })
        })
        .collect()
}

type Conflicts<'a> = &'a mut dyn FnMut(&Network) -> Result<Option<Conflict>, Undecided>;

/// The value of `part` that is least different and leaves no conflict, if there is one. The easier the value, the fewer
/// the conflicts, so that it is found by halving.
fn least(network: &Network, part: Part, conflicts: Conflicts<'_>) -> Result<Option<i64>, Undecided> {
    let mut changed = network.clone();
    let old = value(network, part);
    let Some(enough) = enough(&mut changed, part, conflicts)? else { return Ok(None) };
    // Between a value that is not enough and one that is.
    let (mut bad, mut good) = (old, enough);
    while bad.abs_diff(good) > 1 {
        let middle = bad.midpoint(good);
        set(&mut changed, part, middle);
        if conflicts(&changed)?.is_some() {
            bad = middle;
        } else {
            good = middle;
        }
    }
    Ok(Some(good))
}

/// A value of `part` that leaves no conflict, if there is one.
fn enough(changed: &mut Network, part: Part, conflicts: Conflicts<'_>) -> Result<Option<i64>, Undecided> {
    let easiest = match part {
        Part::Lower(id) => changed.link(id).upper,
        Part::Upper(id) => changed.link(id).lower,
        Part::Edge(id) => {
            // Each conflict says how far the weight must rise for its cycle not to be negative; one without the edge
            // that no weight is enough.
            while let Some(conflict) = conflicts(changed)? {
                let multiplicity = i64::try_from(conflict.multiplicity(part)).unwrap_or(i64::MAX);
                if multiplicity == 0 {
                    return Ok(None);
                }
                let change = (conflict.deficit - 1) / multiplicity + 1;
                let weight = changed.edge(id).weight.checked_add(change).ok_or(Undecided::Overflow)?;
                changed.set_weight(id, weight);
            }
            return Ok(Some(changed.edge(id).weight));
        }
    };
    set(changed, part, easiest);
    Ok(if conflicts(changed)?.is_none() { Some(easiest) } else { None })
}

fn value(network: &Network, part: Part) -> i64 {
    match part {
        Part::Edge(id) => network.edge(id).weight,
        Part::Lower(id) => network.link(id).lower,
        Part::Upper(id) => network.link(id).upper,
    }
}

fn set(network: &mut Network, part: Part, value: i64) {
    match part {
        Part::Edge(id) => network.set_weight(id, value),
        Part::Lower(id) => {
            let upper = network.link(id).upper;
            // What is asked for is between the bounds.
            let _ = network.set_range(id, value, upper);
        }
        Part::Upper(id) => {
            let lower = network.link(id).lower;
            let _ = network.set_range(id, lower, value);
        }
    }
}

/// As [`relaxations`] tells them, applied: the constraint or link with its new value.
pub fn relax(network: &mut Network, part: Part, value: i64) -> Edge {
    set(network, part, value);
    crate::conflict::part_edge(network, part)
}
