//! The commands for control programs and plant models, run as programs: documents and exit statuses (DESIGN 4.2)
//! against the conformance cases and SPEC 9.2 and 9.3.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Map, Value, json};

/// One engine of SPEC 2.2: what the cases of the belief update speak of.
const ENGINE: &str = "(DEFCLASS Engine ()
  (VAR thrust {zero full} OBSERVABLE) (VAR power_in {zero nominal} OBSERVABLE)
  (COMMAND cmd {none off standby fire})
  (MODE Off     ((thrust = zero) AND (power_in = zero)))
  (MODE Standby ((thrust = zero) AND (power_in = nominal)))
  (MODE Firing  ((thrust = full) AND (power_in = nominal)))
  (MODE Failed  true)
  (TRANSITION Off Standby (cmd = standby)) (TRANSITION Standby Firing (cmd = fire))
  (TRANSITION Firing Standby (cmd = standby)) (TRANSITION Standby Off (cmd = off))
  (FAULT Standby Failed 0.01) (FAULT Firing Failed 0.01))
(DEFINSTANCE EngineA Engine INIT Standby)\n";

/// What a call left behind.
struct Answer {
    status: i32,
    output: String,
    errors: String,
}

impl Answer {
    fn json(&self) -> Value {
        serde_json::from_str(&self.output).unwrap_or_else(|error| panic!("{error}: {self}"))
    }
}

impl std::fmt::Display for Answer {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "exit {}\n{}\n{}", self.status, self.output, self.errors)
    }
}

fn enroute(arguments: &[&str]) -> Answer {
    let output = Command::new(env!("CARGO_BIN_EXE_enroute")).args(arguments).output().expect("enroute runs");
    Answer {
        status: output.status.code().expect("an exit status"),
        output: String::from_utf8(output.stdout).expect("UTF-8"),
        errors: String::from_utf8(output.stderr).expect("UTF-8"),
    }
}

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn case_path(name: &str) -> String {
    repository().join("tests/conformance").join(name).display().to_string()
}

fn asset(name: &str) -> String {
    repository().join("assets/programs").join(name).display().to_string()
}

fn case(name: &str) -> Value {
    let text = std::fs::read_to_string(case_path(name)).expect(name);
    serde_json::from_str(&text).expect(name)
}

/// The cases of a kind, by file name.
fn cases(kind: &str) -> Vec<(String, Value)> {
    let mut names: Vec<String> = std::fs::read_dir(repository().join("tests/conformance"))
        .expect("the cases are there")
        .map(|entry| entry.expect("entry").file_name().into_string().expect("UTF-8"))
        .filter(|name| Path::new(name).extension().is_some_and(|extension| extension == "json"))
        .collect();
    names.sort();
    names
        .into_iter()
        .map(|name| (name.clone(), case(&name)))
        .filter(|(_, case)| case["kind"] == kind)
        .collect()
}

/// A file for one call; `name` must differ between tests, which run side by side.
fn written(name: &str, content: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, content).expect("the folder for tests is writable");
    path.display().to_string()
}

