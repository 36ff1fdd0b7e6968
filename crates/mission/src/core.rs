//! The chain from text to plan to paths, with each stage's last result kept.
//!
//! A request redoes only what its text changed: an edit that leaves the network as it was keeps the plan, and paths are
//! kept by their inputs. The caller gives the clock, is asked whether to go on, and gets answers as stages complete.

mod running;

use std::sync::Arc;

use kirk::Options;
use rmpl::program::Program;
use rmpl::{Diagnostic, Severity};
use terrain::Terrain;
use tpn::{Network, Top};

use crate::both_searches;
use crate::control::read_control;
use crate::ground::Grounds;
use crate::planning::{self, Planned};
use crate::problem::Problem;
use crate::program_chance;
use crate::programs::Programs;
use crate::request::{Goal, Request, Response, Update};
use crate::review;
use crate::snapshot::{MapKey, Snapshot, Stage, Timings};
use crate::traverse::Paths;

/// What the core needs from where it runs.
pub trait Surroundings {
    /// Milliseconds since an arbitrary moment.
    fn now_millis(&self) -> f64;

    /// Whether the request under way should be given up, because a newer one has come.
    fn is_superseded(&mut self) -> bool;

    /// Takes an answer.
    fn answer(&mut self, response: Response);
}

/// The planning core of one mission. Feed it requests in order.
#[derive(Default)]
pub struct Core {
    grounds: Grounds,
    paths: Paths,
    sent: Option<MapKey>,
    last: Option<Last>,
    sampler: Option<running::Sampled>,
}

/// What the last planned request led to, and what it depended on.
struct Last {
    revision: u64,
    network: Arc<Network>,
    program: Arc<Program>,
    map: Option<MapKey>,
    options: Options,
    seed: u64,
    planned: Planned,
}

/// Planning that is done within this time is answered once, with the plan.
const QUICK_MILLIS: f64 = 60.0;

/// Events of a search that are kept for stepping through it.
const TRACE_EVENTS: usize = 200_000;

impl Core {
    /// Works a request out. Superseded requests end early and may have answered only in part.
    pub fn handle(&mut self, request: Request, surroundings: &mut dyn Surroundings) {
        match request {
            Request::ImportMap { name, bytes } => {
                surroundings.answer(match self.grounds.import(&name, &bytes) {
                    Ok(map) => Response::MapAccepted {
                        name,
                        cells: [map.frame().width, map.frame().height],
                        no_data_cells: map.no_data_count() as u64,
                    },
                    Err(reason) => Response::MapRejected { name, reason },
                });
            }
            Request::Update(update) => self.update(&update, surroundings),
            Request::Execute { update, script } => self.execute(&update, script, surroundings),
            Request::Sample { update, settings, from } => {
                self.sample(&update, settings, from, surroundings);
            }
            Request::SampleProgram { revision, source, chance, from } => {
                program_chance::answer((revision, &source), chance, from, surroundings);
            }
            Request::Review(update) => self.review(&update, surroundings),
            Request::WorkOut { token, update } => self.work_out_beside(token, &update, surroundings),
            Request::CompareSearches { revision } => self.search_both_ways(revision, surroundings),
        }
    }

    /// The plan is kept from the update before, so this takes only the time of the review itself.
    fn review(&mut self, update: &Update, surroundings: &mut dyn Surroundings) {
        let mut quiet = Quiet { surroundings, passes_maps: true, last: None };
        self.update(update, &mut quiet);
        let Some(snapshot) = quiet.last else { return };
        let mut stop = || surroundings.is_superseded();
        let review = review::review(&snapshot, &update.goal, update.seed, &mut stop);
        if !surroundings.is_superseded() {
            let review = Arc::new(review);
            surroundings.answer(Response::Review { revision: update.revision, review });
        }
    }

