//! Latency of estimation: against the number of components, and on a circuit of 15 breakers and 8 lamps.

#![expect(clippy::print_stdout, reason = "a benchmark prints its table")]

use std::sync::Arc;
use std::{fmt::Write as _, time::Instant};

use plant::{
    Belief, Commands, Model, Observation, SearchStatistics, SimulatedPlant, State, compile, update_best,
    update_exact,
};

const ENGINE: &str = "(DEFCLASS Engine ()
  (VAR thrust {zero full} OBSERVABLE) (VAR power_in {zero nominal} OBSERVABLE)
  (COMMAND cmd {none off standby fire})
  (MODE Off     ((thrust = zero) AND (power_in = zero)))
  (MODE Standby ((thrust = zero) AND (power_in = nominal)))
  (MODE Firing  ((thrust = full) AND (power_in = nominal)))
  (MODE Failed  true)
  (TRANSITION Off Standby (cmd = standby)) (TRANSITION Standby Firing (cmd = fire))
  (TRANSITION Firing Standby (cmd = standby)) (TRANSITION Standby Off (cmd = off))
  (FAULT Standby Failed 0.01) (FAULT Firing Failed 0.01))\n";

fn model(text: &str) -> Model {
    let parsed = rmpl::control::parse(text);
    compile(&parsed.file).0.unwrap_or_else(|| panic!("{:?}", compile(&parsed.file).1))
}

/// A tree of circuit breakers with lamps at its leaves, as Livingstone 2's model `cb` has it.
fn circuit() -> Model {
    let passes = "((feed.out = live) AND (out = live)) OR ((feed.out = dead) AND (out = dead))";
    let breaker = |name: &str, class: &str| {
        format!(
            "(DEFCLASS {name} () (PORT feed {class}) (VAR out {{dead live}}) (COMMAND cmd {{none on off}})
               (MODE On ({passes})) (MODE Off (out = dead)) (MODE Tripped (out = dead)) (MODE Blown (out = dead)) (MODE Unknown true)
               (TRANSITION Off On (cmd = on)) (TRANSITION On Off (cmd = off)) (TRANSITION Tripped Off (cmd = off))
               (FAULT On Tripped 0.01) (FAULT On Blown 0.001) (FAULT On Unknown 0.00001))\n"
        )
    };
    let mut text = String::from(
        "(DEFCLASS Supply () (VAR out {dead live}) (MODE Works (out = live)))\n(DEFINSTANCE supply Supply)\n",
    );
    for level in 0..4 {
        let class = if level == 0 { "Supply".into() } else { format!("Breaker{}", level - 1) };
        text.push_str(&breaker(&format!("Breaker{level}"), &class));
    }
    text.push_str(
        "(DEFCLASS Lamp () (PORT feed Breaker3) (VAR light {dark bright} OBSERVABLE)
           (MODE Works (((feed.out = live) AND (light = bright)) OR ((feed.out = dead) AND (light = dark)))) (MODE Burnt (light = dark))
           (FAULT Works Burnt 0.0001))\n",
    );
    for at in 1..16_u32 {
        let level = at.ilog2();
        let feed = if at == 1 { "supply".into() } else { format!("cb{}", at / 2) };
        text.push_str(&format!("(DEFINSTANCE cb{at} Breaker{level} (feed {feed}) INIT Off)\n"));
    }
    for at in 8..16 {
        text.push_str(&format!("(DEFINSTANCE lamp{at} Lamp (feed cb{at}))\n"));
    }
    model(&text)
}

