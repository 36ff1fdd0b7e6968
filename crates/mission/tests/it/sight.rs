//! Conditions on what vehicles see: the set of places follows from the ground, planning and checking keep it, and a
//! failure says what blocks the line (SPEC 10.5).

use link::Update;
use mission::{Core, Evaluated, Manner};
use snapshot::Goal;

use crate::ridge::{SilentHost, ridge};

const WORLD: &str = "terrain \"ridge.asc\";
location BASE (10, 14); location CRATER (50, 14); location OPEN (50, 3);
vehicle R1 : ATRV at CRATER; vehicle R2 : ATRV at OPEN;
primitive Drive(rover, to)[0,60] moves rover;
primitive Relay(rover, to)[5,10] requires rover.at in visible(to);
";

fn update(scenario: &str) -> Update {
    Update::new(1, format!("{WORLD}scenario Day[0,300] = {{ {scenario} }}"))
}

/// The mission, planned on the ridge.
fn planned(scenario: &str) -> Evaluated {
    let mut core = Core::default();
    core.import("ridge.asc", &ridge()).expect("a map");
    let update = update(scenario);
    let compiled = core.compile(&update, &SilentHost);
    assert!(compiled.network().is_some(), "{:?}", compiled.diagnostics);
    let ground = core.ground(&compiled.program).expect("known ground");
    core.plan(compiled, ground, Manner::default(), &mut SilentHost).expect("a network")
}

/// The places that a condition of the mission comes to, and its text.
fn places(scenario: &str) -> (Vec<String>, String) {
    let evaluated = planned(scenario);
    let network = &evaluated.network;
    let label = network.labels.iter().find(|label| network.sight(label).is_some()).expect("a condition");
    let names = network.value_names(&label.literal).into_iter().map(str::to_owned).collect();
    (names, label.text.to_string())
}

#[test]
fn the_places_that_see_a_location_follow_from_the_ground() {
    let (seen, text) = places("delay; Relay(R1, BASE)");
    assert_eq!((seen, text.as_str()), (vec!["BASE".to_owned(), "OPEN".to_owned()], "R1.at in visible(BASE)"));
    let (hidden, text) = places("ask not R1.at in visible(BASE) [1,1]");
    assert_eq!((hidden, text.as_str()), (vec!["CRATER".to_owned()], "not(R1.at in visible(BASE))"));
    let (seen, _) = places("Relay(R2, OPEN)");
    assert_eq!(seen, ["BASE", "CRATER", "OPEN"]);
}

#[test]
fn a_plan_drives_to_where_the_location_is_in_sight() {
    let is_valid = |scenario: &str| {
        let evaluated = planned(scenario);
        let planning = &evaluated.planned.planning;
        planning.verdict.as_ref().is_some_and(|verdict| verdict.valid)
    };
    assert!(is_valid("Drive(R1, OPEN); Relay(R1, BASE)"));
    assert!(is_valid("Relay(R2, BASE)"));
    // The relay waits for the first drive, and the second one waits for the relay.
    assert!(is_valid("{ delay; Relay(R1, BASE) }, { delay; Drive(R1, OPEN); delay; Drive(R1, CRATER) }"));
    assert!(!is_valid("Drive(R1, OPEN); Drive(R1, CRATER); Relay(R1, BASE)"));
}

#[test]
fn a_failure_says_what_blocks_the_line() {
    let evaluated = planned("Relay(R1, BASE)");
    let failure = evaluated.planned.planning.outcome.failure.as_ref().expect("no plan");
    let expected = "Relay requires R1.at in visible(BASE), but from CRATER the ground near (32, 14) blocks the line of sight";
    let told = &failure.reasons.first().expect("one").message;
    assert!(told.starts_with(expected), "{told}");
}

#[test]
fn without_terrain_everything_is_in_sight() {
    let text = WORLD.replace("terrain \"ridge.asc\";", "") + "scenario Day[0,9] = { Relay(R1, BASE) }";
    let network = mission::compile(&rmpl::parse(&text).program(), &Goal::Default, &mut Vec::new());
    let network = network.expect("it compiles");
    let label = network.labels.iter().find(|label| network.sight(label).is_some()).expect("a condition");
    assert_eq!(network.value_names(&label.literal), ["BASE", "CRATER", "OPEN"]);
}

#[test]
fn a_network_that_was_written_is_read_with_its_sights() {
    let evaluated = planned("Drive(R1, OPEN); Relay(R1, BASE)");
    let compiled = evaluated.compiled.network().expect("a network");
    let document = tpn::network_json::network_to_json(compiled);
    let read = tpn::network_json::network_from_json(&document).expect("it reads");
    assert_eq!(read.sights, compiled.sights);
    let literals = |network: &tpn::Network| -> Vec<tpn::Literal> {
        network.labels.iter().map(|label| label.literal.clone()).collect()
    };
    assert_eq!(literals(&read), literals(compiled));
}

/// Other programs do not know the ground: what they read names the places.
#[test]
fn a_plan_for_other_programs_names_the_places() {
    for scenario in ["delay; Relay(R1, BASE)", "ask not R1.at in visible(BASE) [1,1]"] {
        let evaluated = planned(scenario);
        let compiled = evaluated.compiled.network().expect("a network");
        let label =
            compiled.labels.iter().find(|label| compiled.sight(label).is_some()).expect("a condition");
        let document = interchange::plan_schema::write(compiled).to_string();
        let written = format!("R1.at in {{{}}}", compiled.value_names(&label.literal).join(", "));
        assert!(document.contains(&written), "{written}: {document}");
        interchange::Source::read(&document).expect("it reads");
    }
}

#[test]
fn another_map_gives_other_places() {
    let mut core = Core::default();
    let update = update("Drive(R1, OPEN); Relay(R1, BASE)");
    let hidden = |core: &mut Core| {
        let compiled = core.compile(&update, &SilentHost);
        compiled.network().expect("a network").sights[0].hidden.len()
    };
    core.import("ridge.asc", &ridge()).expect("a map");
    assert_eq!(hidden(&mut core), 1);
    let flat = String::from_utf8(ridge()).expect("a text").replace('6', "0").replace("ncols 00", "ncols 60");
    core.import("ridge.asc", flat.as_bytes()).expect("a map");
    assert_eq!(hidden(&mut core), 0, "the text is the same, and the ground is another");
}

#[test]
fn the_example_reports_from_where_it_sees_its_base() {
    let mut core = Core::default();
    let update = Update::new(1, include_str!("../../../../assets/missions/relay.rmpl"));
    let compiled = core.compile(&update, &SilentHost);
    let network = compiled.network().expect("a network");
    let hidden: Vec<&str> = network.sights[0].hidden.iter().map(|hidden| hidden.place.as_str()).collect();
    assert_eq!(hidden, ["HOLLOW", "SLACK"]);
    let ground = core.ground(&compiled.program).expect("known ground");
    let evaluated = core.plan(compiled, ground, Manner::default(), &mut SilentHost).expect("a network");
    let planning = &evaluated.planned.planning;
    assert!(planning.verdict.as_ref().is_some_and(|verdict| verdict.valid));
    let chosen: Vec<u32> =
        planning.outcome.plans[0].choices.iter().map(|choice| choice.alternative).collect();
    assert_eq!(chosen, [2, 2], "from where it is the base is hidden, and the edge is nearest");
}
