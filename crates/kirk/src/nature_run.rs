//! For a mission that the environment can break: the plan that there would be if the executive chose all durations, and
//! the run in which the environment breaks it.

use controllability::{FailingRun, failing_run};
use exact::Time;
use rmpl::program::Controllability;
use tpn::{Choice, Network};

use crate::options::{Options, Stats, Termination};

/// In the plan of a large mission the adversary tries much: a run that it has not found with so much is not told.
const MAX_EFFORT: usize = 20_000_000;

/// The run, with what that plan chooses; `None` if there is no such plan either, or if that takes too long.
pub(crate) fn nature_run(
    network: &Network,
    threat_gap: Option<Time>,
    termination: &mut dyn Termination,
) -> Option<(Vec<Choice>, FailingRun)> {
    let ordinary = Network { controllability: Controllability::None, ..network.clone() };
    let options = Options { threat_gap, explain: false, relax: false, ..Options::default() };
    let plan = crate::plan(&ordinary, &options, termination).plans.into_iter().next()?;
    let mut effort = 0;
    let mut stop = || {
        // Each step looks at every arc at most.
        effort += network.arcs.len();
        effort > MAX_EFFORT || termination.should_stop(&Stats::default())
    };
    let run = failing_run(network, &plan.selected_arcs, &plan.precedences(network), &mut stop)?;
    Some((plan.choices, run))
}