fn text(value: &Value) -> &str {
    value.as_str().expect("text")
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Checks that `actual` has all that `expected` has.
fn assert_includes(actual: &Value, expected: &Value, about: &str) {
    for (name, value) in expected.as_object().expect("an object") {
        assert_eq!(&actual[name], value, "{about}: {name}");
    }
}

fn estimate(name: &str, prior: &Value, commands: &Value, observations: &Value, more: &[&str]) -> Answer {
    let model = written(&format!("{name}.rmpl"), ENGINE);
    let prior = written(&format!("{name}-prior.json"), &prior.to_string());
    let commands = written(&format!("{name}-commands.json"), &commands.to_string());
    let observations = written(&format!("{name}-observations.json"), &observations.to_string());
    let mut call = vec!["estimate", &model, "--prior", &prior, "--commands", &commands];
    call.extend(["--observations", &observations, "--format", "json"]);
    call.extend(more);
    enroute(&call)
}

fn reconfigure(name: &str, state: &Value, goal: &Value) -> Answer {
    let state = written(&format!("{name}-state.json"), &state.to_string());
    let goal = written(&format!("{name}-goal.json"), &goal.to_string());
    let plant = asset("orbit-plant.rmpl");
    enroute(&["reconfigure", &plant, "--state", &state, "--goal", &goal, "--format", "json"])
}

fn orbit(more: &[&str]) -> Answer {
    let (program, model) = (case_path("h01_orbit_nominal.rmpl"), case_path("orbit_plant.rmpl"));
    let mut call = vec!["run", &program, "--model", &model, "--format", "json"];
    call.extend(more);
    enroute(&call)
}

#[test]
fn step_reproduces_every_trace_of_the_suite() {
    let cases = cases("hca-trace");
    assert!(cases.len() >= 6, "{} traces", cases.len());
    for (name, case) in cases {
        let program = case_path(text(&case["program"]));
        let answer = enroute(&["step", &program, "--estimates", &case_path(&name), "--format", "json"]);
        assert_eq!((answer.status, answer.errors.as_str()), (0, ""), "{name}: {answer}");
        let document = answer.json();
        assert_eq!(document["format"], "enroute-step/1", "{name}");
        assert_eq!(document["terminated"], case["expect"]["terminated"], "{name}");
        let (steps, expected) = (list(&document["steps"]), list(&case["expect"]["steps"]));
        assert_eq!(steps.len(), expected.len(), "{name}");
        for (step, expected) in steps.iter().zip(expected) {
            assert_includes(step, expected, &name);
        }
    }
}

#[test]
fn wrong_programs_are_diagnosed_in_the_document_or_on_standard_error() {
    let cases = cases("hca-error");
    assert!(cases.len() >= 2, "{} cases", cases.len());
    let (estimates, plant) = (written("none.json", "{}"), asset("orbit-plant.rmpl"));
    for (name, case) in cases {
        let program = case_path(text(&case["program"]));
        let code = text(&case["expect"]["error"]);
        let calls: [&[&str]; 3] = [
            &["hca", &program],
            &["step", &program, "--estimates", &estimates],
            &["run", &program, "--model", &plant],
        ];
        for call in calls {
            let answer = enroute(&[call, &["--format", "json"]].concat());
            assert_eq!((answer.status, answer.errors.as_str()), (2, ""), "{name} {call:?}: {answer}");
            let document = answer.json();
            assert_eq!(document["format"], format!("enroute-{}/1", call[0]), "{name}");
            let errors: Vec<&Value> = list(&document["diagnostics"])
                .iter()
                .filter(|diagnostic| diagnostic["severity"] == "error")
                .collect();
            assert_eq!(errors.len(), 1, "{name} {call:?}: {document}");
            assert_eq!(errors[0]["code"], code, "{name} {call:?}");
            assert!(errors[0]["span"]["line"].as_u64() >= Some(1), "{name} {call:?}");

            let answer = enroute(call);
            assert_eq!((answer.status, answer.output.as_str()), (2, ""), "{name} {call:?}: {answer}");
            assert!(answer.errors.contains(&format!("error[{code}]")), "{name} {call:?}: {answer}");
        }
    }
}

#[test]
fn run_reproduces_every_closed_loop_of_the_suite() {
    let cases = cases("closed-loop");
    assert!(!cases.is_empty());
    for (name, case) in cases {
        let program = case_path(text(&case["program"]));
        let model = case_path(text(&case["model"]));
        let answer = enroute(&["run", &program, "--model", &model, "--format", "json"]);
        assert_eq!((answer.status, answer.errors.as_str()), (0, ""), "{name}: {answer}");
        let document = answer.json();
        assert_eq!(document["format"], "enroute-run/1", "{name}");
        assert_eq!(document["terminated"], true, "{name}");
        let (steps, expected) = (list(&document["steps"]), list(&case["expect"]));
        assert_eq!(steps.len(), expected.len(), "{name}");
        for (step, expected) in steps.iter().zip(expected) {
            let about = format!("{name}, step {}", expected["step"]);
            let mut members = expected.as_object().cloned().unwrap_or_default();
            if let Some(probability) = members.remove("prob") {
                assert_eq!(step["probability"], probability, "{about}");
            }
            // The cases name only the components that the program speaks of.
            if let Some(estimate) = members.remove("estimate") {
                assert_includes(&step["estimate"], &estimate, &about);
            }
            assert_includes(step, &Value::Object(members), &about);
        }
    }
}

#[test]
fn a_failure_at_step_three_stays_hidden_until_firing_shows_no_thrust() {
    for injected in ["3:EngineA=Failed", "4:EngineA=Failed"] {
        // What a failed engine shows is not determined; the model's SHOWS lets it look idle.
        let answer = orbit(&["--inject", injected]);
        assert_eq!(answer.status, 0, "{answer}");
        let document = answer.json();
        let steps = list(&document["steps"]);
        let marked: Vec<&Value> = steps.iter().skip(2).map(|step| &step["marked"]).collect();
        let wait = "when (EngineA=Failed AND EngineB=Standby AND Camera=Off)";
        let fire_a = json!(["assert EngineA=Firing", wait]);
        let fire_b = json!(["assert EngineB=Firing"]);
        assert_eq!(marked, [&fire_a, &fire_a, &fire_b, &fire_b, &json!([])], "{injected}");
        let hidden = &steps[2];
        assert_eq!(hidden["estimate"]["EngineA"], "Standby", "{injected}");
        assert_eq!(hidden["probability"], "156816/157609", "{injected}");
        let truth = if injected.starts_with('3') { "Failed" } else { "Standby" };
        assert_eq!(hidden["true_state"]["EngineA"], truth, "{injected}");
        let found = &steps[3];
        assert_eq!(found["commands"], json!({ "EngineA": "fire" }), "{injected}");
        assert_eq!(found["observations"]["EngineA.thrust"], "zero", "{injected}");
        assert_eq!(found["estimate"]["EngineA"], "Failed", "{injected}");
        assert_eq!(document["terminated"], true, "{injected}");
    }
}

#[test]
fn a_program_with_its_plant_in_the_same_file_runs_and_says_so_to_people() {
    let answer = enroute(&["run", &asset("orbit-insertion.rmpl"), "--inject", "3:EngineA=Failed"]);
    assert_eq!((answer.status, answer.errors.as_str()), (0, ""), "{answer}");
    assert!(answer.output.contains("The program ended after 6 steps."), "{answer}");
}

#[test]
fn a_run_that_waits_for_ever_stops_at_the_limit_with_status_three() {
    let answer = orbit(&["--inject", "4:EngineA=Failed", "--inject", "4:EngineB=Failed", "--steps", "12"]);
    assert_eq!(answer.status, 3, "{answer}");
    let document = answer.json();
    assert_eq!(document["terminated"], false);
    assert_eq!(list(&document["steps"]).len(), 13);
}

#[test]
fn chance_reaches_the_end_and_says_how_sure_that_is() {
    let call = ["--monte-carlo", "50", "--seed", "7"];
    let document = orbit(&call).json();
    assert_eq!(document["runs"], 50);
    let interval: Vec<f64> = list(&document["interval"]).iter().filter_map(Value::as_f64).collect();
    let probability = document["probability"].as_f64().expect("a number");
    assert!(interval[0] <= probability && probability <= interval[1], "{document}");
    assert_eq!(orbit(&call).json(), document, "the same seed, the same answer");
}

#[test]
fn estimate_gives_the_exact_fractions_of_the_suite() {
    let members = |modes: &Value| -> Vec<(String, Value)> {
        modes.as_object().into_iter().flatten().map(|(mode, part)| (mode.clone(), part.clone())).collect()
    };
    let case = case("p01_engine_update.json");
    for (at, update) in list(&case["expect"]).iter().enumerate() {
        let prior: Vec<Value> = members(&update["prior"])
            .iter()
            .map(|(mode, part)| json!({ "state": { "EngineA": mode }, "probability": part }))
            .collect();
        let observations: Map<String, Value> = members(&update["obs"])
            .into_iter()
            .map(|(name, value)| (format!("EngineA.{name}"), value))
            .collect();
        let (prior, observations) = (json!(prior), json!(observations));
        let commands = json!({ "EngineA": update["command"] });
        for more in [&[][..], &["--k", "10"]] {
            let answer = estimate(&format!("engine-{at}"), &prior, &commands, &observations, more);
            assert_eq!((answer.status, answer.errors.as_str()), (0, ""), "{update}: {answer}");
            let document = answer.json();
            assert_eq!(document["format"], "enroute-estimate/1");
            let mut found: Vec<(String, Value)> = list(&document["posterior"])
                .iter()
                .map(|known| (text(&known["state"]["EngineA"]).to_owned(), known["probability"].clone()))
                .collect();
            found.sort_by(|left, right| left.0.cmp(&right.0));
            let mut expected = members(&update["posterior"]);
            expected.sort_by(|left, right| left.0.cmp(&right.0));
            assert_eq!(found, expected, "{update}");
        }
    }
}

#[test]
fn estimate_lists_the_likeliest_first_and_keeps_as_many_as_asked() {
    let prior = json!([{ "state": { "EngineA": "Standby" }, "probability": 1 }]);
    let observations = json!({ "EngineA.thrust": "full", "EngineA.power_in": "nominal" });
    let commands = json!({ "EngineA": "fire" });
    let document = estimate("likeliest", &prior, &commands, &observations, &[]).json();
    assert_eq!(
        document["posterior"],
        json!([
            { "state": { "EngineA": "Firing" }, "probability": "396/397" },
            { "state": { "EngineA": "Failed" }, "probability": "1/397" },
        ])
    );
    let document = estimate("likeliest-one", &prior, &commands, &observations, &["--k", "1"]).json();
    // The engine may have failed, which is not kept: it is firing with at least the probability that it does not fail.
    assert_eq!(
        document["posterior"],
        json!([{ "state": { "EngineA": "Firing" }, "probability": ["0.99", "1"] }])
    );
}

#[test]
fn an_observation_that_nothing_explains_is_a_no_with_its_conflict() {
    // An engine that is off does not fail by itself, so it cannot give thrust.
    let prior = json!([{ "state": { "EngineA": "Off" }, "probability": "1" }]);
    let observations = json!({ "EngineA.thrust": "full" });
    let answer = estimate("unexplained", &prior, &json!({}), &observations, &[]);
    assert_eq!(answer.status, 1, "{answer}");
    let document = answer.json();
    assert_eq!(document["posterior"], json!([]));
    assert!(text(&document["conflicts"][0]).contains("EngineA"), "{document}");
}

#[test]
fn reconfigure_finds_the_sequences_of_burton() {
    let closed = json!({ "ValveA": "Closed", "DriverA": "Off" });
    let cases: [(&str, Value, Value, &[&str]); 4] = [
        (
            "open-on",
            json!({ "ValveA": "Open", "DriverA": "On" }),
            closed.clone(),
            &["ValveA close", "DriverA off"],
        ),
        (
            "open-off",
            json!({ "ValveA": "Open", "DriverA": "Off" }),
            closed,
            &["DriverA on", "ValveA close", "DriverA off"],
        ),
        (
            "fire",
            json!({}),
            json!({ "EngineA": "Firing" }),
            &["DriverA on", "EngineA standby", "ValveA open", "EngineA fire"],
        ),
        ("nothing", json!({}), json!({ "EngineA": "Off" }), &[]),
    ];
    for (name, state, goal, expected) in cases {
        let answer = reconfigure(name, &state, &goal);
        assert_eq!((answer.status, answer.errors.as_str()), (0, ""), "{name}: {answer}");
        let document = answer.json();
        assert_eq!(document["format"], "enroute-reconfigure/1");
        assert_eq!(document["status"], "done", "{name}");
        let commands: Vec<String> = list(&document["commands"])
            .iter()
            .map(|command| format!("{} {}", text(&command["component"]), text(&command["command"])))
            .collect();
        assert_eq!(commands, expected, "{name}");
    }
}

#[test]
fn reconfigure_never_plans_a_fault_or_its_repair() {
    let failed = json!({ "EngineA": "Failed" });
    let standby = json!({ "EngineA": "Standby" });
    for (name, state, goal) in
        [("leave-failed", failed.clone(), standby), ("enter-failed", json!({}), failed)]
    {
        let answer = reconfigure(name, &state, &goal);
        assert_eq!(answer.status, 1, "{name}: {answer}");
        let document = answer.json();
        assert_eq!(document["status"], "unreachable", "{name}");
        assert_eq!(document["commands"], json!([]), "{name}");
        assert!(text(&document["reason"]).contains("EngineA"), "{name}: {document}");
    }
}

#[test]
fn hca_shows_orbit_insertion_as_the_specification_lists_it() {
    let answer = enroute(&["hca", &case_path("h01_orbit_nominal.rmpl"), "--as", "json"]);
    assert_eq!((answer.status, answer.errors.as_str()), (0, ""), "{answer}");
    let document = answer.json();
    assert_eq!(document["format"], "enroute-hca/1");
    let locations = list(&document["locations"]);
    let mut labels: Vec<&str> = locations.iter().map(|location| text(&location["label"])).collect();
    labels.sort_unstable();
    assert_eq!(
        labels,
        [
            "assert Camera=Off",
            "assert EngineA=Firing",
            "assert EngineA=Standby",
            "assert EngineB=Firing",
            "assert EngineB=Standby",
            "when (EngineA=Failed AND EngineB=Standby AND Camera=Off)",
            "when (EngineA=Standby AND Camera=Off)",
        ]
    );
    assert_eq!(locations.iter().filter(|location| location["start"] == true).count(), 5);
    let maintained = |composite: &&Value| !composite["maintenance"].is_null();
    assert_eq!(list(&document["composites"]).iter().filter(maintained).count(), 2);
}

#[test]
fn every_form_of_an_automaton_is_written() {
    for (form, content) in [("text", "assert EngineA=Firing"), ("dot", "digraph"), ("svg", "<svg")] {
        let answer = enroute(&["hca", &asset("orbit-insertion.rmpl"), "--as", form]);
        assert_eq!(answer.status, 0, "{form}: {answer}");
        assert!(answer.output.contains(content), "{form}: {answer}");
    }
}

#[test]
fn what_the_call_got_wrong_is_said_on_standard_error_with_status_two() {
    let program = case_path("h06_when_donext.rmpl");
    let broken = written("broken.json", "{\"estimates\": [");
    let orbit_program = case_path("h01_orbit_nominal.rmpl");
    let plant = asset("orbit-plant.rmpl");
    let state = written("stranger-state.json", "{\"EngineC\": \"Off\"}");
    let mode = written("stranger-mode.json", "{\"EngineA\": \"Flying\"}");
    let empty = written("empty.json", "{}");
    let calls: [(&[&str], &str); 8] = [
        (&["step", &program, "--estimates", &broken], "broken.json"),
        (&["step", &program, "--estimates", "no-such-file.json"], "no-such-file.json"),
        (&["run", &orbit_program, "--model", &plant, "--inject", "EngineA=Failed"], "STEP:COMPONENT=MODE"),
        (&["run", &orbit_program, "--model", &plant, "--inject", "0:EngineA=Failed"], "from 1"),
        (&["run", &orbit_program, "--model", &plant, "--inject", "3:EngineC=Failed"], "EngineC"),
        (&["run", &orbit_program, "--model", &plant, "--inject", "3:EngineA=Flying"], "Flying"),
        (&["reconfigure", &plant, "--state", &state, "--goal", &empty], "EngineC"),
        (&["reconfigure", &plant, "--state", &empty, "--goal", &mode], "Flying"),
    ];
    for (call, part) in calls {
        let answer = enroute(call);
        assert_eq!((answer.status, answer.output.as_str()), (2, ""), "{call:?}: {answer}");
        assert!(answer.errors.contains(part), "{call:?}: {answer}");
    }
}

#[test]
fn a_plant_that_is_none_is_diagnosed() {
    let (program, nothing) = (case_path("h01_orbit_nominal.rmpl"), written("nothing.rmpl", ""));
    let answer = enroute(&["run", &program, "--model", &nothing, "--format", "json"]);
    assert_eq!(answer.status, 2, "{answer}");
    assert!(!list(&answer.json()["diagnostics"]).is_empty(), "{answer}");
    let wrong = written("wrong-plant.rmpl", "(DEFCLASS A () (MODE On (x = y)))\n(DEFINSTANCE a A)");
    let empty = written("wrong-plant.json", "{}");
    let answer = enroute(&["reconfigure", &wrong, "--state", &empty, "--goal", &empty, "--format", "json"]);
    assert_eq!((answer.status, answer.errors.as_str()), (2, ""), "{answer}");
    let document = answer.json();
    assert_eq!(document["format"], "enroute-reconfigure/1");
    assert_eq!(document["diagnostics"][0]["severity"], "error", "{document}");
}

#[test]
fn a_program_is_read_from_standard_input() {
    let program = std::fs::File::open(case_path("h06_when_donext.rmpl")).expect("the case is there");
    let output = Command::new(env!("CARGO_BIN_EXE_enroute"))
        .args(["step", "-", "--estimates", &case_path("h06_when_donext.json")])
        .stdin(program)
        .output()
        .expect("enroute runs");
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stdout).ends_with("The program has ended.\n"));
}

