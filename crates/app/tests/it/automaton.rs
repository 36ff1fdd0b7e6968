//! A control program as a user meets it: opened, stepped, broken, watched.

use crate::support;
use egui::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::json;
use workbench::host_io::Remote as _;

fn opened(source: &str) -> support::App {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().set_source(source);
    app.settle();
    app
}

fn orbit_insertion() -> support::App {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().open("orbit-insertion").expect("it is an example");
    app.settle();
    app
}

fn press(app: &mut support::App, name: &str) {
    app.harness.get_by_role_and_label(Role::Button, name).scroll_to_me();
    app.settle();
    app.harness.get_by_role_and_label(Role::Button, name).click();
    app.settle();
}

/// The names of the buttons that represent marked locations.
fn marked(app: &support::App) -> Vec<String> {
    let buttons = app.harness.query_all_by_role(Role::Button);
    let mut names: Vec<String> = buttons
        .filter_map(|node| node.accesskit_node().label())
        .filter_map(|label| label.strip_suffix(", active").map(str::to_owned))
        .collect();
    names.sort();
    names
}

/// SPEC 8.4, nominal: five, five minus the camera, and after three steps the goal to fire and the reserve.
#[test]
fn orbit_insertion_shows_its_marking_step_by_step() {
    let mut app = orbit_insertion();
    let names = |app: &support::App| {
        marked(app)
            .iter()
            .map(|name| name.split(':').next().unwrap_or_default().to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&app), ["a1", "a2", "a3", "w1", "w2"]);
    press(&mut app, "Step");
    assert_eq!(names(&app), ["a1", "a2", "w1", "w2"]);
    press(&mut app, "Step");
    press(&mut app, "Step");
    assert_eq!(
        marked(&app),
        ["a4: assert EngineA=Firing", "w2: when (EngineA=Failed AND EngineB=Standby AND Camera=Off)"]
    );
    press(&mut app, "Step back");
    press(&mut app, "Step back");
    assert_eq!(names(&app), ["a1", "a2", "w1", "w2"]);
}

#[test]
fn the_keys_that_step_through_plans_step_the_program() {
    let mut app = orbit_insertion();
    app.harness.key_press(egui::Key::Period);
    app.settle();
    assert_eq!(marked(&app).len(), 4, "one step on");
    app.harness.key_press(egui::Key::Comma);
    app.settle();
    assert_eq!(marked(&app).len(), 5, "and back");
}

#[test]
fn a_fault_is_injected_by_pressing_a_component() {
    let mut app = orbit_insertion();
    press(&mut app, "Step");
    press(&mut app, "Step");
    press(&mut app, "EngineA");
    press(&mut app, "Failed");
    press(&mut app, "Step");
    press(&mut app, "Step");
    assert_eq!(marked(&app), ["a5: assert EngineB=Firing"]);
    let tells_why = app.harness.query_all_by_label_contains("EngineA=Firing contradicts").next().is_some();
    assert!(tells_why, "the diagnosis says what contradicts what");
}

/// After the unseen failure of engine A in step 3, the missing thrust in step 4 leaves no trajectory in which it fires.
#[test]
fn trajectories_show_where_states_come_from_and_what_an_observation_ruled_out() {
    let mut app = orbit_insertion();
    assert!(
        app.harness.query_by_label_contains("Trajectories over").is_none(),
        "there is nothing before step 1"
    );
    press(&mut app, "Step");
    press(&mut app, "Step");
    press(&mut app, "EngineA");
    press(&mut app, "Failed");
    press(&mut app, "Step");
    let items = |app: &support::App| -> Vec<String> {
        let nodes = app.harness.query_all_by_role(Role::TreeItem);
        nodes.filter_map(|node| node.accesskit_node().label()).collect()
    };
    let has = |app: &support::App, words: &[&str]| {
        items(app).iter().any(|item| words.iter().all(|word| item.contains(word)))
    };
    assert!(has(&app, &["before step 4: EngineA=Failed, 0.25%"]), "{:?}", items(&app));
    press(&mut app, "Step");
    let ruled_out = ["before step 5: EngineA=Firing", "ruled out by EngineA.thrust=zero"];
    assert!(has(&app, &ruled_out), "{:?}", items(&app));
    let tree = app.harness.get_by_role_and_label(Role::Tree, "Trajectories over 4 steps");
    assert!(tree.rect().width() > 250.0);
    app.harness.get_by_label_contains("before step 2: most likely").click_accesskit();
    app.settle();
    assert_eq!(app.json()["hca"]["step"], 1, "an item goes to its step");
}

