//! Many runs of a control program whose components fail by chance, made by the core a few at a time.

use std::collections::BTreeMap;

use executive::model_based::{Options, ProgramTally, StepInput, System, Trials, sample};
use link::ProgramChance;
use smol_str::SmolStr;

use crate::control::{Control, read_control};

/// Makes runs from number `from` on, until `go_on` returns false after a run. The error tells why no run is possible.
pub fn sample_program(
    source: &str,
    chance: &ProgramChance,
    from: u64,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<ProgramTally, String> {
    sample_control(&read_control(source, chance.plant.as_deref()).0, chance, from, go_on)
}

/// The same of a text that was read already.
pub(crate) fn sample_control(
    control: &Control,
    chance: &ProgramChance,
    from: u64,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<ProgramTally, String> {
    let system = control.system()?;
    let inputs = inputs(system, &chance.injected)?;
    let trials = Trials {
        options: Options::default(),
        seed: chance.seed,
        most_steps: chance.most_steps,
        inputs: &inputs,
    };
    sample(system, &trials, from..chance.runs, go_on).map_err(|error| error.to_string())
}

fn inputs(
    system: &System,
    injected: &BTreeMap<u32, BTreeMap<SmolStr, SmolStr>>,
) -> Result<BTreeMap<u32, StepInput>, String> {
    let mut inputs: BTreeMap<u32, StepInput> = BTreeMap::new();
    for (step, modes) in injected {
        for (component, mode) in modes {
            let (component, mode) = system.model.component_mode(component, mode)?;
            inputs.entry(*step).or_default().injected.insert(component, mode);
        }
    }
    Ok(inputs)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAMP: &str = "Main ():: (Lamp = On)
        (DEFCLASS Lamp () (VAR light {dark bright} OBSERVABLE) (COMMAND cmd {none on})
          (MODE Off (light = dark)) (MODE On (light = bright)) (MODE Burnt (light = dark))
          (TRANSITION Off On (cmd = on)) (FAULT Off Burnt 1/4))
        (DEFINSTANCE Lamp Lamp INIT Off)";

    fn chance(runs: u64) -> ProgramChance {
        ProgramChance { plant: None, runs, seed: 5, most_steps: 10, injected: BTreeMap::new() }
    }

    /// The lamp either burns out in the first step, one time in four, or is on for good.
    #[test]
    fn the_share_of_runs_that_end_is_near_what_it_must_be() {
        let tally = sample_program(LAMP, &chance(2000), 0, &mut || true).expect("runs");
        let (low, high) = tally.interval();
        assert!(low < 0.75 && 0.75 < high && high - low < 0.05, "{tally:?}");
        assert_eq!(tally.faults["Lamp=Burnt"].runs, 2000 - tally.reached);
        assert_eq!(tally.stuck["assert Lamp=On"], 2000 - tally.reached);
    }

    #[test]
    fn runs_stop_when_asked_to_and_go_on_where_they_stopped() {
        let mut left = 3;
        let mut go_on = || {
            left -= 1;
            left > 0
        };
        let mut tally = sample_program(LAMP, &chance(50), 0, &mut go_on).expect("runs");
        assert_eq!(tally.runs, 3);
        tally.merge(&sample_program(LAMP, &chance(50), 3, &mut || true).expect("runs"));
        assert_eq!(tally, sample_program(LAMP, &chance(50), 0, &mut || true).expect("runs"));
    }

    #[test]
    fn what_is_injected_happens_in_every_run() {
        let mut chance = chance(20);
        chance.injected.entry(1).or_default().insert("Lamp".into(), "Burnt".into());
        let tally = sample_program(LAMP, &chance, 0, &mut || true).expect("runs");
        assert_eq!((tally.reached, tally.faults.len()), (0, 0), "{tally:?}");
        chance.injected.entry(1).or_default().insert("Lamp".into(), "Brunt".into());
        let error = sample_program(LAMP, &chance, 0, &mut || true).expect_err("no such mode");
        assert!(error.contains("did you mean `Burnt`"), "{error}");
    }
}