/// `F` is never reached, so that nothing explains its value.
const UNREACHED: &str = "(SEQUENCE (I = N) (I = N) (I = N))
(DEFCLASS C () (VAR v {x y} OBSERVABLE) (VAR w {a b} OBSERVABLE) (MODE N (v = x)) (MODE F (v = y)))
(DEFINSTANCE I C INIT N)\n";

#[test]
fn a_refuted_belief_ends_the_run_with_its_conflict() {
    let program = written("refuted.rmpl", UNREACHED);
    let answer = enroute(&["run", &program, "--inject", "2:I=F", "--format", "json"]);
    assert_eq!((answer.status, answer.errors.as_str()), (1, ""), "{answer}");
    let document = answer.json();
    assert_eq!((&document["status"], &document["terminated"]), (&json!("refuted"), &json!(false)));
    let steps = list(&document["steps"]);
    assert_eq!(steps.len(), 3, "{document}");
    assert_eq!(steps[0]["probability"], "1");
    assert_eq!((&steps[1]["refuted"], &steps[1]["probability"]), (&json!(true), &Value::Null));
    // What `w` shows explains itself.
    assert_eq!(steps[1]["unexplained"], json!({ "I.v": "y" }));
    assert_eq!(steps[2]["marked"], json!(["assert I=N"]), "no goal was achieved");
    let answer = enroute(&["run", &program, "--inject", "2:I=F"]);
    assert!(answer.output.contains("refuted   no state of the plant explains I.v=y"), "{answer}");
    assert!(answer.output.contains("The belief is refuted"), "{answer}");
    let many = ["run", &program, "--inject", "2:I=F", "--monte-carlo", "4", "--format", "json"];
    let document = enroute(&many).json();
    assert_eq!((&document["reached"], &document["refuted"]), (&json!(0), &json!(4)), "{document}");
}

