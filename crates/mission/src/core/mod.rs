//! The chain from text to plan to paths, with each stage's last result kept.
//!
//! A request redoes only what its text changed: an edit that leaves the network as it was keeps the plan, and paths are
//! kept by their inputs. The caller gives the clock, is asked whether to continue, and gets answers as stages complete.

mod control_run;
mod evaluating;
mod executions;
mod path_growth;
mod planned;
mod running;

use std::sync::Arc;

use interchange::geojson;
use link::{Request, Response, Update};
use review::MissionRule;
use snapshot::PartKeys;
use snapshot::Problem;
use snapshot::content::Keys;
use snapshot::{MapKey, Snapshot, Stage, Timings};
use terrain::Terrain;

use crate::both_searches;
use crate::contradicting::Trying;
use crate::control::ControlTexts;
use crate::evaluated::{Manner, TRACE_EVENTS};
use crate::ground::Grounds;
use crate::host::{CoreHost, LastSnapshot, Unhurried};
use crate::program_proof::ProofUnderWay;
use crate::reading::{Followed, Reading};
use crate::sampling::Sampled;
use crate::traverse::Paths;

/// The planning core of one mission. Feed it requests in order.
#[derive(Default)]
pub struct Core {
    grounds: Grounds,
    paths: Paths,
    /// The ground that was answered last.
    sent: Option<MapKey>,
    keys: Keys,
    reading: Reading,
    last: Option<planned::Last>,
    sampler: Option<Sampled>,
    trying: Option<Trying>,
    controls: ControlTexts,
    control_run: Option<control_run::Session>,
    proof: Option<ProofUnderWay>,
    growth: Vec<path_growth::Session>,
}

/// Planning that is done within this time is answered once, with the plan.
const QUICK_MILLIS: f64 = 60.0;

/// The search for the best plan starts again after this time, and then each time after this factor longer. The best plan so
/// far is shown meanwhile.
const IMPROVING_MILLIS: f64 = 1_000.0;
const IMPROVING_FACTOR: f64 = 4.0;

impl Core {
    /// Does what is asked for. Superseded requests end early and may have answered only in part.
    pub fn handle(&mut self, request: Request, host: &mut dyn CoreHost) {
        match request {
            Request::ImportMap { name, bytes } => self.import_map(name, &bytes, host),
            Request::Update(update) => self.update(&update, host),
            Request::Execute { update, script } => self.execute(&update, script, host),
            Request::Sample { update, settings, from } => self.sample(&update, settings, from, host),
            Request::SampleProgram { revision, source, chance, from } => {
                self.sample_program((revision, source.text()), chance, from, host);
            }
            Request::ProveProgram { revision, source, question, from } => {
                self.prove_program((revision, source.text()), question, from, host);
            }
            Request::Review { update, rules } => self.review(&update, &rules, host),
            Request::Contradict { update, review, only, effort, from } => {
                self.contradict(&update, &review, (only.as_ref(), effort), from, host);
            }
            Request::ProveRule { update, rule, alternatives } => {
                self.prove_rule_of(&update, &rule, alternatives, host);
            }
            Request::Evaluate { token, update } => self.evaluate_beside(token, &update, host),
            Request::CompareSearches(update) => self.search_both_ways(&update, host),
            Request::RunControl(wanted) => self.run_control(&wanted, host),
            Request::GrowPath(wanted) => self.grow_path(&wanted, host),
        }
    }

    fn import_map(&mut self, name: smol_str::SmolStr, bytes: &[u8], host: &mut dyn CoreHost) {
        if let Some(read) = geojson::declarations_of_file(&name, bytes) {
            host.answer(match read {
                Ok(lines) => Response::PlacesRead { name, lines },
                Err(reason) => Response::MapRejected { name, reason: reason.to_string() },
            });
            return;
        }
        host.answer(match self.grounds.import(&name, bytes) {
            Ok(map) => Response::MapAccepted {
                name,
                cells: [map.frame().width, map.frame().height],
                no_data_cells: map.no_data_count() as u64,
            },
            Err(reason) => Response::MapRejected { name, reason },
        });
    }

    /// The plan is kept from the update before, so this takes only the time of the review itself.
    fn review(&mut self, update: &Update, rules: &[MissionRule], host: &mut dyn CoreHost) {
        let told = self.last.as_ref().and_then(planned::Last::final_plan);
        let mut silent = LastSnapshot { host, passes_maps: true, last: None };
        self.update(update, &mut silent);
        let Some(snapshot) = silent.last else { return };
        // Where planning had been stopped, the plan that is reviewed is another one than was told.
        if self.last.as_ref().and_then(planned::Last::final_plan) != told {
            host.answer(Response::Snapshot(Arc::clone(&snapshot)));
        }
        let mut stop = || host.is_superseded();
        let mut review = review::review(&snapshot, &update.goal, update.seed, &mut stop);
        review.findings = review::flight_rule::evaluate(&snapshot, rules, &mut stop);
        if !host.is_superseded() {
            let review = Arc::new(review);
            host.answer(Response::Review { revision: update.revision, review });
        }
    }

