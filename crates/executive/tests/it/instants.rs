//! What happens at one time happens in an order that the plan says (SPEC 10.4), and values and levels are written down in it.

use std::collections::BTreeMap;
use std::sync::Arc;

use exact::{Rational, Time};
use executive::{Disturbance, Ending, Facts, Happening, PlanNetwork, Replanner, RunOutcome, World, run};
use serde_json::json;
use tpn::generate::Rng;
use tpn::{Network, NodeId, OccurrenceKind, Plan, Supply, Top};

/// Nothing is planned again here.
struct Nobody;

impl Replanner for Nobody {
    fn replan(&mut self, _: &Facts) -> Result<(Arc<Network>, Plan), String> {
        Err("nobody plans again".to_owned())
    }
}

fn compiled(source: &str) -> Arc<Network> {
    let program = rmpl::parse(source).program();
    let (network, diagnostics) = tpn::compile(&program, &Top::Scenario(None));
    Arc::new(network.unwrap_or_else(|| panic!("{diagnostics:?}")))
}

fn execute(network: &Arc<Network>, plan: Plan, disturbances: &[Disturbance]) -> RunOutcome {
    run(network, plan, network.nodes.len(), &World::new(disturbances), &mut Nobody).expect("its times fit")
}

fn lasts(activity: &str, duration: i64) -> Disturbance {
    Disturbance::Duration { activity: activity.into(), duration: duration.into() }
}

/// A plan without choices that orders these uses.
fn ordering(network: &Network, uses: &[[&str; 2]]) -> Plan {
    let stated = json!({"choices": {}, "uses_ordered": uses, "windows": {}});
    tpn::plan_json::plan_from_json(network, &stated).expect("a plan of the network")
}

/// No level that is written down is out of its range.
#[track_caller]
fn levels_stay_in_range(network: &Network, outcome: &RunOutcome) {
    assert_eq!(outcome.ending, Ending::Finished, "{:#?}", outcome.log);
    for entry in &outcome.log {
        let Happening::Level { resource, level, .. } = &entry.happening else { continue };
        let known =
            network.resources.iter().find(|it| it.name == *resource).expect("a resource of the network");
        let (least, greatest) = match known.supply {
            Supply::Reusable { capacity } => (Rational::ZERO, capacity),
            Supply::Reservoir { least, greatest, .. } => (least, greatest),
        };
        assert!((least..=greatest).contains(level), "{entry:?} of {:#?}", outcome.log);
    }
}

#[test]
fn what_the_plan_puts_first_at_one_time_happens_first() {
    let source = |threads: &str| {
        format!(
            "resource Bat 0..10 = 0; primitive A()[10,10] produces Bat 5; primitive B()[5,5] consumes Bat 5;
            scenario S[0,100] = {{ {threads} }}"
        )
    };
    for threads in ["{ delay[10,10]; B() }, A()", "A(), { delay[10,10]; B() }"] {
        let network = compiled(&source(threads));
        let plan = ordering(&network, &[["Produces(Bat)@A#1", "Consumes(Bat)@B#1"]]);
        levels_stay_in_range(&network, &execute(&network, plan, &[]));
    }
}

/// That one comes no later than the other follows from durations alone here, so that the plan need not order them.
#[test]
fn what_durations_put_first_happens_first_where_both_come_at_one_time() {
    for threads in ["{ delay[10,20]; B() }, A()", "A(), { delay[10,20]; B() }"] {
        let network = compiled(&format!(
            "resource Bat 0..10 = 0; primitive A()[0,10] produces Bat 5; primitive B()[5,5] consumes Bat 5;
            scenario S[0,100] = {{ {threads} }}"
        ));
        for duration in [9, 10] {
            let plan = ordering(&network, &[]);
            let outcome = execute(&network, plan, &[lasts("A#1", duration)]);
            levels_stay_in_range(&network, &outcome);
        }
    }
}

/// The environment ends A, and what it produces would be too much before something is consumed.
#[test]
fn what_comes_before_an_event_of_natures_happens_before_it() {
    for threads in ["{ delay[10,10]; B() }, A()", "A(), { delay[10,10]; B() }"] {
        let network = compiled(&format!(
            "resource Bat 0..10 = 10; primitive A() contingent [10,20] produces Bat 5;
            primitive B()[5,5] consumes Bat 5; scenario S[0,100] = {{ {threads} }}"
        ));
        for duration in [10, 11, 20] {
            let plan = ordering(&network, &[]);
            let outcome = execute(&network, plan, &[lasts("A#1", duration)]);
            levels_stay_in_range(&network, &outcome);
        }
    }
}