#[test]
fn with_too_few_states_a_run_ends_at_their_limit() {
    let pump = "(SEQUENCE true true true)
(DEFCLASS Pump () (VAR hum {no yes} OBSERVABLE) (VAR flow {no yes} OBSERVABLE) (COMMAND cmd {none test})
  (MODE Idle (hum = no)) (MODE Dry (hum = no)) (MODE Broken (hum = yes))
  (FAULT Idle Dry 0.1) (FAULT Dry Broken 0.5))
(DEFINSTANCE P Pump INIT Idle)\n";
    let program = written("few-states.rmpl", pump);
    // Only a pump that was dry a step before, which is not kept, is broken now.
    let faults = ["run", &program, "--inject", "1:P=Dry", "--inject", "2:P=Broken", "--format", "json"];
    let answer = enroute(&[&faults[..], &["--k", "1"]].concat());
    assert_eq!(answer.status, 3, "{answer}");
    let document = answer.json();
    assert_eq!(document["status"], "limit");
    let bounds = list(&document["steps"][0]["probability"]);
    assert_eq!((text(&bounds[0]), text(&bounds[1])), ("0.9", "1"), "{document}");
    let answer = enroute(&faults);
    assert_eq!((answer.status, &answer.json()["status"]), (0, &json!("ended")), "{answer}");
    assert_eq!(answer.json()["steps"][1]["estimate"], json!({ "P": "Broken" }));
}

