//! From a prepared network to an answer: one search, or several where the first one proves nothing.

use std::collections::BTreeSet;

use tpn::{Choice, Network, Plan};

use crate::failure::{Failure, FailureKind, Reason};
use crate::model::Model;
use crate::nature_run::nature_run;
use crate::options::{Options, Outcome, Search, Stats, Status, Termination, Unlimited};
use crate::search::{Choices, Engine, Gaps, Halt, Setup};
use crate::solver::{Answer, Part, Problem, Unencoded};
use crate::trace::Event;
use crate::unplannable::Unplannable;
use crate::{demanding, explain, relax, solution};

/// Plans, or explains why there is no plan; also, whether gaps alone made something fail on the way.
pub(crate) fn answer(
    network: &Network,
    model: &Model,
    options: &Options,
    excluded: &[Vec<Choice>],
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Unplannable> {
    let is_list = options.best > 1 || !excluded.is_empty();
    let is_demanding = demanding::has_demands(model) || (is_list && model.has_contexts);
    let (mut outcome, mut has_doubts) = if is_demanding {
        // Nothing that was chosen before is tried again with other bounds.
        (demanding::search(network, model, options, excluded, termination)?, true)
    } else {
        searched(model, options, termination)?
    };
    let is_cut_short = !is_demanding && outcome.status == Status::Limit;
    if is_cut_short && outcome.trace.as_ref().is_some_and(|trace| trace.is_truncated) {
        // What is recorded is searched step by step as the paper does, and stops when the record is full: the answer is
        // up to a search that may take the shortcuts.
        let unrecorded = Options { trace_events: None, ..*options };
        let trace = outcome.trace.take();
        (outcome, has_doubts) = searched(model, &unrecorded, termination)?;
        outcome.trace = trace;
    }
    if outcome.status == Status::NoPlan && options.explain && excluded.is_empty() {
        let mut failure = explain::explain(network, model, &[], termination)?;
        if options.relax {
            failure.relaxations = relax::relaxations(network, model, &failure, termination)?;
            failure.is_of_gap = relax::has_plan_without_gap(network, model, options, termination)?;
            add_failing_run(&mut failure, network, options, termination);
        }
        outcome.failure = Some(failure);
    }
    Ok((outcome, has_doubts))
}

/// Gives the first of nature's reasons that the run belongs to the run in which it fails.
fn add_failing_run(
    failure: &mut Failure,
    network: &Network,
    options: &Options,
    termination: &mut dyn Termination,
) {
    let is_natures = |reason: &&mut Reason| reason.kind == FailureKind::Controllability;
    if failure.reasons.iter_mut().any(|reason| is_natures(&reason))
        && let Some((choices, run)) = nature_run(network, options.threat_gap, termination)
    {
        let is_its = |reason: &&mut Reason| reason.choices.iter().all(|choice| choices.contains(choice));
        if let Some(reason) = failure.reasons.iter_mut().filter(is_natures).find(is_its) {
            reason.failing_run = Some(run);
        }
    }
}

fn searched(
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Unplannable> {
    if options.search.learns() && !options.all {
        first_plan(model, options, termination)
    } else {
        run(model, options, (Gaps::Exact, Stats::default()), termination)
    }
}

/// The plan with these choices, if there is one, and if a search that trusts gaps would find it, too. Leaves in
/// `proposed` times that fit it; where times that nearly fit are there before, it takes less work.
pub(crate) fn with_choices(
    model: &Model,
    choices: &Choices,
    proposed: &mut Vec<i64>,
    termination: &mut dyn Termination,
) -> Result<Option<Outcome>, Unplannable> {
    if !model.has_contexts {
        return Ok(None);
    }
    let setup = Setup {
        jumps: true,
        is_checking: true,
        assumed: Some(choices.clone()),
        proposed: std::mem::take(proposed),
        ..Setup::default()
    };
    let mut engine = Engine::new(model, setup);
    if engine.run(termination)? != Halt::Solution || engine.has_doubts || !engine.has_room_for_gaps()? {
        return Ok(None);
    }
    let plan = solution::plan_at(&mut engine)?;
    let stats = engine.stats;
    *proposed = engine.leaf.schedule;
    Ok(Some(Outcome {
        status: Status::Plan,
        plans: vec![plan],
        bound: None,
        failure: None,
        stats,
        trace: None,
        unplannable: None,
    }))
}

/// How often the search in textual order may go back before an active schedule is tried and the solver takes over.
const MAX_BACKTRACKS: u64 = 100;
/// The same where there are only links and orders to choose, about which it does not learn.
const MAX_BACKTRACKS_UNDECIDED: u64 = 0;
/// How often it may go back where the solver knows a plan in which intervals touch.
const MAX_BACKTRACKS_TOUCHING: u64 = 2_000;

/// A plan, by a search in textual order where that meets few failures, or by an active schedule from where it stands then,
/// and otherwise by the solver.
///
/// Both first expect no choice to force intervals to touch. Where there is no plan then and gaps had to do with it, one
/// that asks for no gaps may show that there is none; otherwise a search that rests such failures on every choice decides.
fn first_plan(
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Unplannable> {
    if options.trace_events.is_some() || !model.has_contexts {
        return first_in_order(model, options, Stats::default(), termination);
    }
    let (outcome, has_doubts, is_stopped) = run_briefly(model, options, termination)?;
    if is_stopped || outcome.status == Status::Plan || (outcome.status == Status::NoPlan && !has_doubts) {
        return Ok((outcome, has_doubts));
    }
    first_by_solver(model, options, outcome.stats, termination)
}

/// A plan of those in which no choice forces intervals to touch, if few failures are met: the first one in textual order,
/// or one with the orders of an active schedule.
pub(crate) fn first_soon(
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<Option<Outcome>, Unplannable> {
    let options = Options { search: Search::ConflictDirected, ..*options };
    let (outcome, ..) = run_briefly(model, &options, termination)?;
    Ok((outcome.status == Status::Plan).then_some(outcome))
}

/// One search that trusts gaps and ends after few failures with an active schedule, whether it has doubts, and whether it
/// was stopped.
fn run_briefly(
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool, bool), Unplannable> {
    let most = if model.decisions.is_empty() { MAX_BACKTRACKS_UNDECIDED } else { MAX_BACKTRACKS };
    let mut is_stopped = false;
    let mut soon = |stats: &Stats| {
        is_stopped = termination.should_stop(stats);
        is_stopped || stats.backtracks > most
    };
    let mut engine = engine(model, options, Gaps::Trusted, Stats::default());
    engine.setup.schedules = true;
    let mut halt = engine.run(&mut soon)?;
    let is_cut_short = halt == Halt::Stopped && !is_stopped && engine.stats.backtracks > most;
    if is_cut_short && engine.order_as_scheduled()? {
        halt = Halt::Solution;
    }
    let (status, plans) = match halt {
        Halt::Solution => (Status::Plan, vec![solution::plan_at(&mut engine)?]),
        Halt::Exhausted => (Status::NoPlan, Vec::new()),
        Halt::Stopped => (Status::Limit, Vec::new()),
    };
    Ok((ended(status, plans, engine.stats), engine.has_doubts, is_stopped))
}

/// A plan by the solver.
///
/// A plan that needs intervals to touch depends on the order in which conflicting pairs are looked at (SPEC 5.3). It is the
/// textual one as far as a search through all such plans comes to an end soon; beyond that it is whichever serves.
fn first_by_solver(
    model: &Model,
    options: &Options,
    mut stats: Stats,
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Unplannable> {
    let mut touching = None;
    let all_gaps = [Gaps::Trusted, Gaps::Ignored];
    for &gaps in if model.gap == 0 { &all_gaps[1..] } else { &all_gaps[..] } {
        let Ok((answer, choices)) = solve(model, gaps, Part::default(), &mut stats, termination) else {
            break;
        };
        let status = match answer {
            Answer::Solved => {
                let Some(choices) = choices else { break };
                if let Some(plan) = plan_with(model, choices.clone(), false)? {
                    return Ok((ended(Status::Plan, vec![plan], stats), true));
                }
                touching = Some(choices);
                break;
            }
            Answer::Stopped => Status::Limit,
            Answer::Unsolvable if gaps == Gaps::Trusted => continue,
            Answer::Unsolvable => Status::NoPlan,
        };
        return Ok((ended(status, Vec::new(), stats), true));
    }
    let Some(choices) = touching else { return run(model, options, (Gaps::Exact, stats), termination) };
    let before = stats.backtracks;
    let mut is_stopped = false;
    let mut soon = |stats: &Stats| {
        is_stopped = termination.should_stop(stats);
        is_stopped || stats.backtracks > before + MAX_BACKTRACKS_TOUCHING
    };
    let (outcome, has_doubts) = run(model, options, (Gaps::Exact, stats), &mut soon)?;
    if is_stopped || outcome.status != Status::Limit {
        return Ok((outcome, has_doubts));
    }
    match plan_with(model, choices, true)? {
        Some(plan) => Ok((ended(Status::Plan, vec![plan], outcome.stats), true)),
        None => run(model, options, (Gaps::Exact, outcome.stats), termination),
    }
}

fn ended(status: Status, plans: Vec<Plan>, stats: Stats) -> Outcome {
    Outcome { status, plans, bound: None, failure: None, stats, trace: None, unplannable: None }
}

/// One search by the solver, whose work is added to `stats`.
pub(crate) fn solve(
    model: &Model,
    gaps: Gaps,
    part: Part<'_>,
    stats: &mut Stats,
    termination: &mut dyn Termination,
) -> Result<(Answer, Option<Choices>), Unencoded> {
    let (mut problem, mut solver) = Problem::new(model, gaps, part, &mut || termination.should_stop(stats))?;
    solver.stats = *stats;
    let answer = solver.solve(&mut problem, &mut |stats| termination.should_stop(stats));
    *stats = solver.stats;
    let choices = (answer == Answer::Solved).then(|| problem.solution(&solver));
    Ok((answer, choices))
}

/// The plan with these choices, where conflicting pairs are ordered by the times given. `None` if a pair that only
/// touches is not forced to.
fn plan_with(
    model: &Model,
    choices: Choices,
    orders_touching_last: bool,
) -> Result<Option<Plan>, Unplannable> {
    let proposed = choices.times.clone();
    let setup = Setup {
        jumps: true,
        is_checking: true,
        assumed: Some(choices),
        orders_touching_last,
        proposed,
        ..Setup::default()
    };
    let mut engine = Engine::new(model, setup);
    if engine.run(&mut Unlimited)? != Halt::Solution {
        return Ok(None);
    }
    solution::plan_at(&mut engine).map(Some)
}

/// The first plan in textual order, but for those that rest on intervals being forced to touch.
fn first_in_order(
    model: &Model,
    options: &Options,
    stats: Stats,
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Unplannable> {
    let (mut outcome, has_doubts) = run(model, options, (Gaps::Trusted, stats), termination)?;
    if outcome.status != Status::NoPlan || !has_doubts {
        return Ok((outcome, has_doubts));
    }
    // A trace is of one search with the rules as they are, and so is what is counted beside it.
    if options.trace_events.is_some() {
        return run(model, options, (Gaps::Exact, Stats::default()), termination);
    }
    let (without_gaps, _) = run(model, options, (Gaps::Ignored, outcome.stats), termination)?;
    if without_gaps.status != Status::Plan {
        return Ok((without_gaps, true));
    }
    outcome = without_gaps;
    run(model, options, (Gaps::Exact, outcome.stats), termination)
}

/// A search that is about to begin, after others with `stats`.
fn engine<'m>(model: &'m Model, options: &Options, gaps: Gaps, stats: Stats) -> Engine<'m> {
    let jumps = options.search.learns();
    let setup = Setup {
        jumps,
        gaps,
        by_structure: jumps,
        is_enumerating: options.all,
        trace_events: options.trace_events,
        ..Setup::default()
    };
    let mut engine = Engine::new(model, setup);
    engine.stats = Stats {
        nodes: engine.stats.nodes,
        arcs: engine.stats.arcs,
        decisions: engine.stats.decisions,
        ..stats
    };
    engine
}

/// One search, after others with `stats`, and whether it has doubts that there is nothing where it found nothing.
fn run(
    model: &Model,
    options: &Options,
    (gaps, stats): (Gaps, Stats),
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Unplannable> {
    let mut engine = engine(model, options, gaps, stats);
    let mut plans: Vec<Plan> = Vec::new();
    let mut known = BTreeSet::new();
    let status = loop {
        match engine.run(termination)? {
            Halt::Exhausted if plans.is_empty() => break Status::NoPlan,
            Halt::Exhausted => break Status::Plan,
            Halt::Stopped => break Status::Limit,
            Halt::Solution => {
                let plan = solution::plan_at(&mut engine)?;
                if !options.all {
                    plans.push(plan);
                    break Status::Plan;
                }
                let key = (plan.choices.clone(), plan.causal_links.clone(), plan.conflict_order.clone());
                if known.insert(key) {
                    let number = plans.len() as u32;
                    engine.log(|_| Event::Solution { plan: number });
                    plans.push(plan);
                }
                if plans.len() >= options.max_plans {
                    break Status::Limit;
                }
            }
        }
    };
    if status == Status::Plan && !options.all {
        engine.log(|_| Event::Solution { plan: 0 });
    }
    let outcome = Outcome {
        status,
        plans,
        bound: None,
        failure: None,
        stats: engine.stats,
        trace: engine.recorder.take().map(|recorder| recorder.trace),
        unplannable: None,
    };
    Ok((outcome, engine.has_doubts))
}

#[cfg(test)]
mod tests {
    use exact::Time;
    use tpn::compile::{Top, compile};
    use tpn::families::{chain, long_requirements, nested, open_shop, pigeonholes, symmetric};
    use tpn::generate::{Recipe, Tightness, mission};

    use super::*;
    use crate::options::ExpansionLimit;

    fn network(text: &str) -> Network {
        let (network, diagnostics) = compile(&rmpl::parse(text).program(), &Top::Scenario(None));
        network.unwrap_or_else(|| panic!("does not compile: {diagnostics:?}\n{text}"))
    }

    /// The solver alone says that there is a plan exactly where the paper's search does, and its plans are plans.
    #[test]
    fn the_solver_alone_agrees_with_the_chronological_search() {
        let mut texts = Vec::new();
        for seed in 0..150 {
            texts.extend([90, 110, 150].map(|percent| nested(20 + seed as usize % 30, percent, seed)));
            texts.extend([70, 85, 100].map(|percent| long_requirements(3, 3, seed, percent)));
            texts.push(open_shop(2, 95 + seed as i64 % 12, seed));
            for tightness in [Tightness::Feasible, Tightness::Boundary, Tightness::Infeasible] {
                texts.push(mission(Recipe { nodes: 30 + seed as usize % 40, tightness, seed }));
            }
        }
        texts.extend([pigeonholes(4, 0), pigeonholes(4, 1), symmetric(3, 2, 0), symmetric(3, 2, 1)]);
        texts.extend([chain(5, true), chain(5, false)]);
        let (mut plans, mut none) = (0, 0);
        for text in &texts {
            for gap in [None, Some(Time::from(1))] {
                let network = network(text);
                let chronological = Options {
                    search: Search::Chronological,
                    threat_gap: gap,
                    explain: false,
                    relax: false,
                    ..Options::default()
                };
                let expected = crate::plan(&network, &chronological, &mut ExpansionLimit(20_000));
                if expected.status == Status::Limit {
                    continue;
                }
                let model = Model::new(&network, gap).expect("times fit");
                let options = Options { search: Search::ConflictDirected, ..chronological };
                let (outcome, _) =
                    first_by_solver(&model, &options, Stats::default(), &mut Unlimited).expect("fits");
                assert_eq!(outcome.status, expected.status, "gap {gap:?}\n{text}");
                let mut network = network;
                network.threat_gap = gap.unwrap_or(network.threat_gap);
                for plan in &outcome.plans {
                    let verdict = verify::check_plan(&network, plan);
                    assert!(verdict.violations.is_empty(), "{verdict:?}\n{text}");
                }
                *if outcome.plans.is_empty() { &mut none } else { &mut plans } += 1;
            }
        }
        assert!(plans > 300 && none > 300, "{plans} have a plan and {none} have none");
    }

    /// Wherever textual order meets a failure and an active schedule is found instead, it makes a plan.
    #[test]
    fn what_is_ordered_as_an_active_schedule_is_a_plan() {
        let mut texts = Vec::new();
        for seed in 0..60 {
            texts.extend([100, 110, 130].map(|percent| open_shop(3 + seed as usize % 3, percent, seed)));
            texts.extend([85, 100].map(|percent| long_requirements(4, 3, seed, percent)));
            texts.push(nested(60, 110, seed));
            texts.push(mission(Recipe { nodes: 60, tightness: Tightness::Feasible, seed }));
        }
        let (mut scheduled, mut unscheduled) = (0, 0);
        for text in &texts {
            for gap in [None, Some(Time::from(1))] {
                let mut network = network(text);
                network.threat_gap = gap.unwrap_or(network.threat_gap);
                let model = Model::new(&network, None).expect("times fit");
                let options = Options { search: Search::ConflictDirected, ..Options::default() };
                let mut engine = engine(&model, &options, Gaps::Trusted, Stats::default());
                let mut at_once = |stats: &Stats| stats.backtracks > 0;
                if engine.run(&mut at_once).expect("times fit") != Halt::Stopped {
                    continue;
                }
                if !engine.order_as_scheduled().expect("times fit") {
                    unscheduled += 1;
                    continue;
                }
                scheduled += 1;
                let plan = solution::plan_at(&mut engine).expect("times fit");
                let verdict = verify::check_plan(&network, &plan);
                assert!(verdict.violations.is_empty(), "{verdict:?}\n{text}");
            }
        }
        assert!(scheduled > 150 && unscheduled > 20, "{scheduled} scheduled, {unscheduled} not");
    }
}
