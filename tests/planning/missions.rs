//! Every conformance case of state, resources, objectives and contingent durations (SPEC 10 to 13), and the list of those
//! whose features are not built yet.

use std::collections::BTreeSet;

use acceptance::cases::{NOT_BUILT, all, cases, expect_as_listed, program};
use acceptance::mission::compile;
use exact::Bound;
use kirk::{Options, Outcome, Search, Status, Unlimited};
use rmpl::Severity;
use serde_json::Value;
use tpn::plan_json::plan_to_json;
use tpn::{Network, Plan, Top};

#[test]
fn every_mission_case_holds_unless_it_is_listed_as_not_built() {
    for (_, case) in cases("mission-plan") {
        for search in [Search::Chronological, Search::ConflictDirected, Search::BestFirst] {
            expect_as_listed(&case, check(&case, search));
        }
    }
}

#[test]
fn the_list_of_what_is_not_built_names_cases_that_exist() {
    let ids: BTreeSet<String> =
        all().iter().filter_map(|(_, case)| Some(case["id"].as_str()?.to_owned())).collect();
    for (id, _) in NOT_BUILT {
        assert!(ids.contains(id), "there is no case {id}");
    }
}

/// What is wrong with what came of a case, if anything is.
fn check(case: &Value, search: Search) -> Result<(), String> {
    let expect = &case["expect"];
    let (network, diagnostics) = compile(&program(case), &Top::Scenario(None));
    let codes: Vec<&str> = diagnostics.iter().map(|found| found.code.0).collect();
    for code in texts(&expect["diagnostics"]) {
        require(codes.contains(&code.as_str()), || format!("{code} is not reported, but {codes:?}"))?;
    }
    if let Some(error) = diagnostics.iter().find(|found| found.severity == Severity::Error) {
        return Err(format!("{search:?}: {}: {}", error.code.0, error.message));
    }
    let network = network.ok_or("there is no network")?;
    let outcome = plan(&network, search, false)?;
    let exists = expect["plan_exists"] == true;
    require(outcome.plans.is_empty() != exists, || format!("{search:?}: {} plans", outcome.plans.len()))?;
    if !exists {
        return check_failure(expect, &outcome);
    }
    check_plan(case, &network, &outcome.plans[0])?;
    if let Some(count) = expect["num_distinct_plans"].as_u64() {
        let every = plan(&network, search, true)?;
        require(every.plans.len() as u64 == count, || format!("{} plans, not {count}", every.plans.len()))?;
        every.plans.iter().try_for_each(|plan| check_sound(&network, plan))?;
    }
    Ok(())
}

fn plan(network: &Network, search: Search, all: bool) -> Result<Outcome, String> {
    let options = Options { search, all, max_plans: 100_000, ..Options::default() };
    let outcome = kirk::plan(network, &options, &mut Unlimited);
    match outcome.status {
        Status::Plan | Status::NoPlan => Ok(outcome),
        status => Err(format!("planning ends with {status:?}")),
    }
}

fn check_failure(expect: &Value, outcome: &Outcome) -> Result<(), String> {
    let failure = outcome.failure.as_ref().ok_or("a failure does not say why")?;
    let kinds: Vec<&str> = failure.reasons.iter().map(|reason| reason.kind.name()).collect();
    for kind in texts(&expect["failure_kinds"]) {
        require(kinds.contains(&kind.as_str()), || format!("no failure is of kind {kind}, but {kinds:?}"))?;
    }
    Ok(())
}