#[test]
fn a_threshold_says_what_was_asked_and_where_commands_were_planned_from() {
    let lamp = "(DEFOPTION entailment 0.95) (L = Lit)
(DEFCLASS Lamp () (COMMAND cmd {none on}) (MODE Dark true) (MODE Lit true) (TRANSITION Dark Lit (cmd = on)))
(DEFINSTANCE L Lamp INIT Lit 0.9 Dark 0.1)\n";
    let program = written("threshold.rmpl", lamp);
    let answer = enroute(&["run", &program, "--format", "json"]);
    assert_eq!((answer.status, answer.errors.as_str()), (0, ""), "{answer}");
    let step = &answer.json()["steps"][0];
    assert_eq!(step["planned_from"], json!({ "L": "Dark" }), "{answer}");
    assert_eq!(step["commands"], json!({ "L": "on" }), "{answer}");
    assert_eq!(
        step["asked"],
        json!([{ "condition": "L=Lit", "probability": "1", "entailed": true }]),
        "{answer}"
    );
    let answer = enroute(&["run", &program]);
    for line in ["  planned   from L=Dark\n", "  known     L=Lit (1)\n"] {
        assert!(answer.output.contains(line), "{answer}");
    }
    let program = written("no-threshold.rmpl", &lamp.replace("(DEFOPTION entailment 0.95)", ""));
    let step = &enroute(&["run", &program, "--format", "json"]).json()["steps"][0];
    assert_eq!((step.get("asked"), step.get("planned_from"), &step["commands"]), (None, None, &json!({})));
}

