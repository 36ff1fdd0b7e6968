//! A text evaluated stage by stage: requests that need its plan build on this, and so does a host that waits for each
//! stage, such as the command line.

use std::sync::Arc;

use exact::Time;
use executive::{PlanError, Script};
use link::Update;
use review::MissionRule;
use review::flight_rule::proof::Proven;
use rmpl::Diagnostic;
use rmpl::program::{Program, World};
use snapshot::content::Keyed;
use snapshot::{Goal, RobustnessSettings, Tally, Timings};
use tpn::{Network, Plan};

use super::Core;
use crate::control::check_control;
use crate::evaluated::{Compiled, Evaluated, Ground, Manner, Scenarios};
use crate::execution::{self, Ran};
use crate::given_plan;
use crate::host::CoreHost;
use crate::listing;
use crate::programs::Programs;
use crate::proving;
use crate::reading;
use crate::sampling::Sampler;
use crate::saved_state::SavedState;

impl Core {
    /// Makes a map file available to `terrain "name"` declarations, or says why it cannot be read.
    pub fn import(&mut self, name: &str, bytes: &[u8]) -> Result<(), String> {
        self.grounds.import(name, bytes).map(|_| ())
    }

    /// Lets missions start from a state instead of what their texts say.
    pub fn start_from(&mut self, start: SavedState) {
        self.reading.start_from(start);
    }

    /// Reads a text and compiles what is to be planned of it. What is kept of an earlier plan follows the text.
    pub fn compile(&mut self, update: &Update, host: &dyn CoreHost) -> Compiled {
        let begun = host.now_millis();
        self.read(update);
        let parsed = host.now_millis();
        let (network, diagnostics) = self.reading.compile(&update.goal, &mut self.grounds, &mut self.keys);
        let compile_millis = host.now_millis() - parsed;
        Compiled {
            source: Arc::clone(update.source.text()),
            goal: update.goal.clone(),
            is_network: self.reading.is_network(),
            program: self.reading.program().value,
            diagnostics,
            timings: Timings { parse_millis: parsed - begun, compile_millis, plan_millis: 0.0 },
            network,
            programs: self.reading.programs(),
        }
    }

    /// Reads a text in either notation, and compiles all of its scenarios.
    pub fn compile_all(&mut self, update: &Update, host: &dyn CoreHost) -> Scenarios {
        if rmpl::control::is_control_text(&update.source) {
            let diagnostics = check_control(&update.source);
            return Scenarios { diagnostics, ..Scenarios::default() };
        }
        self.read(update);
        let program = self.reading.program().value;
        if program.scenarios.is_empty() && (self.reading.is_network() || !program.activities.is_empty()) {
            let compiled = self.compile(&Update { goal: Goal::Default, ..update.clone() }, host);
            let diagnostics = compiled.diagnostics.clone();
            return Scenarios { program, diagnostics, scenarios: vec![compiled] };
        }
        let mut diagnostics = self.reading.diagnostics();
        if program.scenarios.is_empty() {
            return Scenarios { program, diagnostics, scenarios: Vec::new() };
        }
        let has_ground = program.world != World::default();
        let networks = reading::compile_scenarios(&program, &mut self.grounds, &mut diagnostics, has_ground);
        let scenario = |network: Network| Compiled {
            source: Arc::clone(update.source.text()),
            goal: Goal::Default,
            is_network: false,
            program: Arc::clone(&program),
            diagnostics: Vec::new(),
            timings: Timings::default(),
            programs: Arc::new(Programs::compile(&program, Some(&network)).0),
            network: Some(Keyed { key: self.keys.fresh(), value: Arc::new(network) }),
        };
        let scenarios = networks.into_iter().flatten().map(scenario).collect();
        Scenarios { program, diagnostics, scenarios }
    }

    /// Asks for another gap between ordered intervals than the text does.
    pub fn set_threat_gap(&mut self, compiled: &mut Compiled, gap: Time) {
        if let Some(network) = &mut compiled.network {
            network.key = self.keys.fresh();
            Arc::make_mut(&mut network.value).threat_gap = gap;
        }
    }

