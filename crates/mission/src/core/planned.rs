//! The plan of the last request, kept for as long as what it depends on stays the same.

use std::cell::Cell;
use std::sync::Arc;

use kirk::{Stats, Status};
use rmpl::Shift;
use rmpl::program::Program;
use rmpl::spans::Spans as _;
use snapshot::content::{Keyed, Keys};
use snapshot::{ContentKey, MapKey, Planning, SeparationViolation, Snapshot, Traverse, VehicleMotion};
use tpn::{Network, Plan};

use super::Core;
use super::executions::Executions;
use crate::evaluated::{Compiled, Ground, Manner};
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
    manner: Manner,
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
    /// Returns what is equal to what an earlier plan showed is kept. `network` is the one without paths.
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
    /// Plans, unless the plan of the last request still holds: same network, world and manner. `None` if that was given up.
    pub(super) fn plan_kept(
        &mut self,
        compiled: &Compiled,
        network: &Keyed<Network>,
        ground: Option<&Ground>,
        manner: Manner,
        host: &mut dyn CoreHost,
    ) -> Option<&Last> {
        let map = ground.map(|(key, _)| key.clone());
        let program = &compiled.program;
        let holds = self.last.as_ref().is_some_and(|last| {
            last.is_final
                && (last.structure == network.key
                    || last.network == network.value && last.program == *program)
                && (last.manner, &last.map) == (Manner { most_millis: None, ..manner }, &map)
        });
        if holds {
            if let Some(last) = &mut self.last {
                last.structure = network.key;
            }
            return self.last.as_ref();
        }
        let (planned, is_final) = self.planned(compiled, &network.value, ground, &manner, host);
        if host.is_superseded() {
            return None;
        }
        let shown = Shown::new(&planned, network, self.last.as_ref().map(|last| &last.shown), &mut self.keys);
        Some(self.last.insert(Last {
            structure: network.key,
            network: Arc::clone(&network.value),
            program: Arc::clone(program),
            map,
            manner: Manner { most_millis: None, ..manner },
            planned,
            is_final,
            shown,
            executions: Executions::default(),
        }))
    }

    /// Plans, and tells whether no better plan is to be looked for.
    pub(super) fn planned(
        &mut self,
        compiled: &Compiled,
        network: &Arc<Network>,
        ground: Option<&Ground>,
        manner: &Manner,
        host: &mut dyn CoreHost,
    ) -> (Planned, bool) {
        let enough = Cell::new(false);
        let problem = planning::Problem {
            options: manner.options,
            enough: Some(&enough),
            ..compiled.problem(network, ground, manner.seed)
        };
        let due_millis = manner.most_millis.map(|most| host.now_millis() + most);
        let mut stop = || {
            enough.set(due_millis.is_some_and(|due| host.now_millis() >= due));
            host.is_superseded()
        };
        if manner.without_paths {
            let outcome = kirk::plan(network, &manner.options, &mut |_: &Stats| stop() || enough.get());
            return (planning::without_paths(network, outcome), !enough.get());
        }
        let mut planned = planning::plan(&problem, &mut self.grounds, &mut self.paths, &mut stop);
        planned.warnings.extend(self.grounds.unclear_cells(&compiled.program));
        let outcome = &planned.planning.outcome;
        let is_proven = |plan: &Plan| plan.quality.is_optimal == Some(true);
        let is_decided = outcome.status == Status::NoPlan || outcome.plans.first().is_some_and(is_proven);
        let is_final = is_decided || !enough.get();
        if is_final && manner.with_repairs {
            let text = (&*compiled.source, &compiled.goal);
            repairs::add(&mut planned, text, &problem, (&mut self.grounds, &mut self.paths), &mut stop);
        }
        (planned, is_final)
    }
}
