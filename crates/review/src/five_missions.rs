//! The checklists of five missions: for each line that has passed, the change of the plan, the mission, or what it is
//! held against that makes it fail, found by making that change. The listing is in `five_missions.txt`.

use std::sync::Arc;

use exact::{Bound, Rational, Time};
use snapshot::{Goal, Robustness, RobustnessSettings, Tally, Uncertainty};
use snapshot::{Planning, SeparationViolation, Snapshot};
use tpn::{LabelId, Network, Plan};

use super::tests::snapshot;
use super::{FlightRules, MissionRule, Review, Section, Status, review};

const MISSIONS: [(&str, &str, [&str; 2]); 5] = [
    (
        "enroute",
        include_str!("../../../assets/missions/enroute.rmpl"),
        ["PATH1=OK while Group-Traverse-Path", "never Group-Wait while PROCEED=OK"],
    ),
    (
        "arm",
        include_str!("../../../assets/missions/arm.rmpl"),
        ["ARM=OUT while Dig", "never Drive while ARM=OUT"],
    ),
    ("battery", include_str!("../../../assets/missions/battery.rmpl"), ["Battery >= 10", "Battery <= 100"]),
    (
        "storm",
        include_str!("../../../assets/missions/storm.rmpl"),
        ["RELAY=UP while Send", "never Survey while DUST=STORM"],
    ),
    (
        "stations",
        include_str!("../../../assets/missions/stations.rmpl"),
        ["Rover1.at=NORTH_CAMP at start", "Relay <= 1"],
    ),
];

/// Changes the plan alone; what the independent checker says of it then counts.
fn with_plan(snapshot: &Snapshot, change: impl FnOnce(&Network, &mut Plan)) -> Option<Snapshot> {
    let network = Arc::clone(snapshot.network.as_ref()?);
    with_planning(snapshot, |planning| {
        let plan = &mut planning.outcome.plans[0];
        change(&network, plan);
        planning.verdict = Some(verify::check_plan(&network, plan));
    })
}

fn with_planning(snapshot: &Snapshot, change: impl FnOnce(&mut Planning)) -> Option<Snapshot> {
    let mut changed = snapshot.clone();
    change(Arc::make_mut(changed.planning.as_mut()?));
    Some(changed)
}

