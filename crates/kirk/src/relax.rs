//! Changes of one bound that make a mission plannable, each found by planning.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use rmpl::Span;
use tpn::{ArcId, Network};

use crate::choices::Choices;
use crate::explain::{Effort, Refuted};
use crate::failure::{Failure, Member, Relaxation};
use crate::model::{Context, INFINITE, Model};
use crate::options::{Options, Search, Stats, Status, Termination};
use crate::solver::Part;
use crate::trace::Constraint;
use crate::unplannable::Unplannable;
use crate::{answer, wording};

/// At most so many are offered.
const MAX_RELAXATIONS: usize = 8;

/// The smallest changes of single bounds, among those that `failure` rests on, that give `network` a plan.
pub(crate) fn relaxations(
    network: &Network,
    model: &Model,
    failure: &Failure,
    termination: &mut dyn Termination,
) -> Result<Vec<Relaxation>, Unplannable> {
    let effort = Effort::for_size(model.num_nodes, termination);
    if !model.has_contexts {
        return Ok(Vec::new());
    }
    let mut trial = Trial { network, model: model.clone(), effort };
    let mut found: Vec<Relaxation> = Vec::new();
    for (arcs, is_lower) in candidates(network, failure) {
        if let Some(new) = trial.closest(&arcs, is_lower)? {
            found.push(relaxation(network, model, &arcs, is_lower, new));
        }
    }
    found.sort_by(|left, right| cost(left).cmp(&cost(right)).then(left.arc.cmp(&right.arc)));
    found.truncate(MAX_RELAXATIONS);
    Ok(found)
}

/// How far a negative minimum is lowered to see whether that helps: sums with all other bounds still fit.
const WIDEST: i64 = 1 << 50;

/// Planning without the gap may meet so many conflicts.
const MAX_CONFLICTS: u64 = 10_000;

/// Returns whether there is a plan if conflicting intervals may touch.
pub(crate) fn has_plan_without_gap(
    network: &Network,
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<bool, Unplannable> {
    let has_conflicts = model.conditions.variables.iter().any(|variable| variable.labels.len() > 1);
    if model.gap == 0 || !has_conflicts {
        return Ok(false);
    }
    let options = Options {
        search: Search::ConflictDirected,
        all: false,
        best: 1,
        explain: false,
        relax: false,
        trace_events: None,
        traced: None,
        threat_gap: Some(Time::ZERO),
        ..*options
    };
    let mut enough = |stats: &Stats| {
        termination.should_stop(stats) || stats.conflicts.max(stats.backtracks) > MAX_CONFLICTS
    };
    let without = Model::new(network, options.threat_gap)?;
    let outcome = answer::answer(network, &without, &options, &[], &mut enough)?;
    Ok(outcome.status == Status::Plan)
}

/// Bounds of the conflicts, those with the same text together.
fn candidates(network: &Network, failure: &Failure) -> Vec<(Vec<ArcId>, bool)> {
    let mut by_span: BTreeMap<(Option<Span>, bool, Option<ArcId>), Vec<ArcId>> = BTreeMap::new();
    for reason in &failure.reasons {
        for member in &reason.conflict {
            let (arc, is_lower) = match member {
                Member::Bound(Constraint::Lower(arc)) => (*arc, true),
                Member::Bound(Constraint::Upper(arc)) => (*arc, false),
                _ => continue,
            };
            let bounds = &network.arcs[arc.index()];
            // Of what the environment chooses the range becomes narrower, of all else wider.
            let is_at_end = is_lower && bounds.lower == Time::ZERO && !network.is_uncertain(arc);
            if wording::is_structural(bounds.kind) || is_at_end {
                continue;
            }
            let alone = bounds.span.is_none().then_some(arc);
            by_span.entry((bounds.span, is_lower, alone)).or_insert_with(|| vec![arc]);
        }
    }
    // One text may make several arcs: they change together, if they are equal.
    for ((span, _, _), arcs) in &mut by_span {
        let Some(span) = span else { continue };
        let first = arcs[0];
        *arcs = (0..network.arcs.len())
            .map(ArcId::from_index)
            .filter(|arc| {
                let arc = &network.arcs[arc.index()];
                arc.span == Some(*span) && !wording::is_structural(arc.kind)
            })
            .collect();
        let bounds = |arc: &ArcId| {
            let bounds = &network.arcs[arc.index()];
            (bounds.lower, bounds.upper, bounds.is_contingent)
        };
        if arcs.iter().any(|arc| bounds(arc) != bounds(&first)) {
            arcs.clear();
        }
    }
    by_span
        .into_iter()
        .map(|((_, is_lower, _), arcs)| (arcs, is_lower))
        .filter(|(arcs, _)| !arcs.is_empty())
        .collect()
}

/// What planning makes of a value.
enum Trying {
    /// There is a plan with it, and with this value, which is at most as far from the old one.
    Plans(i64),
    Fails,
    /// It takes too long to find out.
    Unknown,
}

struct Trial<'a> {
    network: &'a Network,
    model: Model,
    effort: Effort<'a>,
}

