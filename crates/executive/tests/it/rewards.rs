//! Choices by rewards: those of a direct evaluation of all runs, in exact numbers (SPEC 8.5).

use std::sync::Arc;

use executive::model_based::proof::{Property, Scope, Verdict, prove};
use executive::model_based::{Knowledge, Options, Run, StepInput, System};
use hca::{Automaton, ChosenBy, Standing, Stepper, TestId, TraceStep, locks};
use num_traits::{One as _, Zero as _};
use plant::{Commands, Goal, Probability, Random, State, targets};
use rmpl::control::{Constraint, ConstraintKind};

fn system(program: &str, plant: &str) -> Arc<System> {
    let compilation = System::compile(program, Some(plant));
    assert_eq!(compilation.program_diagnostics, [], "{program}");
    assert_eq!(compilation.model_diagnostics, [], "{plant}");
    compilation.system.expect("it compiles")
}

fn pick<'text>(random: &mut Random, from: &[&'text str]) -> &'text str {
    from[random.below(from.len() as u64) as usize]
}

/// Two components with an observable part, outcomes and faults.
fn plant(random: &mut Random) -> String {
    let mut text = String::new();
    for name in ["A", "B"] {
        let chance = |random: &mut Random| pick(random, &["0.1", "0.25", "0.5"]);
        let guard =
            if name == "B" && random.below(2) == 0 { "((cmd = on) AND (feed = On))" } else { "(cmd = on)" };
        let port = if name == "B" { "(PORT feed ClassA)" } else { "" };
        text.push_str(&format!(
            "(DEFCLASS Class{name} () {port} (VAR v {{lo hi}} OBSERVABLE ERROR 0.2) (COMMAND cmd {{none on off}})
  (MODE Off (v = lo)) (MODE On (v = hi)) (MODE Broken true)
  (TRANSITION Off On {guard}) (TRANSITION Off Broken {guard} {}) (TRANSITION On Off (cmd = off))
  (FAULT {} Broken {}))\n",
            chance(random),
            pick(random, &["On", "Off"]),
            chance(random),
        ));
    }
    let prior = pick(random, &["Off 0.7 On 0.3", "Off 1/3 On 1/3 Broken 1/3", "Off"]);
    text + &format!(
        "(DEFINSTANCE A ClassA INIT {prior}) (DEFINSTANCE B ClassB (feed A) INIT Off 0.6 On 0.4)\n"
    )
}

fn constraint(random: &mut Random) -> String {
    format!("({} = {})", pick(random, &["A", "B"]), pick(random, &["On", "Off", "Broken"]))
}

fn body(random: &mut Random, depth: u32) -> String {
    if depth == 0 {
        return match random.below(3) {
            0 => format!("(REWARD {})", random.below(4)),
            1 => format!("({} = {})", pick(random, &["A", "B"]), pick(random, &["On", "Off"])),
            _ => "true".into(),
        };
    }
    let (first, second) = (body(random, depth - 1), body(random, depth - 1));
    match random.below(11) {
        0 => format!("(PARALLEL {first} {second})"),
        1 | 2 => format!("(SEQUENCE {first} {second})"),
        3 => format!("(IF-THENNEXT-ELSENEXT {} {first} {second})", constraint(random)),
        4 => format!("(WHEN-DONEXT {} {first})", constraint(random)),
        5 => format!("(TIMEOUT 2 {first} {second})"),
        6 => format!("(DO-WATCHING {} {first})", constraint(random)),
        7 => format!("(CHOOSE-PROB (0.25 {first}) (0.75 {second}))"),
        8 => format!("(LOCK (A = On) {first})"),
        _ => choice(random, depth),
    }
}

fn choice(random: &mut Random, depth: u32) -> String {
    let mut text = "(CHOOSE-REWARD".to_owned();
    for _ in 0..2 + random.below(2) {
        let reward = pick(random, &["-2", "0", "1", "2.5", "4"]);
        text.push_str(&format!(" ({reward} {})", body(random, depth - 1)));
    }
    text + ")"
}

/// All runs of a program with a plant that is seen.
struct Direct<'program> {
    system: &'program System,
    stepper: Stepper,
}