/// Every change that is tried, the most particular ones first.
fn cases(snapshot: &Snapshot, rules: &FlightRules) -> Vec<(String, Review)> {
    let plain = |changed: &Snapshot| review(changed, &Goal::Default, 0, &mut || false);
    let held = |changed: &Snapshot, rules: &FlightRules, found: Option<&Robustness>| {
        let mut review = plain(changed);
        review.hold_against(changed, rules, found, &mut || false);
        review
    };
    let by_rules = |name: String, change: &dyn Fn(&mut FlightRules)| {
        let mut rules = rules.clone();
        change(&mut rules);
        (name, held(snapshot, &rules, Some(&runs(95))))
    };
    let network = snapshot.network.as_deref().expect("a network");
    let plan = snapshot.plan().expect("a plan");
    let mut cases = vec![
        by_rules("rule: margins of at least 100000".to_owned(), &|it| it.margin = Some(Time::from(100_000))),
        by_rules("rule: clearance of at least 1000 m".to_owned(), &|it| it.clearance_m = Some(1000.0)),
        by_rules("rule: slopes of at most 0°".to_owned(), &|it| it.slope_deg = Some(0.0)),
        by_rules("rule: every run reaches the end".to_owned(), &|it| {
            it.success_rate = Some(super::SuccessRate { wanted: 1.0, least: 0.97 });
        }),
    ];
    for resource in network.resources.iter().filter(|it| !it.name.contains('#')) {
        let name = format!("rule: a reserve of {} of at least 100000", resource.name);
        cases.push(by_rules(name, &|it| {
            it.reserves.insert(resource.name.clone(), Rational::from_integer(100_000));
        }));
    }
    for (at, rule) in rules.rules.iter().enumerate() {
        let contrary = match rule.rule.strip_prefix("never ") {
            Some(rest) => rest.to_owned(),
            None if rule.rule.contains(">=") => rule.rule.replace(">=", "<"),
            None if rule.rule.contains("<=") => rule.rule.replace("<=", ">"),
            None => format!("never {}", rule.rule),
        };
        let name = format!("rule: {contrary}");
        cases.push(by_rules(name, &|it| it.rules[at].rule.clone_from(&contrary)));
    }
    let mut add = |name: String, changed: Option<Snapshot>| {
        let Some(changed) = changed else { return };
        cases.push((name, held(&changed, rules, Some(&runs(95)))));
    };
    for (index, arc) in network.arcs.iter().enumerate().filter(|(_, arc)| arc.is_contingent) {
        let (Some(occurrence), Bound::Finite(most)) = (arc.occurrence, arc.upper) else { continue };
        let name = &network.occurrences[occurrence.index()].name;
        let mut wider = network.clone();
        wider.arcs[index].upper = Bound::Finite(most.checked_add(Time::from(100)).expect("it fits"));
        add(
            format!("mission: nature may let {name} last 100 longer"),
            with_planning(snapshot, |planning| {
                planning.verdict = Some(verify::check_plan(&wider, &planning.outcome.plans[0]));
            }),
        );
    }
    for link in &plan.causal_links {
        let name = format!("plan: {} is carried by nothing", network.label_name(link.ask));
        add(name, with_plan(snapshot, |_, plan| plan.causal_links.retain(|it| it.ask != link.ask)));
        let others = (0..network.labels.len()).map(LabelId::from_index);
        let mut other = others.filter(|&it| {
            it != link.tell && network.labels[it.index()].mode == rmpl::program::LabelMode::Tell
        });
        if let Some(other) = other.next_back() {
            let name =
                format!("plan: {} is carried by {}", network.label_name(link.ask), network.label_name(other));
            add(
                name,
                with_plan(snapshot, |_, plan| {
                    for it in plan.causal_links.iter_mut().filter(|it| it.ask == link.ask) {
                        it.tell = other;
                    }
                }),
            );
        }
    }
    for order in &plan.conflict_order {
        let (first, then) = (network.label_name(order.first), network.label_name(order.then));
        let name = format!("plan: {then} comes before {first}");
        add(
            name,
            with_plan(snapshot, |_, plan| {
                for it in
                    plan.conflict_order.iter_mut().chain(&mut plan.orderings_added).filter(|it| *it == order)
                {
                    std::mem::swap(&mut it.first, &mut it.then);
                }
            }),
        );
    }
    for (at, order) in plan.state_order.iter().enumerate() {
        let names: Vec<String> = order.producers.iter().map(|&label| network.label_name(label)).collect();
        for (&producer, name) in order.producers.iter().zip(&names) {
            let name = format!("plan: {name} is twice in the order of changes");
            add(name, with_plan(snapshot, |_, plan| plan.state_order[at].producers.push(producer)));
        }
        let name = format!("plan: {} is not in the order of changes", names[names.len() - 1]);
        add(name, with_plan(snapshot, |_, plan| _ = plan.state_order[at].producers.pop()));
        for (position, pair) in names.windows(2).enumerate().skip(1) {
            let (first, then) = (&pair[0], &pair[1]);
            let name = format!("plan: {then} comes before {first}");
            add(
                name,
                with_plan(snapshot, |_, plan| plan.state_order[at].producers.swap(position, position + 1)),
            );
        }
    }
    for order in &plan.uses_ordered {
        let owner = |used: tpn::UseId| {
            let owner = network.uses[used.index()].owner;
            let name = |owner: tpn::OccurrenceId| network.occurrences[owner.index()].name.to_string();
            owner.map_or_else(|| network.use_name(used), name)
        };
        let name = format!("plan: {} comes before {}", owner(order.then), owner(order.first));
        let swapped = with_plan(snapshot, |_, plan| {
            for it in plan.uses_ordered.iter_mut().filter(|it| *it == order) {
                std::mem::swap(&mut it.first, &mut it.then);
            }
        });
        add(name, swapped);
    }
    add(
        "plan: an activity that was selected is left out".to_owned(),
        with_plan(snapshot, |network, plan| {
            let primitive = network
                .occurrences
                .iter()
                .filter_map(|it| it.arc)
                .find(|arc| plan.selected_arcs[arc.index()]);
            plan.selected_arcs[primitive.expect("an activity").index()] = false;
        }),
    );
    add(
        "plan: it has not been checked".to_owned(),
        with_planning(snapshot, |planning| planning.verdict = None),
    );
    add(
        "plan: there is none".to_owned(),
        with_planning(snapshot, |planning| {
            planning.outcome.plans.clear();
            planning.outcome.status = kirk::Status::NoPlan;
            planning.verdict = None;
        }),
    );
    let near = SeparationViolation {
        vehicles: [0, 0],
        since: 0.0,
        time: 1.0,
        position_m: nalgebra::Point2::origin(),
        distance_m: 0.1,
        min_m: 2.2,
        schedule: Vec::new(),
    };
    add(
        "plan: vehicles meet".to_owned(),
        Some(Snapshot { separation_violations: vec![near].into(), ..snapshot.clone() }),
    );
    let mut stopped = review(snapshot, &Goal::Default, 0, &mut || true);
    stopped.hold_against(snapshot, rules, None, &mut || false);
    cases.push(("review: stopped before it looked at the alternatives".to_owned(), stopped));
    cases
}

