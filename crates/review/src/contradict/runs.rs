//! Undisturbed runs of a plan: the environment chooses all its durations within their ranges, and vehicles drive.

use exact::Time;
use executive::Script;
use executive::world::{abort_name, natures_ranges};
use plant::Random;
use rmpl::program::Controllability;
use smol_str::SmolStr;
use tpn::{Network, Plan};

/// Makes the script of one run after the other.
pub(super) struct Runs {
    /// What the environment chooses in the plan, with the ranges.
    natures: Vec<(SmolStr, [Time; 2])>,
    /// Whether runs of other seeds differ although the environment chooses nothing.
    has_drives: bool,
    chance: Random,
    seed: u64,
    made: u64,
}

impl Runs {
    pub(super) fn new(network: &Network, plan: &Plan, has_drives: bool, seed: u64) -> Self {
        let is_asked = network.controllability != Controllability::None;
        let is_selected = |it: &&tpn::Occurrence| {
            it.arc.is_some_and(|arc| plan.selected_arcs.get(arc.index()) == Some(&true))
        };
        let durations = natures_ranges(network).filter(|(it, _)| is_asked && is_selected(it));
        let durations = durations.map(|(it, range)| (it.name.clone(), range));
        let aborts = network.occurrences.iter().filter(is_selected);
        let aborts = aborts.filter_map(|it| Some((abort_name(it), it.aborts?)));
        let natures = durations.chain(aborts).collect();
        Self { natures, has_drives, chance: Random::new(!seed), seed, made: 0 }
    }

    /// The next one; `None` if it would be no other run than those before.
    pub(super) fn next(&mut self) -> Option<Script> {
        let number = self.made;
        self.made += 1;
        let script = Script { run_seed: Some(self.seed.wrapping_add(number)), ..Script::default() };
        if self.natures.is_empty() {
            return (number == 0 || self.has_drives).then_some(script);
        }
        Some(match (number, number % 4) {
            (0, _) => self.with_nature(script, |_, [least, _]| least),
            (1, _) => self.with_nature(script, |_, [_, greatest]| greatest),
            (_, 2) => Script { adversary: true, ..script },
            (_, 3) => {
                let ends: Vec<bool> = self.natures.iter().map(|_| self.chance.below(2) == 1).collect();
                self.with_nature(script, |at, [least, greatest]| if ends[at] { greatest } else { least })
            }
            (_, 0) => {
                let alone = self.chance.below(self.natures.len() as u64) as usize;
                let is_late = self.chance.below(2) == 1;
                self.with_nature(
                    script,
                    |at, [least, greatest]| {
                        if (at == alone) == is_late { greatest } else { least }
                    },
                )
            }
            _ => script,
        })
    }

    fn with_nature(&self, script: Script, choose: impl Fn(usize, [Time; 2]) -> Time) -> Script {
        let chosen = self.natures.iter().enumerate();
        let nature = chosen.map(|(at, (name, range))| (name.clone(), choose(at, *range))).collect();
        Script { nature, ..script }
    }
}
