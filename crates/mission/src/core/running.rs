//! Requests that execute the plan of a text: once as it is watched, or many times with chance.

use std::sync::Arc;

use executive::Script;
use rmpl::program::Program;
use terrain::Terrain;
use tpn::Network;

use super::{Core, Surroundings, compile};
use crate::execution::{self, Execution};
use crate::planning::{self, Planned};
use crate::request::{Response, Update};
use crate::robustness::{RobustnessSettings, Tally, Uncertainty};
use crate::sampling::Sampler;
use crate::snapshot::MapKey;

/// A plan made ready for runs with chance, and what it belongs to.
pub(super) struct Sampled {
    revision: u64,
    uncertainty: Uncertainty,
    sampler: Sampler,
}

/// A text worked out without telling anybody.
struct Worked {
    program: Arc<Program>,
    network: Arc<Network>,
    ground: Option<(MapKey, Arc<Terrain>)>,
    planned: Planned,
}

/// Runs are made for about this long before the answer says how far they got.
const SAMPLING_MILLIS: f64 = 120.0;

impl Worked {
    fn problem(&self, update: &Update) -> planning::Problem<'_> {
        planning::Problem {
            network: &self.network,
            program: &self.program,
            ground: self.ground.as_ref().map(|(key, map)| (key, map)),
            options: kirk::Options { search: update.search, ..kirk::Options::default() },
            seed: update.seed,
            facts: None,
        }
    }
}

impl Core {
    pub(super) fn execute(&mut self, update: &Update, script: Script, surroundings: &mut dyn Surroundings) {
        let revision = update.revision;
        let Some(worked) = self.work_out(update, surroundings) else { return };
        let executed = worked.and_then(|worked| {
            let unknown = execution::unknown(&worked.network, &worked.program, &script.disturbances);
            if !unknown.is_empty() {
                return Err(format!("the mission has no {}", unknown.join(", ")));
            }
            let programs = crate::programs::Programs::compile(&worked.program).0;
            let unknown = programs.unknown_faults(&worked.network, &script.disturbances);
            if !unknown.is_empty() {
                return Err(format!("the mission has no {}", unknown.join(", ")));
            }
            let problem = worked.problem(update);
            let disturbances = &script.disturbances;
            execution::execute(&problem, &worked.planned, disturbances, &mut self.grounds, &mut self.paths)
                .ok_or_else(|| NO_PLAN.to_owned())?
                .map(|ran| Execution::new(revision, script, &worked.program, &worked.planned, ran))
                .map_err(|error| error.to_string())
        });
        surroundings.answer(match executed {
            Ok(execution) => Response::Execution(Arc::new(execution)),
            Err(reason) => Response::NotExecuted { revision, reason },
        });
    }

    pub(super) fn sample(
        &mut self,
        update: &Update,
        settings: RobustnessSettings,
        from: u64,
        surroundings: &mut dyn Surroundings,
    ) {
        let revision = update.revision;
        let Some(worked) = self.work_out(update, surroundings) else { return };
        let sampled =
            worked.and_then(|worked| self.sample_worked(&worked, update, &settings, from, surroundings));
        surroundings.answer(match sampled {
            Ok(tally) => Response::Sampled { revision, settings: Box::new(settings), from, tally },
            Err(reason) => Response::NotExecuted { revision, reason },
        });
    }

    fn sample_worked(
        &mut self,
        worked: &Worked,
        update: &Update,
        settings: &RobustnessSettings,
        from: u64,
        surroundings: &mut dyn Surroundings,
    ) -> Result<Tally, String> {
        let begun = surroundings.now_millis();
        let is_known = self.sampler.as_ref().is_some_and(|known| {
            known.revision == update.revision && known.uncertainty == settings.uncertainty
        });
        if !is_known {
            let sampler = Sampler::new(&worked.program, &worked.planned, &settings.uncertainty)
                .ok_or_else(|| NO_PLAN.to_owned())?
                .map_err(|error| error.to_string())?;
            let uncertainty = settings.uncertainty.clone();
            self.sampler = Some(Sampled { revision: update.revision, uncertainty, sampler });
        }
        let mut tally = Tally::default();
        let Some(Sampled { sampler, .. }) = &self.sampler else { return Ok(tally) };
        let problem = worked.problem(update);
        for number in from..settings.runs {
            sampler
                .run(&problem, settings, number, &mut self.grounds, &mut self.paths, &mut tally)
                .map_err(|error| error.to_string())?;
            if surroundings.now_millis() - begun > SAMPLING_MILLIS || surroundings.is_superseded() {
                break;
            }
        }
        Ok(tally)
    }

    /// Works a text out up to its plan; `None` if that was given up for a newer request, an error if it has none.
    fn work_out(
        &mut self,
        update: &Update,
        surroundings: &mut dyn Surroundings,
    ) -> Option<Result<Worked, String>> {
        if rmpl::control::is_control_text(&update.source) {
            return Some(Err("a control program is stepped, not executed".to_owned()));
        }
        let parse = rmpl::parse(&update.source);
        let program = Arc::new(parse.program());
        let mut diagnostics = parse.diagnostics();
        let Some(network) = compile(&program, &update.goal, &mut diagnostics) else {
            return Some(Err("the mission has errors".to_owned()));
        };
        let network = Arc::new(network);
        let (ground, _) = self.grounds.resolve(&program.world);
        let planned = self.plan(update, &network, &program, ground.as_ref(), surroundings)?;
        Some(Ok(Worked { program, network, ground, planned }))
    }
}

const NO_PLAN: &str = "there is no plan to execute";
