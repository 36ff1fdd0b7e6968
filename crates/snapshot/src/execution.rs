//! A run of a mission: what happened, by which plans, and where the vehicles were.

use std::collections::BTreeSet;
use std::sync::Arc;

use exact::Time;
use executive::{Ending, Entry, Script};
use plant::Model;
use rmpl::Shift;
use rmpl::spans::Spans as _;
use serde::{Deserialize, Serialize};
use tpn::{Network, OccurrenceId, Plan};

use crate::drive::SimulatedDrive;
use crate::{Traverse, VehicleMotion};

/// A run of a mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Execution {
    /// The revision of the text that was executed.
    pub revision: u64,
    /// What went otherwise than planned.
    #[serde(with = "crate::json_text")]
    pub script: Script,
    /// What happened, in order.
    #[serde(with = "crate::json_text")]
    pub log: Vec<Entry>,
    pub ending: Ending,
    /// The plans that were executed, one after the other; there is at least one.
    pub plans: Vec<Executed>,
    /// The traverses as they were driven, in order of departure.
    pub drives: Vec<SimulatedDrive>,
    /// What control programs command, if activities run any.
    pub commanded: Option<Commanded>,
}

/// The plant of a mission and who commands it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Commanded {
    pub plant: Arc<Model>,
    /// The activities that run a control program.
    pub by: BTreeSet<OccurrenceId>,
}

/// A plan that was executed until the run ended or planned again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Executed {
    /// When it was made.
    pub from: Time,
    /// Its network, with its paths; what was known by then of durations is in it, what had happened is in `times`.
    pub network: Arc<Network>,
    pub plan: Plan,
    /// When each node happened, up to the end of the run.
    pub times: Vec<Option<Time>>,
    /// Its traverses.
    pub traverses: Vec<Traverse>,
    /// Where the vehicles are over time: as it happened, and as planned for what did not happen.
    pub motions: Vec<VehicleMotion>,
}

impl Execution {
    /// Moves all places through an edit of the text that left the mission as it is.
    pub fn follow(&mut self, shift: Shift) {
        for executed in &mut self.plans {
            Arc::make_mut(&mut executed.network).follow(shift);
        }
    }

    /// The plan that was followed at `time`, and its number from 0.
    pub fn plan_at(&self, time: f64) -> Option<(usize, &Executed)> {
        let is_made = |plan: &&Executed| plan.from.to_f64() <= time + 1e-9;
        let at = self.plans.iter().take_while(is_made).count().max(1) - 1;
        Some((at, self.plans.get(at)?))
    }

    /// When the last entry of the log was written.
    pub fn end(&self) -> Time {
        self.log.last().map(|entry| entry.time).unwrap_or_default()
    }
}
