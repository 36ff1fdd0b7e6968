//! Why missions have no plan: kinds, minimal conflicts, words and relaxations.

use crate::support::network;
use kirk::{Failure, FailureKind, Options, Status, Unlimited, is_conflict};
use tpn::generate::{Recipe, Tightness, mission};

fn failure(text: &str) -> (tpn::Network, Failure) {
    let network = network(text);
    let outcome = kirk::plan(&network, &Options::default(), &mut Unlimited);
    assert_eq!(outcome.status, Status::NoPlan, "{text}");
    let failure = outcome.failure.expect("explained");
    (network, failure)
}

/// Conflicts are conflicts and no smaller set is one; relaxations give plans, and one unit less does not.
fn check(text: &str) -> Failure {
    let (network, failure) = failure(text);
    assert!(!failure.reasons.is_empty(), "{text}");
    for reason in &failure.reasons {
        assert!(reason.is_minimal, "{}\n{text}", reason.message);
        let conflicts = |members: &[_]| is_conflict(&network, &reason.choices, members);
        assert_eq!(conflicts(&reason.conflict), Some(true), "{}\n{text}", reason.message);
        for left_out in 0..reason.conflict.len() {
            let mut rest = reason.conflict.clone();
            let member = rest.remove(left_out);
            assert_eq!(conflicts(&rest), Some(false), "{}: {member:?} is not needed\n{text}", reason.message);
        }
        let total = exact::Time::checked_sum(reason.cycle.iter().map(|member| member.weight));
        let total = total.expect("a small time");
        assert!(reason.cycle.is_empty() || total.is_negative(), "{text}");
    }
    for relaxation in &failure.relaxations {
        let edited = |fix: Option<rmpl::Fix>| {
            let mut text = text.to_owned();
            for edit in &fix?.edits {
                text.replace_range(edit.span.range(), &edit.text);
            }
            Some(text)
        };
        if let Some(edited) = edited(relaxation.fix(text)) {
            let outcome = kirk::plan(&network_of(&edited), &Options::default(), &mut Unlimited);
            assert_eq!(outcome.status, Status::Plan, "{}\n{edited}", relaxation.label);
        }
    }
    failure
}

fn network_of(text: &str) -> tpn::Network {
    network(text)
}

#[test]
fn a_deadline_that_is_too_tight_names_what_takes_too_long() {
    let failure = check("primitive A()[30,40]; primitive B()[20,30];\nscenario S[0,45] = { A(); B() }");
    assert_eq!(failure.kinds(), [FailureKind::Temporal]);
    assert_eq!(failure.reasons[0].message, "A and B need at least 50, but the scenario allows only 45");
    let fixes: Vec<&str> = failure.relaxations.iter().map(|relaxation| relaxation.label.as_str()).collect();
    assert!(fixes.contains(&"raise the maximum of the scenario from 45 to 50"), "{fixes:?}");
    assert!(fixes.contains(&"lower the minimum of A from 30 to 25"), "{fixes:?}");
}

#[test]
fn blocks_are_told_apart_by_their_activities() {
    let failure = check(
        "primitive Drive()[1,9]; primitive Photo()[1,2]; var L : {ON};\n\
         scenario S[0,40] = { { delay; Drive() }[30,35]; { Photo(); delay; { L=ON [1,2], Drive() } }[12,15] }",
    );
    assert_eq!(
        failure.reasons[0].message,
        "the block around Drive#1 and the block from Photo to Drive#2 need at least 42, but the scenario allows only 40"
    );
    let fixes: Vec<&str> = failure.relaxations.iter().map(|relaxation| relaxation.label.as_str()).collect();
    assert!(fixes.contains(&"lower the minimum of the block around Drive#1 from 30 to 28"), "{fixes:?}");
}

#[test]
fn a_requirement_longer_than_its_assertion_names_both() {
    let text = "primitive Drive()[405,486];\n\
        scenario S[0,800] = { { delay[0,inf]; do { Drive() } maintaining PATH1=OK }, { delay[10,10]; PATH1=OK[404,404] } }";
    let failure = check(text);
    assert_eq!(failure.kinds(), [FailureKind::OpenCondition]);
    assert_eq!(
        failure.reasons[0].message,
        "Drive requires PATH1=OK: Drive needs at least 405, but PATH1=OK holds for only 404"
    );
}

#[test]
fn a_requirement_that_nothing_asserts_says_so() {
    let failure = check("primitive Drive()[4,5];\nscenario S[0,80] = { do { Drive() } maintaining LIGHT }");
    assert_eq!(failure.reasons[0].message, "Drive requires LIGHT, but nothing asserts it");
    assert!(failure.relaxations.is_empty());
}

