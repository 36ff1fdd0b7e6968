//! Every planning, compilation, error and execution case of the conformance suite, through all the crates.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write as _;
use std::path::Path;

use acceptance::cases::{NOT_COPIED, cases, expect_as_listed, folder, program, read};
use acceptance::distances::{FAR, Matrix, Scale, of_arcs};
use acceptance::mission::{all_plans, compile, error_codes, first_plan, network};
use exact::{Bound, Time};
use kirk::Search;
use rmpl::program::LabelMode;
use serde::Deserialize as _;
use serde_json::{Value, json};
use tpn::plan_json::{Names, node_name, plan_to_json};
use tpn::{Choice, DecisionId, LabelId, Network, NodeId, Plan, Top};

fn names(list: &Value) -> Vec<String> {
    let mut names: Vec<String> = list
        .as_array()
        .expect("a list")
        .iter()
        .map(|name| name.as_str().expect("a name").to_owned())
        .collect();
    names.sort();
    names
}

/// A plan as the suite compares plans: everything but the orderings that planning happened to add.
fn comparable(plan: &Value, activities: &str) -> Value {
    let sorted = |list: &Value| {
        let mut items: Vec<String> = list.as_array().expect("a list").iter().map(Value::to_string).collect();
        items.sort();
        items
    };
    json!({
        "choices": plan["choices"],
        "activities": names(&plan[activities]),
        "links": sorted(&plan["causal_links"]),
        "conflicts": sorted(&plan["conflict_order"]),
        "windows": plan["windows"],
    })
}

#[test]
fn every_planning_case_has_exactly_its_plans_with_both_searches() {
    for (name, case) in cases("tpn-plan") {
        let mut network = network(&program(&case));
        if let Some(gap) = case.pointer("/options/threat_gap") {
            network.threat_gap = Time::deserialize(gap).expect("an exact gap");
        }
        let expect = &case["expect"];
        for search in [Search::Chronological, Search::ConflictDirected] {
            let outcome = all_plans(&network, search);
            let found: Vec<Value> = (outcome.plans.iter())
                .map(|plan| comparable(&plan_to_json(&network, plan), "activities"))
                .collect();
            assert_eq!(!found.is_empty(), expect["plan_exists"] == true, "{name}, {search:?}");
            if expect["plan_exists"] != true {
                continue;
            }
            let expected: BTreeSet<String> = (expect["all_plans"].as_array().expect("plans").iter())
                .map(|plan| comparable(plan, "acts").to_string())
                .collect();
            let found_set: BTreeSet<String> = found.iter().map(Value::to_string).collect();
            // A case with many plans lists only some of them, and their number.
            let missing: Vec<&String> = expected.difference(&found_set).collect();
            assert!(missing.is_empty(), "{name}, {search:?}: {missing:#?}");
            assert_eq!(Some(found.len() as u64), expect["num_distinct_plans"].as_u64(), "{name}, {search:?}");
            assert_eq!(found.len(), found_set.len(), "{name}, {search:?}: a plan is listed twice");
            let first = first_plan(&network, search);
            let first = comparable(&plan_to_json(&network, &first.plans[0]), "activities");
            assert_eq!(first, comparable(&expect["canonical"], "acts"), "{name}, {search:?}");
        }
    }
}

#[test]
fn a_case_without_a_plan_fails_in_the_ways_it_says() {
    for (name, case) in cases("tpn-plan") {
        if case["expect"]["plan_exists"] == true {
            continue;
        }
        let network = network(&program(&case));
        let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
        let failure = outcome.failure.expect("a failure says why");
        let found: BTreeSet<&str> = failure.reasons.iter().map(|reason| reason.kind.name()).collect();
        if let Some(kinds) = case.pointer("/expect/failure/kinds").and_then(Value::as_array) {
            let expected: BTreeSet<&str> = kinds.iter().filter_map(Value::as_str).collect();
            assert_eq!(found, expected, "{name}");
        }
    }
}

#[test]
fn the_plan_of_the_enroute_scenario_is_read_back_and_accepted() {
    let network = network(&read(&folder().join("t01_enroute_scenario.rmpl")));
    let plan = &first_plan(&network, Search::Chronological).plans[0];
    let written = plan_to_json(&network, plan);
    assert_eq!(written["choices"], json!({"D1": 0}));
    let read = tpn::plan_json::plan_from_json(&network, &written).expect("our own plan is a plan");
    assert!(verify::check_plan(&network, &read).valid);
    assert_eq!(plan_to_json(&network, &read), written);
}

