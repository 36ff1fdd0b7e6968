//! What plans and reports claim, held against each other: what one command lists no other one calls impossible, and every sum
//! is what its words say.

use crate::command::{answer, enroute, file};

#[test]
fn an_alternative_that_is_listed_is_not_called_impossible() {
    let mission = file(
        "flights.rmpl",
        "terrain \"tai-plain\";
         location BASE (30, 40); location RIDGE (120, 230); location DELTA (230, 210);
         vehicle Drone : Blimp at BASE;
         primitive Fly(to)[2,30] moves Drone;
         primitive Photo(site)[2,4] requires Drone.at=site rewards 3;
         objective maximize reward, minimize end;
         Shoot(site) = { Fly(site); Photo(site) }
         scenario Sol[0,400] = { { delay; unordered { optional Shoot(DELTA); optional Shoot(RIDGE) } } }",
    );
    let report = answer(&enroute(&["report", &mission, "--format", "json"]));
    let listed = answer(&enroute(&["plan", &mission, "--all", "--format", "json"]));
    let plans = listed["plans"].as_array().expect("plans");
    assert!(plans.len() > 2, "{listed}");
    let mut looked_at = 0;
    for choice in report["choices"].as_array().expect("choices") {
        let decision = choice["decision"].as_str().expect("a name");
        for alternative in choice["alternatives"].as_array().expect("alternatives") {
            let fate = alternative["fate"].as_str().expect("a sentence");
            let is_listed = plans.iter().any(|plan| plan["choices"][decision] == alternative["number"]);
            assert!(!is_listed || !fate.starts_with("impossible"), "{decision}: {alternative}");
            looked_at += usize::from(is_listed);
        }
    }
    assert!(looked_at >= 4, "{report}");
}

#[test]
fn a_sum_is_of_one_resource() {
    // Each of the two needs what the other one gives.
    let mission = file(
        "sums.rmpl",
        "resource Battery 0..10 = 4; resource Memory 0..10 = 4;
         primitive Charge()[6,8] consumes Memory 5 produces Battery 3;
         primitive Clear()[6,8] consumes Battery 5 produces Memory 3;
         scenario S[0,60] = { { delay; Charge(); delay }, { delay; Clear(); delay } }",
    );
    let report = answer(&enroute(&["report", &mission, "--format", "json"])).to_string();
    assert!(
        report.contains(
            "Charge#1 and Clear#1 share Memory and Battery, but they do not fit one after the other"
        ),
        "{report}"
    );
    assert!(!report.contains("take 10"), "{report}");
}

#[test]
fn each_plan_of_a_list_says_what_the_objective_counts() {
    let text = "objective minimize end;
        scenario S[0,200] = { { tell P[60,60] }, { delay; P [30,30] } }";
    let mission = file("listed.rmpl", text);
    let output = enroute(&["plan", &mission, "--all", "--format", "json"]);
    let document = file("listed.json", &String::from_utf8_lossy(&output.stdout));
    assert_eq!(answer(&output)["plans"][0]["end"], 60);
    let verified = enroute(&["verify", &mission, &document]);
    assert_eq!(verified.status.code(), Some(0), "{verified:?}");
}
