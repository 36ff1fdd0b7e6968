//! Pinning events of random plans: the windows that remain are those of a network with the pins as constraints.

use exact::{Bound, Time};
use executive::{PinnedPlan, PlanNetwork};
use tpn::generate::{Recipe, Rng, Tightness};
use tpn::{Network, NodeId, Plan, Top, Window};

fn planned(source: &str) -> (Network, Plan) {
    let (network, diagnostics) = tpn::compile(&rmpl::parse(source).program(), &Top::Scenario(None));
    let network = network.unwrap_or_else(|| panic!("{diagnostics:?}"));
    let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
    let plan = outcome.plans.into_iter().next().expect("the mission has a plan");
    (network, plan)
}

/// The windows of the plan with these pins, computed again.
fn recomputed(network: &Network, plan: &Plan, pins: &[(NodeId, Time)]) -> Vec<Option<Window>> {
    let mut constraints = PlanNetwork::new(network, plan).expect("the plan is consistent");
    let times: Vec<Time> = pins.iter().map(|pin| pin.1).collect();
    constraints.refine_for(network, plan, &times).expect("its times fit");
    for &(node, time) in pins {
        let (origin, point) = (constraints.origin(), constraints.point(node).expect("it is selected"));
        let ticks = constraints.scale().ticks(time).expect("it is a whole number of ticks");
        constraints.stn.constrain(origin, point, ticks, Some(ticks), 0).expect("the pin is consistent");
    }
    let windows = constraints.stn.windows(constraints.origin()).expect("its times fit");
    let nodes = (0..network.nodes.len()).map(NodeId::from_index);
    nodes.map(|node| Some(constraints.window(windows[constraints.point(node)?.index()]))).collect()
}

#[test]
fn moving_pinned_events_leaves_the_windows_of_the_plan_with_the_pins_as_constraints() {
    for seed in 0..20 {
        let recipe = Recipe { nodes: 60, tightness: Tightness::Feasible, seed };
        let (network, plan) = planned(&tpn::generate::mission(recipe));
        let mut pinned = PinnedPlan::new(&network, &plan).expect("the plan is consistent");
        let nodes = network.nodes.len();
        assert_eq!(pinned.windows(nodes), plan.windows, "seed {seed}: without pins");
        let mut rng = Rng::new(seed);
        let selected: Vec<NodeId> =
            (0..nodes).map(NodeId::from_index).filter(|it| plan.selected_nodes[it.index()]).collect();
        for _ in 0..4 {
            let node = selected[rng.below(selected.len() as u64) as usize];
            let window = pinned.grab(node).expect("it is selected");
            for _ in 0..3 {
                let wanted = Time::new(rng.between(-10, 4_000), 7).expect("a fraction");
                let time = pinned.move_to(wanted).expect("it is grabbed");
                assert!(time >= window.earliest, "seed {seed}");
                assert!(window.latest.finite().is_none_or(|latest| time <= latest), "seed {seed}");
                let pins = pinned.pins();
                assert_eq!(
                    pinned.windows(nodes),
                    recomputed(&network, &plan, &pins),
                    "seed {seed}: {pins:?}"
                );
            }
        }
        pinned.release_all();
        assert_eq!(pinned.windows(nodes), plan.windows, "seed {seed}: released");
    }
}

const MISSION: &str = "primitive Drive(); primitive Wait();
scenario S[0,100] = { delay[0,40]; Drive()[10,20]; Wait()[5,30] }";

fn event(network: &Network, name: &str) -> NodeId {
    let is_named = |node: &&tpn::Node| node.events.iter().any(|&it| network.event_name(it) == name);
    let index = network.nodes.iter().position(|node| is_named(&node)).expect("an event of this name");
    NodeId::from_index(index)
}

#[test]
fn a_grabbed_event_can_be_put_back_where_it_was() {
    let (network, plan) = planned(MISSION);
    let mut pinned = PinnedPlan::new(&network, &plan).expect("the plan is consistent");
    let (start, end) = (event(&network, "Drive#1.start"), event(&network, "Drive#1.end"));
    pinned.grab(start);
    pinned.move_to(Time::from(12));
    pinned.drop_grabbed();
    let window = pinned.windows(network.nodes.len())[end.index()].expect("it is selected");
    assert_eq!(window, Window { earliest: Time::from(22), latest: Bound::Finite(Time::from(32)) });

    pinned.grab(start);
    assert_eq!(pinned.move_to(Time::from(-3)), Some(Time::ZERO));
    assert!(pinned.put_back());
    assert_eq!(pinned.pins(), [(start, Time::from(12))]);
    assert_eq!(pinned.windows(network.nodes.len())[end.index()], Some(window));
    assert!(!pinned.put_back(), "nothing is grabbed any more");
    pinned.release(start);
    assert_eq!(pinned.windows(network.nodes.len()), plan.windows);
}

#[test]
fn what_lasts_and_what_is_limited_holds_while_a_plan_is_executed() {
    for source in [
        include_str!("../../../../assets/missions/arm.rmpl"),
        "resource Battery 10..100 = 70;
         resource Body;
         primitive Drive()[10,20] consumes Battery 25 uses Body;
         primitive Charge()[45,60] produces Battery 50 uses Body;
         scenario S[0,400] = { { Drive(); delay; Drive(); delay; Drive() }, { delay; Charge() } }",
        "resource A;
         primitive P()[3,5] uses A;
         scenario S[0,30] = { unordered { P(); P(); P() } }",
    ] {
        let (network, plan) = planned(source);
        let pinned = PinnedPlan::new(&network, &plan).expect("the plan is consistent");
        assert_eq!(pinned.windows(network.nodes.len()), plan.windows, "{source}");
    }
}
