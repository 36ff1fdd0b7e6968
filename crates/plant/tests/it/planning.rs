//! Reactive plans: the examples of SPEC 9.2, and random plants against breadth-first search over whole states.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::{fmt::Write as _, path::Path};

use plant::{Goal, Model, Planner, Random, State, compile, successor};

fn model(text: &str) -> Model {
    let parsed = rmpl::control::parse(text);
    assert_eq!(parsed.diagnostics, [], "{text}");
    let (model, diagnostics) = compile(&parsed.file);
    assert!(
        diagnostics.iter().all(|diagnostic| diagnostic.severity != rmpl::Severity::Error),
        "{diagnostics:?}"
    );
    model.expect("a model")
}

fn orbit() -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/conformance/orbit_plant.rmpl");
    model(&std::fs::read_to_string(path).expect("the plant of the suite"))
}

fn commands(
    model: &Model,
    state: &[(&str, &str)],
    goals: &[(&str, &str)],
) -> Result<Vec<String>, Vec<String>> {
    let state = model.state_from_names(state.iter().copied()).expect("state");
    let goals: Vec<Goal> = goals
        .iter()
        .map(|(name, mode)| {
            let (component, mode) = model.component_mode(name, mode).expect("goal");
            Goal::mode(component, mode)
        })
        .collect();
    match Planner::new(&Arc::new(model.clone())).reconfigure(&state, &goals) {
        Ok(plan) => Ok(plan
            .commands(model)
            .into_iter()
            .map(|command| format!("{} {}", command.component, command.command))
            .collect()),
        Err(failed) => Err(failed.into_iter().map(|failed| failed.reason).collect()),
    }
}

#[test]
fn the_sequences_of_the_paper_are_found() {
    let model = orbit();
    let closed = [("ValveA", "Closed"), ("DriverA", "Off")];
    assert_eq!(
        commands(&model, &[("ValveA", "Open"), ("DriverA", "On")], &closed),
        Ok(vec!["ValveA close".into(), "DriverA off".into()])
    );
    assert_eq!(
        commands(&model, &[("ValveA", "Open"), ("DriverA", "Off")], &closed),
        Ok(vec!["DriverA on".into(), "ValveA close".into(), "DriverA off".into()])
    );
    assert_eq!(
        commands(&model, &[], &[("EngineA", "Firing")]),
        Ok(vec!["DriverA on".into(), "EngineA standby".into(), "ValveA open".into(), "EngineA fire".into()])
    );
    assert_eq!(commands(&model, &[("EngineA", "Standby")], &[("EngineA", "Standby")]), Ok(vec![]));
}

#[test]
fn a_goal_out_of_reach_says_why() {
    let model = orbit();
    assert_eq!(
        commands(&model, &[("EngineA", "Failed")], &[("EngineA", "Standby")]),
        Err(vec!["no commanded transition of `EngineA` leads from Failed to Standby".into()])
    );
    let broken = self::model(
        "(DEFCLASS Driver () (COMMAND cmd {none on}) (MODE Off true) (MODE On true) (MODE Dead true)
           (TRANSITION Off On (cmd = on)) (FAULT Off Dead 0.1))
         (DEFCLASS Valve () (PORT driver Driver) (COMMAND cmd {none open}) (MODE Closed true) (MODE Open true)
           (TRANSITION Closed Open ((cmd = open) AND (driver = On))))
         (DEFINSTANCE d Driver) (DEFINSTANCE v Valve (driver d))",
    );
    assert_eq!(
        commands(&broken, &[("d", "Dead")], &[("v", "Open")]),
        Err(vec![
            "`v` goes from Closed to Open only with d=On, which cannot be reached: no commanded transition of `d` leads from Dead to On"
                .into()
        ])
    );
    assert_eq!(
        commands(&broken, &[], &[("v", "Open"), ("d", "Off")]),
        Err(vec!["no commands reach d=Off together with v=Open".into()])
    );
}

#[test]
fn goals_with_nothing_in_common_are_commanded_in_the_same_step() {
    let model = orbit();
    let goals: Vec<Goal> = [("EngineA", "Standby"), ("EngineB", "Standby"), ("Camera", "Off")]
        .into_iter()
        .map(|(name, mode)| {
            model
                .component_mode(name, mode)
                .map(|(component, mode)| Goal::mode(component, mode))
                .expect("goal")
        })
        .collect();
    let next = Planner::new(&Arc::new(model.clone())).next_commands(&model.initial_state(), &goals);
    let names = model.command_names(&next.commands);
    let expected = [("Camera", "turn-off"), ("DriverA", "on"), ("DriverB", "on")];
    assert_eq!(names, expected.map(|(name, command)| (name.to_owned(), command.to_owned())).into());
}

