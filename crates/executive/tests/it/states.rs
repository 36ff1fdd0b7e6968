//! Execution follows states and levels (SPEC 10, 11, 15): what the world changes is seen, what relied on it breaks the plan
//! with one sentence, and planning again starts from the values and levels that there are.

use std::sync::Arc;

use exact::{Rational, Time};
use executive::{Disturbance, Ending, Facts, Happening, Replanner, RunOutcome, World, run};
use tpn::{Network, Plan, Top};

/// Plans again, and lets the independent checker look at what comes of it.
struct Kirk {
    network: Arc<Network>,
    replans: usize,
}

impl Replanner for Kirk {
    fn replan(&mut self, facts: &Facts) -> Result<(Arc<Network>, Plan), String> {
        self.replans += 1;
        let network = Arc::new(facts.apply(&self.network, self.network.nodes.len()));
        let options = kirk::Options { relax: false, ..kirk::Options::default() };
        let outcome = kirk::plan(&network, &options, &mut kirk::Unlimited);
        let Some(plan) = outcome.plans.into_iter().next() else {
            let reasons = outcome.failure.iter().flat_map(|failure| &failure.reasons);
            let messages: Vec<&str> = reasons.map(|reason| reason.message.as_str()).collect();
            return Err(format!("no plan from here: {}", messages.join("; ")));
        };
        let verdict = verify::check_plan(&network, &plan);
        assert!(verdict.valid, "{:?}", verdict.violations);
        Ok((network, plan))
    }
}

fn compiled(source: &str) -> Arc<Network> {
    let program = rmpl::parse(source).program();
    let (network, diagnostics) = tpn::compile(&program, &Top::Scenario(None));
    Arc::new(network.unwrap_or_else(|| panic!("{diagnostics:?}")))
}

/// Executes a mission. What was executed to its end keeps every rule, the world's changes among what happened.
fn execute(source: &str, disturbances: &[Disturbance]) -> RunOutcome {
    let network = compiled(source);
    let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
    let plan = outcome.plans.into_iter().next().expect("the mission has a plan");
    let mut kirk = Kirk { network: Arc::clone(&network), replans: 0 };
    let world = World::new(disturbances);
    let outcome = run(&network, plan, network.nodes.len(), &world, &mut kirk).expect("its times fit");
    assert!(outcome.log.is_sorted_by_key(|entry| entry.time), "{:?}", outcome.log);
    if outcome.ending == Ending::Finished {
        let last = outcome.last();
        let verdict = verify::check_schedule(&last.network, &last.plan, &last.times);
        assert!(verdict.valid, "{disturbances:?}: {:?}", verdict.violations);
    }
    outcome
}

fn becomes(variable: &str, value: &str, at: i64) -> Disturbance {
    Disturbance::State { variable: variable.into(), value: value.into(), at: at.into() }
}

fn level(resource: &str, level: i64, at: i64) -> Disturbance {
    Disturbance::Level { resource: resource.into(), level: Rational::from(level), at: at.into() }
}

fn violations(outcome: &RunOutcome) -> Vec<String> {
    let reason = |entry: &executive::Entry| match &entry.happening {
        Happening::Violation { reason, .. } => Some(reason.clone()),
        _ => None,
    };
    outcome.log.iter().filter_map(reason).collect()
}

fn changes(outcome: &RunOutcome) -> Vec<String> {
    let change = |entry: &executive::Entry| match &entry.happening {
        Happening::Replanned { changes } => Some(changes.join(", ")),
        _ => None,
    };
    outcome.log.iter().filter_map(change).collect()
}

/// Returns what happened to states and levels: `5 ARM=OUT by Deploy#1`.
fn record(outcome: &RunOutcome) -> Vec<String> {
    let words = |entry: &executive::Entry| {
        Some(format!("{} {}", entry.time.readable(), entry.happening.state_words()?))
    };
    outcome.log.iter().filter_map(words).collect()
}

const ARM: &str = "
    state ARM : {IN, OUT} = IN;
    primitive Deploy()[5,10] sets ARM=OUT;
    primitive Dig()[10,20] requires ARM=OUT;
    primitive Look()[3,3];
    ";

fn arm(scenario: &str) -> String {
    format!("{ARM} scenario Day[0,200] = {{ {scenario} }}")
}

