//! Vehicles that would meet (SPEC 10.3): one traverse is put before the other where the mission's bounds allow it, and the
//! author is told where they do not.

use crate::support::Mission;
use mission::planning::Planned;

/// One that stands where Rover1 drives to the east.
const ROVER3: &str =
    "vehicle Rover3 : ATRV-Jr at MIDDLE; primitive Drive3(to) moves Rover3 speed (0.1, 0.5);";

fn plan(scenario: &str) -> Planned {
    let source = format!(
        "option time_unit = second;
        location WEST (0, 0); location EAST (60, 0); location SOUTH (30, -30); location NORTH (30, 30);
        location MIDDLE (30, 0); location ASIDE (30, -20);
        vehicle Rover1 : ATRV at WEST;
        vehicle Rover2 : ATRV-Jr at SOUTH;
        primitive Drive1(to) moves Rover1 speed (0.1, 0.5);
        primitive Drive2(to) moves Rover2 speed (0.1, 0.5);
        {scenario}"
    );
    let planned = Mission::read(&source).with_plan((kirk::Options::default(), 1), |_, planned, _, _| planned);
    let verdict = planned.planning.verdict.as_ref().expect("it has a plan");
    assert!(verdict.valid, "{verdict:?}");
    planned
}

/// The earliest start and end of an activity.
fn times(planned: &Planned, name: &str) -> [f64; 2] {
    let plan = &planned.planning.outcome.plans[0];
    let occurrence = planned.network.occurrences.iter().find(|it| it.name == name).expect("it occurs");
    [occurrence.start, occurrence.end]
        .map(|node| plan.windows[node.index()].expect("it is selected").earliest.to_f64())
}

fn warnings(planned: &Planned) -> usize {
    planned.warnings.iter().filter(|warning| warning.code.0 == "W-ENCOUNTER").count()
}

#[test]
fn traverses_that_cross_are_put_in_an_order() {
    let planned = plan("scenario S[0,400] = { Drive2(NORTH)[120,150], { delay; Drive1(EAST)[120,150] } }");
    assert!(planned.separation_violations.is_empty(), "{:?}", planned.separation_violations);
    assert_eq!(warnings(&planned), 0);
    let ([start, end], [other_start, other_end]) = (times(&planned, "Drive1#1"), times(&planned, "Drive2#1"));
    assert!(end <= other_start || other_end <= start, "{start} to {end}, {other_start} to {other_end}");
}

#[test]
fn a_vehicle_that_stands_in_the_way_drives_first() {
    let planned = plan(&format!(
        "{ROVER3} scenario S[0,400] = {{ {{ delay; Drive1(EAST)[120,150] }}, {{ delay[100,200]; Drive3(ASIDE)[40,60] }} }}"
    ));
    assert!(planned.separation_violations.is_empty(), "{:?}", planned.separation_violations);
    let ([start, _], [_, aside]) = (times(&planned, "Drive1#1"), times(&planned, "Drive3#1"));
    assert!(aside <= start, "Rover3 is aside at {aside}, and Rover1 sets out at {start}");
}

#[test]
fn what_has_no_time_to_wait_is_reported_as_before() {
    // Rover3 sets out when Rover1 has passed it, whatever is planned.
    let planned = plan(&format!(
        "{ROVER3} scenario S[0,400] = {{ Drive1(EAST)[120,120], {{ delay[100,100]; Drive3(ASIDE)[100,100] }} }}"
    ));
    assert_eq!(planned.separation_violations.len(), 1, "{:?}", planned.separation_violations);
    assert_eq!(warnings(&planned), 1);
    let waits = plan(&format!(
        "{ROVER3} scenario S[0,150] = {{ {{ delay; Drive1(EAST)[120,120] }}, {{ delay[60,60]; Drive3(ASIDE)[80,80] }} }}"
    ));
    assert_eq!(warnings(&waits), 1, "260 s are more than there are");
}

#[test]
fn nothing_is_ordered_where_nobody_meets() {
    let planned = plan(&format!(
        "{ROVER3} scenario S[0,400] = {{ {{ delay; Drive2(ASIDE)[20,60] }}, {{ delay; Drive3(NORTH)[60,60] }} }}"
    ));
    assert!(planned.separation_violations.is_empty());
    assert!(planned.planning.outcome.plans[0].uses_ordered.is_empty());
    assert_eq!((times(&planned, "Drive2#1")[0], times(&planned, "Drive3#1")[0]), (0.0, 0.0));
}

#[test]
fn a_vehicle_that_never_moves_is_gone_around() {
    let planned = plan(&format!("{ROVER3} scenario S[0,400] = {{ Drive1(EAST)[120,200] }}"));
    assert!(planned.separation_violations.is_empty(), "{:?}", planned.separation_violations);
    let length_m = planned.traverses[0].length_m;
    assert!((60.05..63.0).contains(&length_m), "{length_m}");
    let no_time = plan(&format!("{ROVER3} scenario S[0,400] = {{ Drive1(EAST)[120,120] }}"));
    assert_eq!((no_time.separation_violations.len(), warnings(&no_time)), (1, 1));
}

#[test]
fn vehicles_that_come_toward_each_other_with_no_time_to_wait_go_around_each_other() {
    let planned = plan(
        "vehicle Rover4 : ATRV at EAST; primitive Drive4(to) moves Rover4 speed (0.1, 0.5);
        scenario S[0,200] = { Drive1(EAST)[120,160], Drive4(WEST)[120,160] }",
    );
    assert!(planned.separation_violations.is_empty(), "{:?}", planned.separation_violations);
    let longest = planned.traverses.iter().map(|traverse| traverse.length_m).fold(0.0, f64::max);
    assert!((60.05..64.0).contains(&longest), "{longest}");
}

#[test]
fn three_vehicles_that_meet_at_one_place_go_around_each_other() {
    let planned = plan(
        "vehicle Rover4 : ATRV at EAST; primitive Drive4(to) moves Rover4 speed (0.1, 0.5);
        scenario S[0,140] = { Drive1(EAST)[120,140], Drive4(WEST)[120,140], Drive2(NORTH)[120,140] }",
    );
    assert!(planned.separation_violations.is_empty(), "{:?}", planned.separation_violations);
}

#[test]
fn what_keeping_apart_costs_is_not_called_optimal() {
    let crossing = "objective minimize end; scenario S[0,400] = { { delay; Drive2(NORTH)[120,150] }, { delay; Drive1(EAST)[120,120] } }";
    let planned = plan(crossing);
    assert!(planned.separation_violations.is_empty(), "{:?}", planned.separation_violations);
    let outcome = &planned.planning.outcome;
    let quality = &outcome.plans[0].quality;
    assert!(quality.end.to_f64() > 120.0, "{quality:?}");
    assert_eq!(quality.is_optimal, Some(false));
    assert_eq!(outcome.bound, Some(exact::Rational::from(120)));
}