/// A chain of components whose transitions may need modes of earlier ones, many of them one-way.
fn random_model(random: &mut Random) -> String {
    let mut text = String::new();
    for at in 0..3 {
        let (mut ports, mut connected) = (String::new(), String::new());
        for other in 0..at {
            let _ = write!(ports, "(PORT p{other} C{other})");
            let _ = write!(connected, "(p{other} c{other})");
        }
        let mut arcs = String::new();
        for from in 0..3 {
            for to in 0..3 {
                if from == to || random.below(3) == 0 {
                    continue;
                }
                let needs = match random.below(if at == 0 { 1 } else { 4 }) {
                    0 => String::new(),
                    1 => format!(" AND (NOT (p{} = M{}))", random.below(at), random.below(3)),
                    _ => format!(" AND (p{} = M{})", random.below(at), random.below(3)),
                };
                // Each target has its own command, so that no two transitions are enabled at once.
                arcs.push_str(&format!("(TRANSITION M{from} M{to} ((cmd = to{to}){needs}))\n"));
            }
        }
        text.push_str(&format!(
            "(DEFCLASS C{at} () {ports} (COMMAND cmd {{none to0 to1 to2}}) (MODE M0 true) (MODE M1 true) (MODE M2 true) {arcs})
             (DEFINSTANCE c{at} C{at} {connected})\n"
        ));
    }
    text
}

/// All states that single commands can lead to.
fn reachable(model: &Model, from: &State) -> BTreeSet<State> {
    let mut seen = BTreeSet::from([from.clone()]);
    let mut waiting = vec![from.clone()];
    while let Some(state) = waiting.pop() {
        for at in 0..model.command_variables.len() {
            for value in 0..model.command_variables[at].values.len() {
                let mut commands = model.idle();
                commands.0[at] = value as u8;
                let next = model
                    .component_ids()
                    .map(|id| successor(model, id, &state, &commands).expect("deterministic"));
                let next = State(next.collect());
                if seen.insert(next.clone()) {
                    waiting.push(next);
                }
            }
        }
    }
    seen
}

#[test]
fn plans_on_random_plants_reach_their_goals_exactly_where_search_says_they_can() {
    let (mut reached, mut failed) = (0, 0);
    for seed in 0..150 {
        let mut random = Random::new(seed);
        let model = model(&random_model(&mut random));
        let planner = Planner::new(&Arc::new(model.clone()));
        for _ in 0..4 {
            let state = State((0..3).map(|_| random.below(3) as u8).collect());
            let mut goals: BTreeMap<u32, u8> = BTreeMap::new();
            for _ in 0..=random.below(2) {
                goals.insert(random.below(3) as u32, random.below(3) as u8);
            }
            let met =
                |state: &State| goals.iter().all(|(component, mode)| state.0[*component as usize] == *mode);
            let asked: Vec<Goal> = goals
                .iter()
                .map(|(component, mode)| Goal::mode(plant::ComponentId(*component), *mode))
                .collect();
            let possible = reachable(&model, &state).iter().any(met);
            match planner.reconfigure(&state, &asked) {
                Ok(plan) => {
                    let mut at = state.clone();
                    for commands in &plan.steps {
                        let next = model
                            .component_ids()
                            .map(|id| successor(&model, id, &at, commands).expect("deterministic"));
                        at = State(next.collect());
                    }
                    assert!(met(&at), "seed {seed}: {goals:?} from {state:?}");
                    reached += 1;
                }
                Err(unreachable) => {
                    assert!(!possible, "seed {seed}: {goals:?} from {state:?}: {unreachable:?}");
                    assert!(
                        unreachable.iter().all(|failed| !failed.limit_reached && !failed.reason.is_empty())
                    );
                    failed += 1;
                }
            }
        }
    }
    assert!(reached > 100 && failed > 30, "both happen: {reached} and {failed}");
}

/// A bus whose output passes through a relay, and a lamp that is switched on only under voltage.
const FED: &str = "
(DEFCLASS Bus () (VAR out {dead live}) (COMMAND cmd {none on}) (MODE Off (out = dead)) (MODE On (out = live))
  (TRANSITION Off On (cmd = on)))
(DEFCLASS Relay () (PORT feed Bus) (VAR out {dead live}) (COMMAND cmd {none close})
  (MODE Open (out = dead))
  (MODE Closed (((feed.out = live) AND (out = live)) OR ((feed.out = dead) AND (out = dead))))
  (TRANSITION Open Closed (cmd = close)))
(DEFCLASS Lamp () (PORT feed Relay) (COMMAND cmd {none on}) (MODE Off true) (MODE On true)
  (TRANSITION Off On ((cmd = on) AND (feed.out = live))))
(DEFINSTANCE B Bus) (DEFINSTANCE R Relay (feed B)) (DEFINSTANCE L Lamp (feed R))";

#[test]
fn a_guard_that_several_components_make_true_together_is_planned_for() {
    let model = model(FED);
    let mut found = commands(&model, &[], &[("L", "On")]).expect("it can be reached");
    assert_eq!(found.pop().as_deref(), Some("L on"), "{found:?}");
    found.sort();
    assert_eq!(found, ["B on", "R close"]);
}

#[test]
fn a_guard_that_nothing_makes_true_is_a_warning() {
    // No mode says that the relay's output is odd.
    let text = FED.replace(
        "(VAR out {dead live}) (COMMAND cmd {none close})",
        "(VAR out {dead live odd}) (COMMAND cmd {none close})",
    );
    let text = text.replace("(feed.out = live))))", "(feed.out = odd))))");
    let (model, diagnostics) = compile(&rmpl::control::parse(&text).file);
    assert!(model.is_some());
    let found: Vec<&str> = diagnostics.iter().map(|found| found.message.as_str()).collect();
    assert_eq!(
        found,
        ["`L` can never take this transition from Off: its guard cannot become true"],
        "{text}"
    );
}
