//! Who carries an activity out: between its start, which the plan decides, and its end, which is reported.

use exact::{Overflow, Rational, Time};
use smol_str::SmolStr;
use tpn::{EventRef, Network, OccurrenceId};

use crate::log::Entry;

/// How an activity that has just been started will go.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ActivityExecution {
    /// When it will be over.
    pub ends: Ends,
    /// What will be seen of it until then, in order of time. Of an activity that is stopped the rest is not seen.
    pub entries: Vec<Entry>,
    /// After how long a traverse passes the vertices of its path, in order; one that is not listed is passed as planned.
    pub passes: Vec<(EventRef, Time)>,
    /// After how long a traverse has driven how many meters more than its path has, or fewer, in order of time: as soon as
    /// it has driven more than the plan counts at most, and when it is there.
    pub extra_meters: Vec<(Time, Rational)>,
    /// How many meters more than its path has the plan counts for a traverse at most, and how many fewer at least.
    pub counted_margins: [Rational; 2],
}

/// When an activity will be over.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Ends {
    /// When the plan wants it to be.
    #[default]
    AsPlanned,
    /// After this long, in mission units.
    After(Time),
    /// As soon as the plan wants it after this long: a vehicle that is early waits.
    NotBefore(Time),
    /// Never; the reason, such as `the program did not reach its end in 40 steps`.
    Never(String),
}

impl Ends {
    /// Returns how long it takes at least; `None` if it never ends.
    pub(crate) const fn least(&self) -> Option<Time> {
        match self {
            Self::AsPlanned => Some(Time::ZERO),
            Self::After(duration) | Self::NotBefore(duration) => Some(*duration),
            Self::Never(_) => None,
        }
    }
}

/// That two vehicles touch, which ends a run: whatever its plan allows for, that is not among it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contact {
    /// When, in mission units from the start.
    pub at: Time,
    /// The activity under way in which it happens.
    pub name: SmolStr,
    /// Who touches whom, and where.
    pub reason: String,
}

/// What goes otherwise than it was said when activities were started, from now on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Revision {
    /// Activities under way, each with how it will go instead.
    pub executions: Vec<(OccurrenceId, ActivityExecution)>,
    /// What will be read from the plant, in order of time; instead of all that was to be read, if that changes.
    pub readings: Option<Vec<PlantReading>>,
}

/// That the mode of a component of the plant is another one, as far as that can be told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlantReading {
    /// When that is found out.
    pub at: Time,
    /// The variable that represents the mode.
    pub variable: SmolStr,
    /// Its value from then on.
    pub value: SmolStr,
}

/// Carries activities out. Whatever it does must follow from its own inputs: a run is worked out as often as it is
/// looked at.
pub trait ActivityExecutor {
    /// Starts an activity at `start`, in mission units; an error if a time of it does not fit. Not called for one whose duration the world decides.
    fn start(
        &mut self,
        network: &Network,
        occurrence: OccurrenceId,
        start: Time,
    ) -> Result<ActivityExecution, Overflow>;

    /// Returns where the vehicles of activities that were started are at `now`, or where they stand, in meters.
    fn whereabouts(&self, _: &Network, _: &[OccurrenceId], _: Time) -> Vec<(u32, [f64; 2])> {
        Vec::new()
    }

    /// When vehicles touch first in what was started so far, if nothing of it is given up.
    fn contact(&self) -> Option<Contact> {
        None
    }

    /// Activities that were started are given up at `now`: what of them is not over is ended early.
    fn abandon(&mut self, _: &Network, _: &[OccurrenceId], _: Time) {}

    /// Returns what the last start or giving up has changed for others; said once.
    fn revise(&mut self) -> Option<Revision> {
        None
    }

    /// All durations that it gives are multiples of this, which is above 0.
    fn granularity(&self) -> Time {
        Time::ONE
    }
}

/// Every activity takes as long as the plan wants it to.
#[derive(Clone, Copy, Debug, Default)]
pub struct AsPlanned;

impl ActivityExecutor for AsPlanned {
    fn start(&mut self, _: &Network, _: OccurrenceId, _: Time) -> Result<ActivityExecution, Overflow> {
        Ok(ActivityExecution::default())
    }
}
