//! Flight rules that are proven over every plan of a mission.

use serde_json::json;

use crate::command::{answer, enroute, file, folder, said};

/// Which of two drives is chosen is up to the planner, and which of the two ends first, too.
const MISSION: &str = "resource Battery 0..100 = 60; state Mast : {UP, DOWN} = DOWN;
primitive Short()[5,9] consumes Battery 20; primitive Long()[8,12] consumes Battery 45;
primitive Raise()[1,2] sets Mast=UP; primitive Lower()[1,2] sets Mast=DOWN;
scenario Day[0,60] = { { Raise(); delay; Lower() }, { delay; choose { Short(), Long() } } }
";

fn rules(name: &str, rules: &[(&str, &str)]) -> String {
    let rules: Vec<_> = rules.iter().map(|(name, rule)| json!({ "name": name, "rule": rule })).collect();
    file(name, &json!({ "format": "enroute-rules/1", "rules": rules }).to_string())
}

#[test]
fn a_rule_holds_in_every_plan_or_is_broken_by_one_that_verifies() {
    let folder = folder("proven-rules");
    let mission = folder.join("day.rmpl");
    std::fs::write(&mission, MISSION).expect("the folder can be written to");
    let mission = mission.to_str().expect("a path in UTF-8");
    let kept = rules("proven-kept.json", &[("Floor", "Battery >= 15"), ("Mast", "Mast=DOWN at end")]);
    let output = enroute(&["prove", mission, "--rules", &kept]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{text}{}", said(&output));
    assert!(text.contains("holds          Floor: Battery >= 15\n"), "{text}");

    // The plan of the mission keeps both, and other plans do not.
    let broken = rules("proven-broken.json", &[("Reserve", "Battery >= 20"), ("No long", "never Long")]);
    assert_eq!(enroute(&["plan", mission, "--rules", &broken]).status.code(), Some(0));
    let plan = folder.join("plan.json");
    let plan = plan.to_str().expect("a path in UTF-8");
    let output = enroute(&["prove", mission, "--rules", &broken, "-o", plan]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{text}{}", said(&output));
    assert!(
        text.contains("broken         Reserve: Battery >= 20\n  another plan can violate it: "),
        "{text}"
    );
    assert!(text.contains("  choices   D1=1\n  schedule\n") && text.contains("  Long#1.start\n"), "{text}");
    let verified = enroute(&["verify", mission, plan]);
    assert_eq!(verified.status.code(), Some(0), "{}", String::from_utf8_lossy(&verified.stdout));
    let told = answer(&enroute(&["prove", mission, "--rules", &broken, "--format", "json"]));
    assert_eq!(told["rules"][0]["counterexample"]["plan"]["choices"], json!({ "D1": 1 }), "{told}");
    assert_eq!(told["rules"][1]["verdict"], "broken");

    // What comes first only in some schedules of one plan.
    let mast = rules("proven-mast.json", &[("Mast", "Mast=DOWN while Short")]);
    let told = answer(&enroute(&["prove", mission, "--rules", &mast, "--format", "json"]));
    assert_eq!(told["rules"][0]["counterexample"]["own"], true, "{told}");
}

#[test]
fn a_proof_that_a_limit_ends_is_not_decided() {
    let mission = file("proven-limit.rmpl", MISSION);
    let rules = rules("proven-limit.json", &[("Floor", "Battery >= 15")]);
    let output = enroute(&["prove", &mission, "--rules", &rules, "--alternatives", "1"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(3), "{text}{}", said(&output));
    assert!(text.contains("not decided: the limit of 1 alternatives was reached"), "{text}");
    for wrong in [
        &["prove", &mission, "--rules", &rules, "--faults", "2"][..],
        &["prove", &mission, "--alternatives", "5"],
        &["prove", &mission],
    ] {
        assert_eq!(enroute(wrong).status.code(), Some(2), "{wrong:?}");
    }
}