#[test]
fn every_compilation_case_has_its_distances_and_labels() {
    for (name, case) in cases("tpn-compile") {
        let activity = case["top"].as_str().expect("a top activity");
        let top = match case["bounds"].as_array().map(Vec::as_slice) {
            Some([lower, upper]) => Top::Activity {
                name: activity.into(),
                lower: Time::deserialize(lower).expect("a time"),
                upper: Bound::deserialize(upper).expect("a bound"),
            },
            _ => Top::activity(activity),
        };
        let (network, diagnostics) = compile(&program(&case), &top);
        // A file with activities only has no scenario to plan, which does not matter here.
        let network = network.unwrap_or_else(|| panic!("{name}: {diagnostics:#?}"));
        let expect = &case["expect"];
        assert_eq!(Some(network.decisions.len() as u64), expect["decisions"].as_u64(), "{name}");
        let mut activities: Vec<String> = (network.occurrences.iter())
            .filter(|occurrence| occurrence.kind == tpn::OccurrenceKind::Primitive)
            .map(|occurrence| occurrence.name.to_string())
            .collect();
        activities.sort();
        assert_eq!(activities, names(&expect["activities"]), "{name}");
        for choice in expect["choices"].as_array().expect("choices") {
            check_choice(&name, &network, choice);
        }
        if let Some(arcs) = expect.get("paper_arcs") {
            assert_eq!(Some(network.nodes.len() as u64), expect["paper_nodes"].as_u64(), "{name}");
            check_paper_network(&network, arcs);
        }
    }
}

fn check_choice(name: &str, network: &Network, expect: &Value) {
    let choices: Vec<Choice> = (expect["choice"].as_object().expect("a choice").iter())
        .map(|(decision, alternative)| Choice {
            decision: DecisionId(decision[1..].parse::<u32>().expect("D1, D2, …") - 1),
            alternative: alternative.as_u64().expect("a number") as u32,
        })
        .collect();
    let (nodes, arcs) = tpn::selection::closure(network, &choices);
    let scale = Scale::of(network);
    let matrix = of_arcs(network, scale, |arc| arcs[arc.index()]);
    assert_eq!(matrix.is_some(), expect["consistent"] == true, "{name} {}", expect["choice"]);
    let Some(matrix) = matrix else { return };
    let events = Names::new(network);
    for (pair, bounds) in expect["bounds"].as_object().expect("bounds") {
        let (from, to) = pair.split_once(" -> ").expect("A -> B");
        let (from, to) = (events.event(from).expect("an event"), events.event(to).expect("an event"));
        assert_eq!(interval_json(scale, &matrix, from, to), *bounds, "{name} {}: {pair}", expect["choice"]);
    }
    let mut labels: Vec<String> = (0..network.labels.len())
        .filter(|&label| arcs[network.labels[label].arc.index()])
        .map(|label| label_json(network, scale, &matrix, &nodes, label).to_string())
        .collect();
    let mut expected: Vec<String> =
        expect["labels"].as_array().expect("labels").iter().map(Value::to_string).collect();
    labels.sort();
    expected.sort();
    assert_eq!(labels, expected, "{name} {}", expect["choice"]);
}

fn interval_json(scale: Scale, matrix: &Matrix, from: NodeId, to: NodeId) -> Value {
    let side = |distance: i64, infinite: &str, sign: i64| match distance {
        FAR.. => Value::from(infinite),
        distance => json!(scale.unscaled(sign * distance)),
    };
    json!([
        side(matrix.get(to.index(), from.index()), "-inf", -1),
        side(matrix.get(from.index(), to.index()), "inf", 1)
    ])
}

/// A labeled interval between the first names of its ends, among events that always happen at the same time.
fn label_json(network: &Network, scale: Scale, matrix: &Matrix, nodes: &[bool], label: usize) -> Value {
    let label = &network.labels[LabelId::from_index(label).index()];
    let arc = &network.arcs[label.arc.index()];
    let representative = |node: NodeId| {
        let together = (0..network.nodes.len()).filter(|&other| {
            nodes[other] && matrix.get(node.index(), other) == 0 && matrix.get(other, node.index()) == 0
        });
        let events = together.flat_map(|other| &network.nodes[other].events);
        events.map(|&event| network.event_name(event)).min().expect("the interval touches a named event")
    };
    let mode = match label.mode {
        LabelMode::Ask => "Ask",
        LabelMode::Tell => "Tell",
    };
    let interval = interval_json(scale, matrix, arc.from, arc.to);
    json!([mode, label.text, representative(arc.from), representative(arc.to), interval[0], interval[1]])
}

