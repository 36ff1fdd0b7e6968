//! Components inside components: names, ports, inheritance, and what is wrong with them (SPEC 2.2).

use plant::{Belief, ComponentId, Model, Observation, compile, update_exact};

use crate::estimation::model;

const PUMP: &str = "
(DEFCLASS Power () (COMMAND cmd {none on off}) (MODE Off true) (MODE On true)
  (TRANSITION Off On (cmd = on)) (TRANSITION On Off (cmd = off)))
(DEFCLASS Coil () (PORT power Power) (PORT housing Pump) (VAR heat {cold warm} OBSERVABLE)
  (MODE Ok (((power = On) AND (heat = warm)) OR ((power = Off) AND (heat = cold)))) (MODE Burnt (heat = cold))
  (FAULT Ok Burnt 0.1 (housing = Running)))
(DEFCLASS Valve () (PORT power Power) (PORT coil Coil) (COMMAND cmd {none open}) (PART seat Seat INIT Dry 0.5 Wet 0.5)
  (MODE Closed true) (MODE Open true)
  (TRANSITION Closed Open ((cmd = open) AND (coil.heat = warm) AND (seat = Dry))))
(DEFCLASS Seat () (MODE Dry true) (MODE Wet true))
(DEFCLASS Pump () (PORT power Power) (COMMAND cmd {none start})
  (PART coil Coil (power power) (housing self)) (PART valve Valve (power power) (coil coil))
  (MODE Still true) (MODE Running true)
  (TRANSITION Still Running ((cmd = start) AND (valve = Open) AND (valve.seat = Dry) AND (valve.coil.heat = warm))))
(DEFINSTANCE P1 Pump (power Main)) (DEFINSTANCE Main Power INIT On) (DEFINSTANCE Spare Coil (power Main) (housing P1))
(DEFINSTANCE Other Valve (power Main) (coil P1.coil))";

fn names(model: &Model) -> Vec<&str> {
    model.components.iter().map(|component| component.name.as_str()).collect()
}

#[test]
fn parts_follow_their_owner_and_are_connected_in_its_names() {
    let model = model(PUMP);
    assert_eq!(
        names(&model),
        ["P1", "P1.coil", "P1.valve", "P1.valve.seat", "Main", "Spare", "Other", "Other.seat"]
    );
    let port = |component: &str, port: &str| -> &str {
        let id = model.component_named(component).expect("a component");
        let ports = &model.component(id).expect("a component").ports;
        let (_, other) = ports.iter().find(|(known, _)| known == port).expect("a port");
        &model.component(*other).expect("a component").name
    };
    assert_eq!(port("P1.coil", "power"), "Main");
    assert_eq!(port("P1.coil", "housing"), "P1");
    assert_eq!(port("P1.valve", "coil"), "P1.coil");
    assert_eq!(port("P1.valve", "seat"), "P1.valve.seat");
    assert_eq!(port("Other", "coil"), "P1.coil");
    assert!(model.variable_named("P1.coil.heat").is_some());
    assert_eq!(plant::groups(&model).len(), 1, "a part belongs to its owner");
    // The prior of a part.
    let belief = Belief::initial(&model, 100).expect("possible");
    assert_eq!(belief.len(), 4);
}

#[test]
fn guards_reach_parts_of_parts() {
    let model = model(&PUMP.replace("INIT Dry 0.5 Wet 0.5", ""));
    let goal = model.component_mode("P1", "Running").map(|(id, mode)| plant::Goal::mode(id, mode));
    let planner = plant::Planner::new(&std::sync::Arc::new(model.clone()));
    let plan = planner.reconfigure(&model.initial_state(), &[goal.expect("a goal")]).expect("a plan");
    let commands: Vec<String> = plan
        .commands(&model)
        .into_iter()
        .map(|command| format!("{} {}", command.component, command.command))
        .collect();
    assert_eq!(commands, ["P1.valve open", "P1 start"]);
    // A fault of the coil is possible only while the pump that it is in runs.
    let running = model.state_from_names([("P1", "Running")]).expect("a state");
    let coil = model.component_named("P1.coil").unwrap_or(ComponentId(0));
    let burnt = |state| {
        let next = update_exact(&model, &Belief::certain(state), &model.idle(), &Observation::default())
            .expect("update");
        next.marginal(&model, coil)[1].low.to_string()
    };
    assert_eq!((burnt(running), burnt(model.initial_state())), ("1/10".to_owned(), "0".to_owned()));
}

