//! Models of Livingstone and Pamela: what is read, and that it means the same.

use serde_json::Value;

use crate::command::{answer, enroute, file, said};

/// Two lamps behind breakers, which are behind another one.
const BREAKERS: &str = "
enum Current { flowing, none };
enum Switch { on, off, reset, noCommand };
class Source { Current out; enum M { ok } m; stateVector m; { out = flowing; } }
class Breaker {
    Switch command;
    Current in;
    Current out;
    private enum Mode { closed, opened, tripped, broken } mode;
    stateVector [mode];
    { switch (mode) { case closed: out = in; case opened: case tripped: out = none; case broken: ; } }
    transition close (opened, closed) { command = on; }
    transition open (closed, opened) { command = off; }
    transition restore (tripped, opened) { command = reset; }
    failure trip (*, tripped, unlikely) {}
    failure break (*, broken, rare) {}
}
class Lamp { Current in; Current light; enum M { ok } m; stateVector m; { light = in; } }
class Board {
    Source source; Breaker main; Breaker left; Breaker right; Lamp red; Lamp green;
    { main.in = source.out; left.in = main.out; right.in = main.out; red.in = left.out; green.in = right.out; }
}";

/// A valve that is commanded through a driver, with a sensor.
const VALVE: &str = "
enum Order { open, close, noCommand };
enum Position { wide, shut };
class Driver {
    Order in; Order out; enum M { on, dead } m; stateVector m;
    { switch (m) { case on: out = in; case dead: out = noCommand; } }
    failure die (*, dead, rare) {}
}
class Valve {
    Order order; Position position; enum M { closed, opened, stuck } m; stateVector m;
    { switch (m) { case closed: case stuck: position = shut; case opened: position = wide; } }
    transition open (closed, opened) { order = open; }
    transition close (opened, closed) { order = close; }
    failure stick (*, stuck, unlikely) {}
}
class System { Order lever; Position seen; Driver driver; Valve valve;
    { driver.in = lever; valve.order = driver.out; seen = valve.position; } }";

fn harness(observed: &[&str], commanded: &[&str], initial: &[&str]) -> (String, String) {
    let each = |tag: &str, key: &str, names: &[&str]| -> String {
        names.iter().map(|name| format!("<{tag} {key}=\"{name}\"/>")).collect()
    };
    let interface = each("obs", "name", observed) + &each("cmd", "name", commanded);
    (
        format!(
            "<?xml version=\"1.0\"?><xmpl><mplHarness name=\"h\" version=\"1\">{interface}</mplHarness></xmpl>"
        ),
        format!("<mplInit>{}</mplInit>", each("assign", "eq", initial)),
    )
}