    /// The open text's own plan is kept.
    fn work_out_beside(&mut self, token: u64, update: &Update, surroundings: &mut dyn Surroundings) {
        let (last, sent) = (self.last.take(), self.sent.take());
        let mut quiet = Quiet { surroundings, passes_maps: false, last: None };
        self.update(update, &mut quiet);
        let found = quiet.last;
        (self.last, self.sent) = (last, sent);
        if let Some(snapshot) = found.filter(|snapshot| snapshot.stage == Stage::Complete) {
            surroundings.answer(Response::WorkedOut { token, snapshot });
        }
    }

    /// Searches the network planned last both ways; says nothing when that was another text, or a newer one waits.
    fn search_both_ways(&self, revision: u64, surroundings: &mut dyn Surroundings) {
        let Some(last) = self.last.as_ref().filter(|last| last.revision == revision) else { return };
        let network = &last.planned.network;
        if let Some(comparison) = both_searches::search(network, revision, TRACE_EVENTS, surroundings) {
            surroundings.answer(Response::Searches(Arc::new(comparison)));
        }
    }

    fn update(&mut self, update: &Update, surroundings: &mut dyn Surroundings) {
        if rmpl::control::is_control_text(&update.source) {
            answer_control(update, surroundings);
            return;
        }
        let begun = surroundings.now_millis();
        let parse = rmpl::parse(&update.source);
        let program = Arc::new(parse.program());
        let mut diagnostics = parse.diagnostics();
        let parsed = surroundings.now_millis();
        let network = compile(&program, &update.goal, &mut diagnostics);
        let (ground, found) = self.grounds.resolve(&program.world);
        diagnostics.extend(found);
        let compiled = surroundings.now_millis();
        let mut snapshot = Snapshot {
            revision: update.revision,
            stage: Stage::Compiled,
            source: Arc::clone(&update.source),
            problems: Problem::all(&diagnostics, &update.source),
            program,
            network: network.map(Arc::new),
            planning: None,
            map: ground.as_ref().map(|(key, _)| key.clone()),
            traverses: Vec::new(),
            motions: Vec::new(),
            encounters: Vec::new(),
            robustness: None,
            timings: Timings {
                parse_millis: parsed - begun,
                compile_millis: compiled - parsed,
                plan_millis: 0.0,
            },
        };
        if let Some((key, map)) = &ground
            && self.sent.as_ref() != Some(key)
        {
            surroundings.answer(Response::Map { key: key.clone(), map: Arc::clone(map) });
            self.sent = Some(key.clone());
        }
        let Some(network) = snapshot.network.clone() else {
            snapshot.stage = Stage::Complete;
            surroundings.answer(Response::Snapshot(Arc::new(snapshot)));
            return;
        };
        let waiting = Some(Arc::new(snapshot.clone()));
        let mut unhurried = Unhurried { surroundings, waiting, due_millis: compiled + QUICK_MILLIS };
        let program = Arc::clone(&snapshot.program);
        let Some(planned) = self.plan(update, &network, &program, ground.as_ref(), &mut unhurried) else {
            return;
        };
        snapshot.stage = Stage::Complete;
        snapshot.network = Some(planned.network);
        snapshot.planning = Some(planned.planning);
        snapshot.traverses = planned.traverses;
        snapshot.motions = planned.motions;
        snapshot.encounters = planned.encounters;
        snapshot.problems.extend(Problem::all(&planned.warnings, &update.source));
        snapshot.problems.sort_by_key(|problem| (problem.span, problem.severity));
        snapshot.timings.plan_millis = surroundings.now_millis() - compiled;
        surroundings.answer(Response::Snapshot(Arc::new(snapshot)));
    }