/// The network equals the paper's up to the numbering of nodes: there is a bijection that maps arcs onto arcs.
fn check_paper_network(network: &Network, paper: &Value) {
    let paper: Vec<(u64, u64, String)> = (paper.as_array().expect("arcs").iter())
        .map(|arc| {
            let part = |index: usize| arc[index].as_u64().expect("a node");
            (part(0), part(1), format!("{} {} {}", arc[2], arc[3], arc[4]))
        })
        .collect();
    let ours: Vec<(u64, u64, String)> = (network.arcs.iter())
        .map(|arc| {
            let labels: Vec<String> = (arc.labels.iter())
                .map(|label| &network.labels[label.index()])
                .map(|label| {
                    let mode = if label.mode == LabelMode::Ask { "Ask" } else { "Tell" };
                    format!("{mode}({})", label.text)
                })
                .collect();
            let text = format!("{} {} {}", json!(arc.lower), json!(arc.upper), json!(labels));
            (u64::from(arc.from.0), u64::from(arc.to.0), text)
        })
        .collect();
    assert_eq!(ours.len(), paper.len(), "the paper's network has {} arcs", paper.len());
    assert!(
        embed(&paper, &ours, &mut BTreeMap::new(), &mut BTreeSet::new()),
        "not the paper's network: {ours:#?}"
    );
}

fn embed(
    rest: &[(u64, u64, String)],
    ours: &[(u64, u64, String)],
    map: &mut BTreeMap<u64, u64>,
    used: &mut BTreeSet<usize>,
) -> bool {
    let Some(((from, to, text), rest)) = rest.split_first() else { return true };
    for (index, (our_from, our_to, our_text)) in ours.iter().enumerate() {
        if our_text != text || used.contains(&index) {
            continue;
        }
        let mut extended = map.clone();
        let agrees = [(from, our_from), (to, our_to)].into_iter().all(|(paper, our)| {
            let is_free = !extended.contains_key(paper) && !extended.values().any(|taken| taken == our);
            if is_free {
                extended.insert(*paper, *our);
            }
            extended.get(paper) == Some(our)
        });
        if agrees {
            used.insert(index);
            if embed(rest, ours, &mut extended, used) {
                *map = extended;
                return true;
            }
            used.remove(&index);
        }
    }
    false
}

#[test]
fn the_scenario_adds_six_nodes_and_eight_arcs_to_the_activity() {
    let network = network(&read(&folder().join("t01_enroute_scenario.rmpl")));
    assert_eq!((network.nodes.len(), network.arcs.len()), (13 + 6, 15 + 8));
}

#[test]
fn every_error_case_has_exactly_its_one_error() {
    for (_, case) in cases("tpn-error") {
        let (found, expected) = (error_codes(&program(&case)), case["expect"]["error"].as_str());
        let is_right = found.len() == 1 && found.first().copied() == expected;
        expect_as_listed(&case, if is_right { Ok(()) } else { Err(format!("the errors are {found:?}")) });
    }
}

#[test]
fn every_execution_case_has_its_windows_after_partial_execution() {
    for (name, case) in cases("execution") {
        let updates = case["expect"]["updates"].as_array().expect("updates");
        let network = network(&program(&updates[0]));
        let plan = &first_plan(&network, Search::Chronological).plans[0];
        if let Some(earliest) = case.pointer("/expect/earliest_schedule") {
            let written = plan_to_json(&network, plan);
            for (event, time) in earliest.as_object().expect("times") {
                assert_eq!(written["windows"][event][0], *time, "{name}: {event}");
            }
        }
        for update in updates {
            check_update(&format!("{name}: {}", update["title"]), &network, plan, update);
        }
    }
}