impl Direct<'_> {
    fn goals(&self) -> Vec<Goal> {
        let model = &self.system.model;
        let marked = self.stepper.marking().iter().filter(|it| !self.stepper.aside().contains(*it));
        let mut goals: Vec<Goal> = marked
            .filter_map(|id| self.system.automaton.location(id)?.assertion.as_ref())
            .filter_map(|it| match &self.system.automaton.guard(it.test)?.constraint.kind {
                ConstraintKind::Equals { variable, value } => {
                    let component = model.component_named(&variable.text)?;
                    Some(Goal::mode(component, model.mode_named(component, &value.text)?))
                }
                _ => None,
            })
            .collect();
        goals.sort_unstable();
        goals.dedup();
        goals
    }

    fn commands(&self, state: &State) -> Commands {
        self.system.planner.next_commands(state, &self.goals()).commands
    }

    /// The best expected sum of rewards from a standing and a state on, in so many steps.
    fn value(&mut self, standing: &Standing, state: &State, steps: u32) -> Probability {
        self.stepper.return_to(standing);
        if let Some(choice) = self.stepper.open_choice().cloned() {
            let mut alternatives = Vec::new();
            let count = self.system.automaton.composite(choice.composite).expect("a choice").children.len();
            for alternative in 0..count {
                self.stepper.return_to(standing);
                self.stepper.choose(alternative);
                let chosen = self.stepper.standing();
                alternatives.push(self.value(&chosen, state, steps));
            }
            return match &choice.by {
                ChosenBy::Reward(_) => alternatives.into_iter().max().expect("alternatives"),
                ChosenBy::Chance(weights) => {
                    let total: u64 = weights.iter().sum();
                    let weighted = alternatives.into_iter().zip(weights);
                    weighted.map(|(value, weight)| value * share(*weight, total)).sum()
                }
            };
        }
        locks::set_aside(&mut [&mut self.stepper]);
        let is_deadlock = locks::deadlock(&[&mut self.stepper]).is_some();
        if steps == 0 || self.stepper.is_done() || is_deadlock {
            return Probability::zero();
        }
        let before = self.stepper.standing();
        let commands = self.commands(state);
        let mut sum = fraction(&self.system.automaton.reward(self.stepper.marking()).to_string());
        let each: Vec<Vec<(u8, Probability)>> = self
            .system
            .model
            .component_ids()
            .map(|id| {
                let targets = targets(&self.system.model, id, state, &commands).expect("targets");
                let total = targets.iter().map(|target| target.weight).sum();
                targets.iter().map(|target| (target.mode, share(target.weight, total))).collect()
            })
            .collect();
        for (first, one) in &each[0] {
            for (second, other) in &each[1] {
                let after = State(vec![*first, *second]);
                let automaton = Arc::clone(&self.system.automaton);
                let holds = |test: TestId| holds(self.system, &automaton, test, &after);
                self.stepper.return_to(&before);
                let mut trace = TraceStep::default();
                self.stepper.step_told(&holds, &mut trace);
                locks::grant(&mut [&mut self.stepper]);
                let next = self.stepper.standing();
                let later = fraction(&trace.reward.to_string()) + self.value(&next, &after, steps - 1);
                sum += later * one * other;
            }
        }
        sum
    }
}

fn share(weight: u64, total: u64) -> Probability {
    Probability::new(weight.into(), total.into())
}

/// A decimal, exactly.
fn fraction(text: &str) -> Probability {
    let (whole, decimals) = text.split_once('.').unwrap_or((text, ""));
    let digits: i64 = format!("{whole}{decimals}").parse().expect("a decimal");
    Probability::new(digits.into(), 10_i64.pow(decimals.len() as u32).into())
}

fn holds(system: &System, automaton: &Automaton, test: TestId, state: &State) -> bool {
    fn satisfied(system: &System, constraint: &Constraint, state: &State) -> bool {
        match &constraint.kind {
            ConstraintKind::True => true,
            ConstraintKind::Equals { variable, value } => {
                let component = system.model.component_named(&variable.text).expect("a component");
                system.model.mode_name(component, state.mode(component)) == value.text
            }
            other => panic!("the programs have no {other:?}"),
        }
    }
    satisfied(system, &automaton.guard(test).expect("a guard").constraint, state)
}

#[test]
fn choices_by_rewards_are_those_of_a_direct_evaluation_of_all_runs() {
    const HORIZON: u32 = 4;
    let mut chosen = [0; 3];
    for seed in 0..150 {
        let mut random = Random::new(seed);
        let model = plant(&mut random);
        let program = format!("(DEFOPTION horizon {HORIZON}) (SEQUENCE true {})", choice(&mut random, 3));
        let system = system(&program, &model);
        let mut run = Run::new(&system, Options::default());
        run.step(&StepInput::default()).expect("a step");
        let belief = run.belief().clone();
        assert!(run.step(&StepInput::default()).is_ok(), "seed {seed}: {program}");
        let made = &run.records()[1].chosen[0];
        let mut direct = Direct { system: &system, stepper: Stepper::undecided(&system.automaton) };
        direct.stepper.step_told(&|_| true, &mut hca::Unobserved);
        let standing = direct.stepper.standing();
        let mut expected = Vec::new();
        for alternative in 0..made.expected.len() {
            let mut sum = Probability::zero();
            let mut whole = Probability::zero();
            for (state, probability) in belief.states() {
                direct.stepper.return_to(&standing);
                direct.stepper.choose(alternative);
                let begun = direct.stepper.standing();
                let probability = probability.exact().expect("nothing is dropped").clone();
                sum += direct.value(&begun, &state, HORIZON) * &probability;
                whole += probability;
            }
            assert!(whole.is_one());
            expected.push(sum);
        }
        let best = expected.iter().max().expect("alternatives");
        let first = expected.iter().position(|value| value == best).expect("the best");
        assert_eq!(made.alternative, first, "seed {seed}: {model}{program}");
        for (found, value) in made.expected.iter().zip(&expected) {
            let found = Probability::new(found.numerator().into(), found.denominator().into());
            let difference = if found > *value { &found - value } else { value - &found };
            assert!(
                difference <= fraction("0.000001"),
                "seed {seed}: {found} is not {value}\n{model}{program}"
            );
        }
        assert_eq!((made.horizon, made.is_shortened), (HORIZON, false));
        chosen[first] += 1;
    }
    assert!(chosen.iter().all(|count| *count > 10), "all alternatives are chosen: {chosen:?}");
}