/// Breakers are switched on level by level; at the fifth step a breaker of the third level has tripped.
fn scenario(model: &Model) -> Vec<(Commands, Observation)> {
    let mut plant = SimulatedPlant::new(&Arc::new(model.clone()), None);
    let mut steps = Vec::new();
    for level in 0..5_u32 {
        let mut commands = model.idle();
        if level < 4 {
            for at in 1_u32 << level..1 << (level + 1) {
                let given = model.commands_from_names([(format!("cb{at}").as_str(), "on")]).expect("breaker");
                commands.0.iter_mut().zip(given.0).for_each(|(slot, value)| *slot = (*slot).max(value));
            }
        }
        let mut injected = std::collections::BTreeMap::new();
        if level == 4 {
            let (component, mode) = model.component_mode("cb5", "Tripped").expect("breaker");
            injected.insert(component, mode);
        }
        plant.step(&commands, &injected).expect("step");
        steps.push((commands, plant.observation()));
    }
    steps
}

fn micros(mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    let begun = Instant::now();
    while begun.elapsed().as_secs_f64() < 0.5 {
        let start = Instant::now();
        work();
        best = best.min(start.elapsed().as_secs_f64() * 1e6);
    }
    best
}

/// With the argument `circuit`, only the circuit is measured.
fn main() {
    if !std::env::args().any(|argument| argument == "circuit") {
        engines();
    }
    breakers_and_lamps();
}

fn engines() {
    println!("{:<28} {:>14} {:>14} {:>14}", "one update, engines", "exact, µs", "1 best, µs", "10 best, µs");
    for count in [1, 2, 4, 8, 16, 50, 100] {
        let mut instances = String::new();
        for at in 0..count {
            let _ = writeln!(instances, "(DEFINSTANCE E{at} Engine INIT Standby)");
        }
        let model = model(&format!("{ENGINE}{instances}"));
        let mut plant = SimulatedPlant::new(&Arc::new(model.clone()), None);
        let fire = Commands(vec![3; count]);
        let (component, failed) = model.component_mode("E0", "Failed").expect("engine");
        plant.step(&fire, &std::iter::once((component, failed)).collect()).expect("step");
        let (belief, observation) = (Belief::certain(model.initial_state()), plant.observation());
        let exact = (count <= 8).then(|| {
            micros(|| {
                assert!(!update_exact(&model, &belief, &fire, &observation).expect("update").is_empty());
            })
        });
        let best = |most: usize| {
            micros(|| {
                let (found, _) =
                    update_best(&model, &belief, &fire, &observation, most, 1_000_000).expect("update");
                assert_eq!(found.most_likely().mode(component), failed);
            })
        };
        let exact = exact.map_or_else(|| "–".to_owned(), |micros| format!("{micros:.1}"));
        println!("{count:<28} {exact:>14} {:>14.1} {:>14.1}", best(1), best(10));
    }
}

fn breakers_and_lamps() {
    let model = circuit();
    let steps = scenario(&model);
    let mut last: Option<Belief> = None;
    let mut belief = Belief::certain(model.initial_state());
    for (step, (commands, observation)) in (1..).zip(&steps) {
        let (next, statistics) =
            update_best(&model, &belief, commands, observation, 5, 1_000_000).expect("update");
        let SearchStatistics { expanded, checked, conflicts, .. } = statistics;
        println!("step {step}: {expanded} nodes expanded, {checked} states checked, {conflicts} conflicts");
        belief = next;
    }
    let micros = micros(|| {
        let mut belief = Belief::certain(model.initial_state());
        for (commands, observation) in &steps {
            belief = update_best(&model, &belief, commands, observation, 5, 1_000_000).expect("update").0;
        }
        last = Some(belief);
    });
    println!(
        "\n15 breakers, 8 lamps: five steps with five ranked candidates in {micros:.1} µs (Livingstone 2: about 1300 µs)"
    );
    let normal = |state: &State| {
        let named = model.state_names(state);
        let odd = named.iter().filter(|(_, mode)| !["On", "Works"].contains(&mode.as_str()));
        odd.map(|(name, mode)| format!("{name}={mode}")).collect::<Vec<_>>().join(", ")
    };
    for (state, probability) in last.iter().flat_map(Belief::states) {
        println!("  {}  {}", normal(state), probability);
    }
}