#[test]
fn estimate_begins_with_the_prior_of_the_model() {
    let model = written(
        "prior.rmpl",
        "(DEFCLASS Tank () (VAR gauge {low high} OBSERVABLE) (MODE Empty (gauge = low)) (MODE Full (gauge = high))
  (MODE Leaking true))
(DEFINSTANCE T Tank INIT Empty 0.5 Full 0.3 Leaking 0.2)\n",
    );
    let (commands, seen) = (written("prior-c.json", "{}"), written("prior-o.json", "{\"T.gauge\":\"low\"}"));
    let call = ["estimate", &model, "--commands", &commands, "--observations", &seen, "--format", "json"];
    let answer = enroute(&call);
    assert_eq!((answer.status, answer.errors.as_str()), (0, ""), "{answer}");
    // 0.5 that is empty, and half of the 0.2 that leaks and shows either.
    let expected = json!([
        { "state": { "T": "Empty" }, "probability": "5/6" },
        { "state": { "T": "Leaking" }, "probability": "1/6" }
    ]);
    assert_eq!(answer.json()["posterior"], expected, "{answer}");
}

#[test]
fn check_finds_wrong_thresholds_and_priors_at_their_places() {
    let text = "(DEFOPTION entailment 0.4)
(L = Lit)
(DEFCLASS Lamp () (MODE Dark true) (MODE Lit true))
(DEFINSTANCE L Lamp INIT Lit 0.9 Dark 0.2)\n";
    let answer = enroute(&["check", &written("wrong-prior.rmpl", text), "--format", "json"]);
    assert_eq!(answer.status, 2, "{answer}");
    let found = answer.json();
    let found: Vec<_> = list(&found["diagnostics"])
        .iter()
        .map(|found| (self::text(&found["code"]), found["span"]["line"].as_u64(), found["hint"].is_string()))
        .collect();
    assert_eq!(found, [("E-PROBABILITY", Some(1), true), ("E-PROBABILITY", Some(4), true)], "{answer}");
}

#[test]
fn check_finds_in_programs_and_plants_what_run_refuses() {
    let plant = "(DEFCLASS Lamp () (COMMAND cmd {none on}) (MODE Off true) (MODE On true) (TRANSITION Off On (cmd = on)))
(DEFINSTANCE L Lamp INIT Off)\n";
    let cases: [(&str, String, &[&str]); 7] = [
        ("a mode", format!("(L = Onn)\n{plant}"), &["Onn", "did you mean `On`?"]),
        ("a component", format!("(M = On)\n{plant}"), &["`M`"]),
        ("a value", plant.replace("(cmd = on)", "(cmd = onn)"), &["onn", "did you mean `on`?"]),
        ("a target", plant.replace("Off On", "Off Onn"), &["Onn", "did you mean `On`?"]),
        ("a class", plant.replace("L Lamp", "L Lapm"), &["Lapm", "did you mean `Lamp`?"]),
        (
            "a probability",
            plant.replace("(TRANSITION", "(FAULT Off On 0) (TRANSITION"),
            &["must be above 0 and at most 1, not `0`"],
        ),
        (
            "probabilities",
            plant.replace("(TRANSITION", "(FAULT On Off 0.7) (FAULT On On 0.6) (TRANSITION"),
            &["must sum to at most 1"],
        ),
    ];
    for (name, text, parts) in cases {
        let file = written("check.rmpl", &text);
        let answer = enroute(&["check", &file]);
        assert_eq!(answer.status, 2, "{name}: {answer}");
        for part in parts {
            assert!(format!("{answer}").contains(part), "{name}, {part}: {answer}");
        }
    }
}

#[test]
fn check_warns_of_orbit_insertion_without_an_engine_left() {
    let program = std::fs::read_to_string(case_path("h01_orbit_nominal.rmpl")).expect("the case is there");
    let plant = std::fs::read_to_string(case_path("orbit_plant.rmpl")).expect("the plant is there");
    let file = written("orbit-with-plant.rmpl", &format!("{program}\n{plant}"));
    let answer = enroute(&["check", &file, "--format", "json"]);
    assert_eq!(answer.status, 0, "{answer}");
    let document = answer.json();
    let found: Vec<&str> =
        list(&document["diagnostics"]).iter().map(|found| text(&found["message"])).collect();
    assert_eq!(found.len(), 1, "{document}");
    assert!(
        found[0].starts_with("after EngineA=Failed and EngineB=Failed the program waits forever"),
        "{found:?}"
    );
}

