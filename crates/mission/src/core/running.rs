//! Requests that execute the plan of a text: once as it is watched, or many times with chance.

use std::sync::Arc;

use executive::Script;
use link::ProgramChance;
use link::{Response, Update};
use rmpl::program::Program;
use snapshot::MapKey;
use snapshot::{RobustnessSettings, Tally};
use terrain::Terrain;
use tpn::Network;

use super::Core;
use crate::execution;
use crate::host::CoreHost;
use crate::planning::{self, Planned};
use crate::program_chance;
use crate::programs::Programs;
use crate::sampling::{Sampled, Sampler};

/// A text with its plan.
pub(super) struct Evaluated {
    pub(super) program: Arc<Program>,
    programs: Arc<Programs>,
    network: Arc<Network>,
    pub(super) ground: Option<(MapKey, Arc<Terrain>)>,
    pub(super) planned: Planned,
}

/// Runs are made for about this long before the answer says how far they got.
const SAMPLING_MILLIS: f64 = 120.0;

impl Evaluated {
    fn problem(&self, update: &Update) -> planning::Problem<'_> {
        planning::Problem {
            ground: self.ground.as_ref().map(|(key, map)| (key, map)),
            options: kirk::Options { search: update.search, ..kirk::Options::default() },
            seed: update.seed,
            programs: Some(&self.programs),
            ..planning::Problem::new(&self.network, &self.program)
        }
    }
}

impl Core {
    pub(super) fn execute(&mut self, update: &Update, script: Script, host: &mut dyn CoreHost) {
        let revision = update.revision;
        let Some(evaluated) = self.evaluate(update, host) else { return };
        let executed = evaluated.and_then(|evaluated| {
            // The plan that is kept is that of the text, and so are its runs.
            if let Some(run) = self.last.as_mut().and_then(|last| last.executions.find(&script, revision)) {
                return Ok(run);
            }
            let Evaluated { network, program, programs, .. } = &evaluated;
            execution::check_disturbances(network, program, programs, &script.disturbances)?;
            let problem = evaluated.problem(update);
            execution::execute(&problem, &evaluated.planned, &script, &mut self.grounds, &mut self.paths)
                .ok_or_else(|| NO_PLAN.to_owned())?
                .map(|ran| {
                    let (program, planned) = (&evaluated.program, &evaluated.planned);
                    let run = Arc::new(execution::executed(revision, script, program, planned, ran));
                    self.last.iter_mut().for_each(|last| last.executions.keep(Arc::clone(&run)));
                    run
                })
                .map_err(|error| error.to_string())
        });
        host.answer(match executed {
            Ok(run) => Response::Execution(run),
            Err(reason) => Response::NotExecuted { revision, reason },
        });
    }

    pub(super) fn sample(
        &mut self,
        update: &Update,
        settings: RobustnessSettings,
        from: u64,
        host: &mut dyn CoreHost,
    ) {
        let revision = update.revision;
        let Some(evaluated) = self.evaluate(update, host) else { return };
        let sampled = evaluated.and_then(|it| self.sample_evaluated(&it, update, &settings, from, host));
        host.answer(match sampled {
            Ok(tally) => Response::Sampled { revision, settings: Box::new(settings), from, tally },
            Err(reason) => Response::NotExecuted { revision, reason },
        });
    }

    fn sample_evaluated(
        &mut self,
        evaluated: &Evaluated,
        update: &Update,
        settings: &RobustnessSettings,
        from: u64,
        host: &mut dyn CoreHost,
    ) -> Result<Tally, String> {
        let begun = host.now_millis();
        let is_known = self.sampler.as_ref().is_some_and(|known| {
            known.revision == update.revision && known.uncertainty == settings.uncertainty
        });
        if !is_known {
            let sampler = Sampler::new(&evaluated.problem(update), &evaluated.planned, &settings.uncertainty)
                .ok_or_else(|| NO_PLAN.to_owned())?
                .map_err(|error| error.to_string())?;
            let uncertainty = settings.uncertainty.clone();
            self.sampler = Some(Sampled { revision: update.revision, uncertainty, sampler });
        }
        let mut tally = Tally::default();
        let Some(Sampled { sampler, .. }) = &self.sampler else { return Ok(tally) };
        let problem = evaluated.problem(update);
        for number in from..settings.runs {
            sampler
                .run(&problem, settings, number, &mut self.grounds, &mut self.paths, &mut tally)
                .map_err(|error| error.to_string())?;
            if host.now_millis() - begun > SAMPLING_MILLIS || host.is_superseded() {
                break;
            }
        }
        Ok(tally)
    }

    /// Runs a control program many times.
    pub(super) fn sample_program(
        &mut self,
        (revision, source): (u64, &Arc<str>),
        chance: ProgramChance,
        from: u64,
        host: &mut dyn CoreHost,
    ) {
        let begun = host.now_millis();
        let control = self.controls.read(source, chance.plant.as_ref());
        let mut go_on = || host.now_millis() - begun <= SAMPLING_MILLIS && !host.is_superseded();
        let tally = program_chance::sample_control(control, &chance, from, &mut go_on);
        host.answer(Response::ProgramSampled { revision, chance, from, tally });
    }

    /// The plan of a text; `None` if that was given up for a newer request, an error if it has none.
    pub(super) fn evaluate(
        &mut self,
        update: &Update,
        host: &mut dyn CoreHost,
    ) -> Option<Result<Evaluated, String>> {
        if rmpl::control::is_control_text(&update.source) {
            return Some(Err("a control program is stepped, not executed".to_owned()));
        }
        self.read(update);
        let (Some(network), _) = self.reading.compile(&update.goal, &mut self.keys) else {
            return Some(Err("the mission has errors".to_owned()));
        };
        let program = self.reading.program().value;
        let programs = self.reading.programs();
        let (ground, _) = self.grounds.resolve(&program.world);
        let planned = self.plan(update, &network, ground.as_ref(), None, host)?.planned.clone();
        Some(Ok(Evaluated { program, programs, network: network.value, ground, planned }))
    }
}

const NO_PLAN: &str = "there is no plan to execute";
