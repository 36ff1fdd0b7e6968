//! A text as far as it has been evaluated: compiled, and planned.

use std::sync::Arc;

use executive::{PlanError, Script};
use kirk::Options;
use link::Update;
use rmpl::Diagnostic;
use rmpl::program::Program;
use snapshot::content::Keyed;
use snapshot::{Goal, MapKey, Problem, Snapshot, Stage, Timings, Uncertainty};
use terrain::Terrain;
use tpn::Network;

use crate::execution;
use crate::planning::{self, Planned};
use crate::programs::Programs;
use crate::sampling::Sampler;

/// Events of a search that are kept for stepping through it.
pub(crate) const TRACE_EVENTS: usize = 200_000;

/// A text, read and compiled.
#[derive(Clone, Debug)]
pub struct Compiled {
    pub source: Arc<str>,
    /// What of it is to be planned.
    pub goal: Goal,
    /// Whether the text is a network of another tool, so that the program is empty.
    pub is_network: bool,
    /// What it says, as far as it is well formed.
    pub program: Arc<Program>,
    /// What is wrong with it, or could be.
    pub diagnostics: Vec<Diagnostic>,
    /// How long reading and compiling took.
    pub timings: Timings,
    pub(crate) network: Option<Keyed<Network>>,
    pub(crate) programs: Arc<Programs>,
}

/// A text with all of its scenarios.
#[derive(Clone, Debug, Default)]
pub struct Scenarios {
    /// What it says, as far as it is well formed.
    pub program: Arc<Program>,
    /// All that is wrong with it, whatever is planned of it.
    pub diagnostics: Vec<Diagnostic>,
    /// Its scenarios, if they are on ground and no error prevents one; without scenarios what is planned by default.
    pub scenarios: Vec<Compiled>,
}

/// The map of a mission that has places, and its name.
pub type Ground = (MapKey, Arc<Terrain>);

/// How a text is planned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Manner {
    /// How to search, and for what.
    pub options: Options,
    /// Seeds path planning.
    pub seed: u64,
    /// Whether the network is planned as it is, without looking for paths of its traverses.
    pub without_paths: bool,
    /// Whether changes of the text are looked for that give it a plan, where it has none.
    pub with_repairs: bool,
    /// The best plan that was found in this time is enough.
    pub most_millis: Option<f64>,
}

impl Manner {
    /// Plans with paths, and does not explain why there is no plan.
    pub fn unexplained() -> Self {
        let options = Options { explain: false, relax: false, ..Options::default() };
        Self { options, ..Self::default() }
    }

    /// Returns how an update asks for its plan.
    pub(crate) fn of(update: &Update) -> Self {
        let trace_events = update.trace.map(|_| TRACE_EVENTS);
        let options =
            Options { search: update.search, traced: update.trace, trace_events, ..Options::default() };
        Self { options, seed: update.seed, with_repairs: true, ..Self::default() }
    }
}

/// A text with its plan, or with the reasons why there is none.
#[derive(Clone, Debug)]
pub struct Evaluated {
    pub compiled: Compiled,
    /// The network without paths.
    pub network: Arc<Network>,
    /// The ground, if the mission has one.
    pub ground: Option<Ground>,
    /// What planning found.
    pub planned: Planned,
    pub(crate) manner: Manner,
}

impl Compiled {
    /// The network, unless an error prevents it.
    pub fn network(&self) -> Option<&Arc<Network>> {
        self.network.as_ref().map(|network| &network.value)
    }

    /// Returns how it is planned as it is usual, once `network` is that of the text.
    pub(crate) fn problem<'a>(
        &'a self,
        network: &'a Arc<Network>,
        ground: Option<&'a Ground>,
        seed: u64,
    ) -> planning::Problem<'a> {
        planning::Problem {
            ground: ground.map(|(key, map)| (key, map)),
            seed,
            programs: Some(&self.programs),
            ..planning::Problem::new(network, &self.program)
        }
    }

    /// Returns what is wrong with it, or could be, in textual order.
    pub fn problems(&self) -> Vec<Problem> {
        Problem::all(&self.diagnostics, &self.source)
    }

    /// Whether a script means something and is about what the mission has; if not, what is wrong with it.
    pub fn check_script(&self, script: &Script) -> Result<(), String> {
        let Some(network) = self.network() else { return Ok(()) };
        execution::check_script(network, &self.program, &self.programs, script)
    }
}

impl Evaluated {
    pub(crate) fn problem(&self) -> planning::Problem<'_> {
        planning::Problem {
            options: Options { trace_events: None, ..self.manner.options },
            ..self.compiled.problem(&self.network, self.ground.as_ref(), self.manner.seed)
        }
    }

    /// Returns what is known of it, as panels and reviews read it; without keys, which tell what an edit changed.
    pub fn snapshot(&self) -> Snapshot {
        let Self { compiled, planned, ground, .. } = self;
        let warnings = Problem::all(&planned.warnings, &compiled.source);
        let mut problems: Vec<Problem> = compiled.problems().into_iter().chain(warnings).collect();
        problems.sort_by_key(|problem| (problem.span, problem.severity));
        Snapshot {
            stage: Stage::Complete,
            problems: problems.into(),
            program: Arc::clone(&compiled.program),
            network: Some(Arc::clone(&planned.network)),
            planning: Some(Arc::clone(&planned.planning)),
            map: ground.as_ref().map(|(key, _)| key.clone()),
            traverses: planned.traverses.clone().into(),
            motions: planned.motions.clone().into(),
            separation_violations: planned.separation_violations.clone().into(),
            timings: compiled.timings,
            ..Snapshot::empty(0, Arc::clone(&compiled.source))
        }
    }

    /// Prepares the plan for random runs. `None` if there is no plan.
    pub fn sampler(&self, uncertainty: &Uncertainty) -> Option<Result<Sampler, PlanError>> {
        Sampler::new(&self.problem(), &self.planned, uncertainty)
    }
}
