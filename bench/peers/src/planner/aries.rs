//! The instance as `aries-solver` takes it: optional times, half-reified differences, clauses.

use std::time::Duration;

use aries_solver::prelude::{Lit, Model, SearchLimit, Solver, Var, leq, or};

use crate::stopwatch::Stopwatch;

use super::instance::{Instance, Interval};
use super::{Answer, Verdict};

/// Solves the instance; times are optional variables that are present with their literal.
pub(crate) fn solve(instance: &Instance, limit: Duration) -> Answer {
    let start = Stopwatch::start();
    let (model, is_trivially_infeasible) = encode(instance);
    let encoded = start.elapsed();
    if is_trivially_infeasible {
        return Answer { verdict: Verdict::NoPlan, encoding: encoded, total: start.elapsed() };
    }
    let mut solver = Solver::new(model);
    let verdict = match solver.solve(SearchLimit::duration(limit)) {
        Ok(Some(_)) => Verdict::Plan,
        Ok(None) => Verdict::NoPlan,
        Err(_) => Verdict::Limit,
    };
    Answer { verdict, encoding: encoded, total: start.elapsed() }
}

fn encode(instance: &Instance) -> (Model, bool) {
    let mut model = Model::new();
    let mut literals = vec![Lit::TRUE];
    for _ in 1..instance.literals {
        literals.push(model.new_variable(0, 1).geq(1));
    }
    for choice in &instance.choices {
        let when = literals[choice.when];
        let alternatives: Vec<Lit> = choice.alternatives.iter().map(|&at| literals[at]).collect();
        for (at, &one) in alternatives.iter().enumerate() {
            model.enforce(or([!one, when]));
            for &other in &alternatives[at + 1..] {
                model.enforce(or([!one, !other]));
            }
        }
        model.enforce(or(alternatives.into_iter().chain([!when]).collect::<Vec<_>>()));
    }
    let times: Vec<Var> = (instance.events.iter().enumerate())
        .map(|(event, &when)| {
            let latest = if event == 0 { 0 } else { instance.horizon };
            model.new_optional_variable(0, latest, literals[when])
        })
        .collect();
    for bounds in &instance.bounds {
        let (from, to) = (times[bounds.from], times[bounds.to]);
        model.enforce_scoped(leq(from + bounds.lower, to), [literals[bounds.when]]);
        if let Some(upper) = bounds.upper {
            model.enforce_scoped(leq(to - upper, from), [literals[bounds.when]]);
        }
    }
    let mut is_trivially_infeasible = false;
    for requirement in &instance.requirements {
        let asked = requirement.interval;
        let mut clause = vec![!literals[asked.when]];
        for support in &requirement.supports {
            let both = model.get_conjunctive_scope(&[literals[asked.when], literals[support.when]]);
            // The link is chosen among supports that exist, so it is a free Boolean that implies both.
            let link = model.new_variable(0, 1).geq(1);
            model.enforce(or([!link, both]));
            model.enforce_if(link, leq(times[support.start], times[asked.start]));
            model.enforce_if(link, leq(times[asked.end], times[support.end]));
            clause.push(link);
        }
        if clause == [!Lit::TRUE] {
            is_trivially_infeasible = true;
        } else {
            model.enforce(or(clause));
        }
    }
    for &(one, other) in &instance.conflicts {
        let both = model.get_conjunctive_scope(&[literals[one.when], literals[other.when]]);
        let before = |model: &mut Model, first: Interval, second: Interval| {
            let order = model.new_variable(0, 1).geq(1);
            model.enforce(or([!order, both]));
            model.enforce_if(order, leq(times[first.end] + instance.gap, times[second.start]));
            order
        };
        let (first, second) = (before(&mut model, one, other), before(&mut model, other, one));
        model.enforce(or([!both, first, second]));
    }
    (model, is_trivially_infeasible)
}
