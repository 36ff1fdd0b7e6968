//! The plan of the last request, kept for as long as what it depends on stays the same.

use std::cell::Cell;
use std::sync::Arc;

use kirk::Options;
use link::Update;
use rmpl::Shift;
use rmpl::program::Program;
use rmpl::spans::Spans as _;
use snapshot::content::{Keyed, Keys};
use snapshot::{ContentKey, MapKey, Planning, SeparationViolation, Snapshot, Traverse, VehicleMotion};
use terrain::Terrain;
use tpn::{Network, Plan};

use super::executions::Executions;
use super::{Core, TRACE_EVENTS};
use crate::host::CoreHost;
use crate::planning::{self, Planned};
use crate::reading::Reading;
use crate::repairs;

/// What the last planned request led to, and what it depended on.
pub(super) struct Last {
    /// The key of the network without paths.
    pub(super) structure: ContentKey,
    network: Arc<Network>,
    program: Arc<Program>,
    map: Option<MapKey>,
    options: Options,
    seed: u64,
    pub(super) planned: Planned,
    /// Whether no better plan is looked for.
    pub(super) is_final: bool,
    pub(super) shown: Shown,
    pub(super) executions: Executions,
}

impl Last {
    /// The plan, by its key, once no better one is looked for.
    pub(super) fn final_plan(&self) -> Option<ContentKey> {
        self.is_final.then_some(self.shown.planning.key)
    }
}

/// What is shown of a plan.
#[derive(Clone)]
pub(super) struct Shown {
    network: Keyed<Network>,
    planning: Keyed<Planning>,
    traverses: Keyed<[Traverse]>,
    motions: Keyed<[VehicleMotion]>,
    separation_violations: Keyed<[SeparationViolation]>,
}

impl Shown {
    /// What is equal to what an earlier plan showed is kept. `network` is the one without paths.
    fn new(planned: &Planned, network: &Keyed<Network>, earlier: Option<&Self>, keys: &mut Keys) -> Self {
        let with_paths = if Arc::ptr_eq(&planned.network, &network.value) {
            network.clone()
        } else {
            Keyed::new(Arc::clone(&planned.network), earlier.map(|it| &it.network), keys)
        };
        Self {
            network: with_paths,
            planning: Keyed::new(Arc::clone(&planned.planning), earlier.map(|it| &it.planning), keys),
            traverses: Keyed::new(planned.traverses.clone().into(), earlier.map(|it| &it.traverses), keys),
            motions: Keyed::new(planned.motions.clone().into(), earlier.map(|it| &it.motions), keys),
            separation_violations: Keyed::new(
                planned.separation_violations.clone().into(),
                earlier.map(|it| &it.separation_violations),
                keys,
            ),
        }
    }

    /// Puts the parts into a snapshot.
    pub(super) fn show(&self, snapshot: &mut Snapshot) {
        let Self { network, planning, traverses, motions, separation_violations } = self.clone();
        snapshot.keys.network = network.key;
        snapshot.keys.planning = planning.key;
        snapshot.keys.traverses = traverses.key;
        snapshot.keys.motions = motions.key;
        snapshot.keys.separation_violations = separation_violations.key;
        snapshot.network = Some(network.value);
        snapshot.planning = Some(planning.value);
        snapshot.traverses = traverses.value;
        snapshot.motions = motions.value;
        snapshot.separation_violations = separation_violations.value;
    }
}

impl Last {
    /// Moves all places through a change that left the program as it is; `reading` has made it already.
    pub(super) fn follow(&mut self, shift: Shift, reading: &Reading) {
        let is_bare = Arc::ptr_eq(&self.planned.network, &self.network);
        self.program = reading.program().value;
        if let Some(network) = reading.network() {
            self.network = network;
        }
        if is_bare {
            self.planned.network = Arc::clone(&self.network);
        } else {
            Arc::make_mut(&mut self.planned.network).follow(shift);
        }
        if self.planned.planning.refers_to_places() {
            Arc::make_mut(&mut self.planned.planning).follow(shift);
        }
        self.planned.warnings.follow(shift);
        self.executions.follow(shift);
        self.shown.network.value = Arc::clone(&self.planned.network);
        self.shown.planning.value = Arc::clone(&self.planned.planning);
    }
}

impl Core {
    /// Plans, unless the plan of the last request still holds: same network, world and options. After `most_millis` the best
    /// plan so far does.
    pub(super) fn plan(
        &mut self,
        update: &Update,
        network: &Keyed<Network>,
        ground: Option<&(MapKey, Arc<Terrain>)>,
        most_millis: Option<f64>,
        host: &mut dyn CoreHost,
    ) -> Option<&Last> {
        let options = Options {
            search: update.search,
            trace_events: update.trace.then_some(TRACE_EVENTS),
            ..Options::default()
        };
        let map = ground.map(|(key, _)| key.clone());
        let program = self.reading.program().value;
        let holds = self.last.as_ref().is_some_and(|last| {
            last.is_final
                && (last.structure == network.key || last.network == network.value && last.program == program)
                && (last.options, last.seed, &last.map) == (options, update.seed, &map)
        });
        if holds {
            if let Some(last) = &mut self.last {
                last.structure = network.key;
            }
            return self.last.as_ref();
        }
        let programs = self.reading.programs();
        let enough = Cell::new(false);
        let problem = planning::Problem {
            ground: ground.map(|(key, map)| (key, map)),
            options,
            seed: update.seed,
            programs: Some(&programs),
            enough: Some(&enough),
            ..planning::Problem::new(&network.value, &program)
        };
        let due_millis = most_millis.map(|most| host.now_millis() + most);
        let mut stop = || {
            enough.set(due_millis.is_some_and(|due| host.now_millis() >= due));
            host.is_superseded()
        };
        let mut planned = planning::plan(&problem, &mut self.grounds, &mut self.paths, &mut stop);
        let text = (&*update.source, &update.goal);
        let is_proven = |plan: &Plan| plan.quality.is_optimal == Some(true);
        let is_final = !enough.get() || planned.planning.outcome.plans.first().is_some_and(is_proven);
        if is_final {
            repairs::add(&mut planned, text, &problem, (&mut self.grounds, &mut self.paths), &mut stop);
        }
        if host.is_superseded() {
            return None;
        }
        let shown = Shown::new(&planned, network, self.last.as_ref().map(|last| &last.shown), &mut self.keys);
        let structure = network.key;
        let network = Arc::clone(&network.value);
        let seed = update.seed;
        let executions = Executions::default();
        let last =
            Last { structure, network, program, map, options, seed, planned, is_final, shown, executions };
        Some(self.last.insert(last))
    }
}