/// The plant model of a text in JMPL, which `enroute check` accepts.
fn model_of(name: &str, text: &str, (interface, initial): (&str, &str)) -> String {
    let files = [
        file(&format!("{name}.jmpl"), text),
        file(&format!("{name}-1.hrn"), interface),
        file(&format!("{name}-1.ini"), initial),
    ];
    let output = enroute(&["convert", &files[0], &files[1], &files[2]]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(!said(&output).contains("not read"), "{output:?}");
    let model = file(&format!("{name}.rmpl"), &String::from_utf8_lossy(&output.stdout));
    let checked = enroute(&["check", &model]);
    assert_eq!(checked.status.code(), Some(0), "{checked:?}");
    model
}

/// Returns what is estimated after a step of a run with these observations.
fn estimate(model: &str, program: &str, step: usize, observed: &[&str]) -> Value {
    // Tests run at the same time, each with a model of its own.
    let program = file(&format!("{}-program.rmpl", model.rsplit('/').next().unwrap_or(model)), program);
    let mut arguments = vec!["run", &program, "--model", model, "--format", "json"];
    arguments.extend(observed.iter().flat_map(|observed| ["--observe", observed]));
    let run = answer(&enroute(&arguments));
    run["steps"][step - 1]["estimate"].clone()
}

#[test]
fn a_breaker_that_trips_is_found_by_the_lamps() {
    let (interface, initial) = harness(
        &["board.red.light", "board.green.light"],
        &["board.main.command", "board.left.command", "board.right.command"],
        &["board.main.mode=opened", "board.left.mode=opened", "board.right.mode=opened"],
    );
    let model = model_of("breakers", BREAKERS, (&interface, &initial));
    let program =
        "Main ():: (SEQUENCE (board.main = closed) (board.left = closed) (board.right = closed) (WAIT 4))";
    let dark = estimate(&model, program, 5, &["5:board.green.light=none"]);
    assert_eq!((&dark["board.right"], &dark["board.main"]), (&"tripped".into(), &"closed".into()), "{dark}");
    let both = estimate(&model, program, 5, &["5:board.green.light=none", "5:board.red.light=none"]);
    assert_eq!((&both["board.right"], &both["board.main"]), (&"closed".into(), &"tripped".into()), "{both}");
}

#[test]
fn a_command_that_constraints_pass_on_arrives_a_step_later() {
    let (interface, initial) =
        harness(&["top.seen"], &["top.lever"], &["top.driver.m=on", "top.valve.m=closed"]);
    let model = model_of("valve", VALVE, (&interface, &initial));
    let program = "Main ():: (SEQUENCE (top.valve = opened) (WAIT 2))";
    let good = estimate(&model, program, 2, &[]);
    assert_eq!((&good["top.valve"], &good["top.driver"]), (&"opened".into(), &"on".into()), "{good}");
    let stuck = estimate(&model, program, 2, &["2:top.seen=shut"]);
    assert_eq!((&stuck["top.valve"], &stuck["top.driver"]), (&"stuck".into(), &"on".into()), "{stuck}");
}

#[test]
fn what_is_left_out_of_a_model_is_listed() {
    let text = "class Lamp { enum M { on, off } m; stateVector m; { light = on; } transition (on, off) { tap = shut; } }";
    let lamp = file("lamp-left-out.jmpl", text);
    let output = enroute(&["import", &lamp]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    for part in
        ["not read: lamp-left-out.jmpl:1: unknown names `light` and `on`", "this transition: unknown names"]
    {
        assert!(said(&output).contains(part), "{output:?}");
    }
    let read = answer(&enroute(&["import", &lamp, "--format", "json"]));
    assert_eq!(read["format"], "enroute-rmpl/1", "{read}");
    assert_eq!(read["left_out"].as_array().map(Vec::len), Some(2), "{read}");
    let impossible =
        "class Lamp { enum M { on } m; stateVector m; enum L { dark, lit, dim } l; { l = lit; l = dim; } }";
    let output = enroute(&["import", &file("lamp-impossible.jmpl", impossible)]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(said(&output).contains("E-CONSTRAINT"), "{output:?}");
    let refused = enroute(&["import", &file("lamp-broken.jmpl", "class Lamp {\n on")]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(said(&refused).contains("lamp-broken.jmpl, line 2"), "{refused:?}");
    let more = enroute(&["import", &lamp, &file("lamp.txt", "")]);
    assert!(said(&more).contains("is not a file of Livingstone"), "{more:?}");
}

/// Two ways to a picture, and a door that must be open.
const PAMELA: &str = "
(defpclass door [] :modes [:open :closed]
  :fields {light {:initial \"off\" :observable true}}
  :methods [(defpmethod open-door {:pre :closed :post :open :bounds [2 4]} [])
            (defpmethod close-door {:pre :open :post :closed :bounds [1 3]} [])])
(defpclass rover [] :methods [(defpmethod drive {:bounds [10 20] :cost 3} [place])
                              (defpmethod picture {:bounds [1 :infinity]} [])])
(defpclass main []
  :fields {hatch (door) rover (rover)}
  :methods [(defpmethod day {:bounds [0 90]} []
              (parallel
                (sequence (ask (not (= hatch.mode \"x\"))) (survey \"north\"))
                (slack-sequence (hatch.close-door :label :close) (hatch.open-door :label :open)))
              (between :close :open :bounds [5 9]))
            (defpmethod survey [where]
              (sequence
                (choose (choice :cost 2 (rover.drive :bounds [12 15] where)) (choice (delay :bounds [30 30])))
                (optional (rover.picture))
                (maintain (= hatch (mode-of door :open)) (rover.picture :bounds [1 5]))
                (whenever (= hatch.light \"on\") (rover.picture))))])
";

#[test]
fn a_mission_of_pamela_is_planned() {
    let source = file("day.pamela", PAMELA);
    let output = enroute(&["convert", &source]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    assert!(said(&output).contains("not read: day.pamela:20: `whenever`"), "{output:?}");
    let mission = String::from_utf8_lossy(&output.stdout).into_owned();
    let mission = file("day.rmpl", &mission);
    let checked = enroute(&["check", &mission]);
    assert_eq!(checked.status.code(), Some(0), "{checked:?}");
    let plan = answer(&enroute(&["plan", &mission, "--format", "json"]));
    assert_eq!(plan["status"], "plan", "{plan}");
    let read = answer(&enroute(&["import", &source, "--format", "json"]));
    assert_eq!(read["left_out"].as_array().map(Vec::len), Some(1), "{read}");
    let refused =
        enroute(&["import", &file("broken.pamela", "(defpclass main []\n :methods [(defpmethod a [] ]")]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    assert!(said(&refused).contains("broken.pamela, line 2: expected `)`, found `]`"), "{refused:?}");
}
