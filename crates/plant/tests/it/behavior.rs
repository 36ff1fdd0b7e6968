//! Classes written as programs: their modes by name, and the beliefs of classes written by hand (SPEC 2.2).

use std::collections::BTreeMap;

use plant::{Belief, Model, Random, compile, update_exact};

use crate::estimation::model;

fn modes(class: &str) -> Vec<String> {
    let model = model(&format!("{class} (DEFINSTANCE c C)"));
    model.components[0].modes.iter().map(|mode| mode.name.to_string()).collect()
}

const VARIABLES: &str = "(VAR flow {no yes} OBSERVABLE ERROR 0.1) (VAR light {dark lit} OBSERVABLE) (COMMAND cmd {none open close})";

fn class(body: &str) -> String {
    format!("(DEFCLASS C () {VARIABLES} (BEHAVIOR {body}))")
}

#[test]
fn modes_are_named_by_what_they_assert_breadth_first() {
    for (body, expected) in [
        ("(ALWAYS (flow = no))", vec!["flow=no"]),
        ("(SEQUENCE (flow = no) (flow = yes))", vec!["flow=no", "flow=yes", "ended"]),
        ("(SEQUENCE (WAIT 3) (flow = yes))", vec!["idle", "idle#2", "idle#3", "flow=yes", "ended"]),
        (
            "(PARALLEL (ALWAYS (light = dark)) (SEQUENCE (flow = no) (flow = yes)))",
            vec!["light=dark&flow=no", "light=dark&flow=yes", "light=dark"],
        ),
        (
            "(IF-THENNEXT-ELSENEXT (cmd = open) (ALWAYS (flow = yes)) (ALWAYS (flow = no)))",
            vec!["idle", "flow=yes", "flow=no"],
        ),
        // Both commands at once cannot be given.
        (
            "(PARALLEL (WHEN-DONEXT (cmd = open) (flow = yes)) (WHEN-DONEXT (cmd = close) (flow = yes)))",
            vec!["idle", "flow=yes", "flow=yes#2", "flow=yes#3", "idle#2", "flow=yes#4", "idle#3", "ended"],
        ),
        (
            "(WHEN-DONEXT (HELD 2 (cmd = open)) (ALWAYS (flow = yes)))",
            vec!["idle", "idle#2", "flow=yes", "flow=yes#2", "flow=yes#3"],
        ),
        ("(AT 2 (flow = yes))", vec!["idle", "idle#2", "flow=yes", "ended"]),
    ] {
        assert_eq!(modes(&class(body)), expected, "{body}");
    }
}

/// The probabilities of modes by number after each of some random steps.
fn beliefs(model: &Model, seed: u64) -> Vec<BTreeMap<Vec<u8>, String>> {
    let mut random = Random::new(seed);
    let mut belief = Belief::initial(model, 100).expect("a start");
    let mut told = Vec::new();
    for _ in 0..12 {
        let mut commands = model.idle();
        for (value, variable) in commands.0.iter_mut().zip(&model.command_variables) {
            *value = random.below(variable.values.len() as u64) as u8;
        }
        let mut observation = plant::Observation::default();
        for (id, variable) in (0..).map(plant::VariableId).zip(&model.variables) {
            let value = random.below(variable.values.len() as u64) as u8;
            if variable.observable && random.below(2) == 0 {
                observation.0.insert(id, value);
            }
        }
        // What nothing explains ends a run of both.
        let Ok(next) = update_exact(model, &belief, &commands, &observation) else { return told };
        told.push(
            next.states().map(|(state, probability)| (state.0.clone(), probability.to_string())).collect(),
        );
        belief = next;
    }
    told
}

#[test]
fn a_class_written_as_a_program_has_the_beliefs_of_one_written_by_hand() {
    let wait = "(SEQUENCE (DO-WATCHING (cmd = open) (ALWAYS (flow = no))) (WAIT 2)
      (CHOOSE-PROB (0.7 (DO-WATCHING (cmd = close) (ALWAYS (flow = yes)))) (0.3 (ALWAYS (light = dark)))) (flow = no))";
    let by_hand = "(MODE Closed (flow = no)) (MODE First true) (MODE Second true) (MODE Open (flow = yes))
      (MODE Dark (light = dark)) (MODE Closing (flow = no)) (MODE Ended true)
      (TRANSITION Closed First (cmd = open)) (TRANSITION First Second true)
      (TRANSITION Second Open true 0.7) (TRANSITION Second Dark true 0.3)
      (TRANSITION Open Closing (cmd = close)) (TRANSITION Closing Ended true)";
    let chance =
        "(CHOOSE-PROB (1/3 (SEQUENCE (flow = no) (ALWAYS (flow = yes)))) (2/3 (ALWAYS (flow = no))))";
    let chance_by_hand =
        "(MODE A (flow = no)) (MODE B (flow = no)) (MODE C (flow = yes)) (TRANSITION A C true)";
    for (body, fields, init, more) in
        [(wait, by_hand, "", 20), (chance, chance_by_hand, "INIT A 1/3 B 2/3", 5)]
    {
        let program = model(&format!("{} (DEFINSTANCE c C)", class(body)));
        let written = model(&format!("(DEFCLASS C () {VARIABLES} {fields}) (DEFINSTANCE c C {init})"));
        let mut compared = 0;
        for seed in 0..30 {
            let (left, right) = (beliefs(&program, seed), beliefs(&written, seed));
            assert_eq!(left, right, "seed {seed}: {body}");
            compared += left.len();
        }
        assert!(compared > more, "{compared} steps");
    }
}