#[test]
fn a_program_is_no_mission_with_errors() {
    let app = orbit_insertion();
    assert_eq!(app.json()["status"], json!("program"));
    assert_eq!(app.json()["diagnostics"], json!([]));
    let app = opened("Main ():: (WHEN-DONEXT (start = on) (shutter = open))");
    assert_eq!(app.json()["status"], json!("program"));
}

#[test]
fn pressing_a_mode_of_a_component_injects_it_and_pressing_it_again_takes_that_back() {
    let mut app = orbit_insertion();
    app.harness.get_by_label_contains("EngineA: Failed").click();
    app.settle();
    assert_eq!(app.json()["hca"]["step"], 0, "nothing has happened yet");
    app.harness.get_by_label("EngineA: Failed, 0%, injected in this step").click();
    app.settle();
    press(&mut app, "Step");
    assert_eq!(app.json()["hca"]["plant"]["trueState"]["EngineA"], "Off", "it was taken back");
    app.harness.get_by_label_contains("EngineA: Failed").click();
    app.settle();
    press(&mut app, "Step");
    assert_eq!(app.json()["hca"]["plant"]["trueState"]["EngineA"], "Failed");
}

/// After engine A was commanded to standby and seen there, SPEC 9.1 leaves 1/397 for a failure that shows the same.
#[test]
fn the_modes_of_a_component_tell_how_likely_they_are() {
    let mut app = orbit_insertion();
    (0..3).for_each(|_| press(&mut app, "Step"));
    app.harness.get_by_label("EngineA: Standby, 99.75%, most likely, true mode");
    app.harness.get_by_label("EngineA: Failed, 0.25%");
    app.harness.get_by_label("Camera: Off, 100%, most likely, true mode");
}

#[test]
fn another_observation_changes_the_diagnosis_and_the_plants_own_brings_it_back() {
    let mut app = orbit_insertion();
    (0..4).for_each(|_| press(&mut app, "Step"));
    let conflicts = |app: &support::App| app.json()["hca"]["plant"]["conflicts"].clone();
    let believed = |app: &support::App| app.json()["hca"]["plant"]["belief"][0]["state"]["EngineA"].clone();
    assert_eq!(conflicts(&app), json!([]));
    let observed = "Observed value of EngineA.thrust";
    app.harness.get_by_role_and_label(Role::ComboBox, observed).scroll_to_me();
    app.settle();
    app.harness.get_by_role_and_label(Role::ComboBox, observed).click();
    app.settle();
    app.harness.get_by_role_and_label(Role::ListBoxOption, "zero").click();
    app.settle();
    assert!(conflicts(&app).to_string().contains("EngineA=Firing contradicts"), "{}", conflicts(&app));
    assert_eq!(believed(&app), "Failed");
    press(&mut app, "Reset EngineA.thrust");
    assert_eq!(conflicts(&app), json!([]));
    assert_eq!(believed(&app), "Firing");
}

#[test]
fn a_composite_selects_its_text() {
    let mut app = orbit_insertion();
    press(&mut app, "a1: assert EngineA=Standby, active");
    let state = app.json();
    let at = |end: &str| state["caret"][end].as_u64().expect("a place in the text") as usize;
    let (from, to) = (at("anchor").min(at("head")), at("anchor").max(at("head")));
    let source = app.harness.state().source();
    let selected = &source[from..to];
    assert!(selected.contains("EngineA = Standby"), "`{selected}` is selected");
}

#[test]
fn many_runs_tell_how_likely_the_program_is_to_reach_its_end() {
    let mut app = orbit_insertion();
    // An engine that is off does not fail.
    (0..2).for_each(|_| press(&mut app, "Step"));
    app.harness.get_by_label_contains("EngineA: Failed").click();
    app.settle();
    press(&mut app, "Monte Carlo");
    press(&mut app, "Run Monte Carlo");
    for _ in 0..200 {
        app.settle();
    }
    let chance = app.json()["hca"]["chance"].clone();
    assert_eq!((&chance["runs"], &chance["isRunning"]), (&json!(2000), &json!(false)));
    let share = chance["probability"].as_f64().expect("a number");
    let low = chance["interval"][0].as_f64().expect("a number");
    let high = chance["interval"][1].as_f64().expect("a number");
    // Engine B alone is left: in some three steps it may fail with 0.01 each.
    assert!(0.9 < low && low < share && share < high && high < 1.0, "{chance}");
    app.harness.get_by_label_contains("EngineB=Failed");
    app.harness.get_by_label_contains("Step through run").click();
    app.settle();
    (0..12).for_each(|_| press(&mut app, "Step"));
    assert_eq!(app.json()["hca"]["canStep"], json!(true), "the run that is shown does not reach its end");
    assert_eq!(app.json()["hca"]["plant"]["trueState"]["EngineB"], "Failed");
}