impl Trial<'_> {
    /// The value closest to the present one that gives a plan, if any does and it is found in time.
    fn closest(&mut self, arcs: &[ArcId], is_lower: bool) -> Result<Option<i64>, Unplannable> {
        let first = &self.model.arcs[arcs[0]];
        let (lower, upper) = (first.lower, first.upper);
        let (old, most) = match (first.is_uncertain, is_lower) {
            (false, true) if lower < 0 => (lower, -WIDEST),
            (false, true) => (lower, 0),
            (false, false) => (upper, INFINITE),
            (true, true) => (lower, upper),
            (true, false) => (upper, lower),
        };
        let bounds = (lower, upper);
        if old == most {
            return Ok(None);
        }
        let Trying::Plans(widest) = self.plans_with(arcs, is_lower, most, bounds)? else { return Ok(None) };
        // Step away from the old value ever faster until there is a plan, then halve what is between.
        let (mut fails, mut step) = (old, 1_i64);
        let mut plans = loop {
            let next = if most < old {
                old.saturating_sub(step).max(widest)
            } else {
                old.saturating_add(step).min(widest)
            };
            if next >= INFINITE / 4 {
                return Ok(None);
            }
            if next == widest {
                break widest;
            }
            match self.plans_with(arcs, is_lower, next, bounds)? {
                Trying::Plans(closest) => break closest,
                Trying::Fails => (fails, step) = (next, step.saturating_mul(2)),
                Trying::Unknown => return Ok(None),
            }
        };
        while plans.abs_diff(fails) > 1 {
            let middle = plans.midpoint(fails);
            match self.plans_with(arcs, is_lower, middle, bounds)? {
                Trying::Plans(closest) => plans = closest,
                Trying::Fails => fails = middle,
                // A change that may be larger than it has to be is none to offer.
                Trying::Unknown => return Ok(None),
            }
        }
        Ok(Some(plans))
    }

    /// Returns what planning makes of a value.
    fn plans_with(
        &mut self,
        arcs: &[ArcId],
        is_lower: bool,
        value: i64,
        (lower, upper): (i64, i64),
    ) -> Result<Trying, Unplannable> {
        if !self.effort.spend() {
            return Ok(Trying::Unknown);
        }
        let (new_lower, new_upper) = if is_lower { (value, upper) } else { (lower, value) };
        for &arc in arcs {
            self.model.set_bounds(self.network, arc, new_lower, new_upper);
        }
        self.model.refresh_structure()?;
        let solved = self.effort.solve(&self.model, Part::default());
        for &arc in arcs {
            self.model.set_bounds(self.network, arc, lower, upper);
        }
        self.model.refresh_structure()?;
        Ok(match solved {
            Some(Refuted::No(solution)) => {
                Trying::Plans(self.closest_within(arcs, is_lower, value, &solution))
            }
            Some(Refuted::By(_)) => Trying::Fails,
            None => Trying::Unknown,
        })
    }

    /// The value closest to the old one that a solution for another value keeps, too: what its arcs really take.
    fn closest_within(&self, arcs: &[ArcId], is_lower: bool, value: i64, solution: &Choices) -> i64 {
        // The environment takes what it likes.
        if self.model.has_uncertainty {
            return value;
        }
        let is_there = |context: Context| {
            context.is_none_or(|choice| solution.alternatives[choice.decision] == Some(choice.alternative))
        };
        let takes = |arc: &ArcId| {
            let arc = &self.model.arcs[*arc];
            let counts = is_there(arc.context) && is_there(arc.other_context);
            counts.then(|| solution.times[arc.to.index()] - solution.times[arc.from.index()])
        };
        let taken = arcs.iter().filter_map(takes);
        let closest = if is_lower { taken.min() } else { taken.max() };
        // The old value has no plan.
        let old = &self.model.arcs[arcs[0]];
        closest.filter(|&it| if is_lower { it < old.lower } else { it > old.upper }).unwrap_or(value)
    }
}

fn relaxation(network: &Network, model: &Model, arcs: &[ArcId], is_lower: bool, new: i64) -> Relaxation {
    let arc = &network.arcs[arcs[0].index()];
    let new = model.time(new);
    let name = wording::arc_name(network, arc);
    let is_natures = network.is_uncertain(arcs[0]);
    let changed = |change: &str, old: Bound| {
        format!("{change} of {name} from {} to {}", old.readable(), new.readable())
    };
    let (old, new_lower, new_upper, label) = if is_natures && is_lower {
        let old = Bound::Finite(arc.lower);
        let label = format!("{}, if the environment allows it", changed("raise the minimum", old));
        (old, Bound::Finite(new), arc.upper, label)
    } else if is_natures {
        let label = format!("{}, if the environment allows it", changed("lower the maximum", arc.upper));
        (arc.upper, Bound::Finite(arc.lower), Bound::Finite(new), label)
    } else if is_lower {
        let old = Bound::Finite(arc.lower);
        let label = changed("lower the minimum", old);
        (old, Bound::Finite(new), arc.upper, label)
    } else {
        let label = changed("raise the maximum", arc.upper);
        (arc.upper, Bound::Finite(arc.lower), Bound::Finite(new), label)
    };
    Relaxation {
        arc: arcs[0],
        is_lower,
        old,
        new,
        span: arc.span,
        bounds_text: format!("[{new_lower}, {new_upper}]"),
        label,
    }
}

/// The change relative to the bound.
fn cost(relaxation: &Relaxation) -> Bound {
    let (old, new) = (relaxation.old.finite().unwrap_or_default(), relaxation.new);
    let change = if new < old { old.checked_sub(new) } else { new.checked_sub(old) };
    let relative = change.and_then(|change| change.checked_ratio(old.max(Time::ONE)));
    relative.map_or(Bound::Infinite, |relative| Bound::Finite(Time::from_units(relative)))
}
