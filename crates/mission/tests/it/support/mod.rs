//! From a text to a plan with its paths, as the tests of missions need it.

use std::cell::Cell;
use std::sync::Arc;

use executive::{Disturbance, Script};
use kirk::Options;
use mission::execution;
use mission::planning::{self, Planned, Problem};
use mission::{Grounds, Paths};
use rmpl::program::Program;
use snapshot::{Execution, Goal};
use tpn::Network;

/// A mission without errors.
pub(crate) struct Mission {
    pub(crate) program: Program,
    pub(crate) network: Arc<Network>,
}

impl Mission {
    pub(crate) fn read(source: &str) -> Self {
        let parse = rmpl::parse(source);
        let program = parse.program();
        let mut diagnostics = parse.diagnostics();
        let network = mission::compile(&program, &Goal::Default, &mut diagnostics);
        Self { network: Arc::new(network.unwrap_or_else(|| panic!("{diagnostics:?}"))), program }
    }

    /// Works with the mission's plan, on its map.
    pub(crate) fn with_plan<T>(
        &self,
        (options, seed): (Options, u64),
        work: impl FnOnce(&Problem<'_>, Planned, &mut Grounds, &mut Paths) -> T,
    ) -> T {
        self.with_plan_until((options, seed), &mut || false, work)
    }

    /// The same with a search that finishes its best plan once `is_enough` says so.
    pub(crate) fn with_plan_until<T>(
        &self,
        (options, seed): (Options, u64),
        is_enough: &mut dyn FnMut() -> bool,
        work: impl FnOnce(&Problem<'_>, Planned, &mut Grounds, &mut Paths) -> T,
    ) -> T {
        let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
        let (ground, found) = grounds.resolve(&self.program);
        assert!(found.is_empty(), "{found:?}");
        let enough = Cell::new(false);
        let problem = Problem {
            ground: ground.as_ref().map(|(key, map)| (key, map)),
            options,
            seed,
            enough: Some(&enough),
            ..Problem::new(&self.network, &self.program)
        };
        let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut || {
            enough.set(is_enough());
            false
        });
        work(&problem, planned, &mut grounds, &mut paths)
    }

    /// Executes the mission's plan.
    pub(crate) fn executed(&self, seed: u64, disturbances: &[Disturbance]) -> Execution {
        let script = Script { disturbances: disturbances.to_vec(), ..Script::default() };
        self.with_plan((Options::default(), seed), |problem, planned, grounds, paths| {
            let verdict = planned.planning.verdict.as_ref().expect("there is a plan");
            assert!(verdict.valid, "{:?}", verdict.violations);
            let ran = execution::execute(problem, &planned, &script, grounds, paths);
            let ran = ran.expect("there is a plan").expect("its times fit");
            execution::executed(1, script.clone(), &self.program, &planned, ran)
        })
    }
}
