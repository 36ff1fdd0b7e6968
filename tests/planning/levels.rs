//! Conditions on the levels of reservoirs (SPEC 17): plans keep them, failures name them, and the checker finds what breaks
//! them. `lasting` compares them with every order of every schedule.

use acceptance::mission::{all_plans, first_plan, network, sound};
use exact::Time;
use kirk::{FailureKind, Options, Search, Status, Unlimited};
use tpn::{Network, Plan};

const DECLARATIONS: &str = "resource Battery 0..200 = 110; resource Memory 0..400 = 0;
    primitive Drive()[10,20] requires Battery >= 60 at start consumes Battery 55;
    primitive Charge()[30,40] produces Battery 40;
    primitive Image()[5,8] requires Memory < 200 produces Memory 90;
    primitive Send()[10,12] consumes Memory 90;";

fn mission(rest: &str) -> Network {
    network(&format!("{DECLARATIONS} {rest}"))
}

#[track_caller]
fn planned(network: &Network) -> Plan {
    let outcome = first_plan(network, Search::ConflictDirected);
    outcome.plans.into_iter().next().expect("there is a plan")
}

#[track_caller]
fn earliest(network: &Network, plan: &Plan, event: &str) -> Time {
    let named = (0..network.nodes.len())
        .find(|&node| network.nodes[node].events.iter().any(|&it| network.event_name(it) == event));
    plan.windows[named.expect("there is such an event")].expect("it is selected").earliest
}

#[test]
fn what_gives_enough_comes_first() {
    // After one drive 55 are left: the other needs the charge before it.
    let network = mission("scenario S[0,200] = { { delay; Drive(); delay; Drive() }, { delay; Charge() } }");
    let plan = planned(&network);
    assert!(earliest(&network, &plan, "Drive#2.start") >= earliest(&network, &plan, "Charge#1.end"));
    // The condition is one on what is there before the drive takes its own.
    let enough = mission("scenario S[0,200] = { Drive() }");
    assert_eq!(first_plan(&enough, Search::Chronological).plans.len(), 1);
}

#[test]
fn a_condition_that_lasts_counts_its_own_changes() {
    // The second image would end with 180, the third with 270.
    let two = mission("scenario S[0,200] = { Image(); Image() }");
    assert_eq!(first_plan(&two, Search::ConflictDirected).status, Status::Plan);
    let three = mission("scenario S[0,200] = { Image(); Image(); Image() }");
    assert_eq!(kirk::plan(&three, &Options::default(), &mut Unlimited).status, Status::NoPlan);
    let sent = mission("scenario S[0,200] = { { Image(); Image(); delay; Image() }, { delay; Send() } }");
    let plan = planned(&sent);
    assert!(earliest(&sent, &plan, "Image#3.end") >= earliest(&sent, &plan, "Send#1.start"));
}

#[test]
fn a_choice_by_a_level_has_each_alternative_where_it_holds() {
    let text = |images: &str| {
        format!("scenario S[0,200] = {{ {images} if Memory > 100 thennext Send() else Charge()[30,30] }}")
    };
    let taken = |images: &str| {
        let plans = all_plans(&mission(&text(images)), Search::Chronological).plans;
        plans.iter().map(|plan| plan.choices[0].alternative).collect::<Vec<u32>>()
    };
    assert_eq!(taken("Image();"), [1]);
    assert_eq!(taken("Image(); Image();"), [0]);
}

#[test]
fn a_failure_names_the_level() {
    let network = mission("scenario S[0,200] = { Drive(); Drive() }");
    let outcome = kirk::plan(&network, &Options::default(), &mut Unlimited);
    let reason = &outcome.failure.expect("it is explained").reasons[0];
    assert_eq!(reason.kind, FailureKind::Resource);
    assert!(
        reason.message.contains(
            "Drive#2 requires Battery >= 60, but with Drive#1 the level would be 55, and not enough is produced in time"
        ),
        "{}",
        reason.message
    );
    let low = network_of("do { delay[1,1] } maintaining Memory > 10");
    let outcome = kirk::plan(&low, &Options::default(), &mut Unlimited);
    let message = &outcome.failure.expect("it is explained").reasons[0].message;
    assert!(message.contains("requires Memory > 10, but the level at the start is 0"), "{message}");
}

fn network_of(body: &str) -> Network {
    mission(&format!("scenario S[0,200] = {{ {body} }}"))
}

#[test]
fn the_checker_finds_what_the_orders_of_a_plan_do_not_keep() {
    let network = mission("scenario S[0,200] = { { delay; Drive(); delay; Drive() }, { delay; Charge() } }");
    let mut plan = planned(&network);
    assert!(!plan.uses_ordered.is_empty());
    plan.uses_ordered.clear();
    let verdict = verify::check_plan(&network, &plan);
    let messages: Vec<String> = verdict.violations.into_iter().map(|it| it.message).collect();
    assert!(
        messages
            .iter()
            .any(|it| it.contains("Drive#2 requires Battery >= 60, but the level may be 55 at its start")),
        "{messages:?}"
    );
    let held = mission("scenario S[0,200] = { { Image(); Image(); delay; Image() }, { delay; Send() } }");
    let mut plan = planned(&held);
    plan.uses_ordered.clear();
    let messages: Vec<String> =
        verify::check_plan(&held, &plan).violations.into_iter().map(|it| it.message).collect();
    assert!(
        messages
            .iter()
            .any(|it| it.contains("Image#3 requires Memory < 200, but the level may be 270 after Image#3")),
        "{messages:?}"
    );
}

#[test]
fn nature_chooses_when_a_charge_is_over() {
    let network = mission(
        "primitive Trickle() contingent [30,60] produces Battery 40;
         scenario S[0,200] = { { delay; Drive(); delay; Drive() }, { delay; Trickle() } }",
    );
    let outcome = kirk::plan(&network, &Options::default(), &mut Unlimited);
    assert_eq!(outcome.status, Status::Plan);
    for plan in &outcome.plans {
        sound(&network, plan).unwrap_or_else(|problem| panic!("{problem}"));
    }
}

#[test]
fn documents_keep_conditions_on_levels() {
    let network = network_of("Drive(); Image()");
    let read = tpn::network_json::network_from_json(&tpn::network_json::network_to_json(&network));
    let read = read.unwrap_or_else(|problem| panic!("{problem}"));
    let levels = |network: &Network| network.uses.iter().map(|it| it.level).collect::<Vec<_>>();
    assert_eq!(levels(&read), levels(&network));
    assert_eq!(levels(&read).iter().flatten().count(), 3);
}
