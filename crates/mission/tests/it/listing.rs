//! Several plans of a mission that moves vehicles (SPEC 10.3, 12): each one that is listed can be driven, from where its
//! movements start, and what cannot be is left out with the reason.

use crate::support::Mission;
use kirk::{Options, Status};
use mission::planning::Planned;
use tpn::{Choice, Plan};

const WORLD: &str = "terrain \"tai-plain\" cell 0.6 origin (0, 0);
    location BASE (10, 10); location A (30, 12); location B (50, 40); location C (15, 45);
    obstacle WALL circle (100, 100, 2);
    vehicle R1 : ATRV-Jr at BASE;
    primitive Drive(to) moves R1 speed (0.02, 0.5);
    ";
/// Meters between BASE, A, B and C, along straight lines.
const BASE_A: f64 = 20.1;
const BASE_B: f64 = 50.0;
const BASE_C: f64 = 35.36;
const A_B: f64 = 34.41;
const A_C: f64 = 36.25;
const B_C: f64 = 35.36;

fn plan(declarations: &str, options: Options) -> Planned {
    let source = format!("{WORLD}{declarations}");
    Mission::read(&source).with_plan((options, 0), |_, planned, _, _| planned)
}

fn all() -> Options {
    Options { all: true, ..Options::default() }
}

/// All plans that are listed.
fn plans(planned: &Planned) -> Vec<&Plan> {
    let others = planned.others.iter().map(|listed| &listed.plan);
    planned.planning.outcome.plans.iter().chain(others).collect()
}

fn alternatives(choices: &[Choice]) -> Vec<u32> {
    choices.iter().map(|choice| choice.alternative).collect()
}

/// The meters that each plan drives, and that it takes the time that these need, half a meter a second at most.
fn lengths(planned: &Planned) -> Vec<f64> {
    let lengths = plans(planned).into_iter().map(|plan: &Plan| {
        let end = plan.windows[planned.network.end.index()].expect("it ends").earliest.to_f64();
        let length_m = plan.quality.length_m;
        assert!((end * 60.0 - length_m / 0.5).abs() < 0.5, "{length_m} m in {end} min");
        length_m
    });
    lengths.collect()
}

fn assert_about(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            (expected - 0.1..expected * 1.03).contains(found),
            "{found} m, {expected} m by straight lines"
        );
    }
}

#[test]
fn every_plan_that_is_listed_drives_from_where_its_own_movements_end() {
    let planned = plan("scenario S[0,60] = { choose { Drive(A), Drive(B) }; Drive(C) }", all());
    assert_eq!(planned.planning.outcome.status, Status::Plan);
    assert_about(&lengths(&planned), &[BASE_A + A_C, BASE_B + B_C]);
    assert!(planned.planning.left_out.is_empty(), "{:?}", planned.planning.left_out);
}

#[test]
fn a_plan_without_time_for_its_drives_is_left_out_with_the_reason() {
    // By B it is 85 m along straight lines, for which there is time, and more around the rock.
    let planned = plan(
        "obstacle ROCK circle (30, 25, 8); scenario S[0,2.86] = { choose { Drive(B), Drive(A) }; Drive(C) }",
        all(),
    );
    let choices: Vec<Vec<u32>> = plans(&planned).iter().map(|plan| alternatives(&plan.choices)).collect();
    assert_eq!(choices, [[1]]);
    lengths(&planned);
    let [left_out] = planned.planning.left_out.as_slice() else { panic!("{:?}", planned.planning.left_out) };
    assert_eq!(alternatives(&left_out.choices), [0]);
    assert!(left_out.reason.contains("Drive#"), "{}", left_out.reason);
}

#[test]
fn a_plan_to_a_place_that_cannot_be_reached_is_left_out_with_the_reason() {
    let planned = plan(
        "location HOLE (100, 100); scenario S[0,60] = { choose { Drive(A), Drive(HOLE), Drive(B) }; Drive(C) }",
        all(),
    );
    assert_about(&lengths(&planned), &[BASE_A + A_C, BASE_B + B_C]);
    let [left_out] = planned.planning.left_out.as_slice() else { panic!("{:?}", planned.planning.left_out) };
    assert_eq!(alternatives(&left_out.choices), [1]);
    assert!(left_out.reason.starts_with("Drive#2 can't be driven from BASE to HOLE"), "{}", left_out.reason);
}

#[test]
fn every_order_of_sites_is_a_plan_of_its_own() {
    let mut expected = [
        BASE_A + A_B + B_C,
        BASE_A + A_C + B_C,
        BASE_B + A_B + A_C,
        BASE_B + B_C + A_C,
        BASE_C + A_C + A_B,
        BASE_C + B_C + A_B,
    ];
    expected.sort_by(f64::total_cmp);
    let orders = |most: &str| {
        let scenario = format!("scenario S[0,{most}] = {{ unordered {{ Drive(A); Drive(B); Drive(C) }} }}");
        let planned = plan(&scenario, all());
        let mut found = lengths(&planned);
        found.sort_by(f64::total_cmp);
        found
    };
    assert_about(&orders("60"), &expected);
    // 92 m are time enough for the two shortest of them.
    assert_about(&orders("3.15"), &expected[..2]);
}

#[test]
fn the_best_plans_that_differ_in_their_choices_have_their_paths() {
    let best = Options { best: 3, ..Options::default() };
    let planned = plan("scenario S[0,60] = { choose { Drive(A), Drive(B), Drive(C) } }", best);
    assert_about(&lengths(&planned), &[BASE_A, BASE_B, BASE_C]);
}

/// By straight lines B is nearer than C, and on the way there is a wall.
const BEHIND_A_WALL: &str = "obstacle BAR polygon (34, 20, 38, 20, 38, 60, 34, 60);
    objective minimize length;
    location HOLE (100, 100);
    ";

#[test]
fn the_best_plans_are_listed_by_their_own_paths() {
    let scenario = "scenario S[0,60] = { choose { Drive(B), Drive(FAR), Drive(HOLE), Drive(A) } }";
    let text = format!("{BEHIND_A_WALL}location FAR (10, 61); {scenario}");
    for (best, expected) in [(2, vec![3, 1]), (3, vec![3, 1, 0]), (9, vec![3, 1, 0])] {
        let planned = plan(&text, Options { best, ..Options::default() });
        let plans = plans(&planned);
        let choices: Vec<u32> = plans.iter().map(|plan| plan.choices[0].alternative).collect();
        let lengths: Vec<f64> = plans.iter().map(|plan| plan.quality.length_m).collect();
        assert_eq!(choices, expected, "{lengths:?}");
        assert!(lengths.is_sorted(), "{lengths:?}");
        assert_eq!(planned.planning.outcome.status, Status::Plan);
        assert!(plans.iter().all(|plan| plan.quality.is_optimal == Some(true)));
        // By straight lines it is the other way round.
        assert!(plans.len() < 3 || BASE_B < 51.0 && lengths[2] > 51.5);
    }
}