    /// The ground of a mission, or what is wrong with the terrain that it names.
    pub fn ground(&mut self, program: &Program) -> Result<Option<Ground>, Box<Diagnostic>> {
        let (ground, problems) = self.grounds.resolve(program);
        problems.into_iter().next().map_or(Ok(ground), |problem| Err(Box::new(problem)))
    }

    /// Plans a text, with paths if there is ground; `None` without a network.
    pub fn plan(
        &mut self,
        compiled: Compiled,
        ground: Option<Ground>,
        manner: Manner,
        host: &mut dyn CoreHost,
    ) -> Option<Evaluated> {
        let network = Arc::clone(compiled.network()?);
        let (planned, _) = self.planned(&compiled, &network, ground.as_ref(), &manner, host);
        Some(Evaluated { compiled, network, ground, planned, manner })
    }

    /// The plan of a text, as it is kept; `None` if that was given up for a newer request, an error if it has none.
    pub(super) fn evaluate(
        &mut self,
        update: &Update,
        host: &mut dyn CoreHost,
    ) -> Option<Result<Evaluated, String>> {
        if rmpl::control::is_control_text(&update.source) {
            return Some(Err(
                "this is a control program: run it step by step in the Automaton panel".to_owned()
            ));
        }
        let compiled = self.compile(update, host);
        let Some(network) = compiled.network.clone() else {
            return Some(Err("the mission has errors".to_owned()));
        };
        let (ground, _) = self.grounds.resolve(&compiled.program);
        let manner = Manner::of(update);
        let planned = self.plan_kept(&compiled, &network, ground.as_ref(), manner, host)?.planned.clone();
        Some(Ok(Evaluated { compiled, network: network.value, ground, planned, manner }))
    }

    /// Puts a plan that is given in the place of the one that was found, with the paths of its own traverses. `read` reads
    /// it as a plan of a network; fails if it is a plan of none, or its traverses can't be driven.
    pub fn take_plan(
        &mut self,
        evaluated: &mut Evaluated,
        read: &dyn Fn(&Network) -> Result<Plan, String>,
    ) -> Result<(), String> {
        let problem = evaluated.problem();
        evaluated.planned =
            given_plan::planned(&problem, &evaluated.planned, read, &mut self.grounds, &mut self.paths)?;
        Ok(())
    }

    /// Executes the plan; `None` if there is none.
    pub fn run(&mut self, evaluated: &Evaluated, script: &Script) -> Option<Result<Ran, PlanError>> {
        let problem = evaluated.problem();
        execution::execute(&problem, &evaluated.planned, script, &mut self.grounds, &mut self.paths)
    }

    /// Simulates run `number` with the seed and the uncertainty of `settings`, and adds its result to `tally`.
    pub fn sample_run(
        &mut self,
        (evaluated, sampler): (&Evaluated, &Sampler),
        settings: &RobustnessSettings,
        number: u64,
        tally: &mut Tally,
    ) -> Result<(), PlanError> {
        sampler.run(&evaluated.problem(), settings, number, &mut self.grounds, &mut self.paths, tally)
    }

    /// Proves that a flight rule holds in every plan of the mission, or finds one that breaks it; the planner tries so many
    /// alternatives.
    pub fn prove_rule(
        &mut self,
        evaluated: &Evaluated,
        rule: &MissionRule,
        alternatives: u64,
        stop: &mut dyn FnMut() -> bool,
    ) -> Proven {
        let ways = (&mut self.grounds, &mut self.paths);
        proving::prove_rule(evaluated, rule, alternatives, ways, stop)
    }

    /// The network with the paths of another plan than the one that was found; why there are none.
    pub fn network_of(&mut self, evaluated: &Evaluated, plan: &Plan) -> Result<Network, String> {
        listing::network_of(&evaluated.problem(), plan, &mut self.grounds, &mut self.paths)
    }
}