fn check_update(name: &str, network: &Network, plan: &Plan, update: &Value) {
    let events = Names::new(network);
    let scale = Scale::of(network);
    let mut points = stn::Stn::new(network.nodes.len());
    constrain(network, plan, scale, &mut points);
    let point = |event: &str| stn::PointId(events.event(event).expect("an event").0);
    let time = |value: &Value| scale.time(Time::deserialize(value).expect("a time"));
    let executed: Vec<(stn::PointId, i64)> = (update["executed"].as_object().expect("times").iter())
        .map(|(event, at)| (point(event), time(at)))
        .collect();
    let pending: Vec<stn::PointId> = update["not_yet_executed"]
        .as_array()
        .expect("events")
        .iter()
        .filter_map(Value::as_str)
        .map(point)
        .collect();
    let execution = stn::Execution {
        origin: stn::PointId(network.start.0),
        executed: &executed,
        now: time(&update["now"]),
        pending: &pending,
    };
    let after = stn::execution_windows(&mut points, execution, 0).expect("small numbers");
    let stn::ExecutionWindows::Consistent(after) = after else {
        assert_eq!(update["consistent"], false, "{name}");
        return;
    };
    assert_eq!(update["consistent"], true, "{name}");
    for (event, window) in update["windows"].as_object().expect("windows") {
        let found = after[point(event).0 as usize];
        let bound =
            |time: Option<i64>| time.map_or_else(|| Value::from("inf"), |time| json!(scale.unscaled(time)));
        assert_eq!(json!([bound(found.earliest), bound(found.latest)]), *window, "{name}: {event}");
    }
}

fn constrain(network: &Network, plan: &Plan, scale: Scale, points: &mut stn::Stn) {
    let id = |node: NodeId| stn::PointId(node.0);
    let mut add = |from: NodeId, to: NodeId, lower: Time, upper: Bound| {
        points.insert(id(to), id(from), -scale.time(lower), 0).expect("a plan is consistent");
        if let Some(upper) = scale.bound(upper) {
            points.insert(id(from), id(to), upper, 0).expect("a plan is consistent");
        }
    };
    for (arc, _) in network.arcs.iter().zip(&plan.selected_arcs).filter(|(_, selected)| **selected) {
        add(arc.from, arc.to, arc.lower, arc.upper);
    }
    let arc = |label: LabelId| &network.arcs[network.labels[label.index()].arc.index()];
    let zero = Time::ZERO;
    for link in &plan.causal_links {
        add(arc(link.tell).from, arc(link.ask).from, zero, Bound::Infinite);
        add(arc(link.ask).to, arc(link.tell).to, zero, Bound::Infinite);
    }
    for ordering in &plan.orderings_added {
        add(arc(ordering.first).to, arc(ordering.then).from, network.threat_gap, Bound::Infinite);
    }
}

/// The suite is kept outside, too, where several programs are held to it; the copy here must be the same.
#[test]
fn the_copy_of_the_suite_is_current() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/conformance");
    if !shared.is_dir() {
        // Written past the harness, which shows nothing of a test that passes.
        let line = "the_copy_of_the_suite_is_current did not compare: ../shared/conformance is not here\n";
        std::io::stdout().write_all(line.as_bytes()).expect("standard output can be written");
        return;
    }
    let names = |folder: &Path| -> BTreeSet<std::ffi::OsString> {
        std::fs::read_dir(folder)
            .expect("readable")
            .map(|entry| entry.expect("readable").file_name())
            .collect()
    };
    let is_missing = |name: &std::ffi::OsString| {
        Path::new(name).file_stem().is_some_and(|stem| NOT_COPIED.iter().any(|missing| stem == *missing))
    };
    let (missing, copied): (BTreeSet<_>, BTreeSet<_>) = names(&shared).into_iter().partition(is_missing);
    assert_eq!(names(&folder()), copied, "the copy and the suite differ by more than what is not copied yet");
    assert_eq!(
        missing.len(),
        2 * NOT_COPIED.len(),
        "the suite has no such case: take it off the list NOT_COPIED"
    );
    let line = format!("the_copy_of_the_suite_is_current: {} cases are not copied yet\n", NOT_COPIED.len());
    std::io::stdout().write_all(line.as_bytes()).expect("standard output can be written");
    for name in copied {
        let (original, copy) = (shared.join(&name), folder().join(&name));
        assert_eq!(read(&copy), read(&original), "{} differs from the suite: copy it again", copy.display());
    }
}

#[test]
fn unnamed_nodes_are_told_apart_in_messages() {
    let network = network("scenario S = { {A(), B()}, C() }");
    let named: BTreeSet<String> =
        (0..network.nodes.len()).map(|node| node_name(&network, NodeId::from_index(node))).collect();
    assert_eq!(named.len(), network.nodes.len());
}
