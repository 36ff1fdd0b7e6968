//! Which conditions may touch, and which must keep the gap (SPEC 5.3): the solver and the paper's search agree on random
//! missions, on whether there is a plan and on all plans, and every plan passes the checker.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::support::{network, options, plan};
use kirk::{ExpansionLimit, Options, Outcome, Search, Status, Unlimited};

/// A sequence of random numbers (xorshift).
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
        (0..5).for_each(|_| {
            random.below(2);
        });
        random
    }

    fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % limit
    }

    /// Bounds with a lower one below `lower`, and at most `width` apart.
    fn bounds(&mut self, lower: u64, width: u64) -> String {
        let lower = self.below(lower);
        format!("[{lower},{}]", lower + self.below(width + 1))
    }
}

/// An activity, a condition, or something that holds others up to `depth` times.
fn unit(random: &mut Random, depth: u32) -> String {
    let value = random.below(3);
    match random.below(if depth > 0 { 9 } else { 5 }) {
        0 => format!("A()[{0},{0}]", random.below(4)),
        1 => format!("X=v{value} {}", random.bounds(4, 2)),
        2 => format!("do A(){} maintaining X=v{value}", random.bounds(3, 2)),
        3 => format!("do A(){} watching X=v{value}", random.bounds(3, 2)),
        4 if random.below(2) == 0 => "delay".to_owned(),
        4 => format!("delay{}", random.bounds(2, 5)),
        5 => format!("if X=v{value} thennext {}", unit(random, depth - 1)),
        6 => format!("choose {{ {}, {} }}", unit(random, depth - 1), unit(random, depth - 1)),
        7 => format!("{{ {}; {} }}", unit(random, depth - 1), unit(random, depth - 1)),
        _ => format!("{{ {}, {} }}", unit(random, depth - 1), unit(random, depth - 1)),
    }
}

fn random_mission(seed: u64) -> String {
    let random = &mut Random::new(seed);
    let count = 2 + random.below(2);
    let mut threads = Vec::new();
    for _ in 0..count {
        let mut thread = String::from(if random.below(2) == 0 { "{ delay; " } else { "{ " });
        for _ in 0..=random.below(3) {
            let _ = write!(thread, "{}; ", unit(random, 2));
        }
        threads.push(thread + "}");
    }
    let (gap, horizon) = (random.below(2), 5 + random.below(15));
    format!(
        "var X : {{v0, v1, v2}}; option threat_gap = {gap}; scenario S[0,{horizon}] = {{ {} }}",
        threads.join(", ")
    )
}

fn told(outcome: &Outcome) -> BTreeSet<impl Ord + std::fmt::Debug + use<>> {
    let told = outcome.plans.iter();
    told.map(|plan| (plan.choices.clone(), plan.causal_links.clone(), plan.conflict_order.clone())).collect()
}

#[test]
fn both_searches_agree_on_what_may_touch() {
    let (mut plans, mut none, mut listed) = (0, 0, 0);
    for seed in 0..4_000 {
        let text = random_mission(seed);
        let network = network(&text);
        let expected = kirk::plan(
            &network,
            &Options { max_plans: 400, ..options(Search::Chronological, true) },
            &mut ExpansionLimit(30_000),
        );
        if expected.status == Status::Limit {
            continue;
        }
        let first = plan(&network, Search::ConflictDirected, false);
        assert_eq!(first.status, expected.status, "{seed}: {text}");
        let all = kirk::plan(&network, &options(Search::ConflictDirected, true), &mut Unlimited);
        assert_eq!(told(&all), told(&expected), "{seed}: {text}");
        for found in [&expected, &first, &all] {
            for plan in &found.plans {
                let verdict = verify::check_plan(&network, plan);
                assert!(verdict.violations.is_empty(), "{seed}: {verdict:?}\n{text}");
            }
        }
        listed += expected.plans.len();
        *if expected.plans.is_empty() { &mut none } else { &mut plans } += 1;
    }
    assert!(
        plans > 600 && none > 2_000 && listed > 1_500,
        "{plans} with plans, {none} without, {listed} listed"
    );
}

/// Returns whether a mission has a plan, which the checker accepts.
fn has_plan(text: &str) -> bool {
    let network = network(text);
    let outcome = plan(&network, Search::ConflictDirected, false);
    assert_ne!(outcome.status, Status::Limit, "{text}");
    for plan in &outcome.plans {
        let verdict = verify::check_plan(&network, plan);
        assert!(verdict.violations.is_empty(), "{verdict:?}\n{text}");
    }
    outcome.status == Status::Plan
}

/// Uses of one thing after each other, in the paper's language.
fn uses(count: i64, horizon: i64) -> String {
    let branches = (0..count).map(|at| format!("{{ delay; ARM=u{at} [10,10]; delay }}"));
    format!("scenario S[0,{horizon}] = {{ {} }}", branches.collect::<Vec<_>>().join(", "))
}

#[test]
fn gaps_between_many_uses_of_one_thing_are_added_up() {
    assert!(has_plan(&uses(12, 131)));
    assert!(!has_plan(&uses(12, 130)), "twelve times 10 and eleven gaps of 1 need 131");
    assert!(has_plan(&format!("option threat_gap = 0; {}", uses(12, 120))));
}

#[test]
fn what_other_demands_order_still_keeps_the_gap() {
    let text = |horizon: i64| {
        format!(
            "resource Arm; primitive Move()[3,3] uses Arm;
             scenario S[0,{horizon}] = {{
                {{ delay; do Move() maintaining not X; delay }}, {{ delay; do Move() watching not X; delay }},
                {{ delay; tell not X [7,7]; delay }}
             }}"
        )
    };
    // An order of the uses does not make their conditions touch.
    assert!(has_plan(&text(15)) && !has_plan(&text(10)));
}

#[test]
fn many_requirements_share_assertions_that_carry_one_each() {
    for count in [20, 60] {
        let mut threads = Vec::new();
        for at in 0..count {
            threads.push(format!("{{ delay; do {{ tell Y=B{at} [5,5] }} maintaining C; delay }}"));
            threads.push(format!("{{ delay; do {{ tell C [6,6] }} maintaining D{at}; delay }}"));
            threads.push(format!("{{ delay; tell D{at} [7,7]; delay }}"));
        }
        assert!(has_plan(&format!("scenario S[0,inf] = {{ {} }}", threads.join(", "))));
    }
}
