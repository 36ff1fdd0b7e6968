//! Parts whose assertions conflict only with each other, under bounds that leave hardly any room: what is found out
//! about them before the search must not change its answers.

use crate::support;
use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::support::{NamedPlan, named, network, options};
use exact::Time;
use kirk::{Options, Search, Status, Unlimited};
use tpn::generate::Rng;

/// Assertions of `variable` in parallel branches, in a part with tight bounds.
fn part(rng: &mut Rng, variable: &str) -> String {
    let mut branches = Vec::new();
    let mut value = 0;
    for _ in 0..rng.between(2, 3) {
        let mut items = Vec::new();
        for _ in 0..rng.between(1, 2) {
            if rng.chance(70) {
                let least = rng.between(0, 2);
                let greatest =
                    if rng.chance(40) { "inf".into() } else { (least + rng.between(0, 4)).to_string() };
                items.push(format!("delay[{least},{greatest}]"));
            }
            if value < 4 {
                let least = rng.between(0, 3);
                let greatest = least + rng.between(0, 1);
                items.push(format!("{variable}=v{} [{least},{greatest}]", rng.below(3)));
                value += 1;
            }
        }
        if items.is_empty() {
            items.push("delay[0,1]".into());
        }
        branches.push(format!("{{ {} }}", items.join("; ")));
    }
    let bounds = if rng.chance(60) { bounds(rng) } else { String::new() };
    format!("{{ {} }}{bounds}", branches.join(", "))
}

fn bounds(rng: &mut Rng) -> String {
    let least = rng.between(0, 6);
    format!("[{least},{}]", least + rng.between(0, 6))
}

fn mission(rng: &mut Rng) -> String {
    let mut text = String::from("scenario Mission = {\n");
    let first = part(rng, "A");
    let second = match rng.below(4) {
        0 => format!("choose {{ {}, delay[{1},{1}] }}", part(rng, "B"), rng.between(0, 9)),
        1 => format!("delay[0,{}]; {}", rng.between(0, 2), part(rng, "B")),
        // No longer enclosed: the same variable outside.
        2 => format!("delay[0,{}]; A=v1 [1,2]", rng.between(0, 9)),
        _ => format!("delay{}", bounds(rng)),
    };
    let _ = writeln!(text, "  {{ {{ {first}; delay[0,{}] }}{} }},", rng.between(0, 2), bounds(rng));
    let _ = writeln!(text, "  {{ {{ {second} }}{} }}\n}}", bounds(rng));
    text
}

#[test]
fn enclosed_conflicts_are_planned_as_the_search_alone_plans_them() {
    let mut plannable = 0;
    for seed in 0..12_000 {
        let mut rng = Rng::new(seed);
        let text = mission(&mut rng);
        let network = network(&text);
        let gap = [Time::ONE, Time::new(1, 2).expect("a half"), Time::from(2)][seed as usize % 3];
        let all = |search| {
            let options = Options { threat_gap: Some(gap), ..options(search, true) };
            let outcome = kirk::plan(&network, &options, &mut Unlimited);
            let plans: BTreeSet<NamedPlan> = outcome.plans.iter().map(|plan| named(&network, plan)).collect();
            (outcome.status, plans)
        };
        let expected = all(Search::Chronological);
        assert_eq!(all(Search::ConflictDirected), expected, "seed {seed}, gap {gap}:\n{text}");
        plannable += u32::from(expected.0 == Status::Plan);
    }
    assert!((1_200..10_800).contains(&plannable), "{plannable} have a plan: the missions are not tight");
}

#[test]
fn touching_that_a_bounded_duration_entails_is_not_lost() {
    // Three units each in exactly six: they can only touch, and the outer bound is what makes them.
    let text = "scenario Mission = {
        { { { delay[0,inf]; A=v0 [3,3] }, { A=v1 [3,3]; delay[0,inf] } }; delay[0,0] }[6,6]
    }";
    let network = network(text);
    for search in [Search::Chronological, Search::ConflictDirected] {
        let outcome = kirk::plan(&network, &options(search, true), &mut Unlimited);
        assert_eq!(outcome.status, Status::NoPlan, "nothing entails an order: v0 may also come first");
    }
    let text = text.replace("{ delay[0,inf]; A=v0 [3,3] }", "{ delay[3,3]; A=v0 [3,3] }");
    let network = support::network(&text);
    for search in [Search::Chronological, Search::ConflictDirected] {
        let outcome = kirk::plan(&network, &options(search, true), &mut Unlimited);
        assert_eq!((outcome.status, outcome.plans.len()), (Status::Plan, 1), "{search:?}");
    }
}