fn check_plan(case: &Value, network: &Network, plan: &Plan) -> Result<(), String> {
    check_sound(network, plan)?;
    let expect = &case["expect"];
    let written = plan_to_json(network, plan);
    let end = &written["windows"]["scenario#1.end"][0];
    if let Some(choices) = expect["choices"].as_array() {
        require(choices.contains(&written["choices"]), || format!("the choices are {}", written["choices"]))?;
    }
    for (member, value) in [("cost", &written["cost"]), ("reward", &written["reward"]), ("end", end)] {
        let expected = &expect[member];
        require(expected.is_null() || same(expected, value), || format!("{member} is {value}"))?;
    }
    for (event, times) in expect["earliest"].as_object().into_iter().flatten() {
        let earliest = &written["windows"][event][0];
        let is_one = times.as_array().into_iter().flatten().any(|time| same(time, earliest));
        require(is_one, || format!("{event} is at {earliest} at the earliest"))?;
    }
    for (event, window) in expect["windows"].as_object().into_iter().flatten() {
        let found = &written["windows"][event];
        let agree = same(&window[0], &found[0]) && same(&window[1], &found[1]);
        require(agree, || format!("the window of {event} is {found}"))?;
    }
    if let Some(goals) = expect["goals"].as_array() {
        require(written["optimal"] == true, || "the plan is not said to be optimal".to_owned())?;
        for (goal, value) in texts(&case["objective"]).iter().zip(goals) {
            let found = evaluate(goal, &written, end)?;
            require(value.as_f64() == Some(found), || format!("{goal} is {found}, not {value}"))?;
        }
    }
    Ok(())
}

/// The checker accepts the plan, its earliest schedule, and its latest where there is one.
fn check_sound(network: &Network, plan: &Plan) -> Result<(), String> {
    acceptance::mission::sound(network, plan)?;
    let latest: Vec<Option<_>> = (plan.windows.iter())
        .map(|window| match window.map(|window| window.latest) {
            Some(Bound::Finite(latest)) => Some(latest),
            _ => None,
        })
        .collect();
    let is_bounded =
        latest.iter().zip(&plan.selected_nodes).all(|(time, selected)| time.is_some() || !selected);
    if is_bounded {
        let verdict = verify::check_schedule(network, plan, &latest);
        require(verdict.valid, || format!("the latest schedule: {:?}", verdict.violations))?;
    }
    Ok(())
}

/// The value of `minimize 2*cost + end` and the like in a plan.
fn evaluate(goal: &str, plan: &Value, end: &Value) -> Result<f64, String> {
    let mut words = goal.split_whitespace();
    let direction = words.next();
    require(matches!(direction, Some("minimize" | "maximize")), || format!("not a goal: {goal}"))?;
    let (mut sum, mut sign) = (0.0, 1.0);
    for word in words {
        match word {
            "+" => sign = 1.0,
            "-" => sign = -1.0,
            term => {
                let (factor, name) = term.split_once('*').unwrap_or(("1", term));
                let value = if name == "end" { end } else { &plan[name] };
                let value = value.as_f64().ok_or_else(|| format!("the plan has no {name}"))?;
                sum += sign * factor.parse::<f64>().map_err(|problem| problem.to_string())? * value;
            }
        }
    }
    Ok(sum)
}

/// Returns whether two JSON numbers, or infinities, are equal: 13 and 13.0 are.
fn same(one: &Value, other: &Value) -> bool {
    one == other || one.as_f64().is_some_and(|one| other.as_f64() == Some(one))
}

fn texts(list: &Value) -> Vec<String> {
    list.as_array().into_iter().flatten().filter_map(|text| Some(text.as_str()?.to_owned())).collect()
}

fn require(is_met: bool, problem: impl FnOnce() -> String) -> Result<(), String> {
    if is_met { Ok(()) } else { Err(problem()) }
}

#[test]
fn goals_are_evaluated_as_they_are_written() {
    let plan = serde_json::json!({"cost": 3, "reward": 5});
    let end = serde_json::json!(7);
    assert_eq!(evaluate("maximize reward - cost", &plan, &end), Ok(2.0));
    assert_eq!(evaluate("minimize 2*cost + end", &plan, &end), Ok(13.0));
    assert!(evaluate("minimize length", &plan, &end).is_err());
}