    /// Plans, unless the plan of the last request still holds: same network, world and wishes.
    fn plan(
        &mut self,
        update: &Update,
        network: &Arc<Network>,
        program: &Arc<Program>,
        ground: Option<&(MapKey, Arc<Terrain>)>,
        surroundings: &mut dyn Surroundings,
    ) -> Option<Planned> {
        let options = Options {
            search: update.search,
            trace_events: update.trace.then_some(TRACE_EVENTS),
            ..Options::default()
        };
        let map = ground.map(|(key, _)| key.clone());
        if let Some(last) = &mut self.last
            && last.network == *network
            && last.program == *program
            && (last.options, last.seed, &last.map) == (options, update.seed, &map)
        {
            last.revision = update.revision;
            return Some(last.planned.clone());
        }
        let problem = planning::Problem {
            network,
            program,
            ground: ground.map(|(key, map)| (key, map)),
            options,
            seed: update.seed,
            facts: None,
        };
        let mut stop = || surroundings.is_superseded();
        let planned = planning::plan(&problem, &mut self.grounds, &mut self.paths, &mut stop);
        if surroundings.is_superseded() {
            return None;
        }
        self.last = Some(Last {
            revision: update.revision,
            network: Arc::clone(network),
            program: Arc::clone(program),
            map,
            options,
            seed: update.seed,
            planned: planned.clone(),
        });
        Some(planned)
    }
}

/// Answers with a compiled network once its plan takes long: to send it twice would hold up the plan.
struct Unhurried<'a> {
    surroundings: &'a mut dyn Surroundings,
    waiting: Option<Arc<Snapshot>>,
    due_millis: f64,
}

impl Surroundings for Unhurried<'_> {
    fn now_millis(&self) -> f64 {
        self.surroundings.now_millis()
    }

    fn is_superseded(&mut self) -> bool {
        let is_due = self.surroundings.now_millis() >= self.due_millis;
        if is_due && let Some(snapshot) = self.waiting.take() {
            self.answer(Response::Snapshot(snapshot));
        }
        self.surroundings.is_superseded()
    }

    fn answer(&mut self, response: Response) {
        self.surroundings.answer(response);
    }
}

/// Keeps the last snapshot instead of answering with it.
struct Quiet<'a> {
    surroundings: &'a mut dyn Surroundings,
    passes_maps: bool,
    last: Option<Arc<Snapshot>>,
}

impl Surroundings for Quiet<'_> {
    fn now_millis(&self) -> f64 {
        self.surroundings.now_millis()
    }

    fn is_superseded(&mut self) -> bool {
        self.surroundings.is_superseded()
    }

    fn answer(&mut self, response: Response) {
        match response {
            Response::Snapshot(snapshot) => self.last = Some(snapshot),
            Response::Map { .. } if !self.passes_maps => {}
            other => self.surroundings.answer(other),
        }
    }
}

/// A control program has no network and nothing to plan; what is wrong with it is all there is to tell.
fn answer_control(update: &Update, surroundings: &mut dyn Surroundings) {
    let begun = surroundings.now_millis();
    let (_, diagnostics) = read_control(&update.source, None);
    let snapshot = Snapshot {
        revision: update.revision,
        stage: Stage::Complete,
        source: Arc::clone(&update.source),
        problems: Problem::all(&diagnostics, &update.source),
        program: Arc::default(),
        network: None,
        planning: None,
        map: None,
        traverses: Vec::new(),
        motions: Vec::new(),
        encounters: Vec::new(),
        robustness: None,
        timings: Timings { parse_millis: surroundings.now_millis() - begun, ..Timings::default() },
    };
    surroundings.answer(Response::Snapshot(Arc::new(snapshot)));
}

/// The network of what is to be planned, if no error prevents it; adds what compiling finds to `diagnostics`.
pub fn compile(program: &Program, goal: &Goal, diagnostics: &mut Vec<Diagnostic>) -> Option<Network> {
    let top = match goal {
        Goal::Default => match (program.scenarios.first(), program.activities.last()) {
            (None, Some(activity)) => Top::activity(activity.name.text.clone()),
            _ => Top::Scenario(None),
        },
        Goal::FirstScenario => Top::Scenario(None),
        Goal::Scenario(name) => Top::Scenario(Some(name.clone())),
        Goal::Activity { name, lower, upper } => {
            Top::Activity { name: name.clone(), lower: *lower, upper: *upper }
        }
    };
    let (network, found) = tpn::compile(program, &top);
    tpn::merge_diagnostics(diagnostics, found);
    diagnostics.extend(Programs::compile(program).1);
    network.filter(|_| diagnostics.iter().all(|found| found.severity != Severity::Error))
}