#[test]
fn a_proof_finds_the_faults_under_which_the_program_waits_forever_and_shows_the_run() {
    let mut app = orbit_insertion();
    press(&mut app, "Proof");
    press(&mut app, "Prove properties");
    app.settle();
    let verdicts = |app: &support::App| {
        let proof = app.json()["hca"]["proof"].clone();
        assert_eq!((&proof["isRunning"], &proof["stopped"]), (&json!(false), &json!(null)), "{proof}");
        proof["verdicts"].as_array().expect("verdicts").clone()
    };
    let one = verdicts(&app);
    assert_eq!(one.len(), 5);
    assert!(one.iter().all(|it| it["verdict"] == "holds"), "{one:?}");
    app.harness.get_by_label("✓ the program ends");
    let properties = "ends; never EngineA = Firing AND EngineB = Firing";
    app.harness
        .state_mut()
        .dispatch("program.setProof", &json!({ "properties": properties, "faults": 2 }))
        .expect("a command");
    press(&mut app, "Prove properties");
    app.settle();
    let two = verdicts(&app);
    assert_eq!((&two[0]["verdict"], &two[1]["verdict"]), (&json!("broken"), &json!("holds")));
    assert_eq!(two[0]["faults"], json!(["3: EngineA=Failed, EngineB=Failed"]));
    app.harness.get_by_label("Step 3: EngineA=Failed, EngineB=Failed");
    app.harness.get_by_label("After 6 steps nothing changes.");
    press(&mut app, "Step through counterexample");
    app.settle();
    let hca = app.json()["hca"].clone();
    assert_eq!(hca["plant"]["trueState"]["EngineB"], "Failed");
    assert_eq!(hca["marked"], json!(["assert EngineB=Firing"]));
    // Another text, another answer.
    let text = format!("; Another text.\n{}", app.harness.state().source());
    app.harness.state_mut().set_source(&text);
    app.settle();
    assert_eq!(app.json()["hca"]["proof"], json!(null));
}

#[test]
fn runs_stop_when_asked_to_and_belong_to_the_text_they_were_made_of() {
    let mut app = orbit_insertion();
    press(&mut app, "Monte Carlo");
    app.world.is_deaf.set(true);
    press(&mut app, "Run Monte Carlo");
    press(&mut app, "Stop runs");
    app.world.is_deaf.set(false);
    press(&mut app, "Run Monte Carlo");
    for _ in 0..200 {
        app.settle();
    }
    assert_eq!(app.json()["hca"]["chance"]["runs"], 2000);
    let text = format!("; Another text.\n{}", app.harness.state().source());
    app.harness.state_mut().set_source(&text);
    app.settle();
    assert_eq!(app.json()["hca"]["chance"], json!(null));
}

#[test]
fn components_fail_by_chance_from_the_same_fault_seed_again_and_again() {
    let mut app = orbit_insertion();
    app.harness.get_by_label("Random component faults").click();
    app.settle();
    let states = |app: &mut support::App| {
        let mut states = Vec::new();
        for _ in 0..4 {
            press(app, "Step");
            states.push(app.json()["hca"]["plant"]["trueState"].clone());
        }
        states
    };
    let first = states(&mut app);
    press(&mut app, "Reset");
    assert_eq!(states(&mut app), first);
}

/// There is nothing to show over time or on the ground.
#[test]
fn a_control_program_has_the_window_to_itself() {
    let app = orbit_insertion();
    let automaton = app.harness.get_by_label_contains("Automaton. ").rect();
    assert!(automaton.height() > 450.0 && automaton.width() > 500.0, "{automaton}");
    assert!(app.harness.query_by_label("No plan to show. The Plan panel explains why.").is_none());
}
