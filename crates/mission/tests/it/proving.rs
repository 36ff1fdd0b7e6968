//! Flight rules over every plan of a mission that moves vehicles: each way of driving has paths of its own.

use link::Update;
use mission::{Core, Manner};
use review::MissionRule;
use review::flight_rule::proof::{ALTERNATIVES, Verdict};
use tpn::plan_json::plan_from_json;

use crate::ridge::SilentHost;

/// From BASE to A are 20.1 m, and to B 50 m, which takes 100 seconds, and along the planned path a little more.
const WORLD: &str = "terrain \"tai-plain\" cell 0.6 origin (0, 0);
    location BASE (10, 10); location A (30, 12); location B (50, 40);
    obstacle WALL circle (100, 100, 2); vehicle R1 : ATRV-Jr at BASE;
    resource Battery 0..100 = 100;
    primitive Drive(to) moves R1 speed (0.02, 0.5) consumes Battery 1 per metre; primitive Dig()[5,10];
    ";

#[track_caller]
fn proven(scenario: &str, rule: &str) -> Verdict {
    proven_of(format!("{WORLD}scenario Day[0,600] = {{ {scenario} }}"), rule)
}

#[track_caller]
fn proven_of(source: String, rule: &str) -> Verdict {
    let mut core = Core::default();
    let update = Update::new(1, source);
    let compiled = core.compile(&update, &SilentHost);
    assert!(compiled.network().is_some(), "{:?}", compiled.diagnostics);
    let ground = core.ground(&compiled.program).expect("known ground");
    let evaluated = core.plan(compiled, ground, Manner::default(), &mut SilentHost).expect("a network");
    let rule = MissionRule { name: "R".into(), rule: rule.into(), ..MissionRule::default() };
    let verdict = core.prove_rule(&evaluated, &rule, ALTERNATIVES, &mut || false).verdict;
    if let Some(found) = verdict.counterexample().filter(|found| !found.is_own) {
        // As `enroute verify` reads it.
        let stated = &found.plan;
        let bare = {
            let mut bare = stated.clone();
            let windows = bare["windows"].as_object_mut().expect("windows");
            windows.retain(|event, _| !event.contains(".leg"));
            plan_from_json(&evaluated.network, &bare).expect("a plan of the text")
        };
        let network = core.network_of(&evaluated, &bare).expect("its drives have paths");
        let plan = plan_from_json(&network, stated).expect("a plan");
        let checked = verify::check_plan(&network, &plan);
        assert!(checked.valid, "{:?}", checked.violations);
    }
    verdict
}

#[test]
fn a_rule_is_held_against_the_paths_of_every_alternative() {
    let either = "choose { Drive(A), Drive(B) }";
    let holds = [
        // The path to B and what a driver adds to it takes less than 84 m.
        ("Battery >= 16", either),
        ("never Drive from 301 to 600", "choose { Drive(A), Drive(B) }[0,300]; delay"),
    ];
    for (rule, scenario) in holds {
        let verdict = proven(scenario, rule);
        assert_eq!(verdict, Verdict::Holds, "{rule}: {}", verdict.sentence());
    }
    // The plan of the mission drives to A.
    for (rule, scenario) in
        [("Battery >= 27", either), ("never R1.at=B at end", either), ("R1.at=A at end of Drive", either)]
    {
        let verdict = proven(scenario, rule);
        let found = verdict.counterexample().unwrap_or_else(|| panic!("{rule}: {}", verdict.sentence()));
        assert_eq!((verdict.name(), found.is_own), ("broken", false), "{rule}: {}", verdict.sentence());
    }
}

#[test]
fn what_no_path_allows_is_no_counterexample() {
    // There is time for the straight line to B, and not for the path.
    let verdict = proven("choose { Drive(A), Drive(B) }[0,1.67]; Dig()", "never R1.at=B at end");
    assert_eq!(verdict, Verdict::Holds, "{}", verdict.sentence());
}

#[test]
fn the_mission_of_the_paper() {
    let source = include_str!("../../../../assets/missions/enroute.rmpl");
    // Its vehicles have a least speed, which is not asked of each vertex of a path.
    for (rule, verdict) in [
        ("never Group-Wait", "broken"),
        ("never Group-Traverse-Path", "broken"),
        ("Rover1.at=BASE at end", "broken"),
        ("PATH1=OK while Group-Traverse-Path", "holds"),
        ("Rover1.at=TAI_POS at end", "holds"),
        ("PATH1=OK", "unsure"),
    ] {
        let found = proven_of(source.to_owned(), rule);
        assert_eq!(found.name(), verdict, "{rule}: {}", found.sentence());
    }
}

/// Two rovers drive to C, one after the other. Which one is first decides which of them stops beside the other, and so how
/// far each drives.
#[test]
fn what_another_order_of_arrivals_may_break_is_not_decided() {
    let mission = |branches: &str| {
        format!(
            "terrain \"tai-plain\" cell 0.6 origin (0, 0);
             location A (24, 52); location B (24, 92); location C (60, 72);
             vehicle R1 : ATRV at A; vehicle R2 : ATRV at B; resource Lane capacity 1;
             resource E1 0..1000 = 1000; resource E2 0..1000 = 1000;
             primitive Drive1(to) [1,200] moves R1 uses Lane consumes E1 1 per metre;
             primitive Drive2(to) [1,200] moves R2 uses Lane consumes E2 1 per metre;
             scenario S[0,900] = {{ {branches} }}"
        )
    };
    let rule = "E2 >= 925";
    let in_order = |first: &str, then: &str| mission(&format!("{first}; delay; {then}"));
    let first = proven_of(in_order("Drive1(C)", "Drive2(C)"), rule);
    assert_eq!(first.name(), "broken", "{}", first.sentence());
    // Its own plan lets R2 drive first.
    let either = proven_of(mission("{ delay; Drive1(C) }, { delay; Drive2(C) }"), rule);
    assert!(matches!(either.name(), "broken" | "open"), "{}", either.sentence());
}