#[test]
fn values_are_written_down_as_they_change() {
    let outcome = execute(&arm("Deploy(); delay[10,50]; Dig()"), &[]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(record(&outcome), ["0 Deploy#1 changes ARM", "5 ARM=OUT by Deploy#1"]);
    assert_eq!(violations(&outcome), [""; 0]);
}

#[test]
fn what_relied_on_a_value_that_is_gone_is_replaced() {
    let source = arm("Deploy(); delay[10,50]; choose { Dig(), { Deploy(); Dig() } }");
    let outcome = execute(&source, &[becomes("ARM", "IN", 7)]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(violations(&outcome), ["Dig#1 needs ARM=OUT at 15, but ARM became IN at 7"]);
    assert_eq!(changes(&outcome).len(), 1);
    assert_eq!(
        record(&outcome),
        [
            "0 Deploy#1 changes ARM",
            "5 ARM=OUT by Deploy#1",
            "7 ARM=IN by the world",
            "15 Deploy#2 changes ARM",
            "20 ARM=OUT by Deploy#2"
        ]
    );
}

#[test]
fn without_another_way_the_run_stops_before_the_activity_starts() {
    let outcome = execute(&arm("Deploy(); delay[10,50]; Dig()"), &[becomes("ARM", "IN", 7)]);
    assert_eq!(outcome.ending, Ending::Stopped);
    assert_eq!(violations(&outcome), ["Dig#1 needs ARM=OUT at 15, but ARM became IN at 7"]);
    let stop = outcome.log.last().expect("it stopped");
    assert_eq!(stop.time, Time::from(7));
    let Happening::Stopped { reason } = &stop.happening else { panic!("{stop:?}") };
    assert!(reason.starts_with("no plan from here: ") && reason.contains("ARM=OUT"), "{reason}");
}

#[test]
fn a_running_activity_that_loses_its_condition_stops_the_run() {
    let outcome = execute(&arm("Deploy(); Dig()"), &[becomes("ARM", "IN", 8)]);
    assert_eq!(outcome.ending, Ending::Stopped);
    assert_eq!(violations(&outcome), ["Dig#1 needs ARM=OUT until 15, but ARM became IN at 8"]);
}

#[test]
fn planning_again_starts_from_the_value_that_there_is() {
    // At first the arm was in, and so it is again: what rests on that is possible only now.
    let source = format!(
        "{ARM} primitive Drive()[5,5] requires ARM=IN;
        scenario Day[0,200] = {{ Deploy(); delay[10,50]; choose {{ Dig(), Drive() }} }}"
    );
    let outcome = execute(&source, &[becomes("ARM", "IN", 7)]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(changes(&outcome), ["D1 takes Drive#1 instead of Dig#1"]);
    // The value at the start says nothing any more once an activity has changed it.
    let source = format!(
        "{ARM} primitive Drive()[5,5] requires ARM=IN; var LIGHT : {{ON}}; primitive Talk()[5,5] requires LIGHT=ON;
        scenario Day[0,200] = {{
            {{ Deploy(); delay[10,50]; choose {{ Talk(), Drive(), Look() }} }}, LIGHT=ON [100,150]
        }}"
    );
    let withdrawn = Disturbance::Withdrawn { condition: "Tell(LIGHT=ON)#1".into(), at: 6.into() };
    let outcome = execute(&source, &[withdrawn]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(changes(&outcome), ["D1 takes Look#1 instead of Talk#1"]);
}

#[test]
fn a_change_that_nothing_relies_on_breaks_nothing() {
    let quiet = ["Deploy(); Look()", "Look(); Deploy(); Dig()"];
    for scenario in quiet {
        let outcome = execute(&arm(scenario), &[becomes("ARM", "OUT", 2)]);
        assert_eq!(outcome.ending, Ending::Finished, "{scenario}");
        assert_eq!(violations(&outcome), [""; 0], "{scenario}");
    }
}

#[test]
fn a_change_while_an_activity_changes_the_variable_comes_to_nothing() {
    let outcome = execute(&arm("Deploy(); Dig()"), &[becomes("ARM", "IN", 3)]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(record(&outcome), ["0 Deploy#1 changes ARM", "5 ARM=OUT by Deploy#1"]);
}

#[test]
fn an_assertion_that_the_world_contradicts_is_over() {
    let source =
        "state DOOR : {OPEN, SHUT} = SHUT; primitive Enter()[5,5] requires DOOR=OPEN; primitive Wait()[1,1];
        scenario Day[0,200] = {
            { delay[60,60]; choose { Enter(), Wait() } }, { delay[10,10]; DOOR=OPEN [80,80] }
        }";
    let outcome = execute(source, &[becomes("DOOR", "SHUT", 30)]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(changes(&outcome), ["D1 takes Wait#1 instead of Enter#1"]);
    assert_eq!(record(&outcome), ["10 DOOR=OPEN by Tell(DOOR=OPEN)#1", "30 DOOR=SHUT by the world"]);
}

const BATTERY: &str = "
    resource Battery 0..100 = 60;
    primitive Drive()[10,20] consumes Battery 25;
    primitive Nap()[1,1];
    primitive Charge()[30,30] produces Battery 50;
    scenario Day[0,400] = { Drive(); delay[5,100]; choose { Nap(), Charge() }; Drive() }
    ";

#[test]
fn levels_are_written_down_as_they_change() {
    let outcome = execute(BATTERY, &[]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(record(&outcome), ["0 Battery=35 by Drive#1", "16 Battery=10 by Drive#2"]);
}

#[test]
fn a_level_that_is_lost_is_made_good_where_that_is_possible() {
    let outcome = execute(BATTERY, &[level("Battery", 10, 12)]);
    assert_eq!(outcome.ending, Ending::Finished);
    let [reason] = violations(&outcome).try_into().expect("one violation");
    assert_eq!(
        reason,
        "Drive#2 needs 25 of Battery at 16, which would take it to -15, below 0: Battery is at 10 at 12, 25 less than \
         planned"
    );
    assert_eq!(changes(&outcome), ["D1 takes Charge#1 instead of Nap#1"]);
    assert_eq!(
        record(&outcome),
        [
            "0 Battery=35 by Drive#1",
            "12 Battery=10 by the world",
            "45 Battery=60 by Charge#1",
            "45 Battery=35 by Drive#2"
        ]
    );
    // There is enough for the plan as it is.
    let outcome = execute(BATTERY, &[level("Battery", 26, 12)]);
    assert_eq!((outcome.ending, violations(&outcome).len()), (Ending::Finished, 0));
}

#[test]
fn a_level_that_is_lost_too_late_stops_the_run() {
    let source = "resource Battery 0..100 = 60; primitive Drive()[10,20] consumes Battery 25;
        scenario Day[0,400] = { Drive(); delay[5,100]; Drive() }";
    let outcome = execute(source, &[level("Battery", 24, 12)]);
    assert_eq!(outcome.ending, Ending::Stopped);
    assert_eq!(violations(&outcome).len(), 1);
    let outcome = execute(source, &[level("Battery", 25, 12)]);
    assert_eq!(outcome.ending, Ending::Finished);
}

#[test]
fn a_level_above_leaves_no_room_for_what_is_produced() {
    let source = "resource Battery 0..100 = 60; primitive Charge()[10,10] produces Battery 50;
        primitive Drive()[10,20] consumes Battery 30; primitive Nap()[1,1];
        scenario Day[0,400] = { Drive(); delay[5,100]; choose { Charge(), Nap() } }";
    let outcome = execute(source, &[level("Battery", 90, 12)]);
    assert_eq!(outcome.ending, Ending::Finished);
    assert_eq!(changes(&outcome), ["D1 takes Nap#1 instead of Charge#1"]);
    assert_eq!(
        violations(&outcome),
        [
            "Charge#1 gives 50 to Battery at 25, which would take it to 140, above 100: Battery is at 90 at 12, 60 more \
          than planned"
        ]
    );
}

/// Whenever the world changes something, the run keeps every rule to its end, or says what broke it and stops.
#[test]
fn at_whatever_time_the_world_changes_something_the_rules_are_kept_or_the_run_stops() {
    let source = "
        state ARM : {IN, OUT} = IN; state LID : {OPEN, SHUT} = SHUT;
        resource Battery 0..40 = 30; resource Power capacity 2;
        primitive Deploy()[5,10] sets ARM=OUT consumes Battery 10;
        primitive Stow()[4,8] sets ARM=IN consumes Battery 5 uses Power;
        primitive Dig()[10,20] requires ARM=OUT, LID=OPEN consumes Battery 15 uses Power 2;
        primitive Drive()[10,30] requires ARM=IN consumes Battery 10;
        primitive Charge()[10,20] produces Battery 20 uses Power;
        primitive Open()[2,4] sets LID=OPEN;
        scenario Day[0,300] = {
            { Open(); delay; optional Charge() },
            { delay[3,9]; Deploy(); delay; choose { Dig(), { Deploy(); Dig() } }; delay; optional Charge(); Stow(); Drive() }
        }";
    let (mut finished, mut stopped, mut replanned) = (0, 0, 0);
    for at in 0..70 {
        for disturbance in [
            becomes("ARM", "IN", at),
            becomes("ARM", "OUT", at),
            becomes("LID", "SHUT", at),
            level("Battery", 3, at),
            level("Battery", 40, at),
        ] {
            let outcome = execute(source, &[disturbance.clone(), becomes("LID", "OPEN", at + 2)]);
            replanned += changes(&outcome).len();
            match outcome.ending {
                Ending::Finished => finished += 1,
                Ending::Stopped => {
                    stopped += 1;
                    assert!(!violations(&outcome).is_empty(), "{disturbance:?}: {:?}", outcome.log);
                }
            }
        }
    }
    assert!(
        finished > 50 && stopped > 20 && replanned > 20,
        "{finished} finished, {stopped} stopped, {replanned}"
    );
}

/// What comes at one instant with a later event, such as the end of a delay before it, waits for what that waits for.
#[test]
fn a_delay_does_not_end_before_what_its_successor_waits_for() {
    let source = "
        resource Battery 0..10 = 1;
        primitive Charge()[10,20] produces Battery 5;
        primitive Use()[1,1] consumes Battery 3;
        scenario S[0,100] = { Charge(), { delay; optional Use() } }";
    for lasts in [10, 15, 20] {
        let outcome =
            execute(source, &[Disturbance::Duration { activity: "Charge#1".into(), duration: lasts.into() }]);
        assert_eq!(outcome.ending, Ending::Finished);
        assert_eq!(violations(&outcome), Vec::<String>::new(), "charging takes {lasts}");
        assert_eq!(outcome.plans.len(), 1);
        assert_eq!(outcome.log.last().map(|entry| entry.time), Some(Time::from(lasts + 1)));
    }
}

const LEVELS: &str = "resource Battery 0..100 = 80;
    primitive Drive()[10,10] requires Battery >= 30 at start consumes Battery 40;
    primitive Survey()[20,20] requires Battery > 35;
    primitive Charge()[10,10] produces Battery 40;
    scenario S[0,200] = { Drive(); delay[5,5]; Survey(); delay[5,5]; optional Charge(); delay; Drive() }
    objective minimize end;";

#[test]
fn conditions_on_levels_hold_in_a_run_without_disturbances() {
    assert_eq!(execute(LEVELS, &[]).ending, Ending::Finished);
}

#[test]
fn a_level_that_will_not_be_high_enough_breaks_the_plan_at_once() {
    // That is enough for the survey; the second drive takes 40, and needs a charge.
    let outcome = execute(LEVELS, &[level("Battery", 36, 20)]);
    assert_eq!(outcome.ending, Ending::Finished, "{:?}", outcome.log);
    let outcome = execute(LEVELS, &[level("Battery", 30, 20)]);
    let told = format!("{:?}", outcome.log);
    assert!(told.contains("Survey#1 needs Battery > 35"), "{told}");
    assert_ne!(outcome.ending, Ending::Finished);
}

#[test]
fn planning_again_gives_a_condition_the_level_that_it_needs() {
    let outcome = execute(LEVELS, &[level("Battery", 20, 37)]);
    assert_eq!(outcome.ending, Ending::Finished, "{:?}", outcome.log);
    let told = format!("{:?}", outcome.log);
    assert!(
        told.contains("Drive#2 needs Battery >= 30, which the plan no longer keeps in every schedule"),
        "{told}"
    );
}