#[test]
fn what_a_behavior_cannot_be_is_reported() {
    for (text, code) in [
        (format!("(DEFCLASS C () {VARIABLES} (MODE M true) (BEHAVIOR true))"), "E-FORM"),
        (
            format!(
                "(DEFCLASS B () (MODE M true) (MODE N true) (FAULT M N 0.1)) (DEFCLASS C (B) {VARIABLES} (BEHAVIOR true))"
            ),
            "E-FORM",
        ),
        (class("(REWARD 3)"), "E-FORM"),
        (class("(LOCK (flow = no) (flow = no))"), "E-FORM"),
        (class("(CHOOSE-REWARD (1 (flow = no)) (2 (flow = yes)))"), "E-FORM"),
        (class("(Missing)"), "E-UNDEF"),
        (class("(WAIT 256)"), "E-SIZE"),
        (class("(flow = odd)"), "E-VALUE"),
        (class("(cmd = open)"), "E-CONSTRAINT"),
        (class("(SEQUENCE (WHEN-DONEXT (other = yes) (flow = no)) (flow = yes))"), "E-UNDEF"),
    ] {
        let parsed = rmpl::control::parse(&text);
        let found = compile(&parsed.file).1;
        assert_eq!(found.iter().map(|found| found.code.0).collect::<Vec<_>>(), [code], "{text}: {found:?}");
    }
}

/// 255 steps of waiting and the end are as many modes as a class can have.
#[test]
fn a_behavior_with_256_modes_is_estimated_and_planned_with() {
    let model = std::sync::Arc::new(model(&format!(
        "{} {} (DEFINSTANCE w W) (DEFINSTANCE h H)",
        "(DEFCLASS W () (BEHAVIOR (WAIT 255)))",
        "(DEFCLASS H () (COMMAND cmd {none go stop}) (BEHAVIOR (SEQUENCE
          (WHEN-DONEXT (cmd = go) (WAIT 252)) (DO-WATCHING (cmd = stop) (ALWAYS true)))))",
    )));
    let (waiting, led) = (plant::ComponentId(0), plant::ComponentId(1));
    let modes: Vec<usize> = model.components.iter().map(|component| component.modes.len()).collect();
    assert_eq!(modes, [256, 255]);
    let last = |id: plant::ComponentId| (modes[id.0 as usize] - 1) as u8;
    assert_eq!(model.mode_name(waiting, last(waiting)), "ended");
    let mut belief = Belief::initial(&model, 100).expect("a start");
    for step in 0..=u8::MAX {
        assert_eq!(belief.most_likely().mode(waiting), step);
        let (idle, nothing) = (model.idle(), plant::Observation::default());
        belief = update_exact(&model, &belief, &idle, &nothing).expect("an update");
    }
    assert_eq!(belief.most_likely().mode(waiting), last(waiting));
    assert_eq!(belief.most_likely().mode(led), 0, "nobody commanded it");
    let planner = plant::Planner::new(&model);
    let goal = plant::Goal::mode(led, last(led));
    assert!(planner.may_reach(belief.most_likely(), &goal));
    let plan = planner.reconfigure(belief.most_likely(), &[goal]).expect("a plan");
    assert_eq!(plan.steps.len(), 254, "one step to start, 252 of waiting, and one to stop");
    assert_eq!(planner.policy(waiting, last(waiting), 0), None);
}

#[test]
fn a_behavior_whose_steps_depend_on_very_many_combinations_is_refused() {
    const WATCHED: usize = 25;
    let commands: String = (0..WATCHED).map(|at| format!(" (COMMAND c{at} {{none go}})")).collect();
    let body = (0..WATCHED)
        .fold("(ALWAYS (flow = no))".to_owned(), |inner, at| format!("(DO-WATCHING (c{at} = go) {inner})"));
    let text = format!("(DEFCLASS C () (VAR flow {{no yes}}){commands} (BEHAVIOR {body})) (DEFINSTANCE c C)");
    let found = compile(&rmpl::control::parse(&text).file).1;
    assert_eq!(found.iter().map(|found| found.code.0).collect::<Vec<_>>(), ["E-SIZE"], "{found:?}");
    assert!(found[0].message.contains("combinations of conditions"), "{found:?}");
}
