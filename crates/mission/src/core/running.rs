//! Requests that execute the plan of a text: once as it is watched, or many times with chance.

use std::sync::Arc;

use exact::Time;
use executive::{PlanError, Script};
use link::{ProgramChance, ProofQuestion, Response, Update};
use review::contradict::{Effort, Observed, Trial};
use review::record::LineKey;
use review::{MissionRule, Review};
use snapshot::{RobustnessSettings, Tally};

use super::Core;
use crate::contradicting::{self, Trying};
use crate::evaluated::Evaluated;
use crate::execution::{self, Ran};
use crate::host::CoreHost;
use crate::program_chance;
use crate::program_proof::ProofUnderWay;
use crate::sampling::Sampled;

/// Runs are made for about this long before the answer says how far they got.
const SAMPLING_MILLIS: f64 = 120.0;

impl Core {
    pub(super) fn execute(&mut self, update: &Update, script: Script, host: &mut dyn CoreHost) {
        let revision = update.revision;
        let Some(evaluated) = self.evaluate(update, host) else { return };
        let executed = evaluated.and_then(|evaluated| {
            // The plan that is kept is that of the text, and so are its runs.
            if let Some(run) = self.last.as_mut().and_then(|last| last.executions.find(&script, revision)) {
                return Ok(run);
            }
            evaluated.compiled.check_script(&script)?;
            let ran = self.run(&evaluated, &script).ok_or_else(|| NO_PLAN.to_owned())?;
            let ran = ran.map_err(|error| error.to_string())?;
            let (program, planned) = (&evaluated.compiled.program, &evaluated.planned);
            let run = Arc::new(execution::executed(revision, script, program, planned, ran));
            self.last.iter_mut().for_each(|last| last.executions.keep(Arc::clone(&run)));
            Ok(run)
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
        let sampled = evaluated.and_then(|it| self.sample_evaluated(&it, revision, &settings, from, host));
        host.answer(match sampled {
            Ok(tally) => Response::Sampled { revision, settings: Box::new(settings), from, tally },
            Err(reason) => Response::NotExecuted { revision, reason },
        });
    }

    fn sample_evaluated(
        &mut self,
        evaluated: &Evaluated,
        revision: u64,
        settings: &RobustnessSettings,
        from: u64,
        host: &mut dyn CoreHost,
    ) -> Result<Tally, String> {
        let begun = host.now_millis();
        let is_known =
            |known: &Sampled| known.revision == revision && known.uncertainty == settings.uncertainty;
        let sampled = match self.sampler.take().filter(is_known) {
            Some(known) => known,
            None => Sampled {
                revision,
                uncertainty: settings.uncertainty.clone(),
                sampler: evaluated
                    .sampler(&settings.uncertainty)
                    .ok_or_else(|| NO_PLAN.to_owned())?
                    .map_err(|error| error.to_string())?,
            },
        };
        let mut tally = Tally::default();
        for number in from..settings.runs {
            self.sample_run((evaluated, &sampled.sampler), settings, number, &mut tally)
                .map_err(|error| error.to_string())?;
            if host.now_millis() - begun > SAMPLING_MILLIS || host.is_superseded() {
                break;
            }
        }
        self.sampler = Some(sampled);
        Ok(tally)
    }

    /// Tries one more schedule or run of the plan, or other plans, against the items without a counterexample. Returns whether
    /// anything was left to try.
    pub fn try_next(&mut self, evaluated: &Evaluated, trial: &mut Trial) -> Result<bool, PlanError> {
        if trial.try_schedule() {
            return Ok(true);
        }
        if trial.wants_plans() {
            trial.try_plans(&contradicting::other_plans(evaluated, &mut self.grounds, &mut self.paths));
            return Ok(true);
        }
        let Some(script) = trial.next_run() else { return Ok(false) };
        let Some(ran) = self.run(evaluated, &script) else { return Ok(false) };
        let Ran { outcome, drives, .. } = ran?;
        let sight = |vehicle: &str, location: &str, at: Time| {
            contradicting::sight(evaluated, &drives, (vehicle, location), at)
        };
        trial.try_run(&script, &Observed { log: &outcome.log, ending: outcome.ending, sight: &sight });
        Ok(true)
    }

    /// Tries the lines of a review, from where the last request ended.
    pub(super) fn contradict(
        &mut self,
        update: &Update,
        review: &Arc<Review>,
        (only, effort): (Option<&LineKey>, Effort),
        from: u64,
        host: &mut dyn CoreHost,
    ) {
        let begun = host.now_millis();
        let revision = update.revision;
        let Some(evaluated) = self.evaluate(update, host) else { return };
        let tried = evaluated.and_then(|evaluated| {
            let wanted = (revision, only.cloned(), effort);
            let known = self.trying.take().filter(|it| it.of == wanted && it.trial.progress()[0] == from);
            let mut trying = if let Some(known) = known {
                known
            } else {
                let trial = Trial::new(&evaluated.snapshot(), review, only, effort);
                Trying { of: wanted, trial: trial.ok_or_else(|| NO_PLAN.to_owned())? }
            };
            while self.try_next(&evaluated, &mut trying.trial).map_err(|error| error.to_string())? {
                if host.now_millis() - begun > SAMPLING_MILLIS || host.is_superseded() {
                    break;
                }
            }
            let (progress, tried) = (trying.trial.progress(), trying.trial.tried().cloned().collect());
            self.trying = Some(trying);
            Ok((progress, tried))
        });
        let (progress, tried) = tried.map_or_else(|reason| ([0; 2], Err(reason)), |(at, it)| (at, Ok(it)));
        host.answer(Response::Contradicted { revision, only: only.cloned(), progress, tried });
    }

    /// Finds out whether a rule holds in every plan.
    pub(super) fn prove_rule_of(
        &mut self,
        update: &Update,
        rule: &MissionRule,
        alternatives: u64,
        host: &mut dyn CoreHost,
    ) {
        let Some(evaluated) = self.evaluate(update, host) else { return };
        let proven = evaluated
            .map(|evaluated| self.prove_rule(&evaluated, rule, alternatives, &mut || host.is_superseded()));
        if !host.is_superseded() {
            let (revision, rule) = (update.revision, rule.rule.clone());
            host.answer(Response::RuleProven { revision, rule, alternatives, proven });
        }
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

    /// Continues a proof about a control program from where the last request ended.
    pub(super) fn prove_program(
        &mut self,
        (revision, source): (u64, &Arc<str>),
        question: ProofQuestion,
        from: usize,
        host: &mut dyn CoreHost,
    ) {
        let begun = host.now_millis();
        let known = self.proof.take().filter(|proof| proof.is_of(source, &question, from));
        let proof = known.map_or_else(
            || ProofUnderWay::new(source, self.controls.read(source, question.plant.as_ref()), &question),
            Ok,
        );
        let mut go_on = || host.now_millis() - begun <= SAMPLING_MILLIS && !host.is_superseded();
        let (states, answer) = match proof.and_then(|proof| proof.lead_on(&mut go_on)) {
            Ok((states, Ok(answer))) => (states, Some(Ok(answer))),
            Ok((states, Err(proof))) => {
                self.proof = Some(proof);
                (states, None)
            }
            Err(reason) => (0, Some(Err(reason))),
        };
        host.answer(Response::ProgramProven { revision, question, states, answer });
    }
}

const NO_PLAN: &str = "the mission has no plan to execute";