    /// The open text's own plan is kept.
    fn evaluate_beside(&mut self, token: u64, update: &Update, host: &mut dyn CoreHost) {
        let (last, sent, reading) = (self.last.take(), self.sent.take(), std::mem::take(&mut self.reading));
        let mut silent = LastSnapshot { host, passes_maps: false, last: None };
        self.update(update, &mut silent);
        let found = silent.last;
        (self.last, self.sent, self.reading) = (last, sent, reading);
        if let Some(snapshot) = found.filter(|snapshot| snapshot.stage == Stage::Complete) {
            host.answer(Response::Evaluated { token, snapshot });
        }
    }

    /// Searches the network with the paths that its plan needs both ways, recorded and measured.
    fn search_both_ways(&mut self, update: &Update, host: &mut dyn CoreHost) {
        let Some(Ok(evaluated)) = self.evaluate(update, host) else { return };
        let network = &evaluated.planned.network;
        if let Some(comparison) = both_searches::search(network, update.revision, TRACE_EVENTS, host) {
            host.answer(Response::Searches(Arc::new(comparison)));
        }
    }

    /// Reads a text; what is kept of the plan follows it.
    fn read(&mut self, update: &Update) {
        let structure = self.reading.network_key();
        let followed = self.reading.follow(update.revision, &update.source, &mut self.keys);
        if let (Followed::Moved(shift), Some(last)) = (followed, &mut self.last)
            && Some(last.structure) == structure
        {
            last.follow(shift, &self.reading);
        }
    }

    fn update(&mut self, update: &Update, host: &mut dyn CoreHost) {
        if rmpl::control::is_control_text(&update.source) {
            self.update_control(update, host);
            return;
        }
        let begun = host.now_millis();
        let mut compiled = self.compile(update, host);
        let (ground, found) = self.grounds.resolve(&compiled.program);
        compiled.diagnostics.extend(found);
        let planning = host.now_millis();
        let parse_millis = compiled.timings.parse_millis;
        let mut snapshot = Snapshot {
            problems: compiled.problems().into(),
            program: Arc::clone(&compiled.program),
            map: ground.as_ref().map(|(key, _)| key.clone()),
            keys: PartKeys { program: self.reading.program().key, ..PartKeys::default() },
            timings: Timings { compile_millis: planning - begun - parse_millis, ..compiled.timings },
            ..Snapshot::empty(update.revision, Arc::clone(update.source.text()))
        };
        self.show_ground(ground.as_ref(), host);
        let Some(network) = compiled.network.clone() else {
            snapshot.stage = Stage::Complete;
            host.answer(Response::Snapshot(Arc::new(snapshot)));
            return;
        };
        snapshot.network = Some(Arc::clone(&network.value));
        snapshot.keys.network = network.key;
        let waiting = Some(Arc::new(snapshot.clone()));
        let mut unhurried = Unhurried { host, waiting, due_millis: planning + QUICK_MILLIS };
        let is_improved = !network.value.objective.is_empty() && unhurried.wants_first_plans();
        let mut most_millis = if is_improved { IMPROVING_MILLIS } else { f64::INFINITY };
        loop {
            let most = Some(most_millis).filter(|most| most.is_finite());
            let manner = Manner { most_millis: most, ..Manner::of(update) };
            let last = self.plan_kept(&compiled, &network, ground.as_ref(), manner, &mut unhurried);
            let Some(last) = last else { return };
            let warnings = Problem::all(&last.planned.warnings, &update.source);
            let mut snapshot = snapshot.clone();
            let mut problems: Vec<Problem> = snapshot.problems.iter().cloned().chain(warnings).collect();
            problems.sort_by_key(|problem| (problem.span, problem.severity));
            snapshot.problems = problems.into();
            last.shown.show(&mut snapshot);
            snapshot.stage = if last.is_final { Stage::Complete } else { Stage::Improving };
            snapshot.timings.plan_millis = unhurried.now_millis() - planning;
            let is_final = last.is_final;
            if is_final || snapshot.plan().is_some() {
                unhurried.answer(Response::Snapshot(Arc::new(snapshot)));
            }
            if is_final {
                return;
            }
            most_millis *= IMPROVING_FACTOR;
        }
    }

    /// Answers with the ground before the first snapshot that refers to it.
    fn show_ground(&mut self, ground: Option<&(MapKey, Arc<Terrain>)>, host: &mut dyn CoreHost) {
        if let Some((key, map)) = ground
            && self.sent.as_ref() != Some(key)
        {
            host.answer(Response::Map { key: key.clone(), map: Arc::clone(map) });
            self.sent = Some(key.clone());
        }
    }
}