fn runs(succeeded: u64) -> Robustness {
    let settings = RobustnessSettings { runs: 100, seed: 3, uncertainty: Uncertainty::default() };
    Robustness { settings, tally: Tally { runs: 100, succeeded, ..Tally::default() } }
}

/// Returns what a line is about, whatever was found of it.
fn subject(text: &str) -> &str {
    let found_either_way = [
        ("there is a plan", "there is no plan"),
        ("the independent checker accepts", "the independent checker rejects"),
        ("dynamically controllable", "controllability is not verified"),
    ];
    for (well, ill) in found_either_way {
        if text.starts_with(well) || text.starts_with(ill) {
            return well;
        }
    }
    text.split([':', '[']).next().unwrap_or(text)
}

/// Returns whether the checker objects to something that a line is about.
fn blames(review: &Review, line: &super::Line) -> bool {
    let mut objections =
        review.plan.iter().filter(|it| it.text.starts_with("the independent checker rejects"));
    // A line about all of something is about whatever is wrong with it.
    objections.any(|objection| {
        line.names.is_empty()
            || line.names.iter().any(|name| {
                objection.text.contains(name.as_str())
                    || objection.names.iter().any(|it| it.contains(name.as_str()))
            })
    })
}

#[test]
fn every_line_that_passed_has_a_case_that_makes_it_fail() {
    let mut listing = String::new();
    let mut untouched = Vec::new();
    let by_checker = [Section::CausalLinks, Section::Conflicts, Section::States, Section::Resources];
    for (name, source, own) in MISSIONS {
        let rules = own.iter().enumerate().map(|(at, rule)| MissionRule {
            name: format!("R{at}"),
            rule: (*rule).to_owned(),
            ..MissionRule::default()
        });
        let rules = FlightRules { rules: rules.collect(), ..FlightRules::default() };
        let snapshot = snapshot(source);
        let mut reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
        reviewed.hold_against(&snapshot, &rules, Some(&runs(95)), &mut || false);
        let cases = cases(&snapshot, &rules);
        listing.push_str(&format!("{name}\n"));
        for section in Section::ALL {
            for line in reviewed.lines(section) {
                let is_red = |review: &Review| {
                    review
                        .lines(section)
                        .iter()
                        .any(|it| it.status > Status::Passed && subject(&it.text) == subject(&line.text))
                };
                // A change of what the line names says more than one of anything else, and what is wrong then has to be
                // about that: a plan that is not valid turns every line red that rests on the checker.
                let names_it = |(case, _): &&(String, Review)| {
                    line.names.iter().any(|name| case.contains(name.as_str()))
                };
                let is_right = |(case, review): &&(String, Review)| {
                    !case.starts_with("plan: ") || !by_checker.contains(&section) || blames(review, line)
                };
                let mut red = cases.iter().filter(|(_, review)| is_red(review)).filter(is_right);
                let first = red.clone().next();
                let case = match line.status {
                    Status::Information => continue,
                    Status::Passed => {
                        let Some((case, _)) = red.find(names_it).or(first) else {
                            untouched.push(format!("{name}: {}: {}", section.title(), line.text));
                            continue;
                        };
                        case.as_str()
                    }
                    Status::Attention => "the mission as it is",
                    Status::Failed => panic!("{name}: {line:?}"),
                };
                listing.push_str(&format!(
                    "  {}: {}\n    {}: {case}\n",
                    section.title(),
                    line.text,
                    if line.status == Status::Passed { "fails by" } else { "needs attention by" }
                ));
            }
        }
    }
    assert_eq!(untouched, Vec::<String>::new());
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/src/five_missions.txt");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(file, &listing).expect("the listing can be written");
    }
    let kept = std::fs::read_to_string(file).unwrap_or_default();
    assert!(
        listing == kept,
        "five_missions.txt is not what the test finds: UPDATE_SNAPSHOTS=1 writes it anew"
    );
}