/// A small mission in which much can come at one time.
fn mission(rng: &mut Rng) -> String {
    let declared = "state X : {A, B} = A; resource R capacity 2; resource T 0..6 = 3;
        primitive ToA() sets X=A; primitive ToB() sets X=B; primitive InA() requires X=A uses R;
        primitive Drink() consumes T 1; primitive Pour() produces T 1 uses R;";
    let names = ["ToA", "ToB", "InA", "Drink", "Pour"];
    let threads: Vec<String> = (0..rng.between(2, 4))
        .map(|_| {
            let parts: Vec<String> = (0..rng.between(1, 3))
                .map(|_| {
                    let name = names[rng.below(names.len() as u64) as usize];
                    let least = rng.below(3);
                    let delay = rng.below(3);
                    format!(
                        "delay[{delay},{}]; {name}()[{least},{}]",
                        delay + rng.below(4),
                        least + rng.below(3)
                    )
                })
                .collect();
            format!("{{ {} }}", parts.join("; "))
        })
        .collect();
    format!("{declared} scenario S[0,40] = {{ {} }}", threads.join(", "))
}

/// The pairs of events of which the first happens before the second, by the distances of all pairs and the closure of the
/// order within an instant.
fn before(network: &Network, plan: &Plan) -> Vec<[NodeId; 2]> {
    let mut made = PlanNetwork::new(network, plan).expect("a plan");
    let distances = made.stn.all_pairs().expect("small times");
    let mut later: BTreeMap<NodeId, Vec<NodeId>> = BTreeMap::new();
    for [one, other] in plan.instant_order(network) {
        later.entry(one).or_default().push(other);
    }
    let leads_to = |from: NodeId, to: NodeId| {
        let mut reached = vec![from];
        let mut next = 0;
        while let Some(node) = reached.get(next) {
            let beyond: Vec<NodeId> =
                later.get(node).into_iter().flatten().copied().filter(|it| !reached.contains(it)).collect();
            reached.extend(beyond);
            next += 1;
        }
        reached.contains(&to)
    };
    let mut pairs = Vec::new();
    for one in made.all_points() {
        for other in made.all_points().filter(|&other| other != one) {
            let (first, then) = (made.node(one), made.node(other));
            let is_no_later = distances.get(other, one) <= 0;
            let is_equal = is_no_later && distances.get(one, other) <= 0;
            if is_no_later && (!is_equal || leads_to(first, then)) {
                pairs.push([first, then]);
            }
        }
    }
    pairs
}

/// Random missions with random durations within their bounds: of two events at one time the one that happens before the
/// other is written down before it.
#[test]
fn random_runs_write_down_what_happens_before_first() {
    let (mut runs, mut ties) = (0, 0);
    for seed in 0..300 {
        let mut rng = Rng::new(seed);
        let source = mission(&mut rng);
        let network = compiled(&source);
        let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
        let Some(plan) = outcome.plans.into_iter().next() else { continue };
        if !verify::check_plan(&network, &plan).valid {
            continue;
        }
        let pairs = before(&network, &plan);
        let mut disturbances = Vec::new();
        for occurrence in network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive) {
            let arc = &network.arcs[occurrence.arc.expect("a duration").index()];
            let (least, most) = (arc.lower, arc.upper.finite().expect("a bound"));
            let duration = rng.between(least.numerator(), most.numerator());
            disturbances.push(lasts(&occurrence.name, duration));
        }
        let outcome = execute(&network, plan.clone(), &disturbances);
        runs += 1;
        let mut places: BTreeMap<NodeId, (Time, usize)> = BTreeMap::new();
        let names = tpn::plan_json::Names::new(&network);
        for (place, entry) in outcome.log.iter().enumerate() {
            if let Happening::Executed { name } = &entry.happening {
                let node = names.event(name).expect("an event of the network");
                places.entry(node).or_insert((entry.time, place));
            }
        }
        for [first, then] in pairs {
            if let (Some(&(at_first, one)), Some(&(at_then, other))) = (places.get(&first), places.get(&then))
            {
                ties += usize::from(at_first == at_then);
                assert!(
                    one < other,
                    "seed {seed}: {first:?} before {then:?} in {source}\n{:#?}",
                    outcome.log
                );
            }
        }
        if outcome.ending == Ending::Finished {
            levels_stay_in_range(&network, &outcome);
        }
    }
    assert!(runs > 100 && ties > 1000, "{runs} runs, {ties} pairs at one time");
}