#[test]
fn conditions_that_cannot_be_kept_apart_are_both_named() {
    let failure =
        check("scenario S[0,20] = { { delay[0,inf]; CAM=ON[12,12] }, { delay[0,inf]; CAM=OFF[10,10] } }");
    assert_eq!(failure.kinds(), [FailureKind::Threat]);
    assert_eq!(
        failure.reasons[0].message,
        "CAM=ON and CAM=OFF overlap, and the planner cannot separate them: CAM=ON, CAM=OFF and a gap of 1 need at least 23, but the scenario allows only 20"
    );
    let horizon =
        failure.relaxations.iter().find(|relaxation| relaxation.old == exact::Bound::Finite(20.into()));
    assert_eq!(horizon.map(|relaxation| relaxation.new), Some(23.into()));
}

#[test]
fn every_alternative_has_its_own_reason() {
    let text = "primitive A()[30,40]; primitive B()[20,30];\n\
        scenario S[0,15] = { choose { A(), B(), { MODE=X[3,3], MODE=Y[3,3] } } }";
    let failure = check(text);
    assert!(failure.is_complete);
    let told: Vec<&str> = failure.reasons.iter().map(|reason| reason.message.as_str()).collect();
    assert_eq!(
        told,
        [
            "if D1 selects A#1, A needs at least 30, but the scenario allows only 15",
            "if D1 selects B#1, B needs at least 20, but the scenario allows only 15",
            "if D1 selects Tell(MODE=X)#1 and Tell(MODE=Y)#1, MODE=X and MODE=Y overlap, and the planner cannot separate them: MODE=X and a gap of 1 need at least 4, \
             but MODE=Y cannot wait that long",
        ]
    );
}

#[test]
fn conflicts_of_random_infeasible_missions_are_minimal() {
    for seed in 0..25 {
        check(&mission(Recipe { nodes: 24, tightness: Tightness::Infeasible, seed }));
    }
}

#[test]
fn what_excludes_each_other_for_too_long_has_one_minimal_reason() {
    for count in [5, 12] {
        let failure = check(&tpn::families::pigeonholes(count, 1));
        assert!(failure.is_complete);
        assert_eq!(failure.kinds(), [FailureKind::Threat]);
        let reason = &failure.reasons[0];
        let all =
            format!("M0=j0, M0=j1 and {} others overlap, and the planner cannot separate them", count - 2);
        let horizon = format!("the scenario allows only {}", count * 10 - 1);
        assert_eq!(reason.message, format!("{all}: {horizon}"));
        let whole = exact::Time::from(count as i64 * 10);
        let is_longer = |relaxation: &kirk::Relaxation| !relaxation.is_lower && relaxation.new == whole;
        assert!(failure.relaxations.iter().any(is_longer), "{:#?}", failure.relaxations);
    }
}

#[test]
fn a_job_shop_one_below_its_optimum_is_explained() {
    let shop = tpn::families::JOB_SHOPS[0];
    let (network, failure) = failure(&shop.mission(shop.optimum - 1));
    assert!(failure.is_complete);
    let [reason] = failure.reasons.as_slice() else { panic!("{failure:#?}") };
    assert_eq!(is_conflict(&network, &[], &reason.conflict), Some(true));
    let optimum = exact::Time::from(shop.optimum);
    assert!(
        failure.relaxations.iter().any(|relaxation| relaxation.new == optimum),
        "{:#?}",
        failure.relaxations
    );
}

#[test]
fn a_plan_that_only_the_gap_prevents_is_offered() {
    let idiom = "var GO : {OK, NO}; primitive Wait()[5,30]; primitive Explore()[2,2];
        scenario S[0,60] = { { do { Wait() } watching GO=OK; if GO=OK thennext Explore() }, { delay[5,20]; GO=OK[10,10] } }"
        .to_owned();
    let failure = kirk::plan(&network(&idiom), &Options::default(), &mut Unlimited).failure;
    let failure = failure.expect("the wait is over a gap before GO, and the guard is asked within it");
    assert!(failure.is_of_gap, "{failure:?}");
    let fix = failure.gap_fix(&idiom).expect("it is offered");
    let edit = &fix.edits[0];
    let mut mended = idiom.clone();
    mended.replace_range(edit.span.range(), &edit.text);
    assert!(mended.contains("option threat_gap = 0;"), "{mended}");
    assert!(kirk::plan(&network(&mended), &Options::default(), &mut Unlimited).failure.is_none(), "{mended}");
    // What has no plan anyway has none without a gap.
    let none = "primitive A()[5,9]; scenario S[0,3] = { A() }";
    let failure = kirk::plan(&network(none), &Options::default(), &mut Unlimited).failure.expect("too short");
    assert!(!failure.is_of_gap && failure.gap_fix(none).is_none());
}