#[test]
fn check_warns_of_a_goal_that_no_run_reaches() {
    let plant = "(DEFCLASS Lamp () (COMMAND cmd {none on}) (MODE Off true) (MODE On true) (MODE Dead true)
        (TRANSITION Off On (cmd = on)) (FAULT On Off 0.1))
        (DEFINSTANCE A Lamp) (DEFINSTANCE B Lamp)";
    let file = written("idle.rmpl", &format!("Main ():: (SEQUENCE (A = Dead) (B = On))\n{plant}"));
    let answer = enroute(&["check", &file, "--format", "json"]);
    assert_eq!(answer.status, 0, "{answer}");
    let document = answer.json();
    let found = list(&document["diagnostics"]);
    let found: Vec<(&str, u64)> =
        found.iter().map(|it| (text(&it["code"]), it["span"]["line"].as_u64().unwrap_or_default())).collect();
    // The goal that nothing reaches, and the mode that nothing leads to.
    assert!(found.contains(&("W-LIVENESS", 1)) && found.contains(&("W-UNREACHABLE", 2)), "{document}");
}

#[test]
fn a_run_lists_the_clocks_with_the_steps_left_and_those_that_were_up() {
    let text = format!(
        "{ENGINE}Main ():: (TIMEOUT 2s (EngineA = Failed) (SEQUENCE (EngineA = Firing) (REWARD 2.5)))"
    );
    let program = written("timed.rmpl", &text);
    let answer = enroute(&["run", &program, "--format", "json"]);
    let document = answer.json();
    assert_eq!((answer.status, &document["status"]), (0, &json!("ended")), "{answer}");
    assert_eq!(document["steps"][0]["clocks"], json!([{ "clock": "TIMEOUT 2 s", "steps_left": 2 }]));
    assert_eq!(document["steps"][0]["elapsed"], json!([]));
    assert_eq!(document["steps"][1]["elapsed"], json!(["TIMEOUT 2 s"]));
    assert_eq!(document["steps"][2]["goals"], json!({ "EngineA": "Firing" }));
    assert_eq!(document["reward"], json!(2.5), "{document}");
    let answer = enroute(&["run", &program]);
    assert!(answer.output.contains("  clock     TIMEOUT 2 s: 1 step left\n"), "{answer}");
    assert!(
        answer.output.contains("  elapsed   TIMEOUT 2 s\n") && answer.output.contains("Rewards: 2.5."),
        "{answer}"
    );
}

#[test]
fn locks_that_wait_for_each_other_end_the_run_with_their_names() {
    let text = format!(
        "{ENGINE}Main ():: (PARALLEL
           (LOCK (EngineA = Standby) (LOCK (EngineA.thrust = zero) (WAIT 3)))
           (LOCK (EngineA.thrust = full) (LOCK (EngineA = Firing) (WAIT 3))))"
    );
    let program = written("deadlock.rmpl", &text);
    let answer = enroute(&["run", &program, "--format", "json"]);
    let document = answer.json();
    assert_eq!((answer.status, &document["status"]), (1, &json!("deadlock")), "{answer}");
    let names = ["EngineA=Standby", "EngineA.thrust=zero", "EngineA.thrust=full", "EngineA=Firing"];
    assert_eq!(document["deadlock"], json!(names.map(|name| format!("LOCK {name}"))), "{document}");
}

#[test]
fn a_choice_is_drawn_with_a_seed() {
    let text =
        format!("{ENGINE}Main ():: (CHOOSE-PROB (0.6 (EngineA = Standby)) (0.4 (EngineA.thrust = zero)))");
    let program = written("choice.rmpl", &text);
    let first = |arguments: &[&str]| {
        let answer = enroute(&[&["run", &program, "--format", "json"], arguments].concat());
        answer.json()["steps"][0]["marked"][0].as_str().expect("a label").to_owned()
    };
    assert_eq!(first(&[]), "assert EngineA=Standby", "the likeliest");
    let drawn: std::collections::BTreeSet<String> =
        (0..20_u64).map(|seed| first(&["--fault-seed", &seed.to_string()])).collect();
    assert_eq!(drawn.len(), 2, "{drawn:?}");
}

