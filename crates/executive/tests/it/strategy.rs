//! Runs of a plan's strategy in which the environment's durations are chosen one by one (SPEC 13.2).

use exact::{Bound, Time};
use executive::{Actor, Course, PinnedPlan};
use tpn::generate::Rng;
use tpn::{Network, NodeId, Plan, Top, Window};

fn planned(source: &str) -> (Network, Plan) {
    let (network, diagnostics) = tpn::compile(&rmpl::parse(source).program(), &Top::Scenario(None));
    let network = network.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
    let plan = outcome.plans.into_iter().next().expect("the mission has a plan");
    (network, plan)
}

fn event(network: &Network, name: &str) -> NodeId {
    let is_named = |node: &&tpn::Node| node.events.iter().any(|&it| network.event_name(it) == name);
    let index = network.nodes.iter().position(|node| is_named(&node)).expect("an event of this name");
    NodeId::from_index(index)
}

fn course(pinned: &PinnedPlan) -> &Course {
    pinned.course().expect("nature chooses a duration")
}

fn window(from: i64, to: i64) -> Window {
    Window { earliest: Time::from(from), latest: Bound::Finite(Time::from(to)) }
}

/// The rover calls when it has arrived, and no later than 25 after it left; it may call while it drives, but not
/// sooner than 5 before it arrives. The environment chooses between 10 and 20.
const CALL: &str = "primitive Drive() contingent [10,20]; primitive Call()[1,1]; primitive Rest()[0,100];
scenario S = { Drive(), { { delay[0,100]; Call() }[0,26] } }";

/// A meeting: who comes first waits for the other.
const MEETING: &str = "primitive Ascend() contingent [10,30]; primitive Drive() contingent [20,25];
primitive Meet()[5,8]; primitive Shoot()[1,2]; primitive Sleep() contingent [4,9];
scenario S = { { Ascend(), Drive() }; Meet(); { Shoot()[1,2]; Sleep() }[0,20], Sleep() }";

#[test]
fn dragging_the_end_of_a_duration_chooses_it_for_nature() {
    let (network, plan) = planned(MEETING);
    let mut pinned = PinnedPlan::new(&network, &plan).expect("it is controllable");
    let (up, there) = (event(&network, "Ascend#1.end"), event(&network, "Drive#1.end"));
    let meet = event(&network, "Meet#1.start");
    assert_eq!(course(&pinned).windows[meet.index()].unwrap().earliest, Time::from(20));
    assert_eq!(pinned.grab(up), Some(window(10, 30)));
    assert_eq!(pinned.move_to(Time::from(12)), Some(Time::from(12)));
    pinned.drop_grabbed();
    assert_eq!(course(&pinned).now, Time::from(12));
    assert_eq!(course(&pinned).windows[meet.index()].unwrap().earliest, Time::from(20));
    // What no one has chosen lasts as long as it can, until someone chooses.
    assert_eq!(pinned.grab(meet), Some(Window { earliest: Time::from(25), latest: Bound::Infinite }));
    assert_eq!(pinned.grab(there), Some(window(20, 25)));
    assert_eq!(pinned.move_to(Time::from(400)), Some(Time::from(25)));
    pinned.move_to(Time::from(21));
    pinned.drop_grabbed();
    let now = course(&pinned);
    assert_eq!(now.now, Time::from(21));
    assert_eq!(now.windows[meet.index()], Some(window(21, 21)), "who came first waited");
    assert_eq!(pinned.pins(), [(up, Time::from(12)), (there, Time::from(21))]);
    assert!(!pinned.put_back());
    pinned.release(up);
    assert_eq!(course(&pinned).now, Time::from(21));
    assert_eq!(course(&pinned).windows[up.index()], Some(window(21, 30)), "it goes on");
    pinned.release_all();
    assert_eq!(course(&pinned).now, Time::ZERO);
}

#[test]
fn a_run_goes_on_from_event_to_event_and_says_who_acts() {
    let (network, plan) = planned(CALL);
    let mut pinned = PinnedPlan::new(&network, &plan).expect("it is controllable");
    let arrived = event(&network, "Drive#1.end");
    assert!(pinned.go_on());
    let before = course(&pinned);
    assert_eq!(before.under_way.len(), 1);
    assert_eq!(before.under_way[0].window, window(10, 20));
    while course(&pinned).windows[arrived.index()] != Some(window(20, 20)) {
        assert!(pinned.go_on(), "a duration that nobody chooses lasts as long as it can");
    }
    while pinned.go_on() {}
    let after = course(&pinned);
    assert_eq!(after.next, None);
    let natures: Vec<Time> =
        after.acts.iter().filter(|act| act.actor != Actor::Executive).map(|act| act.time).collect();
    assert_eq!(natures, [Time::from(20)]);
    assert!(after.acts.windows(2).all(|acts| acts[0].time <= acts[1].time));
}

#[test]
fn every_choice_of_natures_can_be_followed_to_the_end() {
    let mut rng = Rng::new(7);
    for source in [CALL, MEETING] {
        let (network, plan) = planned(source);
        for _ in 0..200 {
            let mut pinned = PinnedPlan::new(&network, &plan).expect("it is controllable");
            loop {
                let under_way = course(&pinned).under_way.clone();
                let chosen = under_way.get(rng.below(under_way.len() as u64 + 1) as usize);
                let Some(chosen) = chosen else {
                    if !pinned.go_on() {
                        break;
                    }
                    continue;
                };
                let end = network.arcs[chosen.natures.index()].to;
                let Some(range) = pinned.grab(end) else { panic!("it can be chosen") };
                let latest = range.latest.finite().expect("nature's ranges are finite");
                let from = range.earliest.checked_mul(10).unwrap().to_f64() as i64;
                let to = latest.checked_mul(10).unwrap().to_f64() as i64;
                pinned.move_to(Time::new(rng.between(from, to + 1), 10).expect("a time"));
                pinned.drop_grabbed();
            }
            let times = &course(&pinned).windows;
            for (index, arc) in network.arcs.iter().enumerate().filter(|it| plan.selected_arcs[it.0]) {
                let at = |node: NodeId| {
                    let window = times[node.index()].expect("it is selected");
                    assert_eq!(Bound::Finite(window.earliest), window.latest, "the run is over");
                    window.earliest
                };
                let took = at(arc.to).checked_sub(at(arc.from)).expect("it fits");
                assert!(arc.lower <= took && Bound::Finite(took) <= arc.upper, "arc {index} took {took:?}");
            }
        }
    }
}

#[test]
fn a_plan_without_nature_has_no_course() {
    let (network, plan) = planned("primitive Drive()[1,5]; scenario S = { Drive() }");
    let mut pinned = PinnedPlan::new(&network, &plan).expect("it is consistent");
    assert_eq!(pinned.course(), None);
    assert!(!pinned.go_on());
}
