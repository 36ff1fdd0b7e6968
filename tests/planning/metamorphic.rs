//! What must not matter does not: names, the order of parallel branches, the unit of time, where the text breaks lines.

use std::collections::BTreeSet;

use acceptance::mission::{PlanKey, all_plans, key, network};
use acceptance::random::small_mission;
use exact::{Bound, Rational, Time};
use kirk::Search;
use tpn::generate::{Recipe, Tightness, mission};
use tpn::{Network, Plan};

const SEEDS: std::ops::Range<u64> = 0..1_000;

fn same(name: String) -> String {
    name
}

fn keys(network: &Network, plans: &[Plan], rename: &dyn Fn(String) -> String) -> BTreeSet<PlanKey> {
    plans.iter().map(|plan| key(network, plan, rename)).collect()
}

/// The plans of two texts by name, after renaming the second's; the count of missions that have any.
fn assert_same_plans(change: impl Fn(&str) -> String, rename: &dyn Fn(String) -> String) {
    let mut with_plan = 0;
    for seed in SEEDS {
        let text = small_mission(seed);
        let changed = change(&text);
        let (one, other) = (network(&text), network(&changed));
        let plans = all_plans(&one, Search::ConflictDirected).plans;
        let changed_plans = all_plans(&other, Search::ConflictDirected).plans;
        assert_eq!(
            keys(&other, &changed_plans, rename),
            keys(&one, &plans, &same),
            "seed {seed}\n{text}\n{changed}"
        );
        with_plan += usize::from(!plans.is_empty());
    }
    assert!(with_plan > 100, "only {with_plan} missions have a plan");
}

#[test]
fn renaming_activities_and_variables_renames_the_plans() {
    let change = |text: &str| text.replace("P0(", "Zebra-Walk(").replace("P2(", "A(").replace("MODE", "Q7");
    let rename = |name: String| name.replace("Zebra-Walk#", "P0#").replace("A#", "P2#").replace("Q7", "MODE");
    assert_same_plans(change, &rename);
}

#[test]
fn line_breaks_and_comments_change_nothing() {
    let change = |text: &str| text.replace(' ', " /* a [comment] { */\n\t").replace(';', " // ; }\n;");
    assert_same_plans(change, &same);
}

#[test]
fn scaling_all_times_scales_all_windows() {
    let mut with_plan = 0;
    for seed in SEEDS {
        let one = network(&small_mission(seed));
        for factor in [Rational::from(60), Rational::new(1, 7).expect("a seventh")] {
            let mut scaled = one.clone();
            for arc in &mut scaled.arcs {
                arc.lower = scaled_time(arc.lower, factor);
                arc.upper = scale(arc.upper, factor);
            }
            scaled.threat_gap = scaled_time(scaled.threat_gap, factor);
            let plans = all_plans(&one, Search::Chronological).plans;
            let scaled_plans = all_plans(&scaled, Search::Chronological).plans;
            assert_eq!(plans.len(), scaled_plans.len(), "seed {seed}, factor {factor}");
            for (plan, scaled_plan) in plans.iter().zip(&scaled_plans) {
                assert_eq!(key(&one, plan, &same), key(&scaled, scaled_plan, &same), "seed {seed}");
                for (window, scaled_window) in plan.windows.iter().zip(&scaled_plan.windows) {
                    let expected = window
                        .map(|window| (scaled_time(window.earliest, factor), scale(window.latest, factor)));
                    assert_eq!(
                        scaled_window.map(|window| (window.earliest, window.latest)),
                        expected,
                        "seed {seed}"
                    );
                }
            }
            with_plan += usize::from(!plans.is_empty());
        }
    }
    assert!(with_plan > 100, "only {with_plan} missions have a plan");
}

fn scale(bound: Bound, factor: Rational) -> Bound {
    bound.finite().map_or(Bound::Infinite, |time| Bound::Finite(scaled_time(time, factor)))
}

fn scaled_time(time: Time, factor: Rational) -> Time {
    time.checked_mul(factor).expect("a small time")
}

/// The branches of the scenario in reverse order. Occurrences are then counted in another order, so only what has no
/// count is compared: the makespans of the plans, and how many links they have.
///
/// With a gap between ordered intervals the windows depend on which threats are looked at first, because what touches
/// by then needs no gap (SPEC 5.3); without one they do not.
#[test]
fn reordering_parallel_branches_changes_no_answer() {
    let mut with_plan = 0;
    for seed in SEEDS {
        let text = small_mission(seed);
        let Some(reordered) = reverse_threads(&text) else { continue };
        let summary = |text: &str| {
            let mut network = network(text);
            network.threat_gap = Time::ZERO;
            let plans = all_plans(&network, Search::ConflictDirected).plans;
            let outline = |plan: &Plan| {
                format!("{:?}, {} links", plan.windows[network.end.index()], plan.causal_links.len())
            };
            plans.iter().map(outline).collect::<BTreeSet<String>>()
        };
        let (before, after) = (summary(&text), summary(&reordered));
        assert_eq!(before, after, "seed {seed}\n{text}\n{reordered}");
        with_plan += usize::from(!before.is_empty());
    }
    assert!(with_plan > 100, "only {with_plan} missions have a plan");
}

/// The text with the threads of its scenario in reverse order; `None` if there is only one.
fn reverse_threads(text: &str) -> Option<String> {
    let (head, body) = text.split_once(" = { ")?;
    let body = body.trim_end().strip_suffix(" }")?;
    let mut threads = Vec::new();
    let (mut depth, mut start) = (0, 0);
    for (at, character) in body.char_indices() {
        match character {
            '{' | '[' | '(' => depth += 1,
            '}' | ']' | ')' => depth -= 1,
            ',' if depth == 0 => {
                threads.push(&body[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    threads.push(&body[start..]);
    threads.reverse();
    (threads.len() > 1).then(|| format!("{head} = {{ {} }}", threads.join(", ")))
}

#[test]
fn generated_missions_are_what_their_recipe_says() {
    for seed in 0..30 {
        for nodes in [50, 200] {
            for tightness in [Tightness::Feasible, Tightness::Boundary, Tightness::Infeasible] {
                let recipe = Recipe { nodes, tightness, seed };
                let text = mission(recipe);
                assert_eq!(text, mission(recipe), "{recipe:?} gives two texts");
                let network = network(&text);
                let size = network.nodes.len();
                assert!(size * 2 > nodes && size < nodes * 2 + 60, "{recipe:?} has {size} nodes");
                let outcome = acceptance::mission::first_plan(&network, Search::ConflictDirected);
                assert_eq!(
                    !outcome.plans.is_empty(),
                    tightness != Tightness::Infeasible,
                    "{recipe:?}\n{text}"
                );
            }
        }
    }
}