#[test]
fn a_more_specific_class_replaces_a_part() {
    let model = model(
        "(DEFCLASS Seat () (MODE Dry true)) (DEFCLASS Gold (Seat) (MODE Shiny true) (FAULT Dry Shiny 0.1))
         (DEFCLASS Valve () (PART seat Seat) (MODE Closed true))
         (DEFCLASS Fine (Valve) (PART seat Gold INIT Shiny) (PART ring Seat))
         (DEFINSTANCE V Fine)",
    );
    assert_eq!(names(&model), ["V", "V.seat", "V.ring"]);
    assert_eq!(model.state_names(&model.initial_state())["V.seat"], "Shiny");
}

#[test]
fn each_mistake_with_parts_gives_one_diagnostic() {
    for (text, code) in [
        ("(DEFCLASS A () (PART b B) (MODE M true)) (DEFCLASS B () (PART a A) (MODE M true))", "E-RECURSION"),
        ("(DEFCLASS A () (PART a A) (MODE M true)) (DEFINSTANCE a A)", "E-RECURSION"),
        ("(DEFCLASS A () (PART b B) (MODE M true))", "E-UNDEF"),
        ("(DEFCLASS A () (PART b B INIT N) (MODE M true)) (DEFCLASS B () (MODE M true))", "E-UNDEF"),
        ("(DEFCLASS A () (PART b B) (VAR b {x}) (MODE M true)) (DEFCLASS B () (MODE M true))", "E-DUP"),
        ("(DEFCLASS A () (PART b B) (MODE M (b = N))) (DEFCLASS B () (MODE M true))", "E-VALUE"),
        ("(DEFCLASS A () (PART b B) (MODE M (b.v = N))) (DEFCLASS B () (MODE M true))", "E-UNDEF"),
        ("(DEFCLASS A () (PART b B) (MODE M true)) (DEFCLASS B () (PORT p A) (MODE M true))", "E-ARITY"),
        (
            "(DEFCLASS A () (PART b B (p c)) (MODE M true)) (DEFCLASS B () (PORT p A) (MODE M true))",
            "E-UNDEF",
        ),
        (
            "(DEFCLASS A () (PART b B (p b)) (MODE M true)) (DEFCLASS B () (PORT p A) (MODE M true))",
            "E-VALUE",
        ),
        (
            "(DEFCLASS A () (PART b B) (MODE M true)) (DEFCLASS B () (MODE M true)) (DEFINSTANCE a A) (DEFINSTANCE a.b B)",
            "E-DUP",
        ),
    ] {
        let parsed = rmpl::control::parse(text);
        assert_eq!(parsed.diagnostics, [], "{text}");
        let found = compile(&parsed.file).1;
        assert_eq!(found.iter().map(|found| found.code.0).collect::<Vec<_>>(), [code], "{text}: {found:?}");
    }
}

/// Each connection refers to the previous one twice.
#[test]
fn connections_that_rest_on_each_other_are_followed_once() {
    let mut text = "(DEFCLASS P () (PORT w P) (MODE M true))
        (DEFCLASS K () (PORT u K) (PORT d K) (PART p P (w u.p.w.p.w.d)) (MODE M true))"
        .to_owned();
    for at in 0..40_usize {
        text += &format!("(DEFINSTANCE i{at} K (u i{}) (d i{}))", at.saturating_sub(1), (at + 1).min(39));
    }
    let parsed = rmpl::control::parse(&text);
    // It ends, whatever it says of connections that lead in a circle.
    let (_, found) = compile(&parsed.file);
    assert!(found.len() < 1000, "{found:?}");
}