/// A camera whose way to a picture takes two steps, and one that fails.
const CAMERAS: &str = "(DEFCLASS Camera () (VAR light {dark lit} OBSERVABLE) (COMMAND cmd {none on})
  (MODE Off (light = dark)) (MODE On (light = lit)) (MODE Dead (light = dark))
  (TRANSITION Off On (cmd = on)) (TRANSITION Off Dead (cmd = on) 0.5))
(DEFINSTANCE Near Camera) (DEFINSTANCE Far Camera)";

#[test]
fn a_certain_small_reward_is_chosen_before_an_unlikely_one_and_after_a_short_horizon() {
    let choose = |horizon: u32| {
        let text = format!(
            "(DEFOPTION horizon {horizon}) (CHOOSE-REWARD (3 (SEQUENCE (WAIT 3) (REWARD 1))) (7 (Near = On)))"
        );
        let mut run = Run::new(&system(&text, CAMERAS), Options::default());
        run.step(&StepInput::default()).expect("a step").chosen[0].describe()
    };
    assert_eq!(choose(10), "alternative 1 of choose by reward 3, 7: 4, 3.5 expected within 10 steps");
    // The wait is not over within three steps.
    assert_eq!(choose(3), "alternative 2 of choose by reward 3, 7: 0, 3.5 expected within 3 steps");
    assert_eq!(choose(1), "alternative 2 of choose by reward 3, 7: 0, 3.5 expected within 1 step");
}

#[test]
fn going_back_restores_the_choices_that_led_into_a_step() {
    let text = "(SEQUENCE true (CHOOSE-REWARD (1 (Near = On)) (2 true)))";
    let mut run = Run::new(&system(text, CAMERAS), Options::default());
    let nothing = StepInput::default();
    let first = run.step(&nothing).expect("a step").clone();
    let second = run.step(&nothing).expect("a step").clone();
    assert_eq!((first.chosen.len(), second.chosen.len(), second.chosen[0].alternative), (0, 1, 1));
    assert!(run.step_back() && run.step_back());
    assert_eq!(*run.step(&nothing).expect("a step"), first);
    assert_eq!(*run.step(&nothing).expect("a step"), second);
    assert_eq!(run.reward().to_string(), "2");
}

#[test]
fn a_horizon_with_too_many_combinations_is_shortened_and_the_run_says_so() {
    let lamps: String = (0..17).map(|at| format!("(DEFINSTANCE L{at} Lamp) ")).collect();
    let model = format!(
        "(DEFCLASS Lamp () (COMMAND cmd {{none on}}) (MODE Off true) (MODE On true) (MODE Dead true)
  (TRANSITION Off On (cmd = on)) (FAULT On Dead 0.1)) {lamps}"
    );
    let goals: String = (0..17).map(|at| format!("(SEQUENCE (L{at} = On) (ALWAYS (L{at} = On)))")).collect();
    let text = format!("(CHOOSE-REWARD (1 (PARALLEL {goals})) (1 true))");
    let mut run = Run::new(&system(&text, &model), Options::default());
    let made = run.step(&StepInput::default()).expect("a step").chosen[0].clone();
    // After the first step every lamp may fail in the second, which is more than is followed.
    assert_eq!((made.alternative, made.horizon, made.is_shortened), (1, 1, true));
    assert!(made.describe().ends_with("0, 1 expected within 1 step (horizon shortened: too many states)"));
}

#[test]
fn a_proof_follows_the_choices_that_the_executive_makes() {
    let text = "(SEQUENCE (CHOOSE-REWARD (1 (Near = On)) (9 (Far = On))) true)";
    let system = system(text, CAMERAS);
    let properties = ["never Near = On", "eventually Far = On"];
    let properties = properties.map(|text| Property::read(text, &system).expect("a property"));
    let proof = prove(&system, &properties, Scope::default(), &mut |_| true).expect("a proof");
    assert_eq!(proof.verdicts[0].1, Verdict::Holds, "it never chooses the near camera");
    let Verdict::Broken(run) = &proof.verdicts[1].1 else { panic!("{:?}", proof.verdicts[1]) };
    assert!(run.start.choices.is_empty() && run.moves.iter().all(|by| by.choices.is_empty()));
    let chance = executive::model_based::proof::chance_to_end(&system, Knowledge::Estimated, 10, 1000);
    assert_eq!(chance.expect("a chance").to_string(), "1/2");
}