#[test]
fn a_choice_by_rewards_says_what_it_expects_and_the_reward_is_counted() {
    let text = format!(
        "{ENGINE}(DEFOPTION horizon 4) Main ():: (CHOOSE-REWARD (3 (EngineA = Standby)) (5 (EngineA = Failed)))"
    );
    let program = written("reward.rmpl", &text);
    let document = enroute(&["run", &program, "--format", "json"]).json();
    let made = &document["steps"][0]["chosen"][0];
    let expected = (&json!(1), &json!("choose by reward 3, 5"), &json!(4), &json!(false));
    assert_eq!((&made["alternative"], &made["choice"], &made["horizon"], &made["shortened"]), expected);
    assert_eq!((&document["reward"], document["steps"][1].get("chosen")), (&json!(3), None), "{document}");
    let answer = enroute(&["run", &program]);
    assert!(
        answer.output.contains(
            "  chose     alternative 1 of choose by reward 3, 5: 2.97, 0.19702 expected within 4 steps\n"
        ),
        "{answer}"
    );
    assert!(answer.output.contains("Rewards: 3.\n"), "{answer}");
}

#[test]
fn trajectories_say_what_the_missing_thrust_ruled_out() {
    let (program, plant) = (case_path("h01_orbit_nominal.rmpl"), case_path("orbit_plant.rmpl"));
    let call = ["run", &program, "--model", &plant, "--inject", "3:EngineA=Failed", "--trajectories"];
    let answer = enroute(&call);
    let step = answer.output.split("step ").nth(4).expect("a fourth step");
    assert!(step.contains("  kept      most likely (9801/9832), from "), "{step}");
    assert!(step.contains("  ruled out EngineA=Firing ("), "{step}");
    assert!(step.contains(") by EngineA.thrust=zero\n") && !step.contains("dropped"), "{step}");
    let document = enroute(&[&call[..], &["--format", "json"]].concat()).json();
    let shown = &document["steps"][3]["trajectories"];
    assert_eq!(shown["ruled_out"][0]["by"], "EngineA.thrust=zero", "{shown}");
    assert_eq!(shown["dropped"], "0");
}

#[test]
fn orbit_insertion_is_proven_to_end_with_one_fault_and_shown_to_wait_forever_with_two() {
    let (program, plant) = (case_path("h01_orbit_nominal.rmpl"), case_path("orbit_plant.rmpl"));
    let prove = |more: &[&str]| {
        let mut call = vec!["prove", &program, "--model", &plant];
        call.extend(more);
        enroute(&call)
    };
    let one = prove(&[]);
    assert_eq!(one.status, 0);
    assert!(!one.output.contains("broken") && one.output.contains("holds      the program ends\n"));
    let two = prove(&["--faults", "2", "--property", "ends"]);
    assert_eq!(two.status, 1);
    // What is printed to repeat the run repeats it.
    let repeat = two.output.lines().find_map(|line| line.trim().strip_prefix("repeat   enroute "));
    let call: Vec<&str> = repeat.expect("a run that can be repeated").split(' ').collect();
    let repeated = enroute(&call);
    assert_eq!(repeated.status, 3);
    assert!(two.output.contains("active   assert EngineB=Firing"), "{}", two.output);
    assert!(repeated.output.contains("Still active:\n  assert EngineB=Firing"), "{}", repeated.output);
    let chance = prove(&["--knowledge", "perfect", "--chance", "20", "--property", "ends within 20"]);
    assert!(
        chance.output.contains("chance     the program ends within 20 steps: 0.9993"),
        "{}",
        chance.output
    );
    // A shell takes the call as it is printed.
    let spaced = written("orbit insertion.rmpl", &std::fs::read_to_string(&program).expect("the case"));
    let call = enroute(&["prove", &spaced, "--model", &plant, "--faults", "2", "--property", "ends"]);
    let repeat = call.output.lines().find_map(|line| line.trim().strip_prefix("repeat   "));
    let words = shlex::split(repeat.expect("a run that can be repeated")).expect("a command");
    assert_eq!(words[..3], ["enroute", "run", spaced.as_str()]);
    // As the help writes it.
    assert_eq!(prove(&["--property", "never EngineA=Firing AND EngineB=Firing"]).status, 0);
    assert_eq!(prove(&["--states", "0"]).status, 2);
    let wrong = prove(&["--property", "never EngineA = Fring"]);
    assert_eq!(wrong.status, 2);
    assert!(wrong.errors.contains("did you mean `Firing`?"), "{}", wrong.errors);
}

#[test]
fn an_observation_can_be_set_and_one_that_cannot_be_read_says_how_to_write_it() {
    let (program, plant) = (case_path("h01_orbit_nominal.rmpl"), case_path("orbit_plant.rmpl"));
    let run = |more: &[&str]| {
        let mut call = vec!["run", &program, "--model", &plant];
        call.extend(more);
        enroute(&call)
    };
    let seen = run(&["--observe", "4:EngineA.thrust=zero"]);
    assert!(
        seen.output.contains("conflict  EngineA=Firing contradicts EngineA.thrust=zero"),
        "{}",
        seen.output
    );
    for (text, part) in [
        ("EngineA.thrust=zero", "expected --observe STEP:VARIABLE=VALUE"),
        ("0:EngineA.thrust=zero", "steps count from 1"),
        ("1:EngineA.thrust=none", "none"),
        ("1:EngineC.thrust=zero", "EngineC.thrust"),
    ] {
        let wrong = run(&["--observe", text]);
        assert_eq!(wrong.status, 2, "{text}");
        assert!(wrong.errors.contains(part), "{text}: {}", wrong.errors);
    }
}
